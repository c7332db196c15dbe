# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Lines end at a stop line: what is painted beyond the junction are other lines."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.birdseye.paint_profile import runs_of
from lane_dp_ros.core.lanes.line_fit import MIN_ROWS
from lane_dp_ros.core.lanes.variants.extended import DASH_MIN, PAINTED
from lane_dp_ros.core.types import BirdsEyeView, LaneLine, PaintMap

JUNCTION = 9.0  # m without paint behind a stop line; less is a crossing of rails or for pedestrians
ASIDE = (0.4, 1.4)  # m to one side of the line; a stop line goes on there
BARE = 0.75  # m; so far before and behind the middle of a stop line the road is bare
BRIGHT = 0.5  # of what the line itself is brighter than the road
END = 1.0  # m; no farther from the middle of the stop line the paint ends
LEVEL = 0.5  # share of its cells; more do not stand above the road


def end_at_stop_line(line: LaneLine, view: BirdsEyeView, graph: PaintMap, blank_cost: float) -> LaneLine:
    """Return the line as far as the stop line of the first junction that it crosses, if it crosses one.

    What is left of it scores its metres of paint, less `blank_cost` a metre.
    """
    per_row = view.resolution[0]
    painted = view.paint_centres(graph, line.rows, view.columns(line.n))[1] > PAINTED
    dashes = runs_of(painted)
    dashes = dashes[np.diff(dashes)[:, 0] * per_row >= DASH_MIN]
    gaps = [(end, start) for (_, end), (start, _) in pairwise(dashes) if (start - end) * per_row >= JUNCTION]
    if not gaps:
        return line
    bars = _bars(line, painted, view)
    for end, _ in gaps:
        if end >= MIN_ROWS and bars[end - 1 : end + round(END / per_row)].any():
            score = float((painted[:end] - blank_cost).sum() * per_row)
            return LaneLine(line.rows[:end], line.s[:end], line.n[:end], line.bend, score)
    return line


def _bars(line: LaneLine, painted: NDArray[np.bool_], view: BirdsEyeView) -> NDArray[np.bool_]:
    """Return the rows (N,) of a line beside which a bar as bright as the line runs across the road."""
    per_row, per_column = view.resolution
    centre = view.nearest_columns(line.n)
    first, last = (round(d / per_column) for d in ASIDE)
    sides = np.array([-1, 1])[:, None, None] * np.arange(first, last + 1)
    columns = np.clip(centre[:, None] + sides, 0, len(view.n) - 1)
    rows = line.rows[:, None]
    beside = view.image[rows, columns].mean(axis=2)
    grey = view.image[line.rows, centre]
    own = np.median((grey - beside)[:, painted], axis=1).max()
    bare = round(BARE / per_row)
    around = np.pad(beside, [(0, 0), (bare, bare)], constant_values=np.inf)
    rise = beside - np.maximum(around[:, : beside.shape[1]], around[:, 2 * bare :])
    bars = (own > 0) & (rise > BRIGHT * own) & (view.on_road[rows, columns].mean(axis=2) > LEVEL)
    return np.asarray(bars.any(axis=0))
