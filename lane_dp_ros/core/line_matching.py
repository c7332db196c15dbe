# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Which line of this frame is which of the frames before: one to one, and none overtakes another."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


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
