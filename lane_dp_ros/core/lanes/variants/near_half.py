# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The nearer half of a line that leads astray: behind a crest, into light, onto the paint of another line."""

from __future__ import annotations

import numpy as np

from lane_dp_ros.core.birdseye.paint_profile import PaintProfile, paint_gain
from lane_dp_ros.core.lanes.candidate import LaneLine
from lane_dp_ros.core.lanes.line_fit import MIN_ROWS, polynomial_fit

STEEP = 0.15  # lateral over forward
PAST_PAINT = 0.1  # share of its paint that a line passes beside


def leads_astray(slope: float, off_paint_fraction: float) -> bool:
    """Return whether a line is so steep, or so often beside its paint, that its nearer half may be better."""
    return slope > STEEP or off_paint_fraction > PAST_PAINT


def near_half(line: LaneLine, paint: PaintProfile, blank_cost: float) -> LaneLine | None:
    """Return the nearer half of a line, fitted to its own paint; None where there is too little to be fitted.

    It ends where its score is highest: its metres of paint, less `blank_cost` a metre of road that is seen.
    """
    view, half = paint.view, slice(len(line.rows) // 2)
    rows, s = line.rows[half], line.s[half]
    centre, weight = paint.centres(rows, view.columns(line.n[half]))
    if np.count_nonzero(weight) < MIN_ROWS:
        return None
    n, bend = polynomial_fit(s, centre, weight)
    column = view.nearest_columns(n)
    gain = np.where(
        paint.paint_map.seen[rows, column], paint_gain(paint.feature(rows, column), blank_cost), 0
    )
    score = np.cumsum(gain) * view.resolution[0]
    end = int(score.argmax()) + 1
    return LaneLine(rows[:end], s[:end], n[:end], bend, float(score[end - 1])) if end >= MIN_ROWS else None
