# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Paths through the graph that may be lanes, best first: Algorithm 2, and its successor with free ends."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.birdseye.paint_map import PaintMap
from lane_dp_ros.core.birdseye.paint_profile import paint_gain
from lane_dp_ros.core.dp.free_end_paths import FreePaths, free_paths, segment_gain
from lane_dp_ros.core.dp.shortest_paths import shortest_paths
from lane_dp_ros.core.lanes.candidate import LanePath
from lane_dp_ros.core.parameter import Parameters, parameter

Floats = NDArray[np.float32]
Nodes = NDArray[np.int32]

SEGMENT = 1.0  # m; length of a straight piece of a free path
CLOSED = -0.3  # gain where an accepted path has been


@dataclass(frozen=True)
class PathSearchConfig(Parameters):
    """The search for paths through the graph."""

    free_ends: bool = parameter(
        True,
        "Paths start and end where the paint does and remember their slope; else the paper's Algorithm 2.",
    )
    max_paths: int = parameter(12, "At most so many candidates.", limits=(1, 50))
    suppression: float = parameter(
        0.3, "Half width of the band closed around a path that was found.", unit="m", limits=(0.1, 2.0)
    )
    min_score: float = parameter(
        1.5, "Metres of paint that make a candidate; for free ends.", unit="m", limits=(0.5, 20.0)
    )
    blank_cost: float = parameter(
        0.14, "Metres of paint that a metre of blank road costs; for free ends.", limits=(0.01, 1.0)
    )
    slope_max: float = parameter(
        0.35,
        "Steepest lateral over forward of a path; the road's axis takes the rest of a bend; for free ends.",
        limits=(0.05, 1.0),
        expert=True,
    )
    slope_cost: float = parameter(
        4.0,
        "Metres of paint that a metre of path costs per squared slope; for free ends.",
        limits=(0.0, 100.0),
        expert=True,
    )
    bend_cost: float = parameter(
        0.14,
        "Metres of paint that a change of slope by one column a metre costs; for free ends.",
        unit="m",
        limits=(0.0, 10.0),
        expert=True,
    )
    separation_min: float = parameter(
        1.2,
        "Paths nearer to a better one of the same pass wait for the next pass; for free ends.",
        unit="m",
        limits=(0.1, 5.0),
        expert=True,
    )
    passes: int = parameter(
        2,
        "How often the graph is searched, what was found closed for the next time; for free ends.",
        limits=(1, 10),
        expert=True,
    )
    neighbours: int = parameter(
        3, "k, columns by which a path may move from row to row; for Algorithm 2.", limits=(1, 10)
    )
    smoothness: float = parameter(
        2.0, "lambda, cost of moving by j columns is lambda j^2; for Algorithm 2.", limits=(0.0, 100.0)
    )
    max_mean_cost: float = parameter(
        0.65, "epsilon, mean cost along a path that ends the search; for Algorithm 2.", limits=(0.0, 1.0)
    )


class SearchGraph(Protocol):
    """What is searched: how much each node (rows, columns) gains, f in [0, 1], where it is `seen`."""

    @property
    def feature(self) -> Floats:
        """How much each node looks like what is searched, in [0, 1]."""

    @property
    def seen(self) -> NDArray[np.bool_]:
        """Nodes of which that is known."""


class PathSearch(Protocol):
    """Proposes paths through the graph."""

    def find(self, paint_map: PaintMap, resolution: tuple[float, float]) -> list[LanePath]:
        """Return candidate paths, best first; none where nothing looks like paint.

        `resolution` is the graph's metres per row and column.
        """


class FullHeightSearch:
    """The paths of Algorithm 2, each from the bottom to the top row.

    Take the path of least cumulative cost, close a band around it - whether it will be accepted or not -
    and search again, until the mean cost over the rows that are seen exceeds `max_mean_cost` (the paper's
    epsilon).
    """

    def __init__(self, config: PathSearchConfig) -> None:
        self._config = config

    def find(self, paint_map: PaintMap, resolution: tuple[float, float]) -> list[LanePath]:
        """See `PathSearch`."""
        per_row, per_column = resolution
        half_band = max(1, round(self._config.suppression / per_column))
        cost = paint_map.cost
        rows = np.arange(len(cost))[::-1]
        found: list[LanePath] = []
        while len(found) < self._config.max_paths and np.isfinite(cost).any(axis=1).all():
            paths = shortest_paths(cost, self._config.neighbours, self._config.smoothness)
            if not np.isfinite(paths.cumulative_cost[0]).any():
                break
            columns = paths.best()[::-1]
            seen = paint_map.seen[rows, columns]
            along = paint_map.feature[rows, columns][seen]
            if not along.size or 1 - along.mean() > self._config.max_mean_cost:
                break
            found.append(
                LanePath(
                    rows[seen],
                    columns[seen].astype(np.float64),
                    float(paint_gain(along, 0.0).sum()) * per_row,
                )
            )
            near = np.abs(np.arange(cost.shape[1]) - columns[::-1, None]) <= half_band
            cost = np.where(near, np.inf, cost).astype(np.float32)
        return found


