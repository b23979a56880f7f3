"""The church front of the real data: its photos from their pixels, and the C++ client's answers to the bit."""

import math
import pathlib
import statistics
import tempfile
import unittest

import maploc
import numpy as np
from running_server import RunningServer, real_data, run


class HerzjesuTest(unittest.TestCase):
    """8 photos that are not of the map."""

    data: pathlib.Path
    server: RunningServer
    client: maploc.Client
    camera: maploc.Camera

    @classmethod
    def setUpClass(cls) -> None:
        """Maps and serves the church."""
        cls.data = real_data("herzjesu")
        store = pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory())) / "store.db"
        run(
            *("maploc-map", "import-colmap", "--store", str(store), "--map", "church", "--gravity", "0,0,1"),
            *("--model", str(cls.data / "map"), "--database", str(cls.data / "database.db")),
            *("--images", str(cls.data / "images")),
        )
        cls.server = cls.enterClassContext(RunningServer(store))
        cls.client = cls.enterClassContext(maploc.Client(cls.server.address))
        cls.camera = maploc.Camera.from_colmap(cls.data / "query" / "cameras.txt")

    def test_every_photo_is_localized_to_a_centimetre(self) -> None:
        map_from_source = self.client.map("church").map_from_source
        errors = []
        for name, source_from_camera in self.references():
            down_in_camera = source_from_camera[:3, :3].T @ [0, 0, 1]
            answer = self.client.localize_photo(
                "church", self.data / "images" / name, self.camera, gravity=maploc.Gravity.down(down_in_camera)
            )
            assert answer.pose is not None, (name, answer.outcome)
            reference = (map_from_source @ source_from_camera)[:3, 3]
            errors.append(float(np.linalg.norm(answer.pose.position_in_map - reference)))
        print("errors in metres:", errors)
        self.assertEqual(len(errors), 8)
        self.assertLessEqual(statistics.median(errors), 0.01)
        self.assertLessEqual(max(errors), 0.05)

    def test_the_answers_are_the_c_plus_plus_clients_to_the_bit(self) -> None:
        for name, source_from_camera in self.references():
            down = exact_unit_vector(source_from_camera[:3, :3].T @ [0, 0, 1])
            photo = self.data / "images" / name
            expected = run(
                *("maploc", "localize", "--server", self.server.address, "--map", "church", "--image", str(photo)),
                *("--camera", str(self.data / "query"), "--gravity", ",".join(map(repr, down))),
            )
            gravity = maploc.Gravity.down(down, sigma_degrees=1.0)
            answer = self.client.localize_photo("church", photo, self.camera, gravity=gravity)
            assert answer.pose is not None
            pose, evidence = expected["map_from_body"], answer.evidence
            self.assertEqual(answer.pose.position_in_map.tolist(), [pose["translation"][axis] for axis in "xyz"])
            self.assertEqual(answer.pose.orientation_xyzw.tolist(), [pose["rotation"][axis] for axis in "xyzw"])
            self.assertEqual(answer.pose.covariance.ravel().tolist(), pose["covariance"])
            self.assertEqual(answer.confidence, expected["confidence"])
            self.assertEqual(evidence.gravity_disagreement_radians, expected["gravity_disagreement_rad"])
            for counts, key in ((evidence.points, "points"), (evidence.usable_lines, "usable_lines")):
                self.assertEqual({"matches": counts.matches, "inliers": counts.inliers}, expected[key])
            self.assertGreater(evidence.usable_lines.inliers, 0)

    def references(self) -> list[tuple[str, maploc.arrays.Floats]]:
        """Of each query photo its name and its 4 x 4 reference pose source_from_camera."""
        lines = (self.data / "query" / "images.txt").read_text().splitlines()
        found = []
        for fields in (line.split() for line in lines if line and not line.startswith("#")):
            w, x, y, z, *translation = map(float, fields[1:8])
            camera_from_source = np.eye(4)
            camera_from_source[:3, :3] = maploc.arrays.matrix_from_quaternion(np.array([x, y, z, w]))
            camera_from_source[:3, 3] = translation
            found.append((fields[9], np.linalg.inv(camera_from_source)))
        return found


def exact_unit_vector(vector: maploc.arrays.Floats) -> list[float]:
    """Near `vector`, with a norm of 1 exactly in whatever order it is summed up: normalizing it changes no bit."""
    random = np.random.default_rng(1)
    while True:
        tried = [float(value) for value in vector + random.normal(0, 1e-9, 3)]
        tried[1] = math.copysign(math.sqrt(1 - tried[0] ** 2 - tried[2] ** 2), tried[1])
        largest = max(map(abs, tried))
        scaled = [value * (1 / largest) for value in tried]
        norms = {
            math.sqrt(v[i] ** 2 + v[j] ** 2 + v[k] ** 2) * scale
            for v, scale in ((tried, 1.0), (scaled, largest))
            for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1))
        }
        if norms | {float(np.linalg.norm(tried))} == {1.0}:
            return tried


if __name__ == "__main__":
    unittest.main()
