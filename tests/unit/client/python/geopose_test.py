"""GeoPose: EPSG's own example, directions, and the names of the published schema."""

import json
import math
import pathlib
import tempfile
import unittest

import maploc
import numpy as np
from maploc.geopose import Anchor

# schemas.opengis.net/geopose/1.0/schemata/GeoPose.Basic.Quaternion: these are all required, and numbers.
SCHEMA = {"position": {"lat", "lon", "h"}, "quaternion": {"x", "y", "z", "w"}}


def pose_at(x: float, y: float, z: float, yaw: float = 0.0) -> maploc.Pose:
    """In the map."""
    turned = np.array([0, 0, math.sin(yaw / 2), math.cos(yaw / 2)])
    return maploc.Pose(np.array([x, y, z]), turned, np.eye(6))


class GeoPoseTest(unittest.TestCase):
    """Poses of maps in several places."""

    def test_epsgs_example_of_a_topocentric_point(self) -> None:
        # EPSG Guidance Note 7-2, method 9837: east, north and up of a point seen from 55 N, 5 E, 200 m.
        anchor = Anchor(55.0, 5.0, 200.0, heading_degrees=90.0)  # x points east
        position = anchor.geopose(pose_at(-189013.869, -128642.040, -4220.171))["position"]
        self.assertAlmostEqual(position["lat"], 53 + 48 / 60 + 33.820 / 3600, delta=1e-8)
        self.assertAlmostEqual(position["lon"], 2 + 7 / 60 + 46.380 / 3600, delta=1e-8)
        self.assertAlmostEqual(position["h"], 73.0, delta=1e-3)

    def test_the_heading_is_clockwise_from_north(self) -> None:
        for heading, north, east in [(0, 1, 0), (90, 0, 1), (180, -1, 0), (270, 0, -1)]:
            position = Anchor(-33.0, 151.0, 20.0, heading).geopose(pose_at(100.0, 0.0, 0.0))["position"]
            self.assertAlmostEqual((position["lat"] + 33.0) * 110900 / 100, north, delta=2e-3)
            self.assertAlmostEqual((position["lon"] - 151.0) * 93450 / 100, east, delta=2e-3)

    def test_the_quaternion_is_of_the_plane_east_north_up(self) -> None:
        # The body's x points north: a quarter turn from east.
        quaternion = Anchor(48.0, 11.0, 500.0, 30.0).geopose(pose_at(0, 0, 0, yaw=math.radians(30)))["quaternion"]
        half = math.sqrt(0.5)
        np.testing.assert_allclose(list(quaternion.values()), [0, 0, half, half], atol=1e-12)

    def test_the_plane_is_the_one_below_the_body(self) -> None:
        # 10 km north of the anchor the vertical leans by the arc of the earth.
        geopose = Anchor(48.0, 11.0, 0.0, 90.0).geopose(pose_at(0.0, 10000.0, 0.0))
        self.assertAlmostEqual(2 * geopose["quaternion"]["x"], 10000 / 6.374e6, delta=1e-5)
        self.assertAlmostEqual(geopose["position"]["h"], 10000**2 / 2 / 6.374e6, delta=0.05)

    def test_the_fields_are_the_schemas(self) -> None:
        geopose = json.loads(json.dumps(Anchor(90.0, -180.0, 0.0, 0.0).geopose(pose_at(1, 2, 3))))
        self.assertEqual({name: set(fields) for name, fields in geopose.items()}, SCHEMA)
        for fields in geopose.values():
            self.assertTrue(all(isinstance(value, float) and math.isfinite(value) for value in fields.values()))

    def test_what_is_no_pose_is_refused_by_name(self) -> None:
        anchor, good = Anchor(48.0, 11.0, 500.0, 30.0), np.array([0, 0, 0, 1.0])
        for position, orientation, field in [
            (np.full(3, math.nan), good, "pose.position_in_map"),
            (np.full(3, 1e200), good, "pose.position_in_map"),
            (np.zeros(3), 2 * good, "pose.orientation_xyzw"),
            (np.zeros(3), 0 * good, "pose.orientation_xyzw"),
        ]:
            with self.subTest(field=field), self.assertRaises(maploc.MaplocError) as raised:
                anchor.geopose(maploc.Pose(position, orientation, np.eye(6)))
            self.assertEqual(raised.exception.field, field)

    def test_an_anchor_is_kept_in_a_file(self) -> None:
        path = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory())) / "anchor.json"
        anchor = Anchor(48.1, 11.6, 520.5, 12.25)
        anchor.write(path)
        self.assertEqual(Anchor.read(path), anchor)
        for text in ("no JSON", "[]", 100000 * "[", '{"latitude_degrees": 1}'):
            path.write_text(text)
            with self.assertRaisesRegex(maploc.MaplocError, "anchor.json"):
                Anchor.read(path)
        path.write_text(json.dumps({**vars(anchor), "latitude_degrees": "north"}))
        with self.assertRaisesRegex(maploc.MaplocError, "anchor.latitude_degrees"):
            Anchor.read(path)
        for bad in (91.0, math.nan, True):
            with self.assertRaisesRegex(maploc.MaplocError, "anchor.latitude_degrees"):
                Anchor(bad, 0, 0, 0)


if __name__ == "__main__":
    unittest.main()
