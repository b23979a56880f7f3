"""Photos as grey images, as the map's importer and the C++ robot read them."""

import os

import cv2
import numpy as np
import numpy.typing as npt

from maploc.errors import invalid

Gray = npt.NDArray[np.uint8]
Photo = str | os.PathLike[str] | npt.NDArray[np.uint8] | npt.NDArray[np.uint16]

_PNG = b"\x89PNG\r\n\x1a\n"
_JPEG = b"\xff\xd8\xff"


def load_gray(path: str | os.PathLike[str]) -> Gray:
    """A photo's pixels as stored, shape (height, width), 8 bits.

    EXIF's orientation is ignored, because a calibration is of the stored pixels. Of 16 bits the eight below the
    highest one in use are taken. A truncated JPEG or PNG is refused: OpenCV fills what is missing with grey.
    """
    name = os.fspath(path)
    try:
        with open(path, "rb") as file:
            content = file.read()
    except OSError as error:
        invalid(name, f"cannot be read ({error.strerror})", "INVALID_FILE")
    if ends_early(content):
        invalid(name, "is truncated: the file stops before the picture's end; copy it again", "TRUNCATED_IMAGE")
    flags = cv2.IMREAD_GRAYSCALE | cv2.IMREAD_IGNORE_ORIENTATION
    pixels = cv2.imread(name, flags | cv2.IMREAD_ANYDEPTH)
    if pixels is not None and pixels.dtype not in (np.uint8, np.uint16):
        pixels = cv2.imread(name, flags)  # OpenCV's own way with floating point
    if pixels is None:
        invalid(name, "is no image that OpenCV can read", "INVALID_FILE")
    return _eight_bits(pixels)


def as_gray(photo: Photo) -> Gray:
    """A photo of a path, or of an array: grey (height, width), or OpenCV's blue-green-red (height, width, 3); uint8."""
    if not isinstance(photo, np.ndarray):
        return load_gray(photo)
    if photo.dtype not in (np.uint8, np.uint16) or photo.size == 0:
        invalid("photo", f"is an array of {photo.dtype} {photo.shape}; it must be uint8 or uint16, and not empty")
    if photo.ndim == 3 and photo.shape[2] == 3:
        return _eight_bits(cv2.cvtColor(photo, cv2.COLOR_BGR2GRAY))
    if photo.ndim != 2:
        invalid("photo", f"has the shape {photo.shape}; it must be (height, width) or (height, width, 3)")
    return _eight_bits(photo)


def _eight_bits(pixels: npt.NDArray[np.uint8] | npt.NDArray[np.uint16]) -> Gray:
    if pixels.dtype == np.uint8:
        return np.ascontiguousarray(pixels, dtype=np.uint8)
    shift = max(0, int(pixels.max()).bit_length() - 8)  # sensors of 10 to 14 bits fill the low ones of 16
    return (pixels >> shift).astype(np.uint8)


def ends_early(content: bytes) -> bool:
    """Whether the bytes are a JPEG or PNG that stops before its end marker. What follows the end does not matter."""
    if content.startswith(_PNG):
        return _png_ends_early(content)
    return content.startswith(_JPEG) and _jpeg_ends_early(content)


def _png_ends_early(content: bytes) -> bool:
    """Chunks of length, type, data and checksum, the last one of type IEND."""
    at = len(_PNG)
    while at + 12 <= len(content):
        end = at + 12 + int.from_bytes(content[at : at + 4], "big")
        if end > len(content):
            return True
        if content[at + 4 : at + 8] == b"IEND":
            return False
        at = end
    return True


def _jpeg_ends_early(content: bytes) -> bool:
    """Segments with their length, so that a thumbnail's end inside of one is passed over; after a scan's header come
    coded bytes, where a marker is FF and neither 0 (a stuffed FF), FF (fill) nor a restart."""
    at = content.find(b"\xff", 2)
    while at != -1 and at + 1 < len(content):
        code = content[at + 1]
        if code in (0x00, 0xFF) or 0xD0 <= code <= 0xD7:
            at = content.find(b"\xff", at + 1)
            continue
        if code == 0xD9:
            return False
        if at + 4 > len(content):
            return True
        at = content.find(b"\xff", at + 2 + int.from_bytes(content[at + 2 : at + 4], "big"))
    return True
