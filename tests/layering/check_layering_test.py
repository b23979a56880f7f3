#!/usr/bin/env python3
"""Writes a file with each kind of violation into a temporary tree and tests that check_layering.py reports it."""

import contextlib
import io
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import check_layering  # noqa: E402


def breaches_of(name, text):
    with tempfile.TemporaryDirectory() as directory:
        root = pathlib.Path(directory)
        path = root / name
        path.parent.mkdir(parents=True)
        path.write_text(text)
        return list(check_layering.check_file(root, path))


class LayeringTest(unittest.TestCase):
    def test_allowed_includes_pass(self):
        text = '#include <vector>\n#include "mapstore/base/status.h"\n#include "server/solvers/up2p.h"\n'
        self.assertEqual(breaches_of("server/ransac/a.cc", text), [])

    def test_wrong_direction_is_found(self):
        for name, included in [("mapstore/base/a.cc", "mapstore/model/map.h"),
                               ("client/api/a.cc", "server/app/server.h"),
                               ("client/robot/a.cc", "mapstore/store/map_store.h"),
                               ("mapstore/store/a.cc", "proto/convert/convert.h"),
                               ("server/solvers/a.h", "tests/support/seed.h")]:
            found = breaches_of(name, f'#include "{included}"\n')
            self.assertEqual(len(found), 1, (name, included))
            self.assertTrue(found[0].startswith(f"{name}:1:"))

    def test_confined_headers_are_found_elsewhere(self):
        for name, included in [("server/service/a.cc", "sqlite3.h"), ("mapstore/store/a.cc", "sqlite3.h"),
                               ("server/pipeline/a.cc", "grpcpp/grpcpp.h"),
                               ("client/robot/a.cc", "maploc/v1/types.pb.h"),
                               ("server/ransac/a.cc", "ceres/ceres.h"),
                               ("server/matching/a.cc", "opencv2/core.hpp")]:
            self.assertEqual(len(breaches_of(name, f"#include <{included}>\n")), 1, (name, included))

    def test_confined_modules_are_found_elsewhere(self):
        for name, text in [("client/python/maploc/client.py", "import grpc"),
                           ("client/python/maploc/answer.py", "from maploc.v1 import types_pb2"),
                           ("client/python/maploc/gravity.py", "    import cv2")]:
            found = breaches_of(name, f"import numpy\n{text}\n")
            self.assertEqual(len(found), 1, text)
            self.assertTrue(found[0].startswith(f"{name}:2:"))
        self.assertEqual(breaches_of("client/python/maploc/channel.py", "import grpc\n"), [])

    def test_unknown_folder_and_long_file_are_found(self):
        self.assertEqual(len(breaches_of("server/attic/a.cc", '#include "mapstore/base/ids.h"\n')), 1)
        self.assertEqual(len(breaches_of("server/app/a.cc", "\n" * 401)), 1)

    def test_an_empty_tree_is_no_pass(self):
        with tempfile.TemporaryDirectory() as directory, contextlib.redirect_stdout(io.StringIO()):
            sys.argv = ["check_layering.py", directory]
            self.assertEqual(check_layering.main(), 1)


if __name__ == "__main__":
    unittest.main()
