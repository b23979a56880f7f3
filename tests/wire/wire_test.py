"""The wire contract: proto/ keeps buf's rules, nothing that was released has changed, and both checks can fail.

environment: MAPLOC_SOURCE_DIR; MAPLOC_BUF, the program
"""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(os.environ["MAPLOC_SOURCE_DIR"])
WIRE = SOURCE / "tests" / "wire"
SERVICE = "proto/maploc/v1/localization_service.proto"


def buf(root, *arguments):
    run = subprocess.run([os.environ["MAPLOC_BUF"], *arguments, "--config", WIRE / "buf.yaml"], cwd=root, text=True,
                         capture_output=True, check=False)
    return run.returncode, run.stdout + run.stderr


def breaking(root):
    return buf(root, "breaking", "--against", WIRE / "released.binpb")


class Wire(unittest.TestCase):
    def changed(self, old, new):
        """A copy of proto/ where the service's file has `new` for `old`."""
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        shutil.copytree(SOURCE / "proto", pathlib.Path(folder.name) / "proto")
        file = pathlib.Path(folder.name) / SERVICE
        text = file.read_text(encoding="utf-8")
        self.assertIn(old, text)
        file.write_text(text.replace(old, new), encoding="utf-8")
        return folder.name

    def test_keeps_the_rules(self):
        code, told = buf(SOURCE, "lint")
        self.assertEqual(code, 0, told)

    def test_what_was_released_has_not_changed(self):
        code, told = breaking(SOURCE)
        self.assertEqual(code, 0, told)

    def test_a_field_without_a_comment_is_found(self):
        code, told = buf(self.changed("  // The robot's name, at most 128 bytes. Required.\n", ""), "lint")
        self.assertNotEqual(code, 0)
        self.assertIn('"robot"', told)

    def test_a_breach_is_found(self):
        for old, new in (("string robot = 2;", "string robot = 7;"), ("string robot = 2;", "bytes robot = 2;"),
                         ("string robot = 2;", "string machine = 2;"),
                         ("  OUTCOME_OUT_OF_MAP = 6;", "  OUTCOME_OUT_OF_MAP = 9;")):
            code, told = breaking(self.changed(old, new))
            self.assertNotEqual(code, 0, new)
            self.assertIn(SERVICE, told)

    def test_an_addition_is_none(self):
        code, told = breaking(self.changed("  string robot = 2;", "  string robot = 2;\n  string colour = 99;"))
        self.assertEqual(code, 0, told)


if __name__ == "__main__":
    if not os.path.exists(os.environ["MAPLOC_BUF"]):
        print("skipped: buf is not installed, because the npm registry could not be reached")
        sys.exit(77)
    unittest.main()
