"""Package and examples are clean under mypy --strict, and the types catch a pose that is used unchecked."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

from running_server import SOURCE

PACKAGE = SOURCE / "client" / "python"
CARELESS = """
import maploc

def where(client: maploc.Client, camera: maploc.Camera) -> None:
    answer = client.localize_photo("yard", "photo.jpg", camera)
    print(answer.pose.map_from_body)
"""


class TypesTest(unittest.TestCase):
    """mypy is Debian's, the package that of this interpreter."""

    def test_the_package_is_strictly_typed(self) -> None:
        self.assertIn("Success", self.mypy("-p", "maploc"))

    def test_the_examples_are_strictly_typed(self) -> None:
        self.assertIn("Success", self.mypy(str(PACKAGE / "examples")))

    def test_the_wheels_builder_is_strictly_typed(self) -> None:
        self.assertIn("Success", self.mypy(str(PACKAGE / "build_backend.py")))

    def test_a_pose_that_is_used_unchecked_is_found(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "careless.py"
            path.write_text(CARELESS)
            self.assertIn('"None" of "Optional[Pose]" has no attribute', self.mypy(str(path)).replace("Item ", ""))

    def mypy(self, *what: str) -> str:
        """What it prints."""
        with tempfile.TemporaryDirectory() as cache:
            command = ["/usr/bin/python3", "-m", "mypy", "--config-file", str(PACKAGE / "pyproject.toml")]
            command += ["--cache-dir", cache, "--python-executable", sys.executable, *what]
            done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=cache)
        self.assertEqual(done.stderr, "")
        return done.stdout


if __name__ == "__main__":
    unittest.main()
