# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Stereo lane detection by dynamic programming, for ROS 2 Jazzy and as a library."""

from __future__ import annotations

from importlib import import_module
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


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.core.{_MODULES[name]}"), name)
