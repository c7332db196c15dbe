# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The pictures of bench_shortest_paths: time against size, and the paper's toy graph."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from lane_dp_ros.core.dp.shortest_paths import ShortestPaths, shortest_paths

MARKERS = "osv^D*"
POINTS_PER_COST = 0.45  # width of an edge of the toy graph: linear in its cost


def draw_times(curves: dict[str, dict[int, float]], title: str, path: Path) -> None:
    """Draw seconds over number of nodes, a curve for each name."""
    figure = Figure(figsize=(7.5, 6), layout="constrained")
    axes = figure.add_subplot()
    for (name, seconds), marker in zip(curves.items(), MARKERS, strict=False):
        sizes, times = np.transpose(sorted(seconds.items()))
        axes.loglog(sizes, 1e3 * times, f"{marker}-", label=name)
    axes.set(xlabel="number of nodes P", ylabel="time of a search [ms]", title=title)
    axes.grid(which="major", color="0.9")
    figure.legend(title="measured growth", loc="outside lower center", ncols=2)
    figure.savefig(path, dpi=120)


def draw_toy_graph(path: Path) -> None:
    """Draw the paper's toy: a 7 x 7 graph, k = 1, the shortest paths to all nodes of the top row in red."""
    cost = np.random.default_rng(4).integers(1, 10, (7, 7))
    found = shortest_paths(cost, k=1)
    figure = Figure(figsize=(6, 6.6), layout="constrained")
    axes = figure.add_subplot(xlim=(-0.5, 6.5), ylim=(6.5, -0.8), aspect="equal")
    axes.axis("off")
    axes.set_title(
        "Shortest paths (red) from the bottom row to every node of the top row\n"
        "An edge costs the number in the node above it, and is as thick as that",
        fontsize=10,
    )
    draw_edges(axes, cost, found)
    axes.scatter(*np.meshgrid(range(7), range(7)), s=330, color="white", edgecolors="black", zorder=3)
    for (row, column), value in np.ndenumerate(cost):
        grey = "0.75" if row == 6 else "black"  # the bottom node's own cost does not count
        axes.text(column, row, str(value), color=grey, ha="center", va="center", zorder=4)
    for column, total in enumerate(found.cumulative_cost[0]):
        axes.text(column, -0.45, f"E = {total:g}", ha="center", color="red")
    figure.savefig(path, dpi=120)


def draw_edges(axes: Axes, cost: np.ndarray, found: ShortestPaths) -> None:
    """Draw all edges of a graph with k = 1: black, those of shortest paths to the top row red and on top."""
    rows, columns = cost.shape
    red = {(v, path[v], path[v + 1]) for path in found.paths(range(columns)) for v in range(rows - 1)}
    for v, u in np.ndindex(rows - 1, columns):
        for below in range(max(0, u - 1), min(columns, u + 2)):
            on_path = (v, u, below) in red
            edge = LineCollection(
                [[(u, v), (below, v + 1)]],
                colors="red" if on_path else "black",
                linewidths=POINTS_PER_COST * cost[v, u],
                zorder=1 + on_path,
            )
            axes.add_collection(edge)
