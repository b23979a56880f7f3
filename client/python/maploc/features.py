"""Keypoints and line segments by OpenCV, the same as the map's importer and the C++ robot find (mapstore/features),
which see for the measurements behind the pixel shifts. Positions: the centre of the photo's first pixel is (0, 0)."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from maploc.errors import MaplocError
from maploc.photo import Gray
from maploc.query import DescriptorKind, Lines, Metric, Points

MAX_POINTS = 5000  # the strongest are kept
MAX_LINES = 1000  # the longest are kept
_MIN_LINE_PIXELS = 20.0
_MIN_SIDE_PIXELS = 32  # below it a detector finds nothing, or fails
# A larger photo is reduced before detection, because SIFT takes 210 bytes a pixel; the detectors overflow on longer
# sides.
_MAX_PIXELS = 3_840_000
_MAX_SIDE_PIXELS = 16384

_ORB_SCALE = np.float32(1.2)
_SIFT_LAYERS = 3
_SIFT_CONTRAST = 0.02  # COLMAP's peak threshold
_SIFT_SHIFT = np.float32(0.25)  # SIFT doubles the image, which puts pixel x at 2x + 1/2, and halves the result
_LSD_SHIFT = np.float32(0.125)  # LSD works at 0.8 of the size, and divides without the half pixel

LBD = DescriptorKind("lbd", 32, Metric.HAMMING)

Floats = npt.NDArray[np.float32]
Bytes = npt.NDArray[np.uint8]


def has_lines() -> bool:
    """Whether this OpenCV has the module line_descriptor; Debian 12's has. Without it queries have points alone."""
    return hasattr(cv2, "line_descriptor")


def detect_points(gray: Gray, kind: DescriptorKind, *, max_points: int = MAX_POINTS) -> Points:
    """The strongest keypoints with descriptors of `kind`: "sift_root_u8", "sift_u8" or "orb"."""
    detectors: dict[str, Callable[[Gray, int], tuple[Floats, Bytes]]] = {
        "sift_root_u8": lambda pixels, count: _sift(pixels, count, _root),
        "sift_u8": lambda pixels, count: _sift(pixels, count, _rounded),
        "orb": _orb,
    }
    if kind.name not in detectors:
        cure = "use orb, sift_root_u8 or sift_u8, or make Points of your own detector's keypoints and descriptors"
        message = f"descriptors of kind '{kind.name}' cannot be extracted from photos; {cure}"
        raise MaplocError("UNIMPLEMENTED", "NO_DETECTOR", message)
    reduced = _reduce(gray)
    if min(reduced.pixels.shape) < _MIN_SIDE_PIXELS:
        return Points.none(kind)
    keypoints, descriptors = detectors[kind.name](reduced.pixels, max_points)
    return Points(reduced.to_photo(keypoints), descriptors, kind)


def detect_lines(gray: Gray) -> Lines:
    """The longest LSD segments with LBD descriptors; none where OpenCV has no line_descriptor (`has_lines`)."""
    reduced = _reduce(gray)
    if not has_lines() or min(reduced.pixels.shape) < _MIN_SIDE_PIXELS:
        return Lines.none(LBD)
    segments = _lsd(reduced.pixels)
    if len(segments) == 0:
        return Lines.none(LBD)
    descriptors = _lbd(reduced.pixels, segments)
    in_photo = reduced.to_photo(segments.reshape(-1, 2)).reshape(-1, 4)
    return Lines(in_photo, descriptors, LBD)


@dataclass(frozen=True)
class _Reduced:
    pixels: Gray
    photo_shape: tuple[int, ...]

    def to_photo(self, positions: Floats) -> Floats:
        """The pixels' outer borders stay in place: (x + 1/2) / side = (x_reduced + 1/2) / side_reduced."""
        if self.pixels.shape == self.photo_shape:
            return positions
        scale = np.array(self.photo_shape[::-1], np.float64) / np.array(self.pixels.shape[::-1], np.float64)
        in_photo: Floats = ((positions.astype(np.float64) + 0.5) * scale - 0.5).astype(np.float32)
        return in_photo


def _reduce(gray: Gray) -> _Reduced:
    height, width = gray.shape
    pixel = max(1.0, math.sqrt(width * height / _MAX_PIXELS), max(width, height) / _MAX_SIDE_PIXELS)
    if pixel == 1.0:
        return _Reduced(gray, gray.shape)
    size = [max(1, math.floor(side / pixel + 1e-9)) for side in (width, height)]
    return _Reduced(cv2.resize(gray, size, interpolation=cv2.INTER_AREA), gray.shape)


def _strongest_first(keypoints: Any) -> npt.NDArray[np.intp]:
    responses = np.array([keypoint.response for keypoint in keypoints], np.float32)
    return np.argsort(-responses, kind="stable")


