# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Measure the paper's complexity table: our DP against general shortest path algorithms on the same graphs.

python benchmarks/bench_shortest_paths.py [-o DIR]
Writes shortest_paths.md (the table), shortest_paths.png (time against size) and toy_graph.png (the paper's
7 x 7 graph with its shortest paths).
"""

from __future__ import annotations

import argparse
import sys
import time
import tracemalloc
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from path_pictures import draw_times, draw_toy_graph
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import dijkstra, floyd_warshall
from skimage.graph import MCP, MCP_Flexible
from tqdm import tqdm

from lane_dp_ros.core.dp.shortest_paths import shortest_paths

K, SMOOTHNESS = 3, 2.0  # the paper's
PAPER_SHAPE = (600, 240)
SHAPES = ((60, 24), (120, 48), (190, 76), (380, 152), PAPER_SHAPE, (1200, 480))  # P = 1440 to 576000
SMALL_SHAPES = ((20, 8), (30, 12), (40, 16), (50, 20), (60, 24))  # P = 160 to 1440: all that is bearable
WANTED_RATIO = 15  # DP against scipy's Dijkstra at PAPER_SHAPE

Costs = NDArray[np.float64]
Search = Callable[[], Costs]  # returns E of the top row


def sparse_graph(cost: Costs, nodes: NDArray[np.intp]) -> csr_array:
    """Return the edges of a cost (rows, columns) whose nodes bear these numbers: [from, to] is their cost."""
    columns = cost.shape[1]
    starts, ends, weights = [], [], []
    for j in range(-K, K + 1):  # from column u - j of one row to column u of the next
        to = slice(max(0, j), columns + min(0, j))
        starts.append(nodes[1:, max(0, -j) : columns - max(0, j)].ravel())
        ends.append(nodes[:-1, to].ravel())
        weights.append(cost[:-1, to].ravel() + SMOOTHNESS * j * j)
    index = (np.concatenate(starts), np.concatenate(ends))
    return csr_array(coo_array((np.concatenate(weights), index), shape=(cost.size, cost.size)))


def prepare_dp(cost: Costs) -> Search:
    """Prepare our DP."""
    picture = cost.astype(np.float32)
    return lambda: np.asarray(shortest_paths(picture, K, SMOOTHNESS).cumulative_cost[0], np.float64)


def prepare_dijkstra(cost: Costs) -> Search:
    """Prepare scipy's Dijkstra (Fibonacci heap, as the paper's): one search from the whole bottom row."""
    nodes = np.arange(cost.size).reshape(cost.shape)
    graph = sparse_graph(cost, nodes)

    def search() -> Costs:
        found = dijkstra(graph, indices=nodes[-1], min_only=True, return_predecessors=True)
        return np.asarray(found[0][nodes[0]])

    return search


def prepare_floyd_warshall(cost: Costs, bottom_first: bool) -> Search:
    """Prepare scipy's Floyd-Warshall: the distances of all pairs of nodes, numbered from this end."""
    nodes = np.arange(cost.size).reshape(cost.shape)
    nodes = nodes[::-1] if bottom_first else nodes
    graph = sparse_graph(cost, nodes)
    return lambda: np.asarray(floyd_warshall(graph)[np.ix_(nodes[-1], nodes[0])].min(axis=0))


class SmoothMCP(MCP_Flexible):
    """skimage's minimum cost path with the price of a step aside, asked of Python for every edge."""

    def travel_cost(self, old_cost: float, new_cost: float, offset_length: float) -> float:  # noqa: ARG002
        """Return the cost of an edge; a step of j columns is sqrt(1 + j^2) long."""
        return new_cost + SMOOTHNESS * (offset_length * offset_length - 1)


