# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Values of several lines in one array, one line after the other, and what is computed of each line."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[Any]

APART = 1e6  # keeps the values of two lines apart when all are sorted at once; values are far smaller


class Segments:
    """Where each line begins and ends in an array of all lines' values; no line is empty."""

    def __init__(self, counts: Sequence[int] | NDArray[np.intp]) -> None:
        self._counts = np.asarray(counts, np.intp)
        self._starts = np.concatenate([[0], np.cumsum(self._counts)[:-1]]).astype(np.intp)

    def __len__(self) -> int:
        return len(self._counts)

    @property
    def lengths(self) -> NDArray[np.intp]:
        """Return how many values (N,) each line has."""
        return self._counts

    @property
    def index(self) -> NDArray[np.intp]:
        """Return the line (N,) that each value is of."""
        return np.repeat(np.arange(len(self)), self._counts)

    def part(self, i: int) -> slice:
        """Return the place of a line's values."""
        start = int(self._starts[i])
        return slice(start, start + int(self._counts[i]))

    def of_kept(self, kept: NDArray[np.bool_]) -> Segments:
        """Return the segments of the values that are kept (N,), at least one a line."""
        return Segments(self.count(kept))

    def count(self, true: NDArray[np.bool_]) -> NDArray[np.intp]:
        """Return, for each line, how many of its values are true."""
        return np.asarray(np.add.reduceat(true.astype(np.intp), self._starts))

    def sum(self, values: Floats) -> Floats:
        """Return the sum of each line's values, along the last axis: (..., values) to (..., lines)."""
        return np.asarray(np.add.reduceat(values, self._starts, axis=-1))

    def spread(self, of_lines: Floats) -> Floats:
        """Return each line's number for all of its values: (..., lines) to (..., values)."""
        return np.repeat(of_lines, self._counts, axis=-1)

    def median(self, values: Floats) -> Floats:
        """Return the median of each line's values, |value| < 1e6 / 2, by one sort for all."""
        ordered = np.sort(values + APART * self.index)
        low, high = self._starts + (self._counts - 1) // 2, self._starts + self._counts // 2
        return np.asarray((ordered[low] + ordered[high]) / 2 - APART * np.arange(len(self)))
