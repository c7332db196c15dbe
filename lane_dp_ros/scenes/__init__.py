# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Rendered stereo pictures of roads whose lane lines are known exactly."""

from lane_dp_ros.scenes.road import Road
from lane_dp_ros.scenes.scene import CAMERA, SIZE, ScenePair, render_pair, render_sequence

__all__ = ["CAMERA", "SIZE", "Road", "ScenePair", "render_pair", "render_sequence"]
