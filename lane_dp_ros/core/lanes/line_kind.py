# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Whether a line is solid or dashed, from the paint along it.

How much paint there is in a row is the contrast of the line to the darker side of it, as a share of that of
the line's certain paint. Where hatching meets a line there is no bright band, yet the line is as bright as
before: only a gap between dashes is as dark as the road. Rows that are hidden or out of the picture say
nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.birdseye.paint_profile import PAINTED, PaintProfile, runs_of
from lane_dp_ros.core.lanes.candidate import LaneLine
from lane_dp_ros.core.lanes.cross_section import (
    DARK,
    FAINT,
    FLANK,
    MIN_PAINTED,
    cross_sections,
    row_medians,
)
from lane_dp_ros.core.lanes.segments import Segments
from lane_dp_ros.core.types import LaneKind

Floats = NDArray[Any]
Cells = NDArray[np.intp]

BESIDE = FLANK[1]  # samples to each side of a line that tell of its paint
RESOLVED = 20.0  # m; farther off a row of the picture is as long as the gaps of short dashes
RUN_LOOKED_FOR = 8.0  # m of a line that begins far off, whose longest run is looked for all the same
# Log-odds of dashed = a + b missing_paint + c log(longest_run / 1 m), by benchmarks/fit_line_kind.py. Right
# on roads left out of it: 104 of 108 lanes in labelled KITTI frames, 989 of 1019 in rendered scenes.
DASHED_LOG_ODDS = (1.80, 12.74, -3.56)


@dataclass(frozen=True, eq=False)
class PaintAlong:
    """The paint along a line, in the rows (N,) from near to far in which the road is seen.

    `s` (N,) [m]; `cells` (N,) are the columns of the line; `sections` (N, 2 BESIDE + 1) the contrasts across
    the line as shares of that of its paint.
    """

    rows: Cells
    cells: Cells
    s: Floats
    sections: Floats

    @cached_property
    def cover(self) -> Floats:
        """How much paint (N,) there is in each row, in [0, 1]."""
        return np.asarray(np.minimum(np.maximum(_middle(self.sections), 0), 1))


def paint_along(lines: Sequence[LaneLine], paint: PaintProfile) -> list[PaintAlong | None]:
    """Return the paint along each line, None for lines of which hardly a row is seen."""
    view = paint.view
    cells = [view.nearest_columns(line.n) for line in lines]
    seen = [view.on_road[line.rows, each] for line, each in zip(lines, cells, strict=True)]
    shown = [i for i, each in enumerate(seen) if np.count_nonzero(each) >= MIN_PAINTED]
    found: list[PaintAlong | None] = [None] * len(lines)
    if not shown:
        return found
    rows = np.concatenate([lines[i].rows[seen[i]] for i in shown])
    columns = view.columns(np.concatenate([lines[i].n[seen[i]] for i in shown]))
    # One call for all lines takes a fraction of the time of one for each.
    sections = _contrasts(cross_sections(view, rows, columns, BESIDE))
    segments = Segments([np.count_nonzero(seen[i]) for i in shown])
    for k, i in enumerate(shown):
        part, at = segments.part(k), seen[i]
        feature = paint.feature(rows[part], cells[i][at])
        level = _paint_level(sections[part], feature)
        found[i] = PaintAlong(rows[part], cells[i][at], lines[i].s[at], sections[part] / level)
    return found


def _contrasts(sections: Floats) -> Floats:
    """Return the Weber contrasts of cross sections (N, samples) to the darker side of the line."""
    near, far = FLANK
    left = row_medians(sections[:, BESIDE - far + 1 : BESIDE - near + 1])
    right = row_medians(sections[:, BESIDE + near : BESIDE + far])
    road = np.minimum(left, right)[:, None]
    return np.asarray((sections - road) / (road + DARK))


def _paint_level(sections: Floats, feature: Floats) -> float:
    """Return the contrast of the paint where it is certain, else where it is likeliest."""
    painted = feature > PAINTED
    if np.count_nonzero(painted) < MIN_PAINTED:
        painted = feature >= np.sort(feature)[-MIN_PAINTED]
    return max(float(row_medians(_middle(sections[painted])[None])[0]), FAINT)


def _middle(sections: Floats) -> Floats:
    """Return the mean of the three samples (N,) in the middle of cross sections, as `BandMeans.paint`."""
    return np.asarray(sections[:, BESIDE - 1 : BESIDE + 2].sum(axis=1) / 3)


def missing_paint(cover: Floats) -> float:
    """Return what share of a line is missing, by its `cover` (N,)."""
    return 1 - float(cover.mean())


def longest_run(cover: Floats, s: Floats, per_row: float) -> float:
    """Return the longest piece of paint [m] of a `cover` (N,) at s (N,) [m], as far as gaps are resolved."""
    resolved = s < max(RESOLVED, s[0] + RUN_LOOKED_FOR)
    runs = runs_of(cover[resolved] > PAINTED)
    return per_row * max(int(np.diff(runs).max(initial=0)), 1)


def own_kind(cover: Floats, s: Floats, per_row: float) -> LaneKind:
    """Return whether a line is solid or dashed, by its `cover` (N,) at s (N,) [m], `per_row` [m] apart."""
    constant, of_missing, of_run = DASHED_LOG_ODDS
    log_odds = constant + of_missing * missing_paint(cover)
    log_odds += of_run * float(np.log(longest_run(cover, s, per_row)))
    return "dashed" if log_odds > 0 else "solid"
