"""What the server answers. Arrays are read-only. README.md says the frames."""

import enum
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from maploc.arrays import LARGEST_METERS, Floats, matrix_from_quaternion, numbers
from maploc.errors import invalid
from maploc.query import DescriptorKind, Strategy


class Outcome(enum.IntEnum):
    """What became of a query; the numbers are the wire's. A pose comes with LOCALIZED alone; the others are normal
    answers."""

    LOCALIZED = 1
    TOO_FEW_MATCHES = 2
    NO_CONSENSUS = 3  # no hypothesis gathered more support than chance
    LOW_CONFIDENCE = 4  # a pose was found but its evidence is too weak to be trusted
    GRAVITY_INCONSISTENT = 5  # the pose contradicts the gravity that was sent: is it DOWN, in the body frame?
    OUT_OF_MAP = 6
    CALIBRATION_INCONSISTENT = 7  # the matches contradict the camera that was sent


class StrategySource(enum.IntEnum):
    """Who chose a strategy; the numbers are the wire's."""

    DEFAULT = 1  # no evidence yet
    LEARNED = 2  # the selector, from the segment's statistics
    PINNED = 3  # an operator
    REQUESTED = 4  # the query


class SessionEnd(enum.IntEnum):
    """How a session ended; the numbers are the wire's."""

    BY_ROBOT = 1
    IDLE = 2  # closed by the server after a time without queries


@dataclass(frozen=True, eq=False)
class Pose:
    """The body's pose in the map at the moment of the image.

    Attributes:
        position_in_map: shape (3,), the map's unit (metres where Map.metric).
        orientation_xyzw: shape (4,), unit quaternion (Hamilton) of map_from_body, in the order of geometry_msgs.
        covariance: 6 x 6, order x, y, z, rotX, rotY, rotZ about the map's fixed axes (map unit, radians), as
            geometry_msgs/PoseWithCovariance.
    """

    position_in_map: Floats
    orientation_xyzw: Floats
    covariance: Floats

    @property
    def map_from_body(self) -> Floats:
        """4 x 4: takes a point of the body frame to the map."""
        matrix = np.eye(4)
        matrix[:3, :3] = matrix_from_quaternion(self.orientation_xyzw)
        matrix[:3, 3] = self.position_in_map
        return matrix


def check_pose(field: str, pose: Pose) -> None:
    """Refuses one whose numbers are no pose's; the covariance is not looked at."""
    position = numbers(f"{field}.position_in_map", pose.position_in_map, (3,))
    if float(np.abs(position).max()) > LARGEST_METERS:
        invalid(f"{field}.position_in_map", "must be within 1e9 of the origin", "OUT_OF_RANGE")
    if abs(float(np.linalg.norm(numbers(f"{field}.orientation_xyzw", pose.orientation_xyzw, (4,)))) - 1) > 1e-3:
        invalid(f"{field}.orientation_xyzw", "must have the norm 1; normalize it", "NOT_A_ROTATION")


@dataclass(frozen=True)
class FeatureCounts:
    """Features matched with the map, and those of them that agree with the final pose."""

    matches: int
    inliers: int


@dataclass(frozen=True)
class FocalScale:
    """True focal length over the one that was sent, as the matches alone have it."""

    scale: float
    sigma: float


@dataclass(frozen=True)
class Evidence:
    """What the answer rests on.

    Attributes:
        points: of the keypoints; of a thousand and more they may be estimated from a sample.
        usable_lines: lines tilted from the vertical by 10 degrees or more.
        vertical_lines: all other lines.
        strategy: the one that found the pose; without one the likeliest of those that were tried.
        strategy_source: who chose the first that was tried.
        fell_back: `strategy` is not that first one.
        iterations: evaluated hypotheses.
        predicted_success: of one draw, by the segment's statistics; 0 before evidence.
        inlier_rms_pixels: root mean square of the inliers' reprojection errors; 0 without a pose.
        gravity_disagreement_radians: between the gravity that was sent and that of the pose as the matches alone give
            it; 0 where either is missing. Near pi: gravity was sent upside down.
        gravity_rejected: the pose was found and refined without the gravity that was sent, because it contradicts the
            matches.
        focal_scale: None where the matches do not determine it.
    """

    points: FeatureCounts
    usable_lines: FeatureCounts
    vertical_lines: FeatureCounts
    strategy: Strategy
    strategy_source: StrategySource
    fell_back: bool
    iterations: int
    predicted_success: float
    inlier_rms_pixels: float
    gravity_disagreement_radians: float
    gravity_rejected: bool
    focal_scale: FocalScale | None


@dataclass(frozen=True)
class StageTimes:
    """Where the server's time went, milliseconds."""

    convert_ms: float
    retrieval_ms: float
    matching_ms: float
    ransac_ms: float
    refinement_ms: float
    total_ms: float


@dataclass(frozen=True, eq=False)
class FeatureMatches:
    """The matches of one kind of feature with the segment that answered.

    Attributes:
        feature_indices: shape (N,): which features of the query.
        inliers: shape (N,), bool: whether each agrees with the final pose.
    """

    feature_indices: npt.NDArray[np.int32]
    inliers: npt.NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Localization:
    """The answer to one query.

    Attributes:
        outcome: what became of it.
        pose: with LOCALIZED alone, else None: test it before you use it.
        confidence: probability that the matches agree with the pose by more than chance, 0 to 1. LOW_CONFIDENCE may
            come with a high one: then another pose explains as much, or the inliers leave the pose open.
        map_version: of the map that answered.
        segment: the one that answered, else the best ranked; -1 with OUT_OF_MAP.
        evidence: what it rests on.
        times: where the server's time went.
        request_id: as sent.
        capture_unix_nanos: as sent.
        point_matches: empty unless the query asked for matches.
        line_matches: empty unless the query asked for matches.
    """

    outcome: Outcome
    pose: Pose | None
    confidence: float
    map_version: int
    segment: int
    evidence: Evidence
    times: StageTimes
    request_id: str
    capture_unix_nanos: int
    point_matches: FeatureMatches
    line_matches: FeatureMatches


@dataclass(frozen=True)
class SegmentChange:
    """What a session changed in one segment."""

    segment: int
    queries: int
    localized: int
    strategy_before: Strategy
    strategy_after: Strategy


@dataclass(frozen=True)
class SessionSummary:
    """What a session did."""

    end: SessionEnd
    queries: int
    localized: int
    segments: tuple[SegmentChange, ...]  # ascending by segment: those that were visited


@dataclass(frozen=True, eq=False)
class Map:
    """A map's enabled version.

    Attributes:
        name: unique.
        version: 1, 2, ...
        metric: lengths are metres; else their unit is unknown.
        map_from_source: 4 x 4 similarity (scale in the rotation's block) from the frame of the imported model.
        point_kind: queries' points must have it; None where the map has no points.
        line_kind: queries' lines must have it; None where the map has no lines.
        segments, points, lines: how many.
        usable_lines: those tilted from the vertical by 10 degrees or more.
    """

    name: str
    version: int
    metric: bool
    map_from_source: Floats
    point_kind: DescriptorKind | None
    line_kind: DescriptorKind | None
    segments: int
    points: int
    lines: int
    usable_lines: int


@dataclass(frozen=True)
class Segment:
    """One segment of a map, with its statistics. Ratios are inliers over matches, weighted by age; None before
    evidence."""

    segment: int
    points: int
    lines: int
    usable_lines: int
    strategy: Strategy
    strategy_source: StrategySource
    point_inlier_ratio: float | None
    line_inlier_ratio: float | None
    sessions: int
    queries: int
    localized: int
