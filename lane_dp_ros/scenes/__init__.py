# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Rendered stereo pictures of roads whose lane lines are known exactly."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from lane_dp_ros.scenes.road import Road
    from lane_dp_ros.scenes.scene import CAMERA, SIZE, ScenePair, render_pair, render_sequence

__all__ = ["CAMERA", "SIZE", "Road", "ScenePair", "render_pair", "render_sequence"]


def __getattr__(name: str) -> Any:
    # Loaded when they are asked for: the command line reads drive_options without OpenCV.
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{'road' if name == 'Road' else 'scene'}"), name)
