# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Every parameter of the node: its own and the detector's."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from lane_dp_ros.core.config import DetectorConfig, preset
from lane_dp_ros.core.parameter import Parameter, Parameters, Value, parameter, parameters, replaced

# Names of before, which are taken for one release.
RENAMED = {
    "lane_graph.feature": "paint_map.feature",
    "lane_graph.edge_weight": "paint_map.edge_weight",
    "lane_graph.contrast_min": "paint_map.contrast_min",
    "lane_graph.contrast_max": "paint_map.contrast_max",
    "tracking.bridge_time": "tracking.coast_time",
    "lane_selection.lane_width_min": "parallel.lane_width_min",
    "lane_selection.lane_width_max": "parallel.lane_width_max",
}
SMALLER = "disparity.correlation_window_size and speckle_size count larger pixels now, leave them out, too"
# Parameters of before, which a file may still hold for one release, and what is there in their place.
JUDGED = "lane_selection.evidence_model judges lines, lane_selection.confidence_min says how sure it must be"
REMOVED = {
    **dict.fromkeys(
        (
            "lane_selection.contrast_min",
            "lane_selection.roughness_max",
            "lane_selection.score_alone",
            "lane_selection.score_min",
            "lane_selection.slope_max",
            "lane_selection.start_max",
            "lane_selection.texture_max",
        ),
        JUDGED,
    ),
    "disparity.disparity_range": f"it follows from the camera's height and the image; {SMALLER}",
    "disparity.downscale": f"it follows from the camera's height and the image; {SMALLER}",
    "road_profile.roll": "the cross slope is always measured, but by road_profile.model quadratic",
    "road_profile.residual_threshold": "it follows from what the matcher resolves",
}
EVERY_NODE = ("use_sim_time", "start_type_description_service")  # ROS gives these to every node


@dataclass(frozen=True)
class NodeConfig(Parameters):
    """What the node itself needs to know."""

    image_transport: str = parameter(
        "raw",
        "raw: left/image_rect and right/image_rect; compressed: left/image_rect/compressed and so on.",
        choices=("raw", "compressed"),
    )
    sync_tolerance: float = parameter(
        0.01, "Left and right are a pair when their stamps differ by no more.", unit="s", limits=(0.0, 0.5)
    )
    lane_lifetime: float = parameter(
        0.5, "A viewer removes lanes that were not renewed for so long.", unit="s", limits=(0.05, 10.0)
    )


def all_parameters(preset_name: str = "default", expert: bool = False) -> dict[str, Parameter]:
    """Return every parameter of the node by its ROS name; defaults are the preset's values.

    Those for experts, which a file may set but nobody is shown, only if `expert`.

    Raises ValueError for an unknown preset.
    """
    return {**parameters(NodeConfig(), expert), **parameters(preset(preset_name), expert)}


def with_current_names(values: Mapping[str, Any]) -> tuple[dict[str, Any], list[str]]:
    """Return values by the parameters' names of today, and a line for each old name.

    Of a value that came under both names the one under today's name is taken; those of parameters that are
    no more are left out.
    """
    removed = [f"{name} is no more, left out: {REMOVED[name]}" for name in values if name in REMOVED]
    values = {name: value for name, value in values.items() if name not in REMOVED}
    current = {name: value for name, value in values.items() if current_name(name) == name}
    old = {name: value for name, value in values.items() if current_name(name) != name}
    for name, value in old.items():
        current.setdefault(current_name(name), value)
    return current, [*(f"{name} is {current_name(name)} now, take that name" for name in old), *removed]


def current_name(name: str) -> str:
    """Return what a parameter is called today."""
    return RENAMED.get(name, name)


def is_of_ros(name: str) -> bool:
    """Return whether a parameter is one that ROS itself gives to nodes, not one of ours."""
    return name in EVERY_NODE or name.startswith("qos_overrides.")


def configs(values: Mapping[str, Value]) -> tuple[NodeConfig, DetectorConfig]:
    """Return the configs that hold `values` (by ROS name) and, for the rest, the defaults.

    Raises ValueError for an unknown name, a value out of range, or values that do not go together.
    """
    own = parameters(NodeConfig())
    return (
        replaced(NodeConfig(), {name: value for name, value in values.items() if name in own}),
        replaced(DetectorConfig(), {name: value for name, value in values.items() if name not in own}),
    )
