"""Reads calibrations of COLMAP, ROS and OpenCV. Only for camera.py."""

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from maploc.arrays import numbers
from maploc.errors import invalid

Path = str | os.PathLike[str]


@dataclass(frozen=True)
class Calibration:
    """As maploc.Camera, with the model's name. Pixels: the centre of the first one is (0, 0)."""

    model: str
    width_pixels: int
    height_pixels: int
    params: list[float]


@dataclass(frozen=True)
class _ColmapModel:
    focal_count: int
    distortion_count: int
    becomes: str


_COLMAP_MODELS = {
    "SIMPLE_PINHOLE": _ColmapModel(1, 0, "SIMPLE_PINHOLE"),
    "PINHOLE": _ColmapModel(2, 0, "PINHOLE"),
    "SIMPLE_RADIAL": _ColmapModel(1, 1, "SIMPLE_RADIAL"),
    "RADIAL": _ColmapModel(1, 2, "RADIAL"),
    "OPENCV": _ColmapModel(2, 4, "OPENCV"),
    "OPENCV_FISHEYE": _ColmapModel(2, 4, "OPENCV_FISHEYE"),
    "SIMPLE_FISHEYE": _ColmapModel(1, 0, "OPENCV_FISHEYE"),
    "FISHEYE": _ColmapModel(2, 0, "OPENCV_FISHEYE"),
    "SIMPLE_RADIAL_FISHEYE": _ColmapModel(1, 1, "OPENCV_FISHEYE"),
    "RADIAL_FISHEYE": _ColmapModel(1, 2, "OPENCV_FISHEYE"),
}
_FISHEYE_COEFFICIENTS = 4
_UNDISTORT = "undistort the photos (cv2.undistort, image_proc, or `colmap image_undistorter`) and use their new camera"


def read_colmap(path: Path, camera_id: int | None) -> Calibration:
    """The camera of that id in a cameras.txt; without an id the only one."""
    cameras = _colmap_lines(path)
    if camera_id is None and len(cameras) > 1:
        ids = ", ".join(map(str, cameras))
        invalid(str(path), f"holds several cameras ({ids}); say which with camera_id", "AMBIGUOUS_CAMERA")
    chosen = next(iter(cameras)) if camera_id is None else camera_id
    if chosen not in cameras:
        invalid(str(path), f"has no camera {chosen}; it has {', '.join(map(str, cameras))}", "NO_CAMERA")
    where, fields = cameras[chosen]
    return _parse_colmap(where, fields)


def _colmap_lines(path: Path) -> dict[int, tuple[str, list[str]]]:
    cameras = {}
    for number, line in enumerate(_read_text(path).splitlines(), 1):
        fields = line.split()
        if not fields or fields[0].startswith("#"):
            continue
        where = f"{os.fspath(path)}:{number}"
        if len(fields) < 5 or not fields[0].isdecimal():
            invalid(where, "is no camera; it must be like '1 PINHOLE 640 480 500 500 320 240'", "INVALID_FILE")
        cameras[int(fields[0])] = (where, fields[1:])
    if not cameras:
        invalid(str(path), "holds no camera; give a cameras.txt of COLMAP", "INVALID_FILE")
    return cameras


def _parse_colmap(where: str, fields: list[str]) -> Calibration:
    name, width, height, *rest = fields
    model = _COLMAP_MODELS.get(name)
    if model is None:
        invalid(where, f"camera model {name} is not supported; {_UNDISTORT}", "UNSUPPORTED_CAMERA_MODEL")
    params = [float(value) for value in numbers(where, rest, (-1,))]
    count = model.focal_count + 2 + model.distortion_count
    if len(params) != count:
        invalid(where, f"{name} takes {count} parameters, got {len(params)}", "COUNT_MISMATCH")
    for i in (model.focal_count, model.focal_count + 1):
        params[i] -= 0.5  # COLMAP puts the centre of the first pixel at (0.5, 0.5)
    if model.becomes == "OPENCV_FISHEYE":
        focal = params[: model.focal_count]
        distortion = params[model.focal_count + 2 :]
        centre = params[model.focal_count : model.focal_count + 2]
        params = [focal[0], focal[-1], *centre, *distortion] + [0.0] * (_FISHEYE_COEFFICIENTS - len(distortion))
    return Calibration(model.becomes, _side(where, width), _side(where, height), params)


def read_ros_yaml(path: Path) -> dict[str, Any]:
    """The fields of a camera_info YAML file."""
    try:
        import yaml
    except ImportError:
        invalid("info", "a YAML file takes PyYAML; apt-get install python3-yaml, or give the fields as a dict")
    try:
        fields = yaml.safe_load(_read_text(path))
    except yaml.YAMLError as error:
        invalid(str(path), f"is no YAML ({error})", "INVALID_FILE")
    if not isinstance(fields, dict):
        invalid(str(path), "holds no camera_info", "INVALID_FILE")
    return fields


