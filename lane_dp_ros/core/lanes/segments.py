# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Values of several lines in one array, one line after the other, and what is computed of each line."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[Any]

APART = 1e6  # keeps the values of two lines apart when all are sorted at once; values are far smaller
UNKNOWN = 0.49 * APART  # stands behind all of its line's values


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

    @cached_property
    def index(self) -> NDArray[np.intp]:
        """Return the line (N,) that each value is of."""
        return np.repeat(np.arange(len(self)), self._counts)

    @property
    def ends(self) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Return where the first and the last value (N,) of each line are."""
        return self._starts, self._starts + self._counts - 1

    def part(self, i: int) -> slice:
        """Return the place of a line's values."""
        start = int(self._starts[i])
        return slice(start, start + int(self._counts[i]))

    def of_kept(self, kept: NDArray[np.bool_]) -> Segments:
        """Return the segments of the values that are kept (N,), at least one a line."""
        return Segments(self.count(kept))

    def count(self, true: NDArray[np.bool_]) -> NDArray[np.intp]:
        """Return how many of each line's values are true, along the last axis as `sum`."""
        return np.asarray(np.add.reduceat(true.astype(np.intp), self._starts, axis=-1))

    def sum(self, values: Floats) -> Floats:
        """Return the sum of each line's values, along the last axis: (..., values) to (..., lines)."""
        return np.asarray(np.add.reduceat(values, self._starts, axis=-1))

    def spread(self, of_lines: Floats) -> Floats:
        """Return each line's number for all of its values: (..., lines) to (..., values)."""
        return np.repeat(of_lines, self._counts, axis=-1)

    def moving_sum(self, values: Floats, window: int) -> Floats:
        """Return the sum of the `window` values around each one, along the last axis, of its own line alone.

        Around value i are i - window // 2 and those behind it, as `np.convolve` has them.
        """
        sums = np.zeros((*values.shape[:-1], values.shape[-1] + 1))
        np.cumsum(values, axis=-1, out=sums[..., 1:])
        at, (first, last) = np.arange(values.shape[-1]), self.ends
        start = np.maximum(at - window // 2, self.spread(first))
        stop = np.minimum(at - window // 2 + window, self.spread(last + 1))
        return np.asarray(sums[..., stop] - sums[..., start])

    def slopes(self, s: Floats, n: Floats) -> Floats:
        """Return the slope of each line n(s) at all of its values, two or more evenly apart."""
        before, after = np.arange(-1, len(s) - 1), np.arange(1, len(s) + 1)
        first, last = self.ends
        before[first] += 1
        after[last] -= 1
        return np.asarray((n[after] - n[before]) / (s[after] - s[before]))

    def median(self, values: Floats) -> Floats:
        """Return the median of each line's values, see `quantile`."""
        return self.quantile(values, 0.5)

    def median_of_known(self, values: Floats) -> Floats:
        """Return the median of each line's values that are not NaN, NaN where half of them or more are."""
        known = np.isfinite(values)
        counts = self.count(known)
        medians = self.quantile(np.where(known, values, UNKNOWN), 0.5, np.maximum(counts, 1))
        return np.where(counts * 2 > self._counts, medians, np.nan)

    def quantile(self, values: Floats, share: float, counts: NDArray[np.intp] | None = None) -> Floats:
        """Return what a share of each line's values are below, |value| < 1e6 / 2, by one sort for all.

        Along the last axis: (..., values) to (..., lines). Of each line the `counts` (..., lines) lowest
        values are looked at, of which there is one or more; all where these are not given.
        """
        ordered = np.sort(values + self._apart, axis=-1)
        at = share * ((self._counts if counts is None else counts) - 1)
        below = at.astype(np.intp)
        first = self._starts + np.arange(0, ordered.size, ordered.shape[-1]).reshape(*ordered.shape[:-1], 1)
        low, high = ordered.take(first + below), ordered.take(first + np.ceil(at).astype(np.intp))
        return np.asarray(low + (at - below) * (high - low) - self._apart[self._starts])

    @cached_property
    def _apart(self) -> Floats:
        """What is added to each value to keep those of the lines apart."""
        return APART * self.index