class FreeEndSearch:
    """Paths with free ends, scored by the metres of paint less what blank road, slope and bends cost.

    Every pass yields all paths that keep clear of better ones; a narrow band around each is closed for
    the next pass, in which a line close beside it can show up.
    """

    def __init__(self, config: PathSearchConfig) -> None:
        self._config = config

    def find(self, paint_map: SearchGraph, resolution: tuple[float, float]) -> list[LanePath]:
        """See `PathSearch`; any graph will do."""
        passes = _FreeEndPasses(paint_map, resolution, self._config)
        for _ in range(self._config.passes):
            if not passes.run():
                break
        return sorted(passes.found, key=lambda path: -path.score)


def path_search(config: PathSearchConfig) -> PathSearch:
    """Return the search that `config.free_ends` chooses."""
    return FreeEndSearch(config) if config.free_ends else FullHeightSearch(config)


class _FreeEndPasses:
    """The state of the repeated search with free ends. Rows run from near to far in here."""

    def __init__(self, graph: SearchGraph, resolution: tuple[float, float], config: PathSearchConfig) -> None:
        per_row, self.per_column = resolution
        self.config = config
        self.step = max(1, round(SEGMENT / per_row))
        self.segment = self.step * per_row
        self.max_slope = int(config.slope_max * self.segment / self.per_column + 1e-6)
        self.rows = len(graph.feature)
        blocks = self.rows // self.step
        gain = paint_gain(graph.feature, config.blank_cost)
        self.reward = np.where(graph.seen, gain, 0).astype(np.float32)[::-1].copy()
        self.taken = np.zeros((blocks, graph.feature.shape[1]), bool)
        slopes = np.arange(-self.max_slope, self.max_slope + 1) * self.per_column / self.segment
        self.slope_cost = (config.slope_cost * self.segment * slopes**2).astype(np.float32)
        self.found: list[LanePath] = []

    def run(self) -> bool:
        """Search once, and close bands around what is found; return whether to search again."""
        gain = segment_gain(self.reward, self.max_slope, self.step, self.segment, self.slope_cost)
        paths = free_paths(gain, self.config.bend_cost)
        score = np.where(self.taken, 0, paths.score)
        ends = self._clear_of_better_ones(paths, score)
        for nodes in ends:
            self._accept(nodes, float(score[nodes[-1, 0], nodes[-1, 1]]))
        if not ends or len(self.found) == self.config.max_paths:
            return False
        self._close(np.concatenate(ends))
        return True

    def _clear_of_better_ones(self, paths: FreePaths, score: Floats) -> list[Nodes]:
        """Return the nodes of the paths of high `score`, best first, that keep clear of better ones."""
        highest = score >= cv2.dilate(score, np.ones((3, 5), np.uint8))
        rows, columns = np.nonzero(highest & (score >= self.config.min_score))
        busy = np.zeros_like(self.taken)
        clear: list[Nodes] = []
        for i in np.argsort(-score[rows, columns], kind="stable"):
            if len(self.found) + len(clear) >= self.config.max_paths:
                break
            if busy[rows[i], columns[i]]:
                continue
            nodes = paths.trace(rows[i], columns[i])
            width = self.config.separation_min
            if busy[nodes[:, 0], nodes[:, 1]].any():  # shares a better path: its rest waits for the next pass
                width = self.config.suppression
            else:
                clear.append(nodes)
            busy[self._band(nodes[:, 0], nodes[:, 1], width)] = True
        return clear

    def _accept(self, nodes: Nodes, score: float) -> None:
        rows, columns = self._cells(nodes)
        self.found.append(LanePath(self.rows - 1 - rows, columns, score))

    def _close(self, nodes: Nodes) -> None:
        """Close a narrow band around nodes of accepted paths for the next pass."""
        rows, columns = self._cells(nodes)
        self.reward[self._band(rows, np.rint(columns).astype(int), self.config.suppression)] = CLOSED
        self.taken[self._band(nodes[:, 0], nodes[:, 1], self.config.suppression)] = True

    def _cells(self, nodes: Nodes) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
        """Return the rows and columns (N step,) of the straight pieces that start in nodes (N, 3)."""
        block, column, slope = nodes.T
        inside = np.arange(self.step)
        rows = (block[:, None] * self.step + inside).ravel()
        shift = (slope - self.max_slope)[:, None] * (inside + 0.5) / self.step
        columns = (column[:, None] + shift).ravel()
        return rows, np.minimum(np.maximum(columns, 0), self.reward.shape[1] - 1)

    def _band(self, rows: NDArray[Any], columns: NDArray[Any], width: float) -> tuple[Any, Any]:
        """Return the index of the cells up to `width` [m] aside of cells (rows[i], columns[i])."""
        half = round(width / self.per_column)
        near = columns[:, None] + np.arange(-half, half + 1)
        return rows[:, None], np.minimum(np.maximum(near, 0), self.reward.shape[1] - 1)
