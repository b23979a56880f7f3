"""Fields of ROS messages, in and out."""

import math
import types
import unittest
from typing import Any

import maploc
import numpy as np
import numpy.typing as npt
from maploc import ros

Floats = npt.NDArray[np.float64]
DRAWS = 40000


def message(**fields: Any) -> Any:
    """With these fields."""
    return types.SimpleNamespace(**fields)


def turn(axis: int, angle: float) -> Floats:
    """About a fixed axis."""
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.eye(3)
    matrix[i, i] = matrix[j, j] = math.cos(angle)
    matrix[j, i], matrix[i, j] = math.sin(angle), -math.sin(angle)
    return matrix


def fixed_axes(x: float, y: float, z: float) -> Floats:
    """Turned about the fixed axes x, then y, then z."""
    return turn(2, z) @ turn(1, y) @ turn(0, x)


def angles_about_fixed_axes(matrix: Floats) -> Floats:
    """The inverse."""
    pitch = math.asin(-matrix[2, 0])
    return np.array([math.atan2(matrix[2, 1], matrix[2, 2]), pitch, math.atan2(matrix[1, 0], matrix[0, 0])])


class PoseTest(unittest.TestCase):
    """What goes out."""

    def setUp(self) -> None:
        self.random = np.random.default_rng(7)
        root = self.random.normal(size=(6, 6)) * np.array([0.1, 0.05, 0.02, 0.004, 0.008, 0.02])[:, None]
        rotation = fixed_axes(0.3, -0.4, 2.0)
        quaternion = np.array([0.0, 0.0, 0.0, 1.0])
        for axis, angle in enumerate((0.3, -0.4, 2.0)):
            quaternion = self.times(self.about(axis, angle), quaternion)
        self.camera = maploc.Pose(np.array([4.0, -2.0, 1.0]), quaternion, root @ root.T)
        np.testing.assert_allclose(self.camera.map_from_body[:3, :3], rotation, atol=1e-12)
        self.camera_from_base = np.eye(4)
        self.camera_from_base[:3, :3] = fixed_axes(-1.5, 0.1, -1.6)
        self.camera_from_base[:3, 3] = [0.3, 1.1, -0.8]

    def about(self, axis: int, angle: float) -> Floats:
        """x, y, z, w."""
        xyzw = np.zeros(4)
        xyzw[axis], xyzw[3] = math.sin(angle / 2), math.cos(angle / 2)
        return xyzw

    def times(self, a: Floats, b: Floats) -> Floats:
        """Of two quaternions."""
        return np.array([*(a[3] * b[:3] + b[3] * a[:3] + np.cross(a[:3], b[:3])), a[3] * b[3] - a[:3] @ b[:3]])

    def test_the_covariance_is_that_of_errors_about_the_maps_fixed_axes(self) -> None:
        fields = ros.pose_with_covariance_stamped(maploc.moved(self.camera, self.camera_from_base), 1)
        stated = self.camera.map_from_body @ self.camera_from_base
        errors = np.array([self.error_of_base(draw, stated) for draw in self.draws()])
        found, told = np.cov(errors.T), np.reshape(fields["pose"]["covariance"], (6, 6))
        spread = np.sqrt(np.diag(found))
        np.testing.assert_allclose(told / np.outer(spread, spread), found / np.outer(spread, spread), atol=0.03)
        # The body's axes would be others: the test must see them.
        body = np.kron(np.eye(2), stated[:3, :3].T)
        wrong = body @ found @ body.T
        self.assertGreater(np.abs((wrong - found) / np.outer(spread, spread)).max(), 0.3)

    def draws(self) -> Floats:
        """Errors of the camera."""
        return self.random.multivariate_normal(np.zeros(6), self.camera.covariance, DRAWS)

    def error_of_base(self, draw: Floats, stated: Floats) -> Floats:
        """Where the base truly is, when the camera errs so."""
        true = self.camera.map_from_body
        true[:3, 3] += draw[:3]
        true[:3, :3] = fixed_axes(*draw[3:]) @ true[:3, :3]
        base = true @ self.camera_from_base
        turned = angles_about_fixed_axes(base[:3, :3] @ stated[:3, :3].T)
        return np.concatenate([base[:3, 3] - stated[:3, 3], turned])

    def test_the_other_fields(self) -> None:
        nanos = 1_700_000_000_123_456_789
        fields = ros.pose_with_covariance_stamped(self.camera, nanos, frame_id="site")
        self.assertEqual(
            fields["header"], {"stamp": {"sec": 1_700_000_000, "nanosec": 123_456_789}, "frame_id": "site"}
        )
        self.assertEqual(fields["pose"]["pose"]["position"], {"x": 4.0, "y": -2.0, "z": 1.0})
        self.assertEqual(list(fields["pose"]["pose"]["orientation"].values()), list(self.camera.orientation_xyzw))
        transform = ros.transform_stamped(self.camera, nanos)
        self.assertEqual((transform["header"]["frame_id"], transform["child_frame_id"]), ("map", "odom"))
        sent = message(
            rotation=message(**transform["transform"]["rotation"]),
            translation=message(**transform["transform"]["translation"]),
        )
        np.testing.assert_allclose(ros.matrix(sent), self.camera.map_from_body, atol=1e-15)
        self.assertEqual(ros.unix_nanos(message(**fields["header"]["stamp"])), nanos)


