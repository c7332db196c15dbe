# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The thresholds that were chosen by looking at labelled frames, with what is physically plausible for each.

A name as of "lane_selection.score_min" is a parameter, one as of "lanes.selection.KERB_STEP" a constant of
the module lane_dp_ros.core.lanes.selection.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib import import_module
from typing import Any

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.parameter import parameters, replaced

CORE = "lane_dp_ros.core"

# Round numbers between what is too lax and what is too strict, five for those that decide most. The numbers
# of the steps that propose lines (extended, parallel, axis_refinement) are not among them.
THRESHOLDS: dict[str, Sequence[float]] = {
    "lane_selection.score_min": (1.0, 2.0, 3.0, 4.0, 5.0),  # m
    "lane_selection.score_alone": (2.0, 3.0, 4.0, 6.0, 8.0),  # m
    "lanes.selection.UNKNOWN_HEIGHT": (2.0, 4.0, 6.0, 8.0, 10.0),  # m
    "lane_selection.start_max": (14.0, 20.0, 26.0),  # m
    "lane_selection.contrast_min": (-0.05, 0.0, 0.05, 0.10, 0.15),
    "lanes.selection.SATURATION_CONTRAST_MIN": (0.05, 0.15, 0.25),
    "lane_selection.height_max": (0.03, 0.05, 0.08, 0.11, 0.14),  # m
    "lanes.selection.OFF_PAINT_FRACTION_MAX": (0.05, 0.10, 0.15),
    "lanes.selection.KERB_CONTRAST": (0.1, 0.2, 0.3, 0.4, 0.5),
    "lanes.selection.KERB_SATURATION_CONTRAST": (0.2, 0.3, 0.4),
    "lanes.selection.KERB_STEP": (0.06, 0.10, 0.14),  # m
    "lanes.selection.RAIL_WIDTH": (0.09, 0.11, 0.13),  # m
    "lanes.selection.KERB_WIDTH": (0.25, 0.30, 0.35),  # m
    "lanes.selection.KERB_HEIGHT": (0.02, 0.04, 0.06),  # m
    "lanes.selection.KERB_BRIGHTNESS": (-0.25, -0.10, 0.05),
    "lanes.selection.UNBROKEN": (4.0, 6.0, 8.0),  # m
    "lane_selection.paint_width_max": (0.26, 0.32, 0.38),  # m
    "lanes.selection.WIDE_BAND_RATIO_MAX": (0.7, 0.85, 1.0, 1.15, 1.3),
    "lane_selection.texture_max": (0.10, 0.15, 0.20, 0.25, 0.30),
    "lane_selection.slope_max": (0.06, 0.10, 0.15, 0.20, 0.30),
    "lanes.selection.SLOPE_PER_BEND": (0.0, 5.0, 10.0),  # m
    "lanes.selection.SAME": (0.10, 0.20, 0.30),  # m
    "lanes.selection.BESIDE": (0.5, 0.75, 1.0),  # m
    "lanes.selection.STRONG": (4.0, 7.0, 10.0),  # m
    "lanes.selection.LONG_PIECE": (6.0, 9.0, 12.0),  # m
    "lanes.selection.DASHES": (2, 3, 4),
    "lane_selection.lane_width_min": (2.0, 2.25, 2.5, 2.75, 3.0),  # m
    "lane_selection.lane_width_max": (3.75, 4.25, 4.75),  # m
    "lanes.plane_sweep.DISTINCT": (0.1, 0.2, 0.3, 0.4, 0.5),
    "lanes.variants.cut.JUNCTION": (6.0, 9.0, 12.0),  # m
    "path_search.min_score": (1.0, 1.5, 2.0, 2.5, 3.0),  # m
    "path_search.blank_cost": (0.10, 0.15, 0.20, 0.25, 0.30),
    "paint_map.contrast_min": (0.2, 0.4, 0.6, 0.8, 1.0),
    "paint_map.contrast_max": (2.0, 2.5, 3.0, 3.5, 4.0),
}


def is_constant(name: str) -> bool:
    """Return whether a threshold is a constant of a module, no parameter."""
    return name.rpartition(".")[2].isupper()


def shipped(name: str) -> float:
    """Return the default of a threshold. Raises KeyError or AttributeError where there is no such one."""
    if not is_constant(name):
        return float(parameters(DetectorConfig())[name].default)
    module, _, constant = name.rpartition(".")
    return float(getattr(import_module(f"{CORE}.{module}"), constant))


def changed(values: Mapping[str, float]) -> tuple[DetectorConfig, dict[str, Any]]:
    """Return the configuration and the names of modules to replace {dotted name: value} for thresholds.

    Raises ValueError for a parameter that there is none of, or that may not have that value.
    """
    chosen = {name: value for name, value in values.items() if not is_constant(name)}
    patches = {f"{CORE}.{name}": value for name, value in values.items() if is_constant(name)}
    return replaced(DetectorConfig(), chosen), patches
