"""Where the robot is, between answers and in spite of wrong ones: answers are held against odometry.

client/odometry says the rule; it is the same in C++, and both pass the same test vectors. Frames as REP-105: map, odom,
base. Transforms are 4 x 4 target_from_source. Covariances are as Pose.covariance. The map must be metric.
"""

import math
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from maploc.answer import Pose, check_pose
from maploc.arrays import (
    LARGEST_METERS,
    Floats,
    is_number,
    is_whole,
    matrix_from_quaternion,
    numbers,
    quaternion_from_matrix,
    rigid_transform,
)
from maploc.errors import invalid
from maploc.odometry_decision import Decision, Gap, Verdict
from maploc.odometry_drift import OdometryDrift
from maploc.odometry_track import Track

# Answers of a new place may be a little further apart: here a right one that is left out costs the robot's time. But
# they must agree three times as well as with the pose so far, else a few with large errors on the same side would move
# it.
_NEW_PLACE_FACTOR = 1.5
_TIMES_BETTER = 3.0
_LARGEST_VARIANCE = 1e12  # beyond it a sum with what odometry adds is not exact


@dataclass(frozen=True)
class TrackerOptions:
    """How answers are judged.

    Attributes:
        drift: of the odometry.
        max_sigmas: an answer further than this from what odometry makes of the answers before, in any direction of its
            position or about any axis, is held back.
        agreeing_answers: so many held back answers that agree with each other are taken: the robot was carried away, or
            it starts. 1 to 100; with 1 nothing is held back.
        smooth: an answer is weighed with what is known before; else the pose follows it wholly.
    """

    drift: OdometryDrift = field(default_factory=OdometryDrift)
    max_sigmas: float = 3.0
    agreeing_answers: int = 3
    smooth: bool = True

    def __post_init__(self) -> None:
        if not (is_number(self.max_sigmas) and math.isfinite(self.max_sigmas) and self.max_sigmas > 0):
            invalid("max_sigmas", "must be finite and positive", "OUT_OF_RANGE")
        if not (is_whole(self.agreeing_answers) and 1 <= self.agreeing_answers <= 100):
            invalid("agreeing_answers", "must be a whole number in 1 to 100", "OUT_OF_RANGE")


