# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The nearer half of a line that leads astray: behind a crest, into light, onto the paint of another line."""

from __future__ import annotations

import numpy as np

from lane_dp_ros.core.lanes.evidence import feature_along
from lane_dp_ros.core.lanes.line_fit import MIN_ROWS, polynomial_fit
from lane_dp_ros.core.types import BirdsEyeView, LaneLine, PaintMap


def near_half(line: LaneLine, view: BirdsEyeView, graph: PaintMap, blank_cost: float) -> LaneLine | None:
    """Return the nearer half of a line, fitted to its own paint; None where there is too little to be fitted.

    It ends where its score is highest: its metres of paint, less `blank_cost` a metre of road that is seen.
    """
    half = slice(len(line.rows) // 2)
    rows, s = line.rows[half], line.s[half]
    centre, weight = view.paint_centres(graph, rows, view.columns(line.n[half]))
    if np.count_nonzero(weight) < MIN_ROWS:
        return None
    n, bend = polynomial_fit(s, centre, weight)
    column = view.nearest_columns(n)
    gain = np.where(graph.seen[rows, column], feature_along(rows, column, view, graph) - blank_cost, 0)
    score = np.cumsum(gain) * view.resolution[0]
    end = int(score.argmax()) + 1
    return LaneLine(rows[:end], s[:end], n[:end], bend, float(score[end - 1])) if end >= MIN_ROWS else None
