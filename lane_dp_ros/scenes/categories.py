# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""All named categories of scenes, in one table."""

from __future__ import annotations

from lane_dp_ros.scenes.category_parts import Make
from lane_dp_ros.scenes.condition_categories import CONDITION_CATEGORIES
from lane_dp_ros.scenes.distractor_categories import DISTRACTOR_CATEGORIES
from lane_dp_ros.scenes.kind_categories import KIND_CATEGORIES
from lane_dp_ros.scenes.marking_categories import MARKING_CATEGORIES
from lane_dp_ros.scenes.road_categories import ROAD_CATEGORIES

CATEGORIES: dict[str, Make] = {
    **ROAD_CATEGORIES,
    **MARKING_CATEGORIES,
    **CONDITION_CATEGORIES,
    **DISTRACTOR_CATEGORIES,
    **KIND_CATEGORIES,
}