class Tracker:
    """Holds the robot's pose in the map. Not thread-safe.

    Attributes:
        held_in_a_row: answers that were held back since the last one that was taken. Images that were not localized do
            not count.
    """

    def __init__(self, options: TrackerOptions | None = None) -> None:
        self._options = options or TrackerOptions()
        self._track: Track | None = None
        self._candidates: list[_Candidate] = []  # oldest first, at most `agreeing_answers`
        self.held_in_a_row = 0

    def judge(self, odom_from_base: npt.ArrayLike, answer: Pose) -> Decision:
        """To be called for every localized answer, in the order of the images' stamps.

        Args:
            odom_from_base: 4 x 4, the odometry at the image's stamp.
            answer: with the same base as its body.
        """
        here = _placed(odom_from_base)
        _check(answer)
        self._advance(here)
        gap = self._track.gap_to(here, answer) if self._track else None
        if self._track and gap and _worst(gap) <= self._options.max_sigmas:
            self._track.take(here, answer, self._options.smooth)
            self._settle(self._track)
            return Decision(Verdict.TAKEN, gap, 0)
        candidate = self._add_to_candidates(here, answer, self._most_sigmas_of_new_place(gap))
        if candidate.agreeing < self._options.agreeing_answers:
            return Decision(self._hold_back(gap), gap, candidate.agreeing)
        self._settle(candidate.track)
        return Decision(Verdict.RELOCATED, gap, candidate.agreeing)

    def advance(self, odom_from_base: npt.ArrayLike) -> None:
        """To be called for images that were not localized, and where there are no images about once a metre: so the
        way's length is known, also of a robot that drives round in circles."""
        self._advance(_placed(odom_from_base))

    def map_from_base(self, odom_from_base: npt.ArrayLike) -> Pose | None:
        """The robot's pose, with the odometry of any moment since the last answer, for example the newest. None before
        the first pose."""
        here = _placed(odom_from_base)
        return self._track.map_from_base(here) if self._track else None

    def map_from_odom(self) -> Pose | None:
        """To be broadcast: constant until the next answer that is taken. None before the first pose."""
        return self._track.map_from_odom() if self._track else None

    def _advance(self, here: Floats) -> None:
        if self._track:
            self._track.advance(here)
        for candidate in self._candidates:
            candidate.track.advance(here)

    def _settle(self, track: "Track") -> None:
        self._track = track
        self._candidates.clear()
        self.held_in_a_row = 0

    def _most_sigmas_of_new_place(self, gap: Gap | None) -> float:
        """How far a held back answer may be from a candidate to belong to it."""
        most = self._options.max_sigmas
        return most if gap is None else min(_NEW_PLACE_FACTOR * most, _worst(gap) / _TIMES_BETTER)

    def _add_to_candidates(self, here: Floats, answer: Pose, max_sigmas: float) -> "_Candidate":
        for candidate in self._candidates:
            if _worst(candidate.track.gap_to(here, answer)) <= max_sigmas:
                candidate.track.take(here, answer, self._options.smooth)
                candidate.agreeing += 1
                return candidate
        # One wrong answer among those of a new place must not make the count begin again.
        del self._candidates[: len(self._candidates) + 1 - self._options.agreeing_answers]
        self._candidates.append(_Candidate(Track(self._options.drift, here, answer)))
        return self._candidates[-1]

    def _hold_back(self, gap: Gap | None) -> Verdict:
        self.held_in_a_row += 1
        if gap is None:
            return Verdict.UNCONFIRMED
        if gap.position_sigmas > self._options.max_sigmas:
            return Verdict.POSITION_CONTRADICTED
        return Verdict.ROTATION_CONTRADICTED


@dataclass
class _Candidate:
    track: Track
    agreeing: int = 1


def _worst(gap: Gap) -> float:
    return max(gap.position_sigmas, gap.rotation_sigmas)


def _placed(odom_from_base: npt.ArrayLike) -> Floats:
    """Checked, and its rotation exact: what is off by 1e-3 would be off by more in products."""
    here = rigid_transform("odom_from_base", odom_from_base)
    if float(np.abs(here[:3, 3]).max()) > LARGEST_METERS:
        invalid("odom_from_base", "must be within 1e9 of the origin", "OUT_OF_RANGE")
    exact = np.array(here)
    exact[:3, :3] = matrix_from_quaternion(quaternion_from_matrix(here[:3, :3]))
    return exact


def _check(answer: Pose) -> None:
    check_pose("answer", answer)
    covariance = numbers("answer.covariance", answer.covariance, (6, 6))
    variances = np.diag(covariance)
    if variances.min() < 0 or variances.max() > _LARGEST_VARIANCE:
        invalid("answer.covariance", "its variances must be in 0 to 1e12", "NOT_A_COVARIANCE")
    # Correlations: so that metres do not hide what is wrong with radians.
    scale = np.array([1 / math.sqrt(variance) if variance > 0 else 1.0 for variance in variances])
    correlations = scale[:, None] * covariance * scale
    if float(np.abs(correlations - correlations.T).max()) > 1e-6:  # printed, and read again
        invalid("answer.covariance", "must be symmetric", "NOT_A_COVARIANCE")
    cure = "must be positive semidefinite and not zero; send the answer's"
    try:
        np.linalg.cholesky(correlations + 1e-12 * np.eye(6))  # a singular one is one too
    except np.linalg.LinAlgError:
        invalid("answer.covariance", cure, "NOT_A_COVARIANCE")
    if not variances.any():
        invalid("answer.covariance", cure, "NOT_A_COVARIANCE")
