# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Shortest paths from the bottom to the top of a picture, by dynamic programming (Algorithms 1 and 2).

Good for anything long and continuous that crosses a picture once in every row: a lane on the road, a
blood vessel, a seam, a horizon (turn the picture on its side). Make a cost that is small on the thing
looked for; the shortest path then runs along it:

>>> import numpy as np
>>> picture = np.zeros((5, 6))
>>> picture[range(5), [4, 3, 3, 2, 2]] = 255  # a bright vessel on dark ground
>>> vessel = shortest_paths(1 - picture / 255, k=1, smoothness=0.1)
>>> vessel.best().tolist()
[4, 3, 3, 2, 2]

Every node has edges to the 2k + 1 nearest nodes of the next row, so one sweep of the rows finds the
shortest paths to *all* nodes in time and space O(k * nodes). A path that runs from side to side, or
from top to bottom, is found in the transposed or flipped array.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float32]
Columns = NDArray[np.int32]

BLOCK_NODES = 1 << 15  # nodes worked on at once when parents are found: their arrays fit a core's cache


@dataclass(frozen=True, eq=False)
class ShortestPaths:
    """The shortest paths from the bottom row to every node of a graph of rows x columns nodes.

    `cumulative_cost` (rows, columns) float32 is the paper's E: the cost of the shortest path from any node
    of the last row to this node; inf where no path leads. `parents` (rows, columns) int32 is the paper's P:
    the column, in the row below, of the node that the path comes from; -1 in the last row and where no
    path leads.
    """

    cumulative_cost: Floats
    parents: Columns

    def path(self, column: int) -> Columns:
        """Return the shortest path to the top node in `column`: its column in every row, top (row 0) first.

        Raises ValueError when there is no such node or no path leads to it.
        """
        here = int(_checked_tops([column], self.cumulative_cost[0])[0])
        path = [here]
        for parents in self.parents[:-1]:  # a tenth of the time that `paths` takes for one
            here = parents.item(here)
            path.append(here)
        return np.array(path, np.int32)

    def paths(self, columns: ArrayLike) -> Columns:
        """Return the shortest paths to the top nodes in `columns` (n,): (n, rows), each as of `path`.

        Raises ValueError when one of them is not in the graph or no path leads to it.
        """
        tops = _checked_tops(columns, self.cumulative_cost[0])
        steps = np.empty((len(self.parents), len(tops)), np.int32)
        steps[0] = tops
        for parents, here, below in zip(self.parents[:-1], steps[:-1], steps[1:], strict=True):
            np.take(parents, here, out=below, mode="clip")  # this mode fills `out` without a copy
        return np.ascontiguousarray(steps.T)

    def best(self) -> Columns:
        """Return the path, as of `path`, to the top node of least cost (the leftmost of equals).

        Raises ValueError when no path leads to the top row.
        """
        return self.path(int(self.cumulative_cost[0].argmin()))


def shortest_paths(cost: ArrayLike, k: int = 1, smoothness: float = 0.0) -> ShortestPaths:
    """Find the shortest paths from the bottom row of a graph to all its nodes.

    Algorithm 2 without the lanes; with smoothness 0 it is Algorithm 1.
    With v counted from the bottom row v = 1, E(u, 1) = 0 and::

        E(u, v) = cost(u, v) + min over |j| <= k of E(u - j, v - 1) + smoothness * j^2.

    So an edge costs what the node it *enters* costs, as in eq. (1) with F[P, (u, v)] = 1 - f(u, v), and the
    bottom node's own cost does not count, as Algorithm 1 sets it. Of parents that cost the same the one with
    the least `abs(j)` is taken, then the left one.

    Args:
        cost: (rows, columns), the cost of each node, of any sign; inf forbids a node, in the last row too.
        k: the most columns >= 0 that a path moves from one row to the next.
        smoothness: the paper's lambda >= 0: a step of j columns costs smoothness * j^2.

    Raises:
        ValueError: the cost is not a picture of numbers above -inf, or k or smoothness is out of range.
    """
    cost = _checked_cost(cost)
    _check_parameters(k, smoothness)
    rows, columns = cost.shape
    k = min(int(k), columns - 1)
    penalty = (smoothness * np.arange(-k, k + 1.0) ** 2).astype(np.float32)
    # k columns of inf on each side: no path leads there, and every node has 2k + 1 neighbours
    padded = np.full((rows, columns + 2 * k), np.inf, np.float32)
    E = padded[:, k : k + columns]
    E[-1] = np.where(np.isinf(cost[-1]), cost[-1], 0)
    arrival = np.full((rows, columns), np.inf, np.float32)  # E without the node's own cost
    _sweep(cost, penalty, padded, arrival)
    return ShortestPaths(E, _parents(padded, arrival, penalty))