class SensorsTest(unittest.TestCase):
    """What comes in."""

    def info(self, **changed: Any) -> Any:
        """A camera's."""
        roi = message(x_offset=0, y_offset=0, height=0, width=0, do_rectify=False)
        fields = {"height": 480, "width": 640, "distortion_model": "plumb_bob", "d": [0.1, 0.02, 0.001, 0.002, 0.0]}
        fields |= {"k": np.array([500, 0, 320, 0, 501, 240, 0, 0, 1.0]), "p": np.zeros(12), "roi": roi}
        return message(**{**fields, "binning_x": 0, "binning_y": 0, **changed})

    def test_a_camera_info(self) -> None:
        camera = ros.camera(self.info())
        self.assertEqual(camera.params, (500, 501, 320, 240, 0.1, 0.02, 0.001, 0.002))
        with self.assertRaisesRegex(maploc.MaplocError, "roi"):
            ros.camera(self.info(binning_x=2))

    def image(self, encoding: str, pixels: npt.NDArray[np.uint8], padding: int) -> Any:
        """With rows that are longer than the image."""
        rows = pixels.reshape(pixels.shape[0], -1)
        data = np.pad(rows, ((0, 0), (0, padding))).tobytes()
        return message(
            encoding=encoding, height=rows.shape[0], width=pixels.shape[1], step=rows.shape[1] + padding, data=data
        )

    def test_images(self) -> None:
        colours = np.arange(24, dtype=np.uint8).reshape(2, 4, 3)
        np.testing.assert_array_equal(ros.pixels(self.image("bgr8", colours, 5)), colours)
        np.testing.assert_array_equal(ros.pixels(self.image("rgb8", colours, 0)), colours[:, :, ::-1])
        np.testing.assert_array_equal(ros.pixels(self.image("mono8", colours[:, :, 0], 3)), colours[:, :, 0])

    def test_an_image_that_is_none_is_refused(self) -> None:
        image = self.image("mono8", np.zeros((2, 4), np.uint8), 0)
        bad = [({"encoding": "bayer_rggb8"}, "encoding"), ({"data": b"1234567"}, "data"), ({"step": 3}, "data")]
        for changed, field in bad:
            with self.assertRaisesRegex(maploc.MaplocError, f"image.{field}"):
                ros.pixels(message(**{**vars(image), **changed}))

    def test_an_imu_measures_up(self) -> None:
        sample = message(linear_acceleration=message(x=0.0, y=0.0, z=9.8), linear_acceleration_covariance=[0.0] * 9)
        camera_from_imu = [[0, -1, 0], [0, 0, -1], [1, 0, 0]]
        np.testing.assert_allclose(ros.gravity(sample, camera_from_imu).down_in_body, [0, 1, 0])
        sample.linear_acceleration_covariance[0] = -1
        with self.assertRaisesRegex(maploc.MaplocError, "not measured"):
            ros.gravity(sample, camera_from_imu)

    def test_a_transform_without_rotation_is_refused(self) -> None:
        zero = message(rotation=message(x=0, y=0, z=0, w=0), translation=message(x=0, y=0, z=0))
        with self.assertRaisesRegex(maploc.MaplocError, "unit quaternion"):
            ros.matrix(zero)


if __name__ == "__main__":
    unittest.main()