def _positions(keypoints: Any) -> Floats:
    return np.array([keypoint.pt for keypoint in keypoints], np.float32).reshape(-1, 2)


def _sift(pixels: Gray, count: int, quantize: Callable[[Floats], Bytes]) -> tuple[Floats, Bytes]:
    detector = cv2.SIFT_create(count, nOctaveLayers=_SIFT_LAYERS, contrastThreshold=_SIFT_CONTRAST)
    keypoints, values = detector.detectAndCompute(pixels, None)
    if not keypoints:
        return np.empty((0, 2), np.float32), np.empty((0, 128), np.uint8)
    order = _strongest_first(keypoints)
    return _positions(keypoints)[order] - _SIFT_SHIFT, quantize(values[order])


def _root(values: Floats) -> Bytes:
    """COLMAP's normalization: L1, square root, times 512."""
    sums = values.sum(axis=1, keepdims=True)
    roots = np.sqrt(np.divide(values, sums, out=np.zeros_like(values), where=sums > 0))
    # Half up as C++ rounds; numpy rounds half to even.
    scaled = np.floor((np.float32(512) * roots).astype(np.float64) + 0.5)
    quantized: Bytes = np.minimum(scaled, 255).astype(np.uint8)
    return quantized


def _rounded(values: Floats) -> Bytes:
    return np.clip(np.rint(values), 0, 255).astype(np.uint8)


def _orb(pixels: Gray, count: int) -> tuple[Floats, Bytes]:
    keypoints, values = cv2.ORB_create(count, scaleFactor=float(_ORB_SCALE)).detectAndCompute(pixels, None)
    if not keypoints:
        return np.empty((0, 2), np.float32), np.empty((0, 32), np.uint8)
    order = _strongest_first(keypoints)
    octaves = np.array([keypoint.octave for keypoint in keypoints])
    return _orb_positions(_positions(keypoints), octaves, pixels.shape)[order], values[order]


def _orb_positions(positions: Floats, octaves: npt.NDArray[Any], shape: tuple[int, ...]) -> Floats:
    """ORB multiplies a pyramid level's coordinates by its nominal scale. But levels are resized with the pixels'
    outer borders
    in place, to whole sizes: (x_level + 1/2) / side_level = (x + 1/2) / side."""
    scales = np.power(np.float64(_ORB_SCALE), octaves).astype(np.float32)[:, None]
    sides = np.array(shape[::-1], np.float32)
    sides_level = np.rint(sides / scales).astype(np.float32)
    half = np.float32(0.5)
    result: Floats = (positions / scales + half) * sides / sides_level - half
    return result


def _lengths(segments: Floats) -> Floats:
    return np.hypot(segments[:, 2] - segments[:, 0], segments[:, 3] - segments[:, 1])


def _lsd(pixels: Gray) -> Floats:
    found = cv2.createLineSegmentDetector(cv2.LSD_REFINE_STD).detect(pixels)[0]
    if found is None:
        return np.empty((0, 4), np.float32)
    height, width = pixels.shape
    limits = np.array([width - 1, height - 1, width - 1, height - 1], np.float32)
    segments = np.clip(found.reshape(-1, 4) + _LSD_SHIFT, np.float32(0), limits)
    segments = segments[_lengths(segments) >= _MIN_LINE_PIXELS]
    longest: Floats = segments[np.argsort(-_lengths(segments), kind="stable")][:MAX_LINES]
    return longest


def _lbd(pixels: Gray, segments: Floats) -> Bytes:
    lengths, longest_side = _lengths(segments), np.float32(max(pixels.shape))
    keylines = [_keyline(i, segments[i], lengths[i], longest_side) for i in range(len(segments))]
    describer = cv2.line_descriptor.BinaryDescriptor_createBinaryDescriptor()
    descriptors: Bytes = describer.compute(pixels, keylines)[1]
    return descriptors


def _keyline(index: int, segment: Floats, length: np.float32, longest_side: np.float32) -> Any:
    line = cv2.line_descriptor.KeyLine()
    x0, y0, x1, y1 = (float(value) for value in segment)
    line.startPointX = line.sPointInOctaveX = x0
    line.startPointY = line.sPointInOctaveY = y0
    line.endPointX = line.ePointInOctaveX = x1
    line.endPointY = line.ePointInOctaveY = y1
    across, down = segment[2] - segment[0], segment[3] - segment[1]
    line.lineLength = float(length)
    line.angle = float(np.arctan2(down, across))
    line.class_id = index
    line.octave = 0
    line.size = float(across * down)
    line.response = float(length / longest_side)
    # As cv::LineIterator counts them, which has no Python.
    line.numOfPixels = int(np.abs(np.rint(segment[2:]) - np.rint(segment[:2])).max()) + 1
    line.pt = (float((segment[0] + segment[2]) / 2), float((segment[1] + segment[3]) / 2))
    return line
