# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The way from the command line to what needs ROS."""

from __future__ import annotations

import importlib
from types import ModuleType

from lane_dp_ros.messages.dds_profile import use_dds_profile


def ros_module(name: str) -> ModuleType:
    """Import a module of lane_dp_ros.ros; the rest of the command line works without ROS.

    Raises ImportError where ROS is missing.
    """
    use_dds_profile()
    return importlib.import_module(f"lane_dp_ros.ros.{name}")
