# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Go on with a line behind a gap: to the next dash, as far as there is paint where the line points to."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.birdseye.paint_profile import PAINTED, PaintProfile, paint_gain, runs_of
from lane_dp_ros.core.lanes.candidate import LaneLine
from lane_dp_ros.core.lanes.line_fit import polynomial_fit
from lane_dp_ros.core.parameter import Parameters, parameter

Floats = NDArray[np.float64]

DASH_MIN = 0.5  # m of paint; the rest of a dash may lie outside the view
LOOK_BACK = 8.0  # m at the end of a line that tell where it points to
OF_ANOTHER = 0.15  # m; paint so near to another line, which runs beside this one, is that one's
EPSILON = 1e-9  # m^2; all in one place has no slope
NEAR, FAR = 0, -1  # the ends of a line


@dataclass(frozen=True)
class ExtensionConfig(Parameters):
    """How far a line goes on behind a gap."""

    gap_max: float = parameter(
        12.0,
        "Between two dashes; the longest in use is that of motorways: 6 m of paint, 12 m of gap.",
        unit="m",
        limits=(1.0, 50.0),
        expert=True,
    )
    turn_max: float = parameter(
        0.1,
        "Lateral over forward; paint that runs otherwise is of another line.",
        limits=(0.0, 1.0),
        expert=True,
    )


def extend_line(
    line: LaneLine,
    paint: PaintProfile,
    blank_cost: float,
    config: ExtensionConfig,
    others: Sequence[LaneLine] = (),
) -> LaneLine:
    """Return the line, extended at both ends over gaps of at most `config.gap_max` to further paint.

    It ends before paint of the `others` that run beside it. What it gains in score [m] is the paint less what
    the gap costs, `blank_cost` a metre of both; a gap never takes score away.
    """
    beside = [other for other in others if other.s[0] < line.s[-1] and other.s[-1] > line.s[0]]
    for end in (FAR, NEAR):
        while (longer := _to_next_dash(line, end, paint, blank_cost, config, beside)) is not None:
            line = longer
    return line


def _to_next_dash(
    line: LaneLine,
    end: int,
    paint: PaintProfile,
    blank_cost: float,
    config: ExtensionConfig,
    beside: Sequence[LaneLine],
) -> LaneLine | None:
    """Return the line with the next dash beyond its `end`, fitted anew; None where there is none."""
    view = paint.view
    per_row = view.resolution[0]
    rows, shortest = _rows_beyond(line, end, len(view.s)), round(DASH_MIN / per_row)
    if len(rows) < shortest:
        return None
    s = view.s[rows]
    n = line.n[end] + _slope(line, end) * (s - line.s[end])
    centre, weight = paint.centres(rows, view.columns(n))
    painted = (weight > PAINTED) & (n > view.n[0]) & (n < view.n[-1])
    dash = _first_run(painted, shortest)
    if dash is None or dash.start * per_row > config.gap_max:
        return None
    if _turn(s[dash], (centre - n)[dash]) > config.turn_max:
        return None  # the paint of a line that this one crosses
    if any(_is_paint_of(other, s[dash], centre[dash]) for other in beside):
        return None  # this one leads into it
    rows, n = rows[: dash.stop], n[: dash.stop]
    if end == FAR:
        rows, n = np.concatenate([line.rows, rows]), np.concatenate([line.n, n])
    else:
        rows, n = np.concatenate([rows[::-1], line.rows]), np.concatenate([n[::-1], line.n])
    centre, weight = paint.centres(rows, view.columns(n))
    fitted, bend = polynomial_fit(view.s[rows], centre, weight)
    beyond = np.arange(dash.stop) >= dash.start
    gain = float(paint_gain(beyond, blank_cost).sum()) * per_row
    return LaneLine(rows, view.s[rows], fitted, bend, line.score + max(gain, 0.0))


def _is_paint_of(other: LaneLine, s: Floats, centre: Floats) -> bool:
    """Return whether most of the paint centred at road coordinates (s, centre) is that of another line."""
    along = (s >= other.s[0]) & (s <= other.s[-1])
    near = np.abs(np.interp(s, other.s, other.n) - centre) <= OF_ANOTHER
    return bool(np.mean(along & near) > 0.5)


def _turn(s: Floats, aside: Floats) -> float:
    """Return by how much, lateral over forward, paint `aside` [m] of where the line points to runs off it."""
    return abs(_slope_of(s, aside)) if len(s) > 2 else 0.0


def _rows_beyond(line: LaneLine, end: int, count: int) -> NDArray[np.intp]:
    """Return the rows, of a view of `count` rows, beyond an end of a line, the nearest to the line first."""
    if end == FAR:  # the far rows of a view come first
        return np.arange(line.rows[FAR] - 1, -1, -1)
    return np.arange(line.rows[NEAR] + 1, count)


def _slope(line: LaneLine, end: int) -> float:
    """Return lateral over forward where a line ends."""
    last = np.abs(line.s - line.s[end]) <= LOOK_BACK
    return _slope_of(line.s[last], line.n[last])


def _slope_of(s: Floats, n: Floats) -> float:
    """Return the slope of the straight line n(s) by least squares; `np.polyfit` takes ten times as long."""
    centred = s - s.mean()
    return float(centred @ n / max(float(centred @ centred), EPSILON))


def _first_run(painted: NDArray[np.bool_], shortest: int) -> slice | None:
    """Return the first run of at least `shortest` painted rows."""
    runs = runs_of(painted)
    long = runs[np.diff(runs)[:, 0] >= shortest]
    return slice(*long[0].tolist()) if len(long) else None
