# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Which lines are one of two side by side: both found, or the other one shown by the cross section."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.birdseye.paint_profile import PAINTED, runs_of
from lane_dp_ros.core.lanes.candidate import LaneLine
from lane_dp_ros.core.lanes.line_kind import BESIDE, RESOLVED, PaintAlong, own_kind
from lane_dp_ros.core.types import LaneKind

Floats = NDArray[Any]

COMPARED = np.linspace(0, 1, 10)  # of the way that two lines have in common
DOUBLE_LINE = 0.75  # m; two lines farther apart are two
TWIN = (4, 6)  # samples aside; farther off kerbs and gutters lie beside lines
SLIT = 3  # samples from the centre of the other line; there it is dark on both sides
WITHIN, REACH = TWIN[1] - TWIN[0] + 1, TWIN[1] + SLIT
TWIN_RUN = 1.5  # m; its longest piece of paint, at least
TWIN_SHARE = 0.2  # of the rows; shorter are marks beside the line


def side_by_side(a: LaneLine, b: LaneLine) -> bool:
    """Return whether two lines run at most `DOUBLE_LINE` apart over half of the shorter one or more.

    Lines that part or merge on the way are not side by side.
    """
    first, last = max(a.s[0], b.s[0]), min(a.s[-1], b.s[-1])
    if last - first < min(a.length, b.length) / 2:
        return False
    s = first + (last - first) * COMPARED
    return bool((np.abs(np.interp(s, a.s, a.n) - np.interp(s, b.s, b.n)) <= DOUBLE_LINE).all())


def twin_beside(along: PaintAlong, per_row: float) -> tuple[int, LaneKind] | None:
    """Return the other line of a narrow double one: its side, -1 left or 1 right, and its kind.

    None where no second band, with a dark slit between, is near enough to be seen sharply. `per_row` is the
    length [m] of a row.
    """
    count = int(np.searchsorted(along.s, RESOLVED))
    contrast, s = along.sections[:count, BESIDE - REACH : BESIDE + REACH + 1], along.s[:count]
    smooth = (contrast[:, 2:] + contrast[:, 1:-1] + contrast[:, :-2])[:, SLIT - 1 : 1 - SLIT] / 3
    band = smooth - np.maximum(contrast[:, : -2 * SLIT], contrast[:, 2 * SLIT :])
    for side, aside in ((-1, slice(None, WITHIN)), (1, slice(-WITHIN, None))):
        painted = band[:, aside].max(axis=1) > PAINTED
        if np.count_nonzero(painted) < max(TWIN_SHARE * count, TWIN_RUN / per_row):
            continue
        if np.diff(runs_of(painted)).max() * per_row >= TWIN_RUN:
            cover = smooth[:, aside].max(axis=1)
            return side, own_kind(np.minimum(np.maximum(cover, 0), 1), s, per_row)
    return None
