# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The exact rows in which a camera sees the road straight ahead, hills and cross slope included."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.scenes.view import View

Floats = NDArray[np.float64]

DEPTHS: Floats = np.arange(5.0, 36.0, dtype=np.float64)  # [m] that are asked for
ROUNDS = 5  # in which the height of the place is found that is looked at; a slope of 10 % leaves 1e-5 of it
OFF_THE_ROAD = 30.0  # [m] aside, where no road is that could be followed


def profile_ahead(view: View) -> Floats | None:
    """Return depth z [m] and row v [px] (N, 2) of the road straight ahead, at u = cx, every metre.

    Where the road bends away it is taken to go on beside itself with its cross slope, without kerbs and
    walls. The profile ends at a crest that hides what is behind, and at the picture's border; None where
    less than two of its points are left.
    """
    rows = view.camera.cy + view.camera.fy * _drops(view, DEPTHS) / DEPTHS
    hidden = np.flatnonzero(np.diff(rows) >= 0) + 1
    end = int(hidden[0]) if len(hidden) else len(rows)
    seen = np.flatnonzero((rows[:end] >= 0) & (rows[:end] <= view.size[1] - 1))
    return np.column_stack([DEPTHS[seen], rows[seen]]) if len(seen) > 1 else None


def _drops(view: View, depths: Floats) -> Floats:
    """Return how far below the camera's axis [m] the road lies at each depth, NaN off the road."""
    _, down, forward = view.axes
    drops = np.full_like(depths, view.road.camera_height)
    for _ in range(ROUNDS):
        x, up, z = view.origin[:, None] + depths * forward[:, None] + drops * down[:, None]
        s, n, _ = view.course.locate(x.astype(np.float32), z.astype(np.float32))
        along = s.astype(np.float64) + view.course.position
        level = view.road.level(along, n.astype(np.float64), view.course.position)
        drops = drops + (up - level) / -down[1]
    return np.where(np.abs(n) < OFF_THE_ROAD, drops, np.nan)
