"""How far odometry may be wrong: stated by the user, as standard deviations."""

from dataclasses import dataclass

import numpy as np

from maploc.arrays import Floats, numbers
from maploc.errors import invalid
from maploc.transforms import moving_jacobian


@dataclass(frozen=True)
class PoseSigmas:
    """Standard deviations in the map's axes, z up: of x and of y, of z, about x and about y, about z."""

    horizontal_meters: float
    vertical_meters: float
    tilt_radians: float
    yaw_radians: float

    def variances(self) -> Floats:
        """In the order of a covariance."""
        flat, high, tilt, yaw = self.horizontal_meters, self.vertical_meters, self.tilt_radians, self.yaw_radians
        variances: Floats = np.square(np.array([flat, flat, high, tilt, tilt, yaw]))
        return variances


@dataclass(frozen=True)
class OdometryDrift:
    """How far odometry may be wrong. The defaults suit wheels whose odometry knows no slopes.

    Attributes:
        at_rest: stamps that do not fit, springs: no drift. Positive.
        per_meter: of the way driven.
        per_radian: of the angle turned.
    """

    at_rest: PoseSigmas = PoseSigmas(0.01, 0.01, 0.01, 0.005)
    per_meter: PoseSigmas = PoseSigmas(0.02, 0.05, 0.02, 0.01)
    per_radian: PoseSigmas = PoseSigmas(0.02, 0.01, 0.01, 0.03)

    def __post_init__(self) -> None:
        for name in ("at_rest", "per_meter", "per_radian"):
            sigmas = numbers(f"drift.{name}", list(vars(getattr(self, name)).values()), (4,))
            if sigmas.min() < 0 or sigmas.max() > 1e100:
                invalid(f"drift.{name}", "must be finite and not negative", "OUT_OF_RANGE")
        if not self.at_rest.variances().all():
            invalid("drift.at_rest", "must be positive", "OUT_OF_RANGE")

    def at_rest_covariance(self) -> Floats:
        """Of what is wrong between an answer and the odometry at its stamp, wherever the robot is."""
        return np.diag(self.at_rest.variances())

    def covariance(self, meters: float, radians: float, travel_in_map: Floats) -> Floats:
        """Of what odometry adds over a way of this length that led by `travel_in_map` (end minus start).

        The variance is sigma^2 * way * max(way, 1): so a metre with ten answers is as uncertain as one with two, and a
        long way without any is wrong by a share of it, because a wheel's wrong radius does not average out. A drift of
        rotation counts as if it came half way.
        """
        growth = meters * max(meters, 1) * self.per_meter.variances()
        growth = growth + radians * max(radians, 1) * self.per_radian.variances()
        jacobian = moving_jacobian(travel_in_map / 2)
        covariance: Floats = jacobian @ np.diag(growth) @ jacobian.T
        return covariance
