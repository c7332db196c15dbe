# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Lines end at a stop line: what is painted beyond the junction is another line."""

from __future__ import annotations

from itertools import chain, pairwise

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.data import BirdsEyeView, LaneGraph, LaneLine
from lane_dp_ros.core.line_extension import DASH_MIN, PAINTED
from lane_dp_ros.core.runs import runs_of

JUNCTION = 9.0  # m without paint behind a stop line; less is a crossing of rails or for pedestrians
ASIDE = (0.4, 1.4)  # m to one side of the line; a stop line goes on there
BARE = 0.75  # m; so far before and behind the middle of a stop line the road is bare
BRIGHT = 0.5  # of what the line itself is brighter than the road
END = 1.0  # m; no farther from the middle of the stop line the paint ends


def end_at_stop_lines(
    line: LaneLine, view: BirdsEyeView, graph: LaneGraph, blank_cost: float
) -> list[LaneLine]:
    """Return the pieces of a line before and behind junctions that begin at a stop line, else the line.

    A piece scores its metres of paint, less `blank_cost` a metre.
    """
    per_row, per_column = view.resolution
    painted = view.paint_centres(graph, line.rows, (line.n - view.n[0]) / per_column)[1] > PAINTED
    dashes = runs_of(painted)
    dashes = dashes[np.diff(dashes)[:, 0] * per_row >= DASH_MIN]
    gaps = [(end, start) for (_, end), (start, _) in pairwise(dashes) if (start - end) * per_row >= JUNCTION]
    if not gaps:
        return [line]
    bars = _bars(line, painted, view)
    ended = [gap for gap in gaps if bars[gap[0] - 1 : gap[0] + round(END / per_row)].any()]
    edges = [0, *chain.from_iterable(ended), len(painted)]
    pieces = [slice(*edges[i : i + 2]) for i in range(0, len(edges), 2)] if ended else []
    return [_piece(line, rows, painted, per_row, blank_cost) for rows in pieces] or [line]


def _piece(
    line: LaneLine, rows: slice, painted: NDArray[np.bool_], per_row: float, blank_cost: float
) -> LaneLine:
    """Return some rows of a line; they score their metres of paint, less what being blank costs."""
    score = float((painted[rows] - blank_cost).sum() * per_row)
    return LaneLine(line.rows[rows], line.s[rows], line.n[rows], line.bend, score)


def _bars(line: LaneLine, painted: NDArray[np.bool_], view: BirdsEyeView) -> NDArray[np.bool_]:
    """Return the rows (N,) of a line where a bar runs across the road on one side of it."""
    per_row, per_column = view.resolution
    centre = np.rint((line.n - view.n[0]) / per_column).astype(int)
    grey = view.image[line.rows, np.clip(centre, 0, len(view.n) - 1)].astype(np.float32)
    bare = round(BARE / per_row)
    bars = np.zeros(len(line.rows), bool)
    for side in (-1, 1):
        first, last = (round(d / per_column) for d in ASIDE)
        columns = np.clip(centre[:, None] + side * np.arange(first, last + 1), 0, len(view.n) - 1)
        beside = view.image[line.rows[:, None], columns].mean(axis=1)
        around = np.pad(beside, bare, constant_values=np.inf)
        rise = beside - np.maximum(around[: len(beside)], around[2 * bare :])
        bars |= rise > BRIGHT * np.median((grey - beside)[painted])
    return bars
