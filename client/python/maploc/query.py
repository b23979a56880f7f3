"""What a robot sends. Inputs are checked when they are made; arrays are copied and read-only. README.md says the
frames."""

import enum
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from maploc.arrays import Floats, is_whole, numbers, rigid_transform
from maploc.camera import Camera
from maploc.errors import invalid


class Metric(enum.IntEnum):
    """How two descriptors are compared; the numbers are the wire's."""

    HAMMING = 1  # bits that differ
    L2_U8 = 2  # Euclidean distance over unsigned bytes


class Strategy(enum.IntEnum):
    """How samples are drawn; the numbers are the wire's."""

    ONE_POINT_ONE_LINE = 1
    TWO_POINTS = 2
    MIXED = 3
    THREE_POINTS = 4  # needs no gravity


class Refinement(enum.IntEnum):
    """How a pose is refined; the numbers are the wire's."""

    AUTO = 1  # 6 degrees of freedom, gravity as a measurement with its sigma
    YAW_AND_POSITION = 2  # gravity is held
    WITHOUT_GRAVITY = 3  # 6 degrees of freedom


@dataclass(frozen=True)
class DescriptorKind:
    """What a descriptor is: proto/maploc/v1/types.proto defines the names. A map has one kind for points and one for
    lines (`Map.point_kind`, `Map.line_kind`); a query must have the same."""

    name: str
    bytes_count: int
    metric: Metric


@dataclass(frozen=True, eq=False)
class Points:
    """Keypoints of one image.

    Attributes:
        keypoints_pixels: N x 2 float32, x and y in the distorted image, the centre of the first pixel at (0, 0).
            OpenCV's SIFT finds them 0.25 pixels too far right and down, COLMAP stores them 0.5 too far;
            maploc.detect_points corrects that.
        descriptors: N x kind.bytes_count uint8.
        kind: of the descriptors.
    """

    keypoints_pixels: npt.NDArray[np.float32]
    descriptors: npt.NDArray[np.uint8]
    kind: DescriptorKind

    def __post_init__(self) -> None:
        _check_features(self, "points", "keypoints_pixels", 2)

    @classmethod
    def none(cls, kind: DescriptorKind) -> "Points":
        """No keypoints."""
        return cls(np.empty((0, 2), np.float32), np.empty((0, kind.bytes_count), np.uint8), kind)


@dataclass(frozen=True, eq=False)
class Lines:
    """Line segments of one image.

    Attributes:
        segments_pixels: N x 4 float32: start x, start y, end x, end y; pixels as those of Points. A line runs so that
            the darker side lies as LSD has it: turned round it does not match.
        descriptors: N x kind.bytes_count uint8.
        kind: of the descriptors.
    """

    segments_pixels: npt.NDArray[np.float32]
    descriptors: npt.NDArray[np.uint8]
    kind: DescriptorKind

    def __post_init__(self) -> None:
        _check_features(self, "lines", "segments_pixels", 4)

    @classmethod
    def none(cls, kind: DescriptorKind) -> "Lines":
        """No lines."""
        return cls(np.empty((0, 4), np.float32), np.empty((0, kind.bytes_count), np.uint8), kind)


def _check_features(features: Points | Lines, name: str, coordinates: str, columns: int) -> None:
    values = numbers(f"{name}.{coordinates}", getattr(features, coordinates), (-1, columns), np.float32)
    given = np.asarray(features.descriptors)
    if given.dtype != np.uint8:
        cure = "the kind's bytes are meant; for SIFT of OpenCV see maploc.detect_points"
        invalid(f"{name}.descriptors", f"are {given.dtype}, but must be uint8; {cure}", "DESCRIPTOR_TYPE")
    rows = numbers(f"{name}.descriptors", given, (-1, features.kind.bytes_count), np.uint8)
    if len(rows) != len(values):
        invalid(f"{name}.descriptors", f"are {len(rows)}, for {len(values)} {name}", "COUNT_MISMATCH")
    object.__setattr__(features, coordinates, values)
    object.__setattr__(features, "descriptors", rows)


@dataclass(frozen=True, eq=False)
class View:
    """What one camera sees. maploc.make_view makes one of a photo.

    Attributes:
        camera: its calibration.
        points: keypoints, or None.
        lines: line segments, or None.
        camera_from_body: 4 x 4 rigid transform, metres: the body's pose in the camera's optical frame (x right, y
            down, z forward). None: the body is the camera.
    """

    camera: Camera
    points: Points | None = None
    lines: Lines | None = None
    camera_from_body: Floats | None = None

    def __post_init__(self) -> None:
        if self.camera_from_body is not None:
            checked = rigid_transform("view.camera_from_body", self.camera_from_body)
            object.__setattr__(self, "camera_from_body", checked)


@dataclass(frozen=True, eq=False)
class Prior:
    """Where the robot believes it is: a hint where to look first, never a constraint on the answer.

    Attributes:
        position_in_map: shape (3,), map frame and unit.
        sigma: standard deviation of each axis, in the map's unit; positive.
    """

    position_in_map: Floats
    sigma: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "position_in_map", numbers("prior.position_in_map", self.position_in_map, (3,)))
        if not self.sigma > 0:
            invalid("prior.sigma", "must be positive", "OUT_OF_RANGE")


@dataclass(frozen=True)
class QueryOptions:
    """What most robots leave alone.

    Attributes:
        capture_unix_nanos: when the image was taken, nanoseconds since the Unix epoch; returned with the answer. 0:
            unknown.
        request_id: the caller's name for the query, at most 128 bytes; returned with the answer. Each query of a
            session needs its own: sent again it counts once. "" in a session: chosen for each call.
        include_matches: the answer holds the matches, to draw them.
        strategy: None: the one that the server recorded for the segment.
        refinement: how the pose is refined.
        max_error_pixels: up to so many pixels a feature agrees with a pose, 0.1 to 1000. None: the server's threshold.
        map_version: the version that the map must have: FAILED_PRECONDITION (MAP_VERSION_MISMATCH) where the answer
            would be in another one. 0: whichever it is.
    """

    capture_unix_nanos: int = 0
    request_id: str = ""
    include_matches: bool = False
    strategy: Strategy | None = None
    refinement: Refinement = Refinement.AUTO
    max_error_pixels: float | None = None
    map_version: int = 0

    def __post_init__(self) -> None:
        if not (is_whole(self.capture_unix_nanos) and 0 <= self.capture_unix_nanos < 2**63):
            invalid("options.capture_unix_nanos", "must be nanoseconds since 1970, not negative", "OUT_OF_RANGE")
        if not (is_whole(self.map_version) and 0 <= self.map_version < 2**63):
            invalid("options.map_version", "must not be negative; 0 takes any", "OUT_OF_RANGE")
