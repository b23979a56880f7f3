"""The Python of the READMEs, run as it stands there against the painted room."""

import itertools
import pathlib
import subprocess
import sys
import tempfile
import unittest

import cv2
import maploc
from room_test_case import RoomTestCase
from running_server import SOURCE


class ReadmeTest(RoomTestCase):
    """Only the server's address and the map's name are others."""

    def test_the_projects_example_runs(self) -> None:
        printed = self.run_lines(SOURCE / "README.md")
        self.assertIn("queries=1, localized=1", printed)

    def test_the_packages_example_runs(self) -> None:
        printed = self.run_lines(SOURCE / "client" / "python" / "README.md")
        self.assertNotIn("not localized", printed)
        self.assertTrue(printed.startswith("[["), printed)

    def run_lines(self, readme: pathlib.Path) -> str:
        """What the indented block that begins with `import maploc` prints."""
        text = readme.read_text(encoding="utf-8")
        lines = text[text.index("    import maploc\n") :].splitlines()
        block = itertools.takewhile(lambda line: not line or line.startswith("    "), lines)
        program = "\n".join(line[4:] for line in block)
        program = program.replace("127.0.0.1:50051", self.server.address).replace('"yard"', '"room"')
        with tempfile.TemporaryDirectory() as folder:
            cv2.imwrite(f"{folder}/photo.jpg", maploc.load_gray(self.shots[0].path), [cv2.IMWRITE_JPEG_QUALITY, 95])
            cameras = (self.folder / "model" / "cameras.txt").read_text()
            pathlib.Path(folder, "cameras.txt").write_text(cameras)
            done = subprocess.run(
                [sys.executable, "-c", program], cwd=folder, capture_output=True, text=True, check=False
            )
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout


if __name__ == "__main__":
    unittest.main()
