"""A calibrated camera. Pixels: the centre of the first pixel is (0, 0), as OpenCV and ROS have it."""

import enum
import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from maploc import camera_files
from maploc.errors import invalid


class CameraModel(enum.IntEnum):
    """COLMAP's camera models with COLMAP's parameters; the numbers are the wire's."""

    SIMPLE_PINHOLE = 1  # f, cx, cy
    PINHOLE = 2  # fx, fy, cx, cy
    SIMPLE_RADIAL = 3  # f, cx, cy, k
    RADIAL = 4  # f, cx, cy, k1, k2
    OPENCV = 5  # fx, fy, cx, cy, k1, k2, p1, p2
    OPENCV_FISHEYE = 6  # fx, fy, cx, cy, k1, k2, k3, k4


_PARAM_COUNTS = {
    CameraModel.SIMPLE_PINHOLE: 3,
    CameraModel.PINHOLE: 4,
    CameraModel.SIMPLE_RADIAL: 4,
    CameraModel.RADIAL: 5,
    CameraModel.OPENCV: 8,
    CameraModel.OPENCV_FISHEYE: 8,
}
MAX_SIDE_PIXELS = 65536


@dataclass(frozen=True)
class Camera:
    """A camera's calibration, of the pixels as they are stored in the photo's file.

    Attributes:
        model: which parameters there are.
        width_pixels, height_pixels: the photo's size, 1 to 65536.
        params: as the model says; focal lengths and principal point in pixels, the centre of the first pixel at (0, 0).
            COLMAP has it at (0.5, 0.5): `from_colmap` takes the half pixel off.
    """

    model: CameraModel
    width_pixels: int
    height_pixels: int
    params: Sequence[float]

    def __post_init__(self) -> None:
        object.__setattr__(self, "params", tuple(float(value) for value in self.params))
        for side in ("width_pixels", "height_pixels"):
            if not 1 <= getattr(self, side) <= MAX_SIDE_PIXELS:
                invalid(f"camera.{side}", "must be in 1 to 65536", "OUT_OF_RANGE")
        count = _PARAM_COUNTS[self.model]
        if len(self.params) != count:
            invalid("camera.params", f"{self.model.name} takes {count}, got {len(self.params)}", "COUNT_MISMATCH")
        if not all(map(math.isfinite, self.params)):
            invalid("camera.params", "must be finite", "NOT_FINITE")

    @classmethod
    def from_colmap(cls, path: str | os.PathLike[str], *, camera_id: int | None = None) -> "Camera":
        """From COLMAP's cameras.txt. `camera_id` chooses among several; one alone needs no choice.

        SIMPLE_PINHOLE, PINHOLE, SIMPLE_RADIAL, RADIAL, OPENCV, and all fisheyes without tangential or prism terms.
        """
        return cls._of(camera_files.read_colmap(path, camera_id))

    @classmethod
    def from_ros(cls, info: Mapping[str, Any] | str | os.PathLike[str], *, rectified: bool = False) -> "Camera":
        """From a CameraInfo: a dict with the message's fields (ROS 1 or 2), or the path of a YAML file of
        camera_calibration, which takes python3-yaml.

        Args:
            info: `distortion_model` plumb_bob, rational_polynomial (k3 and further must be 0) or equidistant.
            rectified: the photo is of a topic such as image_rect: the projection matrix P holds, without distortion.
        """
        fields = info if isinstance(info, Mapping) else camera_files.read_ros_yaml(info)
        return cls._of(camera_files.parse_ros(fields, rectified))

    @classmethod
    def from_opencv(cls, path: str | os.PathLike[str], *, fisheye: bool = False) -> "Camera":
        """From a file of OpenCV's FileStorage (YAML, XML or JSON) with camera_matrix, distortion_coefficients,
        image_width and image_height, as OpenCV's calibration sample writes them.

        Args:
            path: the file.
            fisheye: the file is of cv2.fisheye.calibrate. A file with `fisheye_model: 1` need not be told.
        """
        return cls._of(camera_files.read_opencv(path, fisheye))

    @classmethod
    def _of(cls, found: camera_files.Calibration) -> "Camera":
        return cls(CameraModel[found.model], found.width_pixels, found.height_pixels, found.params)