def prepare_mcp(cost: Costs, kind: type[MCP]) -> Search:
    """Prepare a minimum cost path of skimage that moves upwards only, from the whole bottom row."""
    rows, columns = cost.shape
    entered = cost.copy()
    entered[-1] = 0  # skimage counts the start's own cost
    starts = [(rows - 1, u) for u in range(columns)]
    moves = [(-1, j) for j in range(-K, K + 1)]
    searcher = kind(entered, offsets=moves)
    return lambda: np.array(searcher.find_costs(starts)[0][0])


@dataclass
class Algorithm:
    """One line of the table: how to search, what the theory says, and what was measured."""

    name: str
    theory: str
    prepare: Callable[[Costs], Search]
    rounds: int
    shapes: tuple[tuple[int, int], ...] = SHAPES
    smoothness: float = SMOOTHNESS
    seconds: dict[int, float] = field(default_factory=dict)
    bytes_per_node: float = 0.0

    @property
    def shown(self) -> tuple[int, int]:
        """Return the size for the table: the paper's, or else the largest."""
        return PAPER_SHAPE if PAPER_SHAPE in self.shapes else max(self.shapes)

    @property
    def growth(self) -> float:
        """Return b of seconds = a * P^b, fitted to the logarithms of all sizes."""
        sizes, seconds = np.log(np.transpose(sorted(self.seconds.items())))
        return float(np.polyfit(sizes, seconds, 1)[0])


def algorithms() -> list[Algorithm]:
    """Return what is compared."""
    return [
        Algorithm("this DP (numpy)", "P", prepare_dp, 10),
        Algorithm("scipy dijkstra", "P log P", prepare_dijkstra, 10),
        Algorithm(
            "skimage MCP, lambda = 0", "P log P", lambda cost: prepare_mcp(cost, MCP), 4, smoothness=0.0
        ),
        Algorithm("skimage MCP_Flexible", "P log P", lambda cost: prepare_mcp(cost, SmoothMCP), 1),
        Algorithm(
            "scipy floyd_warshall, bottom row first",
            "P^3",
            lambda cost: prepare_floyd_warshall(cost, bottom_first=True),
            2,
            SMALL_SHAPES,
        ),
        Algorithm(
            "scipy floyd_warshall, top row first",
            "P^3",
            lambda cost: prepare_floyd_warshall(cost, bottom_first=False),
            4,
            SMALL_SHAPES,
        ),
    ]


def random_cost(shape: tuple[int, int]) -> Costs:
    """Return a cost in [0, 1), exact in float32, the same at every call."""
    return np.random.default_rng(shape[0]).random(shape, dtype=np.float32).astype(np.float64)


def measure(compared: list[Algorithm]) -> None:
    """Time all algorithms at all sizes: the best of the rounds, taking turns. Their answers are checked."""
    shapes = sorted({shape for algorithm in compared for shape in algorithm.shapes})
    with tqdm(total=len(shapes), unit="size", disable=None) as progress:
        for shape in shapes:
            progress.set_postfix_str(f"{shape[0]} x {shape[1]}")
            measure_at(shape, [algorithm for algorithm in compared if shape in algorithm.shapes])
            progress.update()


def measure_at(shape: tuple[int, int], compared: list[Algorithm]) -> None:
    """Time algorithms that take turns on one graph."""
    cost = random_cost(shape)
    searches = [algorithm.prepare(cost) for algorithm in compared]
    for algorithm, search in zip(compared, searches, strict=True):
        check_answer(algorithm, cost, search())
    for turn in range(max(algorithm.rounds for algorithm in compared)):
        for algorithm, search in zip(compared, searches, strict=True):
            if turn < algorithm.rounds:
                best = algorithm.seconds.get(cost.size, np.inf)
                algorithm.seconds[cost.size] = min(best, seconds_of(search))


def check_answer(algorithm: Algorithm, cost: Costs, costs_found: Costs) -> None:
    """Stop unless the costs of the top nodes are those that the DP finds."""
    expected = shortest_paths(cost, K, algorithm.smoothness).cumulative_cost[0]
    if not np.allclose(costs_found, expected, rtol=1e-5, atol=1e-4):
        worst = np.abs(costs_found - expected).max()
        sys.exit(f"{algorithm.name} and the DP differ by {worst:.3g} at {cost.shape}, expected equal costs")