def _sweep(cost: Floats, penalty: Floats, padded: Floats, arrival: Floats) -> None:
    """Fill `arrival` and `padded` from the second-last row up to row 0.

    Only the minimum is taken here: which neighbour gave it is asked of many rows at once afterwards, which
    is much faster than an argmin in every row.
    """
    columns, reach = cost.shape[1], len(penalty)
    neighbours = sliding_window_view(padded, reach, axis=1).transpose(0, 2, 1)  # (rows, 2k + 1, columns)
    E = padded[:, reach // 2 : reach // 2 + columns]
    candidates = np.empty((reach, columns), np.float32)
    penalties = penalty[:, np.newaxis]
    upwards = slice(-2, None, -1)
    rows = zip(neighbours[:0:-1], arrival[upwards], E[upwards], cost[upwards], strict=True)
    for below, least, total, own in rows:
        np.add(below, penalties, out=candidates)
        np.minimum.reduce(candidates, axis=0, out=least)
        np.add(least, own, out=total)


def _parents(padded: Floats, arrival: Floats, penalty: Floats) -> Columns:
    """Return the column of each node's parent: the neighbour whose E + penalty is the arrival cost."""
    rows, columns = arrival.shape
    k = len(penalty) // 2
    steps = np.array(sorted(range(-k, k + 1), key=lambda j: (abs(j), j), reverse=True), np.int32)
    parents = np.empty((rows, columns), np.int32)
    block = max(1, BLOCK_NODES // columns)
    for top in range(0, rows - 1, block):
        here = slice(top, min(top + block, rows - 1))
        choice = _last_match(padded[here.start + 1 : here.stop + 1], arrival[here], penalty, steps)
        np.add(steps[choice], np.arange(columns, dtype=np.int32), out=parents[here])
    # Also a forbidden node has an arrival cost, but no path ends in it.
    parents[np.isinf(padded[:, k : k + columns])] = -1
    parents[-1] = -1
    return parents


def _last_match(
    below: Floats, arrival: Floats, penalty: Floats, steps: Columns
) -> NDArray[np.uint8] | NDArray[np.uint32]:
    """Return the index of the last of `steps` that leads from the rows `below` at the cost of `arrival`."""
    k, columns = len(penalty) // 2, arrival.shape[1]
    index_type = np.uint8 if len(steps) <= 256 else np.uint32
    choice, match = np.zeros(arrival.shape, index_type), np.empty(arrival.shape, index_type)
    total, equal = np.empty(arrival.shape, np.float32), np.empty(arrival.shape, np.bool_)
    for i, j in enumerate(steps.tolist()):
        np.add(below[:, k + j : k + j + columns], penalty[k + j], out=total)
        np.equal(total, arrival, out=equal)
        np.multiply(equal.view(np.uint8), index_type(i), out=match)  # faster than to copy where equal
        np.maximum(choice, match, out=choice)
    return choice


def _checked_cost(cost: ArrayLike) -> Floats:
    picture = np.asarray(cost, dtype=np.float32)
    if picture.ndim != 2 or picture.size == 0:
        raise ValueError(f"cost has shape {picture.shape}, expected (rows, columns), both at least 1")
    if not picture.min() > -np.inf:  # a minimum is NaN when any value is
        raise ValueError("cost holds NaN or -inf, expected numbers (inf forbids a node)")
    return picture


def _check_parameters(k: int, smoothness: float) -> None:
    if k != int(k) or k < 0:
        raise ValueError(f"k is {k}, expected a whole number of columns >= 0")
    if not 0 <= smoothness < np.inf:
        raise ValueError(f"smoothness is {smoothness}, expected a finite number >= 0")


def _checked_tops(columns: ArrayLike, costs: Floats) -> NDArray[np.intp]:
    tops = np.atleast_1d(np.asarray(columns))
    if tops.size and not np.issubdtype(tops.dtype, np.integer):
        raise ValueError(f"columns are of type {tops.dtype}, expected whole numbers")
    tops = tops.astype(np.intp)
    outside = tops[(tops < 0) | (tops >= len(costs))]
    if len(outside):
        raise ValueError(f"column {outside[0]} is not in the graph, expected 0 to {len(costs) - 1}")
    unreachable = tops[np.isinf(costs[tops])]
    if len(unreachable):
        raise ValueError(f"no path leads to the top node in column {unreachable[0]}")
    return tops
