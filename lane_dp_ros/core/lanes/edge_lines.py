# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Lines that may be borders of the carriageway: paths through the edge map."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from lane_dp_ros.core.birdseye.birds_eye import BirdsEyeView
from lane_dp_ros.core.birdseye.edge_map import EdgeMap
from lane_dp_ros.core.lanes.candidate import LaneLine, LanePath
from lane_dp_ros.core.lanes.line_fit import MIN_ROWS, polynomial_fit
from lane_dp_ros.core.lanes.path_search import FreeEndSearch, PathSearchConfig

BLANK_COST = 0.2  # of a border that a metre without any costs: borders are long, and seldom interrupted
SEPARATION = 0.5  # m; nearer borders wait for the next pass
MIN_LENGTH = 2.0  # net metres of border
MAX_PATHS = 10


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
            )
        )

    def find(self, edges: EdgeMap, view: BirdsEyeView) -> list[LaneLine]:
        """Return lines in the view along the borders of its map, the longest first."""
        lines = (_line(path, edges, view) for path in self._search.find(edges, edges.resolution))
        return [line for line in lines if line is not None]


def _line(path: LanePath, edges: EdgeMap, view: BirdsEyeView) -> LaneLine | None:
    """Return the smooth line along a path through the edge map, in the rows of the view."""
    if len(path.rows) < MIN_ROWS:
        return None
    n, bend = polynomial_fit(edges.s[path.rows], *edges.centres(path.rows, path.columns))
    half = edges.resolution[0] / 2
    s = edges.s[path.rows]
    rows = np.flatnonzero((view.s > s[0] - half) & (view.s < s[-1] + half))[::-1]
    return LaneLine(rows, view.s[rows], np.interp(view.s[rows], s, n), bend, path.score)
