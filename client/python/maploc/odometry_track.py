"""One belief of where the robot is, and how far an answer is from it. Only for odometry.py."""

import math

import numpy as np
import numpy.typing as npt

from maploc.answer import Pose
from maploc.arrays import Floats, quaternion_from_matrix, rigid_transform
from maploc.odometry_decision import Gap
from maploc.odometry_drift import OdometryDrift
from maploc.transforms import difference, inverse, moving_jacobian, plus, rotation_vector

# Frames that are nearer to each other show the same, and err alike.
_PLACE_METERS = 0.05
_PLACE_RADIANS = 0.05


def moved(map_from_a: Pose, a_from_b: npt.ArrayLike) -> Pose:
    """The pose of a frame b whose 4 x 4 pose in a is exact: an error of a's rotation moves b too."""
    a_from_b = rigid_transform("a_from_b", a_from_b)
    map_from_b = map_from_a.map_from_body @ a_from_b
    jacobian = moving_jacobian(map_from_b[:3, 3] - map_from_a.position_in_map)
    return _pose(map_from_b, jacobian @ map_from_a.covariance @ jacobian.T)


def map_from_odom(map_from_base: Pose, odom_from_base: npt.ArrayLike) -> Pose:
    """REP-105's transform from odom to map: where the odometry's origin lies, given the robot's pose in the map and, at
    the same moment, in the odometry's frame (4 x 4)."""
    return moved(map_from_base, inverse(rigid_transform("odom_from_base", odom_from_base)))


class Track:
    """One belief of where the robot is: an answer, and what odometry and further answers made of it."""

    def __init__(self, drift: OdometryDrift, here: Floats, answer: Pose) -> None:
        self._drift = drift
        self._begin_place(here, None, _pose(answer.map_from_body, self._measured(answer)))

    def advance(self, here: Floats) -> None:
        """The robot came to here."""
        self._meters, self._radians = self._way_to(here)
        self._last_here = here

    def map_from_base(self, here: Floats) -> Pose:
        """The pose there, with what odometry may have added since the last answer."""
        pose = moved(self._map_from_base, inverse(self._here) @ here)
        travel = pose.position_in_map - self._map_from_base.position_in_map
        return _pose(pose.map_from_body, pose.covariance + self._drift.covariance(*self._way_to(here), travel))

    def map_from_odom(self) -> Pose:
        """As Tracker.map_from_odom."""
        return map_from_odom(self._map_from_base, self._here)

    def gap_to(self, here: Floats, answer: Pose) -> Gap:
        """How far an answer is from this belief."""
        expected = self.map_from_base(here)
        gap = difference(answer.map_from_body, expected.map_from_body)
        covariance = expected.covariance + self._measured(answer)
        return Gap(
            float(np.linalg.norm(gap[:3])),
            float(np.linalg.norm(gap[3:])),
            _sigmas(gap[:3], covariance[:3, :3]),
            _sigmas(gap[3:], covariance[3:, 3:]),
        )

    def take(self, here: Floats, answer: Pose, smooth: bool) -> None:
        """Follows the answer: wholly, or smoothed with what was known before (a Kalman filter's update).

        Smoothed answers of one place count as one, because they err alike.
        """
        measured = _pose(answer.map_from_body, self._measured(answer))
        if smooth and self._is_at_this_place(here):
            self._average(here, measured)
            self._follow(here)
        else:
            self._begin_place(here, self.map_from_base(here) if smooth else None, measured)

    def _begin_place(self, here: Floats, before: Pose | None, measured: Pose) -> None:
        self._here = here  # where the place begins
        self._before = before  # the belief there without its answers; None: it had none
        self._mean = measured  # of its answers
        self._answers = 1  # so many
        self._follow(here)

    def _is_at_this_place(self, here: Floats) -> bool:
        turn = rotation_vector(inverse(self._here)[:3, :3] @ here[:3, :3])
        way = math.dist(here[:3, 3], self._here[:3, 3])
        return way < _PLACE_METERS and float(np.linalg.norm(turn)) < _PLACE_RADIANS

    def _average(self, here: Floats, measured: Pose) -> None:
        at_begin = moved(measured, inverse(here) @ self._here)
        self._answers += 1
        step = difference(at_begin.map_from_body, self._mean.map_from_body) / self._answers
        # However their errors depend on each other, that of the mean is no larger.
        covariance = self._mean.covariance + (at_begin.covariance - self._mean.covariance) / self._answers
        self._mean = _pose(plus(self._mean.map_from_body, step), covariance)

    def _follow(self, here: Floats) -> None:
        self._map_from_base = _fused(self._before, self._mean) if self._before else self._mean  # where the place begins
        self._last_here = here  # where the way ends
        self._meters = self._radians = 0.0  # the way since the last answer that was taken

    def _way_to(self, here: Floats) -> tuple[float, float]:
        step = inverse(self._last_here) @ here
        turn = float(np.linalg.norm(rotation_vector(step[:3, :3])))
        return self._meters + float(np.linalg.norm(step[:3, 3])), self._radians + turn

    def _measured(self, answer: Pose) -> Floats:
        return answer.covariance + self._drift.at_rest_covariance()


def _pose(map_from_body: Floats, covariance: Floats) -> Pose:
    return Pose(map_from_body[:3, 3], quaternion_from_matrix(map_from_body[:3, :3]), covariance)


def _fused(expected: Pose, measured: Pose) -> Pose:
    """A Kalman filter's update."""
    gain = np.linalg.solve(expected.covariance + measured.covariance, expected.covariance).T
    rest = np.eye(6) - gain
    step = gain @ difference(measured.map_from_body, expected.map_from_body)
    covariance = rest @ expected.covariance @ rest.T + gain @ measured.covariance @ gain.T
    return _pose(plus(expected.map_from_body, step), covariance)


def _sigmas(gap: Floats, covariance: Floats) -> float:
    """The largest contradiction over all directions of three dimensions, in standard deviations."""
    squared = float(gap @ np.linalg.solve(covariance, gap))
    # Rounding may leave no covariance where an answer's variances are 10^12 times odometry's.
    return math.sqrt(squared) if squared >= 0 else math.inf
