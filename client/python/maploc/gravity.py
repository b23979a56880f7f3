"""Gravity as a robot measures it. The usual mistake is its sign: an accelerometer at rest measures UP, maploc takes
DOWN."""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from maploc.arrays import Floats, numbers, rotation
from maploc.errors import invalid

STANDARD_GRAVITY = 9.80665  # m/s^2
_UNIT_TOLERANCE = 0.05  # written with few digits
_SENSOR_TOLERANCE = 0.2  # a share: bias, and a robot that moves


@dataclass(frozen=True, eq=False)
class Gravity:
    """The direction DOWN in the body frame. The body is the camera (x right, y down, z forward) unless the view has a
    `camera_from_body`: so for an upright camera it is about (0, 1, 0).

    Make it with `down` or `from_accelerometer_at_rest`, which check the vector's length.

    Attributes:
        down_in_body: unit vector, shape (3,).
        sigma_radians: standard deviation about each horizontal axis, in (0, pi/2].
    """

    down_in_body: Floats
    sigma_radians: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "down_in_body", numbers("gravity.down_in_body", self.down_in_body, (3,)))
        length = float(np.linalg.norm(self.down_in_body))
        if abs(length - 1) > 1e-6:
            invalid(
                "gravity.down_in_body",
                f"has the length {length:g}, but must be a unit vector; make it with Gravity.down",
            )
        if not 0 < self.sigma_radians <= math.pi / 2:
            invalid("gravity.sigma_radians", "must be above 0 and at most pi/2 (90 degrees)", "OUT_OF_RANGE")

    @classmethod
    def down(cls, down_in_body: npt.ArrayLike, *, sigma_degrees: float = 1.0) -> "Gravity":
        """From a vector that points down in the body frame: of unit length, or in m/s^2 (9.81 within 20%)."""
        vector = numbers("down_in_body", down_in_body, (3,))
        length = _checked_length("down_in_body", vector, unit_is_fine=True)
        return cls(vector / length, math.radians(sigma_degrees))

    @classmethod
    def from_accelerometer_at_rest(
        cls, acceleration_in_imu: npt.ArrayLike, *, body_from_imu: npt.ArrayLike, sigma_degrees: float = 2.0
    ) -> "Gravity":
        """From one sample of an accelerometer whose robot stands still, or moves evenly.

        Args:
            acceleration_in_imu: shape (3,), m/s^2, as the sensor tells it (`sensor_msgs/Imu.linear_acceleration`): at
                rest it measures +9.81 UP. It is negated here; do not negate it before.
            body_from_imu: 3 x 3 rotation that takes a direction in the IMU's frame to the body frame; numpy.eye(3)
                where the IMU is the body. Where the view has no `camera_from_body` the body is the camera: then this is
                camera_from_imu, as Kalibr has it (`T_cam_imu`).
            sigma_degrees: standard deviation; 2 suits one sample of a robot that drives smoothly.
        """
        up = numbers("acceleration_in_imu", acceleration_in_imu, (3,))
        length = _checked_length("acceleration_in_imu", up, unit_is_fine=False)
        body = rotation("body_from_imu", body_from_imu)
        return cls.down(body @ (-up / length), sigma_degrees=sigma_degrees)


def _checked_length(field: str, vector: Floats, *, unit_is_fine: bool) -> float:
    length = float(np.linalg.norm(vector))
    if length == 0:
        invalid(field, "is zero, which is no direction; has the sensor reported yet?", "ZERO_GRAVITY")
    is_unit = abs(length - 1) <= _UNIT_TOLERANCE
    if abs(length / STANDARD_GRAVITY - 1) <= _SENSOR_TOLERANCE or (unit_is_fine and is_unit):
        return length
    cure = (
        "it seems to be in g, multiply it by 9.80665"
        if is_unit
        else "take a sample at rest, or a filtered one, in m/s^2"
    )
    invalid(field, f"has the length {length:g}, but gravity is 9.81 m/s^2 (within 20%); {cure}", "IMPLAUSIBLE_GRAVITY")
