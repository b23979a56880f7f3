"""The examples, as a user runs them, on the painted room."""

import csv
import pathlib
import subprocess
import sys

import unittest

from room_test_case import RoomTestCase
from running_server import SOURCE

EXAMPLES = SOURCE / "client" / "python" / "examples"


class ExamplesTest(RoomTestCase):
    """Each is a program of at most 40 lines. ros_node_test has the ROS node."""

    def test_they_are_short(self) -> None:
        examples = sorted(set(EXAMPLES.glob("*.py")) - {EXAMPLES / "ros_node.py"})
        self.assertEqual([path.name for path in examples], ["folder.py", "loop.py", "photo.py"])
        for path in examples:
            self.assertLessEqual(len(path.read_text().splitlines()), 40, path)

    def test_a_photo(self) -> None:
        shot = self.shots[0]
        printed = self.run_example("photo.py", str(shot.path), *map(str, shot.down_in_camera))
        position = [float(number) for number in printed.splitlines()[0].split()[1:]]
        for found, true in zip(position, shot.position_in_room, strict=True):
            self.assertAlmostEqual(found, true, delta=0.02)

    def test_a_loop(self) -> None:
        printed = self.run_example("loop.py", str(self.queries() / "%d.png"))
        self.assertEqual(printed.count("LOCALIZED"), len(self.shots))
        self.assertTrue(printed.endswith(f"{len(self.shots)} frames localized\n"), printed)

    def test_a_folder(self) -> None:
        (self.queries() / "broken.png").write_bytes(b"no picture")
        (self.queries() / "cut.png").write_bytes(self.shots[0].path.read_bytes()[:-100])
        rows = list(csv.DictReader(self.run_example("folder.py", str(self.queries())).splitlines()))
        self.assertEqual([row["photo"] for row in rows], [shot.path.name for shot in self.shots])
        self.assertEqual({row["outcome"] for row in rows}, {"LOCALIZED"})

    def queries(self) -> pathlib.Path:
        """The folder of the query photos."""
        return self.shots[0].path.parent

    def run_example(self, name: str, what: str, *more: str) -> str:
        """What it printed."""
        cameras = str(self.folder / "model" / "cameras.txt")
        command = [sys.executable, str(EXAMPLES / name), self.server.address, "room", what, cameras, *more]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout


if __name__ == "__main__":
    unittest.main()
