# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The thresholds that were chosen by looking at labelled frames, and what is plausible for each."""

from __future__ import annotations

from collections.abc import Sequence

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.parameter import parameters

# Round numbers between what is too lax and what is too strict, five for those that decide most. The numbers
# of the steps that propose lines (extended, parallel, axis_refinement) are not among them.
THRESHOLDS: dict[str, Sequence[float]] = {
    "lane_selection.score_min": (1.0, 2.0, 3.0, 4.0, 5.0),  # m
    "lane_selection.score_alone": (2.0, 3.0, 4.0, 6.0, 8.0),  # m
    "lane_selection.score_unknown_height": (2.0, 4.0, 6.0, 8.0, 10.0),  # m
    "lane_selection.start_max": (14.0, 20.0, 26.0),  # m
    "lane_selection.contrast_min": (-0.05, 0.0, 0.05, 0.10, 0.15),
    "lane_selection.saturation_contrast_min": (0.05, 0.15, 0.25),
    "lane_selection.height_max": (0.03, 0.05, 0.08, 0.11, 0.14),  # m
    "lane_selection.off_paint_fraction_max": (0.05, 0.10, 0.15),
    "lane_selection.kerb_contrast_max": (0.1, 0.2, 0.3, 0.4, 0.5),
    "lane_selection.kerb_saturation_contrast_max": (0.2, 0.3, 0.4),
    "lane_selection.kerb_step_min": (0.06, 0.10, 0.14),  # m
    "lane_selection.rail_width_max": (0.09, 0.11, 0.13),  # m
    "lane_selection.kerb_width_min": (0.25, 0.30, 0.35),  # m
    "lane_selection.kerb_height_min": (0.02, 0.04, 0.06),  # m
    "lane_selection.kerb_brightness_max": (-0.25, -0.10, 0.05),
    "lane_selection.unbroken_min": (4.0, 6.0, 8.0),  # m
    "lane_selection.paint_width_max": (0.26, 0.32, 0.38),  # m
    "lane_selection.wide_band_ratio_max": (0.7, 0.85, 1.0, 1.15, 1.3),
    "lane_selection.texture_max": (0.10, 0.15, 0.20, 0.25, 0.30),
    "lane_selection.slope_max": (0.06, 0.10, 0.15, 0.20, 0.30),
    "lane_selection.slope_per_bend": (0.0, 5.0, 10.0),  # m
    "lane_selection.same_line": (0.10, 0.20, 0.30),  # m
    "lane_selection.double_line": (0.5, 0.75, 1.0),  # m
    "lane_selection.strong_score": (4.0, 7.0, 10.0),  # m
    "lane_selection.strong_segment": (6.0, 9.0, 12.0),  # m
    "lane_selection.strong_dashes": (2, 3, 4),
    "lane_selection.lane_width_min": (2.0, 2.25, 2.5, 2.75, 3.0),  # m
    "lane_selection.lane_width_max": (3.75, 4.25, 4.75),  # m
    "plane_sweep.distinctness_min": (0.1, 0.2, 0.3, 0.4, 0.5),
    "stop_line.unpainted_min": (6.0, 9.0, 12.0),  # m
    "path_search.min_score": (1.0, 1.5, 2.0, 2.5, 3.0),  # m
    "path_search.blank_cost": (0.10, 0.15, 0.20, 0.25, 0.30),
    "paint_map.contrast_min": (0.2, 0.4, 0.6, 0.8, 1.0),
    "paint_map.contrast_max": (2.0, 2.5, 3.0, 3.5, 4.0),
}


def shipped(name: str) -> float:
    """Return the default of a threshold. Raises KeyError where there is no such parameter."""
    default = parameters(DetectorConfig())[name].default
    assert isinstance(default, (int, float))
    return default
