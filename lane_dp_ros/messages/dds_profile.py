# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Where the Fast DDS profile for big images lies. Imports no ROS: it must be set before ROS is loaded."""

from __future__ import annotations

import os
import sys
from pathlib import Path

VARIABLE = "FASTRTPS_DEFAULT_PROFILES_FILE"
PROFILE = Path("config/fastdds_big_images.xml")


def use_dds_profile() -> None:
    """Set the profile for this process and its children, unless the user has set one.

    By default, Fast DDS drops many camera images between processes.
    """
    path = find_dds_profile()
    if path is not None and not os.environ.get(VARIABLE):
        os.environ[VARIABLE] = str(path)


def find_dds_profile() -> Path | None:
    """Return its path: installed by colcon or pip, or beside the source tree."""
    return next((folder / PROFILE for folder in _folders() if (folder / PROFILE).is_file()), None)


def _folders() -> list[Path]:
    folders = [Path(__file__).resolve().parents[2], Path(sys.prefix) / "share/lane_dp_ros"]
    try:
        from ament_index_python.packages import get_package_share_directory  # there is none without ROS

        return [Path(get_package_share_directory("lane_dp_ros")), *folders]
    except (ModuleNotFoundError, LookupError, OSError):  # no ament, not installed by it, or none sourced
        return folders
