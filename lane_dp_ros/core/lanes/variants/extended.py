# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Go on with a line behind a gap: to the next dash, as far as there is paint where the line points to."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.birdseye.paint_profile import runs_of
from lane_dp_ros.core.lanes.line_fit import polynomial_fit
from lane_dp_ros.core.types import BirdsEyeView, LaneLine, PaintMap

Floats = NDArray[np.float64]

GAP_MAX = 12.0  # m between two dashes, the longest in use (motorways: 6 m of paint, 12 m of gap)
DASH_MIN = 0.5  # m of paint; the rest of a dash may lie outside the view
LOOK_BACK = 8.0  # m at the end of a line that tell where it points to
TURN_MAX = 0.1  # lateral over forward; paint that runs otherwise is of another line
PAINTED = 0.5  # weight of the paint's centre
NEAR, FAR = 0, -1  # the ends of a line


def extend_line(line: LaneLine, view: BirdsEyeView, graph: PaintMap, blank_cost: float) -> LaneLine:
    """Return the line, extended at both ends over gaps of at most `GAP_MAX` to further paint.

    What it gains in score [m] is the paint less what the gap costs, `blank_cost` a metre of both; a gap never
    takes score away.
    """
    for end in (FAR, NEAR):
        while (longer := _to_next_dash(line, end, view, graph, blank_cost)) is not None:
            line = longer
    return line


def _to_next_dash(
    line: LaneLine, end: int, view: BirdsEyeView, graph: PaintMap, blank_cost: float
) -> LaneLine | None:
    """Return the line with the next dash beyond its `end`, fitted anew; None where there is none."""
    per_row = view.resolution[0]
    rows = _rows_beyond(line, end, view)
    s = view.s[rows]
    n = line.n[end] + _slope(line, end) * (s - line.s[end])
    centre, weight = view.paint_centres(graph, rows, view.columns(n))
    painted = (weight > PAINTED) & (n > view.n[0]) & (n < view.n[-1])
    dash = _first_run(painted, round(DASH_MIN / per_row))
    if dash is None or dash.start * per_row > GAP_MAX or _turns(s[dash], (centre - n)[dash]):
        return None
    rows, n = rows[: dash.stop], n[: dash.stop]
    if end == FAR:
        rows, n = np.concatenate([line.rows, rows]), np.concatenate([line.n, n])
    else:
        rows, n = np.concatenate([rows[::-1], line.rows]), np.concatenate([n[::-1], line.n])
    centre, weight = view.paint_centres(graph, rows, view.columns(n))
    fitted, bend = polynomial_fit(view.s[rows], centre, weight)
    gain = (dash.stop - dash.start - blank_cost * dash.stop) * per_row
    return LaneLine(rows, view.s[rows], fitted, bend, line.score + max(gain, 0.0))


def _turns(s: Floats, aside: Floats) -> bool:
    """Return whether paint `aside` [m] of where the line points to is of a line that this one crosses."""
    return len(s) > 2 and abs(float(np.polyfit(s, aside, 1)[0])) > TURN_MAX


def _rows_beyond(line: LaneLine, end: int, view: BirdsEyeView) -> NDArray[np.intp]:
    """Return the rows of the view beyond an end of a line, the nearest to the line first."""
    if end == FAR:  # the far rows of a view come first
        return np.arange(line.rows[FAR] - 1, -1, -1)
    return np.arange(line.rows[NEAR] + 1, len(view.s))


def _slope(line: LaneLine, end: int) -> float:
    """Return lateral over forward where a line ends."""
    last = np.abs(line.s - line.s[end]) <= LOOK_BACK
    return float(np.polyfit(line.s[last], line.n[last], 1)[0])


def _first_run(painted: NDArray[np.bool_], shortest: int) -> slice | None:
    """Return the first run of at least `shortest` painted rows."""
    runs = runs_of(painted)
    long = runs[np.diff(runs)[:, 0] >= shortest]
    return slice(*long[0].tolist()) if len(long) else None
