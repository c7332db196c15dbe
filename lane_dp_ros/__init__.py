# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Stereo lane detection by dynamic programming, for ROS 2 Jazzy and as a library."""

from __future__ import annotations

import re
from importlib import import_module, metadata
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from lane_dp_ros.core.config import DetectorConfig, preset
    from lane_dp_ros.core.detector import LaneDetection, LaneDetector
    from lane_dp_ros.core.geometry.camera import StereoCamera
    from lane_dp_ros.core.pipeline import LanePipeline
    from lane_dp_ros.core.types import Lane, Prior, StereoFrame

__all__ = [
    "DetectorConfig",
    "Lane",
    "LaneDetection",
    "LaneDetector",
    "LanePipeline",
    "Prior",
    "StereoCamera",
    "StereoFrame",
    "__version__",
    "preset",
]

# Loaded when they are asked for: a module of this package must not need OpenCV because the detector does.
_MODULES = {
    "DetectorConfig": "config",
    "Lane": "types",
    "LaneDetection": "detector",
    "LaneDetector": "detector",
    "LanePipeline": "pipeline",
    "Prior": "types",
    "StereoCamera": "geometry.camera",
    "StereoFrame": "types",
    "preset": "config",
}


def version() -> str:
    """Return the version of what is installed, or of the source tree that this runs in."""
    try:
        return metadata.version(__name__)
    except metadata.PackageNotFoundError:
        manifest = Path(__file__).parents[1] / "package.xml"
        found = re.search(r"<version>(.+)</version>", manifest.read_text()) if manifest.is_file() else None
        return found[1] if found else "unknown"


def __getattr__(name: str) -> Any:
    if name == "__version__":
        return version()
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.core.{_MODULES[name]}"), name)
