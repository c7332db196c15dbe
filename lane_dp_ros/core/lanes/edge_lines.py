# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Lines that may be borders of the carriageway: paths through the edge map."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from lane_dp_ros.core.birdseye.birds_eye import BirdsEyeView
from lane_dp_ros.core.birdseye.edge_map import EdgeMap
from lane_dp_ros.core.lanes.candidate import LaneLine
from lane_dp_ros.core.lanes.line_fit import cubic_lines
from lane_dp_ros.core.lanes.path_search import FreeEndSearch, PathSearchConfig

BLANK_COST = 0.2  # of a border that a metre without any costs: borders are long, and seldom interrupted
SEPARATION = 0.5  # m; of borders that are nearer the longest is taken
MIN_LENGTH = 2.0  # net metres of border
MAX_PATHS = 10
PASSES = 1  # a second search, for lines close beside those found, finds false borders


class EdgeLineSearch:
    """Proposes lines along borders; as the paint's paths they have free ends."""

    def __init__(self, config: PathSearchConfig) -> None:
        self._search = FreeEndSearch(
            replace(
                config,
                blank_cost=BLANK_COST,
                separation_min=SEPARATION,
                min_score=MIN_LENGTH,
                max_paths=MAX_PATHS,
                passes=PASSES,
            )
        )

    def find(self, edges: EdgeMap, view: BirdsEyeView) -> list[LaneLine]:
        """Return lines in the view along the borders of its map, the longest first."""
        paths = self._search.find(edges, edges.resolution)
        half = edges.resolution[0] / 2
        return [_in_rows_of(view, line, half) for line in cubic_lines(paths, edges.s, edges.centres)]


def _in_rows_of(view: BirdsEyeView, line: LaneLine, half: float) -> LaneLine:
    """Return a line through cells of the edge map, `half` [m] of a cell longer, in the rows of the view."""
    rows = np.flatnonzero((view.s > line.s[0] - half) & (view.s < line.s[-1] + half))[::-1]
    s = view.s[rows]
    return LaneLine(rows, s, np.interp(s, line.s, line.n), line.bend, line.score)
