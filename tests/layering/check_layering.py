#!/usr/bin/env python3
"""Checks the layering rules (README.md beside this file) in every source file. Prints each violation as file:line.

usage: check_layering.py SOURCE_DIR
"""

import pathlib
import re
import sys

# A folder may include itself, the folders listed for it here, and what these may include.
MAY_INCLUDE = {
    "mapstore/base": [],
    "mapstore/geometry": ["mapstore/base"],
    "mapstore/model": ["mapstore/geometry"],
    "mapstore/descriptors": ["mapstore/model"],
    "mapstore/features": ["mapstore/model"],
    "mapstore/formats": ["mapstore/model"],
    "mapstore/statistics": ["mapstore/model"],
    "mapstore/store": ["mapstore/descriptors", "mapstore/features", "mapstore/formats", "mapstore/statistics"],
    "mapstore/importers": ["mapstore/store"],
    "mapstore/tools": ["mapstore/importers"],
    "proto/convert": ["mapstore/model"],
    "proto/recording": ["proto/convert"],
    "server/solvers": ["mapstore/model"],
    "server/ransac": ["server/solvers"],
    "server/refinement": ["server/solvers"],
    "server/trust": ["server/ransac", "server/refinement"],
    "server/matching": ["mapstore/descriptors"],
    "server/retrieval": ["mapstore/descriptors"],
    "server/pipeline": ["server/trust", "server/matching", "server/retrieval"],
    "server/sessions": ["server/pipeline", "mapstore/store"],
    "server/access": ["mapstore/store"],
    "server/recorder": ["proto/recording"],
    "server/service": ["server/access", "server/pipeline", "server/recorder", "server/sessions", "proto/convert"],
    "server/app": ["server/service"],
    "server/compare": ["server/sessions", "proto/recording", "mapstore/tools"],
    "client/api": ["proto/convert", "mapstore/model"],
    "client/odometry": ["mapstore/model"],
    "client/robot": ["client/api", "mapstore/features", "mapstore/formats"],
    "client/cli": ["client/robot", "proto/recording"],
}

# Third-party headers and the only files that may include them (regular expressions for the include and for the file).
CONFINED = [
    (r"sqlite3\.h", r"mapstore/(store|formats)/sqlite_[^/]*$|tests/"),
    (r"grpc(pp|\+\+)?/.*|.*\.grpc\.pb\.h", r"(server/service|server/app|client/api|tests)/"),
    (r"maploc/v1/.*\.pb\.h", r"(server/service|server/app|client/api|proto/convert|tests)/"),
    (r"maploc/recording/v1/.*\.pb\.h", r"(server/(service|recorder)|proto/recording|tests)/"),
    (r"zlib\.h", r"proto/recording/crc_frame\.cc$|tests/"),
    (r"ceres/.*", r"(server/refinement|tests)/|mapstore/importers/[^/]*triangulat[^/]*$"),
    (r"openssl/.*", r"server/app/tls_material\.cc$|server/access/token\.cc$|tests/"),
    (r"opencv2/.*", r"(mapstore/features|client|tests)/"),
]

# The same for the modules that the Python package imports.
CONFINED_MODULES = [
    (r"grpc(\..*)?", r"client/python/maploc/channel\.py$|tests/"),
    (r"maploc\.v1(\..*)?", r"client/python/maploc/(client|wire)\.py$|tests/"),
    (r"cv2(\..*)?", r"client/python/maploc/(camera_files|features|photo)\.py$|client/python/examples/|tests/"),
]

OWN = re.compile(r"^(proto|mapstore|server|client|tests)/")
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]')
PYTHON_IMPORT = re.compile(r"^\s*(?:import|from)\s+([\w.]+)")
MAX_LINES = 400


def reachable(folder):
    seen, stack = set(), [folder]
    while stack:
        here = stack.pop()
        if here not in seen:
            seen.add(here)
            stack.extend(MAY_INCLUDE.get(here, []))
    return seen


def check_include(name, folder, included):
    if OWN.match(included):
        target = "/".join(included.split("/")[:2])
        if folder in MAY_INCLUDE and target not in reachable(folder):
            yield f"{folder} may not include {target}"
        if folder not in MAY_INCLUDE and not name.startswith("tests/"):
            yield f"{folder} is not a known folder; add it to check_layering.py"
    for header, allowed in CONFINED:
        if re.fullmatch(header, included) and not re.search(allowed, name):
            yield f"{included} may be included only in {allowed}"


def check_import(name, module):
    for confined, allowed in CONFINED_MODULES:
        if re.fullmatch(confined, module) and not re.search(allowed, name):
            yield f"{module} may be imported only in {allowed}"


def check_line(name, line):
    if name.endswith(".py"):
        match = PYTHON_IMPORT.match(line)
        return check_import(name, match.group(1)) if match else ()
    match = INCLUDE.match(line)
    return check_include(name, "/".join(name.split("/")[:2]), match.group(1)) if match else ()


def check_file(root, path):
    name = path.relative_to(root).as_posix()
    lines = path.read_text(encoding="utf-8").splitlines()
    for number, line in enumerate(lines, 1):
        for breach in check_line(name, line):
            yield f"{name}:{number}: {breach}"
    if len(lines) > MAX_LINES:
        yield f"{name}: {len(lines)} lines, more than {MAX_LINES}; split the file"


def check_readmes(root):
    for folder in [*MAY_INCLUDE, "client/python"]:
        if not (root / folder / "README.md").exists():
            yield f"{folder}: has no README.md"


def main():
    root = pathlib.Path(sys.argv[1])
    files = [p for top in ("proto", "mapstore", "server", "client", "tests") for p in sorted((root / top).rglob("*"))
             if p.suffix in (".h", ".cc", ".py")]
    breaches = [b for path in files for b in check_file(root, path)] + list(check_readmes(root))
    print("\n".join(breaches) if breaches else f"{len(files)} files keep the layering.")
    return 1 if breaches or not files else 0


if __name__ == "__main__":
    sys.exit(main())
