# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Which line of this frame is which of the frames before: one to one, and none overtakes another."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def match_in_order(distances: Floats, limit: float) -> list[tuple[int, int]]:
    """Return the pairs (row, column) that match most and nearest, in order of both.

    `distances` (M, N): of each known line (row) to each found one (column), both from left to right;
    pairs of more than `limit` never match. Dynamic programming maximises the sum of (limit - distance) over
    the pairs (Needleman, Wunsch 1970, align two sequences so): lines do not cross from frame to frame.
    """
    gain = limit - distances
    best = np.zeros((len(distances) + 1, distances.shape[1] + 1))
    for i, j in np.ndindex(distances.shape):
        paired = best[i, j] + gain[i, j] if gain[i, j] >= 0 else -np.inf
        best[i + 1, j + 1] = max(best[i, j + 1], best[i + 1, j], paired)
    return _trace_back(best, gain)


def _trace_back(best: Floats, gain: Floats) -> list[tuple[int, int]]:
    i, j = gain.shape
    pairs = []
    while i and j:
        if gain[i - 1, j - 1] >= 0 and best[i, j] == best[i - 1, j - 1] + gain[i - 1, j - 1]:
            i, j = i - 1, j - 1
            pairs.append((i, j))
        elif best[i, j] == best[i - 1, j]:
            i -= 1
        else:
            j -= 1
    return pairs[::-1]
