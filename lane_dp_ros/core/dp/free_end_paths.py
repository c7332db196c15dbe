# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Best smooth paths that start and end where they like: the row-by-row DP with a memory of slope.

The paper's Algorithm 2 has every path cross the whole picture, and charges lambda * j^2 for each step
aside, so that a curved line pays although it is smooth. Here

- a node is (row, column, slope), and only a *change* of slope costs;
- what is summed is a gain that may be negative, and a path starts and ends where it gains most: the start
  and the destination node of a lane, which the paper names as its future work (1).

A row here is usually a block of several rows of a picture, so that a slope of whole columns per block is
fine enough; `segment_gain` sums a picture up to such blocks:

>>> import numpy as np
>>> reward = np.full((6, 5), -1.0)
>>> reward[range(1, 6), [4, 3, 2, 2, 2]] = 2.0  # row 0: nothing
>>> paths = free_paths(segment_gain(reward, max_slope=1, step=1), bend_penalty=0.5)
>>> row, column = np.unravel_index(paths.score.argmax(), paths.score.shape)
>>> float(paths.score[row, column])
9.5
>>> paths.trace(row, column).tolist()  # row, column, index of the slope
[[1, 4, 0], [2, 3, 0], [3, 2, 1], [4, 2, 1], [5, 2, 1]]
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np
from numpy.lib.stride_tricks import as_strided
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float32]
Indices = NDArray[np.int32]


