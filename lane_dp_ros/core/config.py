# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The configuration of the lane pipeline, one part a stage that stands beside its stage."""

from __future__ import annotations

from dataclasses import dataclass, field

from lane_dp_ros.core.birdseye.birds_eye import BirdsEyeConfig
from lane_dp_ros.core.birdseye.paint_map import PaintMapConfig
from lane_dp_ros.core.lanes.axis_refinement import AxisRefinementConfig
from lane_dp_ros.core.lanes.line_fit import LaneModelConfig
from lane_dp_ros.core.lanes.path_search import PathSearchConfig
from lane_dp_ros.core.lanes.selection import LaneSelectionConfig
from lane_dp_ros.core.lanes.variants.extension import ExtensionConfig
from lane_dp_ros.core.lanes.variants.parallel import ParallelConfig
from lane_dp_ros.core.lanes.variants.stop_line import StopLineConfig
from lane_dp_ros.core.parameter import Parameters, parameter, replaced
from lane_dp_ros.core.presets import PAPER, PRESETS
from lane_dp_ros.core.road.disparity import DisparityConfig
from lane_dp_ros.core.road.road_profile import RoadProfileConfig
from lane_dp_ros.core.road.vanishing_point import VanishingPointConfig
from lane_dp_ros.core.tracking.tracker import TrackingConfig


@dataclass(frozen=True)
class DetectorConfig(Parameters):
    """All stages of the lane pipeline."""

    disparity: DisparityConfig = field(default_factory=DisparityConfig)
    road_profile: RoadProfileConfig = field(default_factory=RoadProfileConfig)
    vanishing_point: VanishingPointConfig = field(default_factory=VanishingPointConfig)
    birds_eye: BirdsEyeConfig = field(default_factory=BirdsEyeConfig)
    paint_map: PaintMapConfig = field(default_factory=PaintMapConfig)
    path_search: PathSearchConfig = field(default_factory=PathSearchConfig)
    lane_model: LaneModelConfig = field(default_factory=LaneModelConfig)
    lane_selection: LaneSelectionConfig = field(default_factory=LaneSelectionConfig)
    extension: ExtensionConfig = field(default_factory=ExtensionConfig)
    parallel: ParallelConfig = field(default_factory=ParallelConfig)
    stop_line: StopLineConfig = field(default_factory=StopLineConfig)
    axis_refinement: AxisRefinementConfig = field(default_factory=AxisRefinementConfig)
    tracking: TrackingConfig = field(default_factory=TrackingConfig)
    seed: int = parameter(0, "Seed of the random samples: same frame, same lanes.", limits=(0, 2**31 - 1))


def preset(name: str) -> DetectorConfig:
    """Return the configuration of that name: "default", or "paper" (the paper's numbers and formulas).

    Raises ValueError for another name.
    """
    if name not in PRESETS:
        raise ValueError(f"preset {name!r}: expected one of {', '.join(PRESETS)}")
    return replaced(DetectorConfig(), PAPER if name == "paper" else {})
