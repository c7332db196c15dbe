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

    `padded` (rows, 1 + slopes + 1, p + columns + p) float32 holds the `values`, with -inf around them: one
    slope more on each side, and p = slopes // 2 + 1 columns, so that what leads to a node is in the array;
    `score` (rows, columns) float32: the highest value of all slopes; -inf where no path may end.
    Index i of a slope means i - slopes // 2 columns to the right from this row to the next.
    """

    padded: Floats
    score: Floats
    bend_penalty: float

    @property
    def values(self) -> Floats:
        """Return what the best path that ends in each node gains, (rows, slopes, columns)."""
        return _inside(self.padded)

    @property
    def slope(self) -> Indices:
        """Return the index of the slope that gives `score` (rows, columns); of equals the straightest."""
        values, best = self.values, np.zeros(self.score.shape, np.int32)
        for i in reversed(_straightest_first(values.shape[1])):
            np.copyto(best, i, where=values[:, i] == self.score)
        return best

    def trace(self, row: int, column: int) -> Indices:
        """Return the nodes (n, 3) of the best path that ends in (row, column): row, column, index of slope.

        They are ordered from the start of the path to its end, one node a row.
        Raises ValueError when there is no such node or no path may end in it.
        """
        rows, columns = self.score.shape
        if not (0 <= row < rows and 0 <= column < columns):
            raise ValueError(f"({row}, {column}) is not in the graph, expected below ({rows}, {columns})")
        ends = self.values[row, :, column].tolist()
        slope = max(_straightest_first(len(ends)), key=ends.__getitem__)
        if ends[slope] == -np.inf:
            raise ValueError(f"no path may end in ({row}, {column}): it is forbidden")
        nodes = self._nodes_before(row, column, slope)[::-1]
        rows_of, slopes_of, columns_of = np.unravel_index(nodes, self.padded.shape)
        pad = self.padded.shape[1] // 2
        return np.stack([rows_of, columns_of - pad, slopes_of - 1], axis=1).astype(np.int32)

    def _nodes_before(self, row: int, column: int, slope: int) -> list[int]:
        """Return the places in `padded`, flat, of the nodes of the best path to this one, its end first."""
        _, slopes, width = self.padded.shape
        pad, row_before = slopes // 2, slopes * width
        values, penalty = self._flat, self.bend_penalty
        at, aside = row * row_before + (slope + 1) * width + column + pad, slope + 1 - pad
        nodes = [at]
        while at >= row_before:
            straight = at - row_before - aside
            left, right = straight - width + 1, straight + width - 1  # the slopes beside lead here, too
            gains = values[straight], values[left] - penalty, values[right] - penalty
            gain = max(gains)
            if gain <= 0:
                break
            # Of equals the one without a bend.
            if gain == gains[0]:
                at = straight
            elif gain == gains[1]:
                at, aside = left, aside - 1
            else:
                at, aside = right, aside + 1
            nodes.append(at)
        return nodes

    @cached_property
    def _flat(self) -> memoryview:
        """`padded`, flat: an element costs a fraction of what it costs to index the array."""
        return memoryview(self.padded.ravel())  # type: ignore[arg-type]


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
    padded = np.full((rows, slopes + 2, columns + 2 * (slopes // 2 + 1)), -np.inf, np.float32)
    E = _inside(padded)
    E[0] = gain[0]
    best = np.empty((slopes, columns), np.float32)
    start = np.zeros_like(best)  # the maximum with a number takes three times as long
    for moved, own, total in zip(_moved_on(padded)[:-1], gain[1:], E[1:], strict=True):
        np.maximum(moved[:-2], moved[2:], out=best)
        np.subtract(best, penalty, out=best)
        np.maximum(best, moved[1:-1], out=best)
        np.maximum(best, start, out=best)
        np.add(best, own, out=total)
    return FreePaths(padded, E.max(axis=1), float(penalty))


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
    # The rows of a block apart from one another, padded and flat: those of all blocks are summed up in one
    # piece, whatever lies between the columns of one block and those of the next.
    width = columns + 2 * max_slope
    size = blocks * width
    padded = np.full((step, size + 2 * max_slope), -np.inf, np.float32)
    rows = picture[: blocks * step].reshape(blocks, step, columns).transpose(1, 0, 2)
    inside = padded[:, :size].reshape(step, blocks, width)[:, :, max_slope : max_slope + columns]
    np.multiply(rows, np.float32(length / step), out=inside)
    gain = np.empty((blocks, 2 * max_slope + 1, columns), np.float32)
    total = np.empty(size, np.float32)
    for i, lefts in enumerate(_first_columns(max_slope, step)):
        np.subtract(padded[0, lefts[0] : lefts[0] + size], costs[i], out=total)
        for row, left in zip(padded[1:], lefts[1:], strict=True):
            total += row[left : left + size]
        gain[:, i] = total.reshape(blocks, width)[:, :columns]
    return gain


@cache
def _first_columns(max_slope: int, step: int) -> list[list[int]]:
    """Return, for each slope and row of a piece, the column (padded) of the piece that starts in column 0."""
    slopes = np.arange(-max_slope, max_slope + 1)[:, None]
    aside = np.rint(slopes * (np.arange(step) + 0.5) / step).astype(int)
    return [(max_slope + each).tolist() for each in aside]


def _inside(padded: Floats) -> Floats:
    """Return the view (rows, slopes, columns) of a padded graph without its padding."""
    pad = padded.shape[1] // 2
    return padded[:, 1:-1, pad:-pad]


def _moved_on(padded: Floats) -> Floats:
    """Return the view (rows, slopes + 2, columns) whose [r, i, u] is the node of row r that leads to u.

    This node, E(r, j, u - j), lies at i * width + pad + (u - j) in row r of `padded`, with `pad` columns of
    padding and j = i - pad: at i * (width - 1) + 2 * pad + u. So a view does what a copy with indices would
    do. It reaches neither before nor behind the columns of its slope, and what it meets beside the graph is
    padding, -inf.
    """
    rows, slopes, width = padded.shape
    pad = slopes // 2
    row_bytes, slope_bytes, column_bytes = padded.strides
    shape = (rows, slopes, width - 2 * pad)
    strides = (row_bytes, slope_bytes - column_bytes, column_bytes)
    return as_strided(padded[:, 0, 2 * pad :], shape, strides, writeable=False)


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
