"""A corner of a room whose walls are painted with noise: photos of it, and the COLMAP model of those that map it.

Frames: the room is a map's: z up, metres. Cameras: x right, y down, z forward.
"""

import pathlib
from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

WIDTH, HEIGHT, FOCAL = 640, 480, 500.0
WALL_METERS = 6.0
TEXELS = 1200
Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Shot:
    """A photo with its reference pose."""

    path: pathlib.Path
    camera_from_room: Floats  # 3 x 4
    position_in_room: Floats
    down_in_camera: Floats


def paint_room(folder: pathlib.Path, seed: int) -> list[Shot]:
    """Writes photos/, model/ (of the mapping photos) and cameras.txt; returns the query shots, photos/query/N.png."""
    walls = [_texture(np.random.default_rng(seed + i)) for i in range(3)]
    mapping = [
        _shoot(folder / "photos" / "map" / f"{i}.png", walls, angle) for i, angle in enumerate(np.linspace(25, 65, 7))
    ]
    queries = [
        _shoot(folder / "photos" / "query" / f"{i}.png", walls, angle) for i, angle in enumerate((35.0, 48.0, 57.0))
    ]
    _write_model(folder / "model", mapping)
    return queries


def _texture(random: np.random.Generator) -> npt.NDArray[np.uint8]:
    """Blobs of several sizes, so that the painting has corners near and far."""
    sum_of_sizes = np.zeros((TEXELS, TEXELS), np.float32)
    for cells in (30, 90, 300):
        noise = random.random((cells, cells), np.float32)
        sum_of_sizes += cv2.resize(noise, (TEXELS, TEXELS), interpolation=cv2.INTER_CUBIC)
    texture: npt.NDArray[np.uint8] = np.clip(sum_of_sizes / 3 * 255, 0, 255).astype(np.uint8)
    return texture


def _shoot(path: pathlib.Path, walls: list[npt.NDArray[np.uint8]], angle_degrees: float) -> Shot:
    """From a circle about the corner, towards it."""
    angle = np.radians(angle_degrees)
    position = np.array([4.5 * np.cos(angle), 4.5 * np.sin(angle), 1.6])
    forward = np.array([0.6, 0.6, 1.2]) - position
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, [0, 0, 1])
    right /= np.linalg.norm(right)
    rotation = np.array([right, np.cross(forward, right), forward])
    path.parent.mkdir(parents=True, exist_ok=True)
    if not cv2.imwrite(str(path), _render(walls, rotation, position)):
        raise OSError(f"{path} cannot be written")
    pose = np.column_stack([rotation, -rotation @ position])
    return Shot(path, pose, position, rotation @ np.array([0.0, 0.0, -1.0]))


def _render(walls: list[npt.NDArray[np.uint8]], rotation: Floats, position: Floats) -> npt.NDArray[np.uint8]:
    """The walls are the planes x = 0, y = 0 and the floor z = 0; each pixel shows the nearest that it meets."""
    x, y = np.meshgrid(np.arange(WIDTH) - (WIDTH - 1) / 2, np.arange(HEIGHT) - (HEIGHT - 1) / 2)
    rays = np.stack([x / FOCAL, y / FOCAL, np.ones_like(x)], axis=-1) @ rotation
    photo = np.zeros((HEIGHT, WIDTH), np.uint8)
    nearest = np.full((HEIGHT, WIDTH), np.inf)
    for axis, wall in enumerate(walls):
        with np.errstate(divide="ignore"):
            distance = -position[axis] / rays[..., axis]
        hit = (distance > 0) & (distance < nearest)
        nearest[hit] = distance[hit]
        point = position + rays * distance[..., None]
        u, v = (point[..., (axis + i) % 3] / WALL_METERS * TEXELS for i in (1, 2))
        where = (u.astype(np.float32), v.astype(np.float32))
        seen = cv2.remap(wall, *where, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REFLECT)
        photo[hit] = seen[hit]
    return photo


def _write_model(folder: pathlib.Path, shots: list[Shot]) -> None:
    """COLMAP's text model: poses alone; the importer triangulates. The centre of the first pixel is (0.5, 0.5) here."""
    folder.mkdir()
    camera = f"1 PINHOLE {WIDTH} {HEIGHT} {FOCAL} {FOCAL} {WIDTH / 2} {HEIGHT / 2}\n"
    images = [f"{i} {_pose_text(shot.camera_from_room)} 1 map/{shot.path.name}\n\n" for i, shot in enumerate(shots, 1)]
    (folder / "cameras.txt").write_text(camera)
    (folder / "images.txt").write_text("".join(images))
    (folder / "points3D.txt").write_text("")


def _pose_text(camera_from_room: Floats) -> str:
    """QW QX QY QZ TX TY TZ."""
    vector, _ = cv2.Rodrigues(camera_from_room[:, :3])
    angle = float(np.linalg.norm(vector))
    axis = vector.ravel() / angle
    values = [np.cos(angle / 2), *(np.sin(angle / 2) * axis), *camera_from_room[:, 3]]
    return " ".join(repr(float(value)) for value in values)
