# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Lines end at a stop line: what is painted beyond the junction are other lines."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.birdseye.birds_eye import BirdsEyeView
from lane_dp_ros.core.birdseye.paint_profile import PAINTED, PaintProfile, paint_gain, runs_of
from lane_dp_ros.core.lanes.candidate import LaneLine
from lane_dp_ros.core.lanes.line_fit import MIN_ROWS
from lane_dp_ros.core.lanes.variants.extension import DASH_MIN
from lane_dp_ros.core.parameter import Parameters, parameter

ASIDE = (0.4, 1.4)  # m to one side of the line; a stop line goes on there
BARE = 0.75  # m; so far before and behind the middle of a stop line the road is bare
END = 1.0  # m; no farther from the middle of the stop line the paint ends
LEVEL = 0.5  # share of its cells; more do not stand above the road


@dataclass(frozen=True)
class StopLineConfig(Parameters):
    """The stop line of a junction, at which lines end."""

    unpainted_min: float = parameter(
        9.0,
        "Without paint behind a stop line; less is a crossing of rails or for pedestrians.",
        unit="m",
        limits=(2.0, 50.0),
        expert=True,
    )
    rise_min: float = parameter(
        0.5,
        "Rise of a stop line over the road, as a share of the line's own.",
        limits=(0.0, 2.0),
        expert=True,
    )


def end_at_stop_line(
    line: LaneLine, paint: PaintProfile, blank_cost: float, config: StopLineConfig
) -> LaneLine:
    """Return the line as far as the stop line of the first junction that it crosses, if it crosses one.

    What is left of it scores its metres of paint, less `blank_cost` a metre.
    """
    view = paint.view
    per_row = view.resolution[0]
    painted = paint.centres(line.rows, view.columns(line.n))[1] > PAINTED
    dashes = runs_of(painted)
    dashes = dashes[np.diff(dashes)[:, 0] * per_row >= DASH_MIN]
    gaps = [
        (end, start)
        for (_, end), (start, _) in pairwise(dashes)
        if (start - end) * per_row >= config.unpainted_min
    ]
    if not gaps:
        return line
    bars = _bars(line, painted, view, config.rise_min)
    for end, _ in gaps:
        if end >= MIN_ROWS and bars[end - 1 : end + round(END / per_row)].any():
            score = float(paint_gain(painted[:end], blank_cost).sum()) * per_row
            return LaneLine(line.rows[:end], line.s[:end], line.n[:end], line.bend, score)
    return line


def _bars(line: LaneLine, painted: NDArray[np.bool_], view: BirdsEyeView, bright: float) -> NDArray[np.bool_]:
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
    bars = (own > 0) & (rise > bright * own) & (view.on_road[rows, columns].mean(axis=2) > LEVEL)
    return np.asarray(bars.any(axis=0))