@dataclass(frozen=True, eq=False)
class FreePaths:
    """The best path, from wherever it starts, to every node of a graph of rows x slopes x columns nodes.

    `values` (rows, slopes, columns) float32: what the best path that ends in this node gains;
    `score` (rows, columns) float32: the same, over all slopes; -inf where no path may end.
    Index i of a slope means i - slopes // 2 columns to the right from this row to the next.
    """

    values: Floats
    score: Floats
    bend_penalty: float

    @property
    def slope(self) -> Indices:
        """Return the index of the slope that gives `score` (rows, columns); of equals the straightest."""
        best = np.zeros(self.score.shape, np.int32)
        for i in reversed(_straightest_first(self.values.shape[1])):
            np.copyto(best, i, where=self.values[:, i] == self.score)
        return best

    def trace(self, row: int, column: int) -> Indices:
        """Return the nodes (n, 3) of the best path that ends in (row, column): row, column, index of slope.

        They are ordered from the start of the path to its end, one node a row.
        Raises ValueError when there is no such node or no path may end in it.
        """
        rows, columns = self.score.shape
        if not (0 <= row < rows and 0 <= column < columns):
            raise ValueError(f"({row}, {column}) is not in the graph, expected below ({rows}, {columns})")
        if np.isneginf(self.score[row, column]):
            raise ValueError(f"no path may end in ({row}, {column}): it is forbidden")
        slopes = self.values.shape[1]
        ends = self.values[row, :, column].tolist()
        slope: int | None = max(_straightest_first(slopes), key=ends.__getitem__)
        nodes = []
        while slope is not None:
            nodes.append((row, column, slope))
            slope = self._slope_before(row, column, slope)
            row, column = row - 1, column - ((slope or 0) - slopes // 2)
        return np.array(nodes[::-1], np.int32)

    def _slope_before(self, row: int, column: int, slope: int) -> int | None:
        """Return the slope of the node before this one on the best path to it; None where it starts here."""
        if row == 0:
            return None
        best, best_gain = None, 0.0
        _, slopes, columns = self.values.shape
        values, penalty = self._values, self.bend_penalty
        u = column - slope + slopes // 2
        # Of equals the one without a bend.
        for i, here, bent in ((slope, u, 0.0), (slope - 1, u + 1, penalty), (slope + 1, u - 1, penalty)):
            if 0 <= i < slopes and 0 <= here < columns:
                gain = values[row - 1, i, here] - bent
                if gain > best_gain:
                    best, best_gain = i, gain
        return best

    @cached_property
    def _values(self) -> memoryview:
        """The values, an element of which costs a third of what it costs to index the array."""
        return memoryview(self.values)  # type: ignore[arg-type]


def free_paths(gain: ArrayLike, bend_penalty: float) -> FreePaths:
    """Find the best paths with free start and free end to all nodes of a graph, rows in the order given.

    With j = i - slopes // 2 the slope [columns a row] of index i::

        E(r, j, u) = gain(r, j, u)
            + max(0, max over |j' - j| <= 1 of E(r - 1, j', u - j') - bend_penalty * |j' - j|)

    where 0 starts a path: of equals the shorter path is taken, then the one without a bend.

    Args:
        gain: (rows, slopes, columns), what a path gains in each node; negative is a cost, -inf forbids
            the node. The number of slopes is odd, the middle one is straight on.
        bend_penalty: what a change of slope by one column a row costs, >= 0; larger changes are not allowed.

    Raises:
        ValueError: the gain is not three-dimensional with an odd number of slopes, or holds NaN or inf, or
            bend_penalty is negative or not finite.
    """
    gain = _checked_gain(gain)
    if not 0 <= bend_penalty < np.inf:
        raise ValueError(f"bend_penalty is {bend_penalty}, expected a finite number >= 0")
    penalty = np.float32(bend_penalty)
    rows, slopes, columns = gain.shape
    reach = slopes // 2
    padded = np.full((rows, slopes, columns + 2 * reach), -np.inf, np.float32)
    E = padded[:, :, reach : reach + columns]
    E[0] = gain[0]
    bent = np.full((slopes + 2, columns), -np.inf, np.float32)  # one slope more on each side: no path has it
    best = np.empty((slopes, columns), np.float32)
    for straight, own, total in zip(_moved_on(padded)[:-1], gain[1:], E[1:], strict=True):
        np.subtract(straight, penalty, out=bent[1:-1])
        np.maximum(bent[:-2], bent[2:], out=best)
        np.maximum(best, straight, out=best)
        np.maximum(best, 0, out=best)
        np.add(best, own, out=total)
    return FreePaths(E, E.max(axis=1), float(penalty))


def segment_gain(
    reward: ArrayLike, max_slope: int, step: int, length: float = 1.0, slope_cost: ArrayLike | None = None
) -> Floats:
    """Return the gain of straight pieces, (rows // step, 2 * max_slope + 1, columns), for `free_paths`.

    The piece (block, i, u) starts in column u with the block's first row and moves j = i - max_slope columns
    to the right over its `step` rows: in row t it lies in column u + j * (t + 0.5) / step, rounded.
    Its gain is `length` times the mean of `reward` (rows, columns) there, less the `slope_cost`
    (2 * max_slope + 1,) of its slope; -inf where it leaves the picture. Rows beyond the last whole block are
    left out.

    Raises ValueError when the reward is not a picture of at least `step` rows, step < 1 or max_slope < 0.
    """
    picture = np.asarray(reward, dtype=np.float32)
    if step < 1 or max_slope < 0:
        raise ValueError(f"step is {step} and max_slope {max_slope}, expected step >= 1 and max_slope >= 0")
    if picture.ndim != 2 or len(picture) < step or picture.shape[1] == 0:
        raise ValueError(f"reward has shape {picture.shape}, expected (rows, columns) with >= {step} rows")
    blocks, columns = len(picture) // step, picture.shape[1]
    costs = np.zeros(2 * max_slope + 1) if slope_cost is None else slope_cost
    costs = np.asarray(costs, np.float32)
    # The rows of a block apart from one another, so that those of all blocks are summed up in one piece.
    padded = np.full((step, blocks, columns + 2 * max_slope), -np.inf, np.float32)
    rows = picture[: blocks * step].reshape(blocks, step, columns).transpose(1, 0, 2)
    np.multiply(rows, np.float32(length / step), out=padded[:, :, max_slope : max_slope + columns])
    gain = np.empty((blocks, 2 * max_slope + 1, columns), np.float32)
    total = np.empty((blocks, columns), np.float32)
    for i, lefts in enumerate(_first_columns(max_slope, step)):
        np.subtract(padded[0, :, lefts[0] : lefts[0] + columns], costs[i], out=total)
        for t in range(1, step):
            total += padded[t, :, lefts[t] : lefts[t] + columns]
        gain[:, i] = total
    return gain


@cache
def _first_columns(max_slope: int, step: int) -> list[list[int]]:
    """Return, for each slope and row of a piece, the column (padded) of the piece that starts in column 0."""
    slopes = np.arange(-max_slope, max_slope + 1)[:, None]
    aside = np.rint(slopes * (np.arange(step) + 0.5) / step).astype(int)
    return [(max_slope + each).tolist() for each in aside]


def _moved_on(padded: Floats) -> Floats:
    """Return the view (rows, slopes, columns) whose [r, i, u] is the node of row r that leads to column u.

    This node, E(r, j, u - j), lies at i * width + reach + (u - j) in row r of `padded`, with reach =
    slopes // 2 columns of padding and j = i - reach: at i * (width - 1) + 2 * reach + u. So a view does
    what a copy with indices would do. It reaches neither before nor behind the columns of its slope, and
    what it meets beside the graph is padding, -inf.
    """
    rows, slopes, width = padded.shape
    reach = slopes // 2
    row_bytes, slope_bytes, column_bytes = padded.strides
    shape = (rows, slopes, width - 2 * reach)
    strides = (row_bytes, slope_bytes - column_bytes, column_bytes)
    return as_strided(padded[:, 0, 2 * reach :], shape, strides, writeable=False)


@cache
def _straightest_first(slopes: int) -> list[int]:
    """Return the indices of the slopes, the straightest first, left before right."""
    return sorted(range(slopes), key=lambda i: (abs(i - slopes // 2), i))


def _checked_gain(gain: ArrayLike) -> Floats:
    array = np.asarray(gain, dtype=np.float32)
    if array.ndim != 3 or array.size == 0 or array.shape[1] % 2 == 0:
        raise ValueError(f"gain has shape {array.shape}, expected (rows, slopes, columns), slopes odd")
    if not array.max() < np.inf:  # a maximum is NaN when any value is
        raise ValueError("gain holds NaN or inf, expected numbers (-inf forbids a node)")
    return array
