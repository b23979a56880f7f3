"""Gravity's sign, frame and length."""

import math
import unittest

import maploc
import numpy as np
import numpy.typing as npt

# A camera that looks along the IMU's x, upright: its x is the IMU's -y, its y -z, its z x.
CAMERA_FROM_IMU = np.array([[0, -1, 0], [0, 0, -1], [1, 0, 0]])


class GravityTest(unittest.TestCase):
    """A robot that stands on level ground."""

    def test_an_accelerometer_at_rest_measures_up_and_gravity_is_down(self) -> None:
        gravity = maploc.Gravity.from_accelerometer_at_rest([0, 0, 9.81], body_from_imu=np.eye(3))
        np.testing.assert_allclose(gravity.down_in_body, [0, 0, -1])
        self.assertEqual(gravity.sigma_radians, math.radians(2))

    def test_it_is_turned_into_the_bodys_frame(self) -> None:
        gravity = maploc.Gravity.from_accelerometer_at_rest([0, 0, 9.7], body_from_imu=CAMERA_FROM_IMU)
        np.testing.assert_allclose(gravity.down_in_body, [0, 1, 0])

    def test_down_is_taken_as_it_is(self) -> None:
        for vector in ([0, 1, 0], [0, 9.81, 0], [0, 0.97, 0]):
            np.testing.assert_allclose(maploc.Gravity.down(vector).down_in_body, [0, 1, 0])

    def test_a_length_that_is_no_gravity_is_refused(self) -> None:
        for sample, reason, cure in [
            ([0, 0, 0], "ZERO_GRAVITY", ""),
            ([0, 0, 1], "IMPLAUSIBLE_GRAVITY", "9.80665"),
            ([0, 0, 14], "IMPLAUSIBLE_GRAVITY", "at rest"),
            ([0, 0, math.nan], "NOT_FINITE", ""),
            ([0, 0], "COUNT_MISMATCH", ""),
        ]:
            self.check_refused(sample, np.eye(3), reason, cure)
        with self.assertRaisesRegex(maploc.MaplocError, "length 2"):
            maploc.Gravity.down([0, 2, 0])

    def test_what_is_no_rotation_is_refused(self) -> None:
        for matrix in (np.zeros((3, 3)), 2 * np.eye(3), np.diag([1.0, 1.0, -1.0])):
            self.check_refused([0, 0, 9.81], matrix, "NOT_A_ROTATION", "")

    def test_a_sigma_that_is_no_sigma_is_refused(self) -> None:
        for sigma in (0, -1, 91, math.nan):
            with self.assertRaisesRegex(maploc.MaplocError, "sigma"):
                maploc.Gravity.down([0, 1, 0], sigma_degrees=sigma)

    def check_refused(self, sample: list[float], body_from_imu: npt.ArrayLike, reason: str, cure: str) -> None:
        """Of an accelerometer's sample."""
        with self.assertRaises(maploc.MaplocError) as raised:
            maploc.Gravity.from_accelerometer_at_rest(sample, body_from_imu=body_from_imu)
        self.assertEqual(raised.exception.reason, reason)
        self.assertIn(cure, raised.exception.cure)


if __name__ == "__main__":
    unittest.main()
