"""A pose on the earth: OGC GeoPose 1.0, Basic-Quaternion, of a map whose anchor is known.

The anchor says where the map's origin lies and where its x axis points; a map's z is up. It is kept in a JSON file
beside the robot, with the names of Anchor's attributes.
"""

import json
import math
import os
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from maploc.answer import Pose, check_pose
from maploc.arrays import Floats, matrix_from_quaternion, quaternion_from_matrix
from maploc.errors import invalid

_SEMI_MAJOR_METERS = 6378137.0  # WGS84
_FLATTENING = 1 / 298.257223563  # WGS84
_SQUARED_ECCENTRICITY = _FLATTENING * (2 - _FLATTENING)
_LIMITS = {"latitude_degrees": 90.0, "longitude_degrees": 180.0, "height_meters": 1e5, "heading_degrees": 360.0}


@dataclass(frozen=True)
class Anchor:
    """Where a map lies.

    Attributes:
        latitude_degrees, longitude_degrees: of the map's origin, WGS84.
        height_meters: of the map's origin above the ellipsoid (not above the sea).
        heading_degrees: direction of the map's x axis, clockwise from north.
    """

    latitude_degrees: float
    longitude_degrees: float
    height_meters: float
    heading_degrees: float

    def __post_init__(self) -> None:
        for name, limit in _LIMITS.items():
            value = getattr(self, name)
            number = isinstance(value, (int, float)) and not isinstance(value, bool)
            if not number or not -limit <= value <= limit:
                invalid(f"anchor.{name}", f"must be a number in {-limit:g} to {limit:g}", "OUT_OF_RANGE")

    @classmethod
    def read(cls, path: str | os.PathLike[str]) -> "Anchor":
        """From a JSON file that `write` wrote, or you did."""
        try:
            with open(path, encoding="utf-8") as file:
                fields = json.load(file)
        except (OSError, ValueError, RecursionError) as error:
            invalid(os.fspath(path), f"cannot be read ({error})", "INVALID_FILE")
        if not isinstance(fields, dict) or set(fields) != set(_LIMITS):
            invalid(os.fspath(path), f"must be a JSON object of {', '.join(_LIMITS)}", "INVALID_FILE")
        return cls(**fields)

    def write(self, path: str | os.PathLike[str]) -> None:
        """To a JSON file."""
        with open(path, "w", encoding="utf-8") as file:
            json.dump(asdict(self), file, indent=2)

    def geopose(self, pose: Pose) -> dict[str, Any]:
        """GeoPose 1.0 Basic-Quaternion of a pose in the map, for json.dumps.

        The quaternion is enu_from_body, in the plane that touches the ellipsoid at the body's own latitude and
        longitude: x east, y north, z up.
        """
        check_pose("pose", pose)
        latitude, longitude = math.radians(self.latitude_degrees), math.radians(self.longitude_degrees)
        ecef_from_map = _ecef_from_enu(latitude, longitude) @ _enu_from_map(math.radians(self.heading_degrees))
        origin = _ecef(latitude, longitude, self.height_meters)
        body = _geodetic(origin + ecef_from_map @ pose.position_in_map)
        enu_from_map = _ecef_from_enu(body[0], body[1]).T @ ecef_from_map
        xyzw = quaternion_from_matrix(enu_from_map @ matrix_from_quaternion(pose.orientation_xyzw))
        return {
            "position": {"lat": math.degrees(body[0]), "lon": math.degrees(body[1]), "h": body[2]},
            "quaternion": dict(zip("xyzw", map(float, xyzw))),
        }


def _enu_from_map(heading: float) -> Floats:
    east, north = math.sin(heading), math.cos(heading)  # of the map's x axis
    return np.array([[east, -north, 0], [north, east, 0], [0, 0, 1.0]])


def _ecef_from_enu(latitude: float, longitude: float) -> Floats:
    s, c = math.sin(latitude), math.cos(latitude)
    t, d = math.sin(longitude), math.cos(longitude)
    return np.array([[-t, -s * d, c * d], [d, -s * t, c * t], [0, c, s]])


def _normal_radius(latitude: float) -> float:
    return _SEMI_MAJOR_METERS / math.sqrt(1 - _SQUARED_ECCENTRICITY * math.sin(latitude) ** 2)


def _ecef(latitude: float, longitude: float, height: float) -> Floats:
    radius = _normal_radius(latitude)
    across = (radius + height) * math.cos(latitude)
    up = (radius * (1 - _SQUARED_ECCENTRICITY) + height) * math.sin(latitude)
    return np.array([across * math.cos(longitude), across * math.sin(longitude), up])


def _geodetic(ecef: Floats) -> tuple[float, float, float]:
    """Latitude and longitude in radians, height in metres. Each round is 150 times as exact as the last."""
    across, up = math.hypot(ecef[0], ecef[1]), float(ecef[2])
    latitude = math.atan2(up, across * (1 - _SQUARED_ECCENTRICITY))
    for _ in range(8):
        shift = _SQUARED_ECCENTRICITY * _normal_radius(latitude) * math.sin(latitude)
        latitude = math.atan2(up + shift, across)
    s, c = math.sin(latitude), math.cos(latitude)
    height = across * c + up * s - _SEMI_MAJOR_METERS * math.sqrt(1 - _SQUARED_ECCENTRICITY * s * s)
    return latitude, math.atan2(ecef[1], ecef[0]), height
