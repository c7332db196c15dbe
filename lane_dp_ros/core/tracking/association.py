# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Which line of this frame is which of the frames before, and whether it lies on its own paint."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.tracking.frenet_line import NEAREST, SHARED, FrenetLine, picture_rows

Floats = NDArray[np.float64]

STRAYED = 2  # rows; in one alone, a line may be off by chance


def match_in_order(gains: Floats) -> list[tuple[int, int]]:
    """Return the pairs (row, column) that gain most together, in order of both.

    `gains` (M, N): of each known line (row) matched with each found one (column), both from left to right;
    pairs that gain nothing never match. Dynamic programming maximises the sum of the gains over the pairs
    (Needleman, Wunsch 1970, align two sequences so): lines do not cross from frame to frame.
    """
    best = np.zeros((len(gains) + 1, gains.shape[1] + 1))
    for i, j in np.ndindex(gains.shape):
        paired = best[i, j] + gains[i, j] if gains[i, j] > 0 else -np.inf
        best[i + 1, j + 1] = max(best[i, j + 1], best[i + 1, j], paired)
    return _trace_back(best, gains)


def _trace_back(best: Floats, gains: Floats) -> list[tuple[int, int]]:
    i, j = gains.shape
    pairs = []
    while i and j:
        if gains[i - 1, j - 1] > 0 and best[i, j] == best[i - 1, j - 1] + gains[i - 1, j - 1]:
            i, j = i - 1, j - 1
            pairs.append((i, j))
        elif best[i, j] == best[i - 1, j]:
            i -= 1
        else:
            j -= 1
    return pairs[::-1]


def agreement(a: FrenetLine, b: FrenetLine, limit: float) -> float:
    """Return how much of the picture two lines share, times by how much less than `limit` [m] they are apart.

    Near the camera, where lines are seen best, a metre counts most, see `shared_rows`. A part that runs off
    elsewhere counts nothing, but spoils nothing. 0 where the lines share too little to be compared, or are
    farther apart in most rows.
    """
    s = shared_rows(a, b)
    apart = np.abs(np.interp(s, a.s, a.y) - np.interp(s, b.s, b.y))
    if len(s) == 0 or np.median(apart) > limit:
        return 0.0
    return float(np.mean(np.maximum(limit - apart, 0)) * (1 / s[0] - 1 / s[-1]))


def strayed(seen: FrenetLine, expected: FrenetLine, others: Iterable[FrenetLine]) -> bool:
    """Whether a line was found, for a part, on the paint of `others` that are seen, too.

    Paint lies still: it is that line's to whose course it lies nearer. But where the course expected lies
    nearer to another line than what is seen, it is itself that strayed before. What has more such rows
    is wrong.
    """
    s = shared_rows(seen, expected)
    here, there = np.interp(s, seen.s, seen.y), np.interp(s, expected.s, expected.y)
    beside_here, beside_there = (_beside(s, y, others) for y in (here, there))
    apart = np.abs(here - there)
    wrong = np.sum(beside_here < np.minimum(apart, beside_there))
    right = np.sum(beside_there < np.minimum(apart, beside_here))
    return bool(wrong >= STRAYED and wrong > right)


def shared_rows(a: FrenetLine, b: FrenetLine) -> Floats:
    """Return s [m] of what two lines share, see `picture_rows`; none where they share less than `SHARED`."""
    first, last = max(a.s[0], b.s[0]), min(a.s[-1], b.s[-1])
    return picture_rows(first, last) if last - max(first, NEAREST) >= SHARED else np.empty(0)


def _beside(s: Floats, y: Floats, others: Iterable[FrenetLine]) -> Floats:
    """Return the distance [m] of points to the nearest of other lines, inf where none runs."""
    nearest = np.full_like(s, np.inf)
    for other in others:
        nearest = np.minimum(nearest, np.abs(y - np.interp(s, other.s, other.y, np.inf, np.inf)))
    return nearest
