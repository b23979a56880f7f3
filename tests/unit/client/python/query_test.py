"""Inputs are checked when they are made."""

import math
import unittest
import unittest.mock
from typing import Any

import maploc
import numpy as np
from maploc.arrays import matrix_from_quaternion, quaternion_from_matrix
from maploc.proxy import is_loopback, proxy_in_use

KIND = maploc.DescriptorKind("orb", 32, maploc.Metric.HAMMING)
CAMERA = maploc.Camera(maploc.CameraModel.PINHOLE, 640, 480, (500, 500, 320, 240))


class QueryTest(unittest.TestCase):
    """Features, views, priors."""

    def test_arrays_are_copied_and_read_only(self) -> None:
        keypoints = np.ones((2, 2), np.float64)
        points = maploc.Points(keypoints, np.zeros((2, 32), np.uint8), KIND)
        keypoints[0, 0] = 9
        self.assertEqual(points.keypoints_pixels[0, 0], 1)
        self.assertEqual(points.keypoints_pixels.dtype, np.float32)
        with self.assertRaises(ValueError):
            points.keypoints_pixels[0, 0] = 9

    def test_a_wrong_shape_or_type_is_refused_by_its_name(self) -> None:
        keypoints, descriptors = np.ones((2, 2), np.float32), np.zeros((2, 32), np.uint8)
        for wrong, field in [
            ((np.ones((2, 3)), descriptors), "points.keypoints_pixels"),
            ((np.full((2, 2), math.inf), descriptors), "points.keypoints_pixels"),
            ((keypoints, np.zeros((2, 31), np.uint8)), "points.descriptors"),
            ((keypoints, np.zeros((1, 32), np.uint8)), "points.descriptors"),
            ((keypoints, np.zeros((2, 32), np.float32)), "points.descriptors"),
        ]:
            self.check_field(field, lambda made=wrong: maploc.Points(*made, KIND))
        self.check_field("lines.segments_pixels", lambda: maploc.Lines(keypoints, descriptors, KIND))

    def test_a_camera_from_body_must_be_rigid(self) -> None:
        sheared, scaled = np.eye(4), np.eye(4)
        sheared[3, 0], scaled[0, 0] = 1, 2
        for matrix in (sheared, scaled, np.eye(3), np.full((4, 4), math.nan)):
            self.check_field("view.camera_from_body", lambda made=matrix: maploc.View(CAMERA, camera_from_body=made))

    def test_a_prior_needs_a_sigma(self) -> None:
        for sigma in (0.0, -1.0, math.nan):
            self.check_field("prior.sigma", lambda made=sigma: maploc.Prior(np.zeros(3), made))

    def test_a_time_is_of_this_epoch(self) -> None:
        for nanos in (-1, 2**63):
            self.check_field("options.capture_unix_nanos", lambda made=nanos: maploc.QueryOptions(made))

    def test_a_quaternion_is_its_matrix(self) -> None:
        random = np.random.default_rng(1)
        special = [np.eye(4)[i] for i in range(4)]
        for quaternion in special + [q / np.linalg.norm(q) for q in random.normal(size=(100, 4))]:
            matrix = matrix_from_quaternion(quaternion)
            np.testing.assert_allclose(matrix @ matrix.T, np.eye(3), atol=1e-14)
            again = quaternion_from_matrix(matrix)
            self.assertAlmostEqual(abs(float(again @ quaternion)), 1, places=12)
        quarter_about_z = matrix_from_quaternion(np.array([0, 0, math.sqrt(0.5), math.sqrt(0.5)]))
        np.testing.assert_allclose(quarter_about_z @ [1, 0, 0], [0, 1, 0], atol=1e-15)

    def test_a_token_is_not_sent_in_the_clear(self) -> None:
        self.check_field("token", lambda: maploc.Client("yard:50051", token="secret"))
        self.check_field("token", lambda: maploc.Client("localhost:1", token="secret\n"))
        self.check_field("root_certificates", lambda: maploc.Client("yard:1", token="x", root_certificates="/absent"))

    def test_which_addresses_are_this_machine(self) -> None:
        for address in (
            "localhost:1",
            "127.8.0.1:1",
            "[::1]:1",
            "::1",
            "unix:/tmp/s",
            "dns:///localhost:1",
            "0.0.0.0:1",
        ):
            self.assertTrue(is_loopback(address), address)
        for address in (
            "yard:1",
            "10.0.0.1:1",
            "[fe80::1]:1",
            "localhost.example.com:1",
            "127.example.com:1",
            "unixhost:1",
        ):
            self.assertFalse(is_loopback(address), address)

    def test_a_proxy_is_named_without_its_password(self) -> None:
        environment = {"https_proxy": "http://me:secret@proxy:3128", "no_proxy": "depot, .lan"}
        with unittest.mock.patch.dict("os.environ", environment, clear=True):
            self.assertEqual(proxy_in_use("yard:1"), "http://proxy:3128 of https_proxy")
            for address in ("depot:1", "yard.lan:1", "localhost:1"):
                self.assertEqual(proxy_in_use(address), "")

    def check_field(self, field: str, make: Any) -> None:
        """What `make` makes is refused, by this name."""
        with self.assertRaises(maploc.MaplocError) as raised:
            make()
        self.assertEqual((raised.exception.code, raised.exception.field), ("INVALID_ARGUMENT", field))


if __name__ == "__main__":
    unittest.main()
