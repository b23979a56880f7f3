"""The built binaries, and a maploc-server on a port that the system chooses."""

import json
import os
import pathlib
import subprocess
import time
import unittest
import zlib
from types import TracebackType
from typing import Any, Self

BIN = pathlib.Path(os.environ["MAPLOC_BIN_DIR"])
SOURCE = pathlib.Path(os.environ["MAPLOC_SOURCE_DIR"])
_START_SECONDS = 30.0


def run(binary: str, *arguments: str) -> Any:
    """Runs one of the binaries with --json; what it printed."""
    command = [str(BIN / binary), *arguments, "--json"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise AssertionError(f"{' '.join(command)}\n{done.stderr}")
    return json.loads(done.stdout)


def seed_of(name: str) -> int:
    """As tests/support/seed.h: of the test's name, and of MAPLOC_TEST_SEED to look for more."""
    return zlib.crc32((name + os.environ.get("MAPLOC_TEST_SEED", "")).encode())


def real_data(name: str) -> pathlib.Path:
    """A folder of the real data. Skips the test where it is not there."""
    folder = pathlib.Path(os.environ.get("MAPLOC_SHARED_DATA") or SOURCE.parent / "shared" / "data") / name
    if not folder.exists():
        raise unittest.SkipTest(
            f"no real data: {folder} does not exist; set MAPLOC_SHARED_DATA to the folder that holds it"
        )
    return folder


class RunningServer:
    """Serves a store until the end of the block."""

    def __init__(self, store: pathlib.Path) -> None:
        self._folder = store.parent
        self._log = (self._folder / "server.log").open("w")
        port_file = self._folder / "port"
        port_file.unlink(missing_ok=True)
        command = [
            str(BIN / "maploc-server"),
            "--store",
            str(store),
            "--listen",
            "127.0.0.1:0",
            "--port-file",
            str(port_file),
        ]
        self._process = subprocess.Popen(command, stdout=self._log, stderr=self._log)
        deadline = time.monotonic() + _START_SECONDS
        while not (port_file.exists() and port_file.read_text().endswith("\n")):
            if self._process.poll() is not None or time.monotonic() > deadline:
                self.stop()
                raise AssertionError(f"the server does not serve: {(self._folder / 'server.log').read_text()}")
            time.sleep(0.01)
        self.address = f"127.0.0.1:{port_file.read_text().strip()}"

    def stop(self) -> None:
        """Ends the process; again: nothing."""
        self._process.terminate()
        self._process.wait()
        self._log.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.stop()
