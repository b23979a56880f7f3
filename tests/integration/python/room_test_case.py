"""A painted room, mapped and served, for the tests that need photos and no real data."""

import pathlib
import tempfile
import unittest

import maploc
from painted_room import Shot, paint_room
from running_server import RunningServer, run, seed_of


class RoomTestCase(unittest.TestCase):
    """The map is "room"."""

    kinds = {"room": "sift_root_u8"}  # the maps and the kinds of their points
    folder: pathlib.Path
    shots: list[Shot]
    server: RunningServer
    client: maploc.Client
    camera: maploc.Camera

    @classmethod
    def setUpClass(cls) -> None:
        """Imports and serves the maps."""
        cls.folder = pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory()))
        cls.shots = paint_room(cls.folder, seed_of(cls.__name__))
        for name, kind in cls.kinds.items():
            run(
                *("maploc-map", "import-colmap", "--store", str(cls.folder / "store.db"), "--map", name),
                *("--model", str(cls.folder / "model"), "--images", str(cls.folder / "photos")),
                *("--triangulate", "--gravity", "0,0,-1", "--scale", "1", "--descriptors", kind),
            )
        cls.server = cls.enterClassContext(RunningServer(cls.folder / "store.db"))
        cls.client = cls.enterClassContext(maploc.Client(cls.server.address))
        cls.camera = maploc.Camera.from_colmap(cls.folder / "model" / "cameras.txt")

    def segment_counts(self) -> tuple[int, int]:
        """Queries and sessions that the room's segments have counted."""
        segments = self.client.segments("room")
        return sum(segment.queries for segment in segments), sum(segment.sessions for segment in segments)
