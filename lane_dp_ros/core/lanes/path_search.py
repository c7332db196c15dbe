# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Paths through the graph that may be lanes, best first: Algorithm 2, and its successor with free ends."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.config import PathSearchConfig
from lane_dp_ros.core.dp.free_end_paths import free_paths, segment_gain
from lane_dp_ros.core.dp.shortest_paths import shortest_paths
from lane_dp_ros.core.types import LanePath, PaintMap

Floats = NDArray[np.float32]

SEGMENT = 1.0  # m; length of a straight piece of a free path
SLOPE_MAX = 0.35  # lateral over forward; the road's axis takes the rest of a bend
SLOPE_COST = 4.0  # m of paint per m and slope^2
BEND_COST = 0.14  # m of paint per change of slope by one column
FREE_PASSES = 4
CLOSED = -0.3  # gain where an accepted path has been
APART = 1.2  # m; paths nearer to a better one of the same pass wait for the next pass


def find_paths(graph: PaintMap, resolution: tuple[float, float], config: PathSearchConfig) -> list[LanePath]:
    """Return candidate paths, best first; none where nothing looks like paint.

    `resolution` is the graph's metres per row and column.
    """
    search = _free if config.free_ends else _full_height
    return search(graph, resolution, config)


def _full_height(
    graph: PaintMap, resolution: tuple[float, float], config: PathSearchConfig
) -> list[LanePath]:
    """Return the paths of Algorithm 2, each from the bottom to the top row.

    Take the path of least cumulative cost, close a band around it - whether it will be accepted or not -
    and search again, until the mean cost over the rows that are seen exceeds `config.max_mean_cost` (the
    paper's epsilon).
    """
    per_row, per_column = resolution
    half_band = max(1, round(config.suppression / per_column))
    cost = graph.cost
    rows = np.arange(len(cost))[::-1]
    found: list[LanePath] = []
    while len(found) < config.max_paths and np.isfinite(cost).any(axis=1).all():
        paths = shortest_paths(cost, config.neighbours, config.smoothness)
        if not np.isfinite(paths.cumulative_cost[0]).any():
            break
        columns = paths.best()[::-1]
        seen = graph.seen[rows, columns]
        along = graph.feature[rows, columns][seen]
        if not along.size or 1 - along.mean() > config.max_mean_cost:
            break
        found.append(LanePath(rows[seen], columns[seen].astype(np.float64), float(along.sum()) * per_row))
        near = np.abs(np.arange(cost.shape[1]) - columns[::-1, None]) <= half_band
        cost = np.where(near, np.inf, cost).astype(np.float32)
    return found


def _free(graph: PaintMap, resolution: tuple[float, float], config: PathSearchConfig) -> list[LanePath]:
    """Return paths with free ends, scored by the metres of paint less what blank road and bends cost.

    Every pass yields all paths that keep clear of better ones; a narrow band around each is closed for
    the next pass, in which a line close beside it can show up.
    """
    search = _FreeSearch(graph, resolution, config)
    for _ in range(FREE_PASSES):
        if not search.run_pass():
            break
    return sorted(search.found, key=lambda path: -path.score)


class _FreeSearch:
    """The state of the repeated search with free ends. Rows run from near to far in here."""

    def __init__(self, graph: PaintMap, resolution: tuple[float, float], config: PathSearchConfig) -> None:
        per_row, self.per_column = resolution
        self.config = config
        self.step = max(1, round(SEGMENT / per_row))
        self.segment = self.step * per_row
        self.max_slope = int(SLOPE_MAX * self.segment / self.per_column + 1e-6)
        self.rows = len(graph.feature)
        blocks = self.rows // self.step
        self.reward = (
            np.where(graph.seen, graph.feature - config.blank_cost, 0).astype(np.float32)[::-1].copy()
        )
        self.taken = np.zeros((blocks, graph.feature.shape[1]), bool)
        slopes = np.arange(-self.max_slope, self.max_slope + 1) * self.per_column / self.segment
        self.slope_cost = (SLOPE_COST * self.segment * slopes**2).astype(np.float32)
        self.found: list[LanePath] = []

    def run_pass(self) -> bool:
        """Search once; return whether anything was found."""
        gain = segment_gain(self.reward, self.max_slope, self.step)
        gain *= np.float32(self.segment)
        gain -= self.slope_cost[:, None]
        paths = free_paths(gain, BEND_COST)
        score = np.where(self.taken, 0, paths.score)
        highest = score >= cv2.dilate(score, np.ones((3, 5), np.uint8))
        rows, columns = np.nonzero(highest & (score >= self.config.min_score))
        busy = np.zeros_like(self.taken)
        before = len(self.found)
        for i in np.argsort(-score[rows, columns], kind="stable"):
            if len(self.found) >= self.config.max_paths:
                break
            if busy[rows[i], columns[i]]:
                continue
            nodes = paths.trace(rows[i], columns[i])
            if busy[nodes[:, 0], nodes[:, 1]].any():  # shares a better path: its rest waits for the next pass
                self._mark(busy, nodes[:, 0], nodes[:, 1], self.config.suppression)
            else:
                self._accept(nodes, float(score[rows[i], columns[i]]), busy)
        return len(self.found) > before

    def _accept(self, nodes: NDArray[Any], score: float, busy: NDArray[np.bool_]) -> None:
        """Keep the path, close a band around it and let its neighbourhood wait."""
        block, column, slope = nodes.T
        inside = np.arange(self.step)
        rows = (block[:, None] * self.step + inside).ravel()
        shift = (slope - self.max_slope)[:, None] * (inside + 0.5) / self.step
        columns = np.clip((column[:, None] + shift).ravel(), 0, self.reward.shape[1] - 1)
        self.found.append(LanePath(self.rows - 1 - rows, columns, score))
        half = self._cells(self.config.suppression)
        self.reward[_band(rows, np.rint(columns).astype(int), half, self.reward.shape[1])] = CLOSED
        self._mark(self.taken, block, column, self.config.suppression)
        self._mark(busy, block, column, APART)

    def _mark(
        self, cells: NDArray[np.bool_], rows: NDArray[Any], columns: NDArray[Any], width: float
    ) -> None:
        cells[_band(rows, columns, self._cells(width), cells.shape[1])] = True

    def _cells(self, width: float) -> int:
        return round(width / self.per_column)


def _band(
    rows: NDArray[Any], columns: NDArray[Any], half: int, width: int
) -> tuple[NDArray[Any], NDArray[Any]]:
    """Return the index of the cells within `half` columns of cells (rows[i], columns[i])."""
    near = columns[:, None] + np.arange(-half, half + 1)
    return rows[:, None], np.clip(near, 0, width - 1)
