"""Builds the wheel (PEP 517) with the standard library and protoc alone, so that pip needs no network.

It generates the messages and stubs of ../../proto into the wheel, and writes nothing into the source tree.
"""

import base64
import hashlib
import pathlib
import re
import shutil
import subprocess
import tempfile
import tomllib
import zipfile
from typing import Any

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
GENERATORS = ("protoc", "grpc_python_plugin")
TAG = "py3-none-any"
EPOCH = (1980, 1, 1, 0, 0, 0)  # the same sources give the same bytes


def build_wheel(wheel_directory: str, config_settings: Any = None, metadata_directory: Any = None) -> str:
    """Writes the wheel into `wheel_directory` and returns its file name."""
    project = tomllib.loads((HERE / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    stem = f"{project['name']}-{_version()}"
    files = _package_files() | _generated_files()
    files[f"{stem}.dist-info/METADATA"] = _metadata(project).encode()
    files[
        f"{stem}.dist-info/WHEEL"
    ] = f"Wheel-Version: 1.0\nGenerator: maploc\nRoot-Is-Purelib: true\nTag: {TAG}\n".encode()
    files[f"{stem}.dist-info/licenses/LICENSE"] = (ROOT / "LICENSE").read_bytes()
    record = f"{stem}.dist-info/RECORD"
    files[record] = (_record(files) + f"{record},,\n").encode()
    name = f"{stem}-{TAG}.whl"
    with zipfile.ZipFile(pathlib.Path(wheel_directory) / name, "w", zipfile.ZIP_DEFLATED) as wheel:
        for path, content in files.items():
            wheel.writestr(zipfile.ZipInfo(path, EPOCH), content, zipfile.ZIP_DEFLATED)
    return name


def build_sdist(sdist_directory: str, config_settings: Any = None) -> str:
    """There is none: the package is built beside the proto files that it is generated from."""
    raise RuntimeError("maploc has no source distribution; build a wheel in a checkout: pip wheel client/python")


def _version() -> str:
    match = re.search(r"project\(maploc VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text(encoding="utf-8"))
    if match is None:
        raise RuntimeError(f"{ROOT / 'CMakeLists.txt'} names no version of maploc")
    return match.group(1)


def _package_files() -> dict[str, bytes]:
    paths = sorted((HERE / "maploc").glob("*.py")) + [HERE / "maploc" / "py.typed"]
    return {f"maploc/{path.name}": path.read_bytes() for path in paths}


def _generated_files() -> dict[str, bytes]:
    missing = [tool for tool in GENERATORS if shutil.which(tool) is None]
    if missing:
        raise RuntimeError(
            f"{' and '.join(missing)} not found; apt-get install protobuf-compiler protobuf-compiler-grpc"
        )
    with tempfile.TemporaryDirectory() as folder:
        protos = sorted((ROOT / "proto" / "maploc" / "v1").glob("*.proto"))
        command = [
            "protoc",
            f"-I{ROOT / 'proto'}",
            f"--python_out={folder}",
            f"--pyi_out={folder}",
            f"--grpc_out={folder}",
        ]
        command += [f"--plugin=protoc-gen-grpc={shutil.which('grpc_python_plugin')}", *map(str, protos)]
        subprocess.run(command, check=True)
        generated = pathlib.Path(folder)
        files = {path.relative_to(generated).as_posix(): path.read_bytes() for path in sorted(generated.rglob("*.py*"))}
    return {"maploc/v1/__init__.py": b""} | files


def _metadata(project: dict[str, Any]) -> str:
    lines = ["Metadata-Version: 2.1", f"Name: {project['name']}", f"Version: {_version()}"]
    lines += [f"Summary: {project['description']}", f"License: {project['license']['text']}"]
    lines += [f"Requires-Python: {project['requires-python']}"]
    lines += [f"Requires-Dist: {requirement}" for requirement in project["dependencies"]]
    lines += ["Description-Content-Type: text/markdown", ""]
    return "\n".join(lines) + "\n" + (HERE / str(project["readme"])).read_text(encoding="utf-8")


def _record(files: dict[str, bytes]) -> str:
    def row(path: str, content: bytes) -> str:
        digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
        return f"{path},sha256={digest},{len(content)}\n"

    return "".join(row(path, content) for path, content in files.items())