def parse_ros(info: Mapping[str, Any], rectified: bool) -> Calibration:
    """From a CameraInfo's fields: of the message (ROS 1: K, D, P; ROS 2: k, d, p), or of its YAML file."""
    size = [_side(f"camera_info.{side}", _field(info, side, f"image_{side}")) for side in ("width", "height")]
    _refuse_cut_image(info, size)
    if rectified:
        p = numbers("camera_info.p", _entries(_field(info, "p", "P", "projection_matrix")), (12,))
        return Calibration("PINHOLE", size[0], size[1], [float(p[i]) for i in (0, 5, 2, 6)])
    k = numbers("camera_info.k", _entries(_field(info, "k", "K", "camera_matrix")), (9,))
    d = numbers("camera_info.d", _entries(_field(info, "d", "D", "distortion_coefficients")), (-1,))
    name = str(_field(info, "distortion_model"))
    if name not in ("plumb_bob", "rational_polynomial", "equidistant"):
        invalid("camera_info.distortion_model", f"{name!r} is not supported; {_UNDISTORT}", "UNSUPPORTED_CAMERA_MODEL")
    return _of_opencv("camera_info.d", size, k.reshape(3, 3), d, name == "equidistant")


def _refuse_cut_image(info: Mapping[str, Any], size: list[int]) -> None:
    roi = info.get("roi") or {}
    cut = any(roi.get(key, 0) for key in ("x_offset", "y_offset"))
    cut = cut or [roi.get("width", 0) or size[0], roi.get("height", 0) or size[1]] != size
    if cut or max(info.get("binning_x", 0), info.get("binning_y", 0)) > 1:
        invalid(
            "camera_info.roi", "the calibration is of the whole image, without region or binning; send whole images"
        )


def read_opencv(path: Path, fisheye: bool) -> Calibration:
    """From a file of cv2.FileStorage."""
    import cv2

    _read_text(path)  # names a file that is not there, where FileStorage only prints
    try:
        storage = cv2.FileStorage(os.fspath(path), cv2.FILE_STORAGE_READ)
    except (cv2.error, SystemError) as error:
        invalid(str(path), f"is no file of OpenCV's FileStorage ({error})", "INVALID_FILE")
    try:
        k, d = (_opencv_matrix(path, storage, key) for key in ("camera_matrix", "distortion_coefficients"))
        size = [_opencv_side(path, storage, key) for key in ("image_width", "image_height")]
        is_fisheye = fisheye or storage.getNode("fisheye_model").real() == 1
    finally:
        storage.release()
    return _of_opencv(str(path), size, numbers(str(path), k, (3, 3)), numbers(str(path), d.ravel(), (-1,)), is_fisheye)


def _opencv_matrix(path: Path, storage: Any, key: str) -> Any:
    matrix = storage.getNode(key).mat()
    if matrix is None:
        invalid(str(path), f"has no matrix '{key}'", "INVALID_FILE")
    return matrix


def _opencv_side(path: Path, storage: Any, key: str) -> int:
    if storage.getNode(key).empty():
        invalid(str(path), f"has no '{key}'", "INVALID_FILE")
    return _side(str(path), storage.getNode(key).real())


def _of_opencv(where: str, size: Sequence[int], k: Any, d: Any, fisheye: bool) -> Calibration:
    pinhole = [float(value) for value in (k[0, 0], k[1, 1], k[0, 2], k[1, 2])]
    distortion = [float(value) for value in d]
    if not np.any(d) and not fisheye:
        return Calibration("PINHOLE", size[0], size[1], pinhole)
    # OpenCV's order: k1, k2, p1, p2, then terms that maploc has not; a fisheye's k1, k2, k3, k4.
    if any(distortion[4:]):
        terms = f"k1, k2, p1, p2 are supported, further terms ({distortion[4:]}) are not"
        cure = f"calibrate with them fixed at 0 (cv2.CALIB_FIX_K3), or {_UNDISTORT}"
        invalid(where, f"{terms}; {cure}", "UNSUPPORTED_CAMERA_MODEL")
    distortion = (distortion + [0.0] * 4)[:4]
    return Calibration("OPENCV_FISHEYE" if fisheye else "OPENCV", size[0], size[1], pinhole + distortion)


def _field(info: Mapping[str, Any], *names: str) -> Any:
    for name in names:
        if name in info:
            return info[name]
    invalid(f"camera_info.{names[0]}", f"is required (one of {', '.join(names)})", "REQUIRED")


def _entries(matrix: Any) -> Any:
    """A YAML file has rows, cols and data where the message has a list."""
    return matrix.get("data") if isinstance(matrix, Mapping) else matrix


def _side(where: str, value: Any) -> int:
    side = float(numbers(where, value, ()))
    if side != int(side):
        invalid(where, "the image's sides must be whole numbers of pixels")
    return int(side)


def _read_text(path: Path) -> str:
    try:
        with open(path, encoding="utf-8-sig") as file:
            return file.read()
    except (OSError, UnicodeDecodeError) as error:
        invalid(os.fspath(path), f"cannot be read ({error})", "INVALID_FILE")
