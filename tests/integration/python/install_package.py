#!/usr/bin/env python3
"""Builds the wheel of client/python and installs it into a fresh venv over Debian's packages, without network.

usage: install_package.py SOURCE_DIR VENV_DIR
"""

import pathlib
import subprocess
import sys
import venv


def main() -> None:
    """Fails where the package cannot be installed, or leaves something in the source tree."""
    package, folder = pathlib.Path(sys.argv[1]) / "client" / "python", pathlib.Path(sys.argv[2])
    before = sorted(package.rglob("*"))
    venv.create(folder, system_site_packages=True, clear=True, with_pip=True)
    pip = [str(folder / "bin" / "python"), "-m", "pip", "--no-input", "--disable-pip-version-check"]
    subprocess.run(
        [*pip, "wheel", "--no-index", "--no-deps", "--wheel-dir", str(folder / "wheels"), str(package)], check=True
    )
    (wheel,) = (folder / "wheels").iterdir()
    subprocess.run([*pip, "install", "--no-index", str(wheel)], check=True)
    if sorted(package.rglob("*")) != before:
        sys.exit(f"building the wheel changed {package}")


if __name__ == "__main__":
    main()
