"""From a photo to what is sent."""

from maploc.answer import Map
from maploc.arrays import Floats
from maploc.camera import Camera
from maploc.errors import invalid
from maploc.features import LBD, detect_lines, detect_points
from maploc.photo import Photo, as_gray
from maploc.query import View


def make_view(photo: Photo, camera: Camera, map_info: Map, *, camera_from_body: Floats | None = None) -> View:
    """Finds the features that the map needs.

    Args:
        photo: a path; or uint8 pixels as stored, grey (height, width) or OpenCV's blue-green-red (height, width, 3).
        camera: of these pixels.
        map_info: of Client.map; says the kinds of the descriptors.
        camera_from_body: as View.
    """
    gray = as_gray(photo)
    height, width = gray.shape
    if (width, height) != (camera.width_pixels, camera.height_pixels):
        size = f"{camera.width_pixels}x{camera.height_pixels}"
        cure = "give the camera of the stored pixels: of the same size, and not turned as EXIF's orientation says"
        invalid("photo", f"is {width}x{height}, its camera {size}; {cure}", "SIZE_MISMATCH")
    return View(
        camera,
        None if map_info.point_kind is None else detect_points(gray, map_info.point_kind),
        detect_lines(gray) if map_info.line_kind == LBD else None,
        camera_from_body,
    )
