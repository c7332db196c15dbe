# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""How to get a library that is not installed, here: by pip in a venv, by apt or by pip outside of one."""

from __future__ import annotations

import os
import re
import shutil
import sys
import sysconfig
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path

from lane_dp_ros.messages.errors import one_line

NAME = "lane_dp_ros"
ROS_ROOT = Path("/opt/ros")
SOURCE_TREE = "'.[ros]', in the source tree"
OF_ROS = re.compile(r"rcl\w+|ament\w+|rosidl\w+|\w+_(msgs|interfaces)")


@dataclass(frozen=True)
class Library:
    """A library that is imported: what it is for, and its name at PyPI and among apt's packages (or "")."""

    use: str
    pip: str
    apt: str = ""


LIBRARIES = {
    "cv2": Library("OpenCV, for all pictures", "opencv-python-headless", "python3-opencv"),
    "PIL": Library("Pillow, for Rerun's pictures", "pillow", "python3-pil"),
    "numpy": Library("numpy, for everything", "numpy", "python3-numpy"),
    "pyarrow": Library("pyarrow, for tables of Parquet", "pyarrow"),
    "rerun": Library("Rerun's SDK, for its recordings", "rerun-sdk"),
    "rosbags": Library("rosbags, to read and write bags", "rosbags"),
    "scipy": Library("scipy, for fits", "scipy", "python3-scipy"),
    "tqdm": Library("tqdm, for the progress bar", "tqdm", "python3-tqdm"),
    "yaml": Library("PyYAML, to read parameter files", "pyyaml", "python3-yaml"),
}


def missing_library(error: ImportError) -> str:
    """Return one line that names what could not be imported and the command that brings it here."""
    name = (error.name or "").partition(".")[0]
    if not isinstance(error, ModuleNotFoundError):
        return f"{name or 'a library'} is installed but cannot be loaded: {one_line(error)}"
    if OF_ROS.fullmatch(name):
        return f"needs ROS 2 ({one_line(error)}): {_ros_command()}"
    library = LIBRARIES.get(name, Library(name, name))
    return f"needs {library.use}: {_command(library)}"


def _command(library: Library) -> str:
    if library.apt and not _in_venv() and shutil.which("apt-get"):
        return f"sudo apt install {library.apt}"
    return f"{_pip_install()} {library.pip}"


def _ros_command() -> str:
    """Return how ROS comes into reach: that of this machine, else the wheels that setup.py pins."""
    installed = sorted(ROS_ROOT.glob("*/setup.bash"))
    if installed and not os.environ.get("ROS_DISTRO"):
        return f"source {installed[-1]}"
    return f"{_pip_install()} {' '.join(_wheels_of_ros()) or SOURCE_TREE}"


def _wheels_of_ros() -> list[str]:
    try:
        required = metadata.requires(NAME) or []
    except metadata.PackageNotFoundError:
        return []
    return [f"'{text.partition(';')[0].strip()}'" for text in required if text.startswith("ros-")]


def _pip_install() -> str:
    """Return the command that installs for this interpreter, also where Debian says that it must not."""
    marker = Path(sysconfig.get_path("stdlib"), "EXTERNALLY-MANAGED")
    managed = not _in_venv() and marker.exists()
    return f"{sys.executable} -m pip install{' --user --break-system-packages' if managed else ''}"


def _in_venv() -> bool:
    return sys.prefix != sys.base_prefix