def seconds_of(search: Search) -> float:
    """Return how long one search takes."""
    start = time.perf_counter()
    search()
    return time.perf_counter() - start


def measure_memory(algorithm: Algorithm) -> None:
    """Note the most memory that numpy holds while a graph is built and searched, without the cost itself."""
    cost = random_cost(algorithm.shown)
    tracemalloc.start()
    algorithm.prepare(cost)()
    algorithm.bytes_per_node = tracemalloc.get_traced_memory()[1] / cost.size
    tracemalloc.stop()


def table(compared: list[Algorithm]) -> Iterator[str]:
    """Yield the table in markdown, line by line."""
    yield "| algorithm | theory: time | measured | nodes | ms | bytes a node |"
    yield "|---|---|---|---|---|---|"
    for algorithm in compared:
        rows, columns = algorithm.shown
        milliseconds = 1e3 * algorithm.seconds[rows * columns]
        measured = f"P^{algorithm.growth:.2f} | {rows} x {columns} | {milliseconds:.1f}"
        yield f"| {algorithm.name} | {algorithm.theory} | {measured} | {algorithm.bytes_per_node:.0f} |"


def notes(compared: list[Algorithm]) -> str:
    """Return what one must know to read the table."""
    size = PAPER_SHAPE[0] * PAPER_SHAPE[1]
    dp, general, *_, bottom_first, top_first = compared
    ratio = general.seconds[size] / dp.seconds[size]
    return f"""
At {PAPER_SHAPE[0]} x {PAPER_SHAPE[1]} nodes, scipy's Dijkstra takes **{ratio:.1f} times** the DP's time (wanted: at least {WANTED_RATIO}).

P is the number of nodes. k = {K}, lambda = {SMOOTHNESS:g}, random costs, one core; the algorithms take turns, the best
of several rounds counts. All give the DP's costs of the top row (plain MCP, which knows no lambda, those of
lambda = 0): this is checked. A time is that of a search with its parents (scipy's Floyd-Warshall: without).
Building scipy's graph is not in the time, but in the memory, the most that numpy holds.
MCP and MCP_Flexible may move upwards only; MCP_Flexible asks Python for the cost of every edge.
The DP grows by less than P as numpy's calls, a few a row, still cost as much as the arithmetic.

The paper's table says O(P E) for Floyd-Warshall, which with E = (2k + 1) P edges would be O(P^2). The algorithm
is three loops over all nodes, O(P^3) in time and O(P^2) in space: measured is P^{bottom_first.growth:.2f} with the nodes
numbered as the paper does, the bottom row first. Only with the top row first it is O(P E), measured P^{top_first.growth:.2f}:
scipy passes over nodes that do not lead to the intermediate node yet, and in this order, which a graph with
cycles does not have, all but 2k + 1 do not.
"""  # noqa: E501 (numbers take the place of expressions)


def main() -> None:
    """Measure, print the table, write it and the pictures."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument(
        "-o", "--output", type=Path, default=Path("bench"), help="where to write (default: bench)"
    )
    output = parser.parse_args().output
    try:
        output.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        sys.exit(f"{output} cannot be made a directory ({error.strerror}), expected one to write to")
    draw_toy_graph(output / "toy_graph.png")
    compared = algorithms()
    measure(compared)
    for algorithm in compared:
        measure_memory(algorithm)
    text = "\n".join(table(compared)) + "\n" + notes(compared)
    (output / "shortest_paths.md").write_text(f"# Shortest paths: the complexity measured\n\n{text}")
    curves = {f"{a.name}: P^{a.growth:.2f}": a.seconds for a in compared}
    draw_times(curves, f"Shortest paths, k = {K}, $\\lambda$ = {SMOOTHNESS:g}", output / "shortest_paths.png")
    print(text)


if __name__ == "__main__":
    main()
