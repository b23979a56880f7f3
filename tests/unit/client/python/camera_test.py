"""Cameras of COLMAP's, ROS's and OpenCV's files."""

import pathlib
import tempfile
import unittest
from typing import Any

import cv2
import maploc
import numpy as np
from maploc import CameraModel

ROS_YAML = """image_width: 640
image_height: 480
camera_name: left
camera_matrix: {rows: 3, cols: 3, data: [500.0, 0.0, 320.5, 0.0, 501.0, 240.5, 0.0, 0.0, 1.0]}
distortion_model: plumb_bob
distortion_coefficients: {rows: 1, cols: 5, data: [-0.1, 0.02, 0.001, -0.002, 0.0]}
projection_matrix: {rows: 3, cols: 4, data: [450.0, 0.0, 318.0, 0.0, 0.0, 451.0, 239.0, 0.0, 0.0, 0.0, 1.0, 0.0]}
"""


class CameraTest(unittest.TestCase):
    """Files in a folder of their own."""

    def setUp(self) -> None:
        """Makes the folder."""
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))

    def test_colmaps_half_pixel_is_taken_off(self) -> None:
        camera = maploc.Camera.from_colmap(self.file("\ufeff# comment\n7 PINHOLE 640 480 500 501 320.5 240.5\n"))
        self.assertEqual(camera, maploc.Camera(CameraModel.PINHOLE, 640, 480, (500, 501, 320, 240)))

    def test_a_short_fisheye_becomes_a_whole_one(self) -> None:
        camera = maploc.Camera.from_colmap(self.file("1 RADIAL_FISHEYE 640 480 500 320.5 240.5 0.1 0.2\n"))
        self.assertEqual(camera.model, CameraModel.OPENCV_FISHEYE)
        self.assertEqual(camera.params, (500, 500, 320, 240, 0.1, 0.2, 0, 0))

    def test_several_cameras_take_a_choice(self) -> None:
        path = self.file("1 SIMPLE_PINHOLE 640 480 500 320 240\n2 SIMPLE_PINHOLE 320 240 250 160 120\n")
        self.assertEqual(maploc.Camera.from_colmap(path, camera_id=2).width_pixels, 320)
        self.assertEqual(self.refusal(maploc.Camera.from_colmap, path).reason, "AMBIGUOUS_CAMERA")
        with self.assertRaisesRegex(maploc.MaplocError, "has no camera 3; it has 1, 2"):
            maploc.Camera.from_colmap(path, camera_id=3)

    def test_faults_of_a_colmap_file_are_named_with_their_line(self) -> None:
        for text, reason in [
            ("\n1 PINHOLE 640 480 500 500 320\n", "COUNT_MISMATCH"),
            ("\n1 FOV 640 480 500 500 320 240 0.9\n", "UNSUPPORTED_CAMERA_MODEL"),
            ("\n1 PINHOLE 640 480 500 500 320 nan\n", "NOT_FINITE"),
            ("\n1 PINHOLE 640 480 500 500 320 x\n", "INVALID_FIELD"),
            ("\nIMAGE_ID\n", "INVALID_FILE"),
        ]:
            path = self.file(text)
            error = self.refusal(maploc.Camera.from_colmap, path)
            self.assertEqual((error.reason, error.field), (reason, f"{path}:2"))
        self.assertEqual(self.refusal(maploc.Camera.from_colmap, self.folder / "absent").reason, "INVALID_FILE")

    def test_a_camera_info_keeps_its_pixels(self) -> None:
        expected = (500, 501, 320.5, 240.5, -0.1, 0.02, 0.001, -0.002)
        message = {
            **{"width": 640, "height": 480, "distortion_model": "plumb_bob"},
            **{"k": [500, 0, 320.5, 0, 501, 240.5, 0, 0, 1], "d": [-0.1, 0.02, 0.001, -0.002, 0]},
            **{"binning_x": 0, "binning_y": 1, "roi": {"x_offset": 0, "y_offset": 0, "width": 0, "height": 0}},
        }
        for info in (
            self.file(ROS_YAML),
            message,
            {key.upper() if len(key) == 1 else key: message[key] for key in message},
        ):
            camera = maploc.Camera.from_ros(info)
            self.assertEqual((camera.model, camera.params), (CameraModel.OPENCV, expected))

    def test_a_rectified_topic_has_the_projection_matrix(self) -> None:
        camera = maploc.Camera.from_ros(self.file(ROS_YAML), rectified=True)
        self.assertEqual(camera, maploc.Camera(CameraModel.PINHOLE, 640, 480, (450, 451, 318, 239)))

    def test_what_a_camera_info_cannot_say_to_maploc_is_refused(self) -> None:
        good: dict[str, Any] = {"width": 640, "height": 480, "distortion_model": "plumb_bob", "k": [1.0] * 9, "d": []}
        maploc.Camera.from_ros(good)
        for bad, field in [
            ({"d": [0, 0, 0, 0, 0.3]}, "camera_info.d"),
            ({"k": [1.0] * 8}, "camera_info.k"),
            ({"distortion_model": "omni"}, "camera_info.distortion_model"),
            ({"binning_x": 2}, "camera_info.roi"),
            ({"roi": {"x_offset": 8}}, "camera_info.roi"),
            ({"roi": {"height": 240}}, "camera_info.roi"),
        ]:
            error = self.refusal(maploc.Camera.from_ros, good | bad)
            self.assertEqual(error.field, field)
        del good["k"]
        self.assertEqual(self.refusal(maploc.Camera.from_ros, good).reason, "REQUIRED")

    def test_opencvs_files_are_read(self) -> None:
        matrix = np.array([[500.0, 0, 320.5], [0, 501, 240.5], [0, 0, 1]])
        for name, distortion, fisheye, model in [
            ("a.yml", [], False, CameraModel.PINHOLE),
            ("a.yml", [0.1, 0.2, 0.3, 0.4, 0.0], False, CameraModel.OPENCV),
            ("a.xml", [0.1, 0.2, 0.3, 0.4], True, CameraModel.OPENCV_FISHEYE),
        ]:
            path = self.folder / name
            storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_WRITE)
            storage.write("image_width", 640)
            storage.write("image_height", 480)
            storage.write("camera_matrix", matrix)
            storage.write("distortion_coefficients", np.array(distortion or [0.0] * 5).reshape(-1, 1))
            storage.release()
            camera = maploc.Camera.from_opencv(path, fisheye=fisheye)
            self.assertEqual((camera.model, camera.params[:4]), (model, (500, 501, 320.5, 240.5)))
            self.assertEqual(list(camera.params[4:]), distortion[:4])

    def test_faults_of_an_opencv_file_are_named(self) -> None:
        for text, missing in [
            ("%YAML:1.0\n---\nimage_width: 640\n", "camera_matrix"),
            ("no yaml at all", "FileStorage"),
            ("", "FileStorage"),
        ]:
            path = self.file(text)
            error = self.refusal(maploc.Camera.from_opencv, path)
            self.assertEqual(error.field, str(path))
            self.assertIn(missing, error.message)

    def file(self, text: str) -> pathlib.Path:
        """A file of the folder with this text."""
        path = self.folder / "file.yaml"
        path.write_text(text, encoding="utf-8")
        return path

    def refusal(self, reader: Any, argument: Any) -> maploc.MaplocError:
        """The error of a call that must fail."""
        with self.assertRaises(maploc.MaplocError) as raised:
            reader(argument)
        self.assertEqual(raised.exception.code, "INVALID_ARGUMENT")
        return raised.exception


if __name__ == "__main__":
    unittest.main()
