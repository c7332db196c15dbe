# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The presets by name, and what the paper's differs in. Needs no library, for the command line's sake."""

from __future__ import annotations

from lane_dp_ros.core.parameter import Value

PRESETS = ("default", "paper")

PAPER: dict[str, Value] = {
    "road_profile.model": "quadratic",
    "vanishing_point.method": "dense",
    "vanishing_point.centred_principal_point": True,
    "birds_eye.near": 0.0,
    "birds_eye.width": 12.0,
    "birds_eye.forward_resolution": 1 / 15,
    "paint_map.feature": "edges_and_grey",
    "path_search.free_ends": False,
    "path_search.suppression": 1.0,
    "lane_model.model": "parabola",
    "lane_model.residual_threshold": 5**0.5 * 0.05,  # t_r = 5 px^2 at 20 px/m
    "lane_selection.evidence": False,
    "tracking.enabled": False,
}
