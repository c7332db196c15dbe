# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The shortest paths: by eye on small graphs, against Dijkstra's algorithm on random ones."""

from __future__ import annotations

import doctest

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from lane_dp_ros.core.dp import shortest_paths as module
from lane_dp_ros.core.dp.shortest_paths import ShortestPaths, shortest_paths

INF = np.inf

# A 7 x 7 graph as the paper's toy example: one cheap path (1 a node) winds through dear ground (5 a node).
TOY_PATH = [5, 4, 3, 2, 2, 3, 3]
TOY = np.full((7, 7), 5.0)
TOY[np.arange(7), TOY_PATH] = 1.0


def dijkstra_costs(cost: np.ndarray, k: int, smoothness: float) -> np.ndarray:
    """Return the cumulative cost of all nodes, by scipy, from one source below the bottom row.

    Every edge is lifted by 1 (an edge of weight 0 is no edge to scipy); a path to row v has as many
    edges whichever way it goes, so the lift comes off again exactly.
    """
    rows, columns = cost.shape
    nodes = np.arange(rows * columns).reshape(rows, columns)
    source = rows * columns
    edges = [(source, int(nodes[-1, u]), 1.0) for u in range(columns) if cost[-1, u] < INF]
    for v in range(rows - 1):
        for u in range(columns):
            for p in range(max(0, u - k), min(columns, u + k + 1)):
                if cost[v, u] < INF and cost[v + 1, p] < INF:
                    weight = cost[v, u] + smoothness * (u - p) ** 2
                    edges.append((int(nodes[v + 1, p]), int(nodes[v, u]), weight + 1))
    start, end, weights = np.array(edges or [(source, source, 1.0)]).T
    graph = coo_array((weights, (start.astype(int), end.astype(int))), shape=(source + 1, source + 1)).tocsr()
    distances = dijkstra(graph, indices=source)[:-1].reshape(rows, columns)
    return distances - np.arange(rows, 0, -1)[:, np.newaxis]


def cost_of(path: np.ndarray, cost: np.ndarray, smoothness: float) -> float:
    """Return what a path costs, summed as the definition says it."""
    entered = cost[np.arange(len(path) - 1), path[:-1]]
    return float(np.sum(entered) + smoothness * np.sum(np.diff(path.astype(float)) ** 2))


def assert_consistent(found: ShortestPaths, cost: np.ndarray, k: int, smoothness: float) -> None:
    """Every path that is reported keeps to the edges and costs what is reported; no other is reported."""
    tops = np.flatnonzero(np.isfinite(found.cumulative_cost[0]))
    for top, path in zip(tops, found.paths(tops), strict=True):
        assert path[0] == top
        assert np.all(np.abs(np.diff(path)) <= k)
        assert np.array_equal(path, found.path(int(top)))
        reported = found.cumulative_cost[0, top]
        assert cost_of(path, cost, smoothness) == pytest.approx(reported, rel=1e-5, abs=1e-4)
    unreachable = np.isinf(found.cumulative_cost)
    assert np.array_equal(found.parents[:-1] == -1, unreachable[:-1])
    assert np.all(found.parents[-1] == -1)


def test_sums_the_nodes_entered_but_not_the_bottom_node():
    found = shortest_paths([[3.0, 1.0], [2.0, 4.0], [9.0, 9.0]], k=1)
    assert found.cumulative_cost.tolist() == [[5.0, 3.0], [2.0, 4.0], [0.0, 0.0]]
    assert found.parents.tolist() == [[0, 0], [0, 1], [-1, -1]]
    assert found.paths([0, 1]).tolist() == [[0, 0, 0], [1, 0, 0]]
    assert found.cumulative_cost.dtype == np.float32


@pytest.mark.parametrize(("smoothness", "path"), [(0.0, [0, 2]), (0.2, [0, 2]), (0.3, [0, 0])])
def test_smoothness_costs_the_square_of_the_step(smoothness, path):
    """To get to column 2 costs 4 * smoothness and saves 1."""
    found = shortest_paths([[0.0, INF, INF], [0.0, INF, -1.0], [5.0, INF, 5.0]], k=2, smoothness=smoothness)
    assert found.path(0).tolist()[:2] == path


def test_a_negative_cost_is_a_reward():
    found = shortest_paths([[0.0, -2.0, 0.0], [0.0, 0.0, 0.0]], k=1)
    assert found.best().tolist() == [1, 1]
    assert found.cumulative_cost[0].tolist() == [0.0, -2.0, 0.0]


def test_of_equal_parents_the_straight_one_then_the_left_one():
    assert shortest_paths(np.zeros((2, 3)), k=2).parents[0].tolist() == [0, 1, 2]
    crossroads = [[0.0, 0.0, 0.0], [0.0, INF, 0.0]]
    assert shortest_paths(crossroads, k=2).parents[0].tolist() == [0, 0, 2]
    assert shortest_paths(np.ones((2, 3)), k=1).best().tolist() == [0, 0]


def test_a_wall_is_passed_where_it_is_open():
    cost = np.ones((4, 5))
    cost[2] = [INF, INF, INF, INF, 1.0]
    found = shortest_paths(cost, k=2)
    assert found.cumulative_cost[0].tolist() == [3.0] * 5
    assert found.path(0).tolist() == [0, 2, 4, 4]
    with pytest.raises(ValueError, match="no path leads to the top node in column 0"):
        shortest_paths(cost, k=1).path(0)


def test_a_closed_wall_lets_no_path_through():
    cost = np.ones((3, 2))
    cost[1] = INF
    found = shortest_paths(cost)
    assert np.all(np.isinf(found.cumulative_cost[:2]))
    assert np.all(found.parents == -1)
    with pytest.raises(ValueError, match="no path"):
        found.best()


def test_a_forbidden_bottom_node_starts_no_path():
    found = shortest_paths([[1.0, 1.0], [INF, 0.0]], k=0)
    assert found.cumulative_cost.tolist() == [[INF, 1.0], [INF, 0.0]]
    assert found.parents.tolist() == [[-1, 1], [-1, -1]]


def test_one_row_and_one_column():
    row = shortest_paths([[4.0, 2.0]], k=3)
    assert row.cumulative_cost.tolist() == [[0.0, 0.0]]
    assert row.path(1).tolist() == [1]
    column = shortest_paths([[4.0], [2.0], [1.0]], k=3, smoothness=1.0)
    assert column.cumulative_cost.tolist() == [[6.0], [2.0], [0.0]]
    assert column.best().tolist() == [0, 0, 0]


def test_the_papers_toy_graph():
    found = shortest_paths(TOY, k=1)
    assert found.best().tolist() == TOY_PATH
    assert found.cumulative_cost[0].min() == 6.0
    assert found.paths(range(7)).shape == (7, 7)
    assert_consistent(found, TOY, 1, 0.0)


def test_a_winding_vessel_is_found_in_a_noisy_picture():
    rows, columns = 200, 120
    truth = 60 + 30 * np.sin(np.arange(rows) / 25)
    distance = np.arange(columns) - truth[:, np.newaxis]
    noise = np.random.default_rng(7).normal(0, 0.25, (rows, columns))
    picture = np.exp(-0.5 * (distance / 1.5) ** 2) + noise
    path = shortest_paths(1 - picture, k=3, smoothness=0.1).best()
    assert np.median(np.abs(path - truth)) <= 1.0
    assert np.max(np.abs(path - truth)[:-3]) <= 5.0


@settings(deadline=None, max_examples=150)
@given(
    cost=npst.arrays(
        np.float32,
        npst.array_shapes(min_dims=2, max_dims=2, max_side=9),
        elements=st.one_of(st.floats(0, 10, width=32), st.integers(0, 2).map(float), st.just(INF)),
    ),
    k=st.integers(1, 5),
    smoothness=st.one_of(st.integers(0, 5).map(float), st.floats(0, 5)),
)
def test_costs_are_those_of_dijkstra(cost, k, smoothness):
    found = shortest_paths(cost, k, smoothness)
    expected = dijkstra_costs(cost, k, smoothness)
    np.testing.assert_allclose(found.cumulative_cost, expected, rtol=1e-5, atol=1e-4)
    assert_consistent(found, cost, k, smoothness)


@pytest.mark.parametrize("shape", [(400, 150), (3, 700)])
def test_large_and_wide_graphs_as_dijkstra(shape):
    """More rows than one block of the parents' search, and more neighbours than a byte can count."""
    cost = np.random.default_rng(3).random(shape).astype(np.float32)
    k = 3 if shape[0] > shape[1] else 1000
    found = shortest_paths(cost, k, 0.001)
    if k == 3:
        np.testing.assert_allclose(found.cumulative_cost, dijkstra_costs(cost, k, 0.001), rtol=1e-4)
    assert_consistent(found, cost, k, 0.001)


def test_the_input_is_left_alone_and_answers_repeat():
    cost = np.random.default_rng(1).random((30, 20))
    before = cost.copy()
    first, second = shortest_paths(cost, 2, 0.5), shortest_paths(cost[:, ::1], 2, 0.5)
    assert np.array_equal(cost, before)
    assert np.array_equal(first.parents, second.parents)


@pytest.mark.parametrize(
    ("cost", "k", "smoothness", "message"),
    [
        (np.ones(4), 1, 0.0, r"cost has shape \(4,\), expected \(rows, columns\)"),
        (np.ones((0, 4)), 1, 0.0, r"cost has shape \(0, 4\)"),
        (np.ones((2, 2, 3)), 1, 0.0, r"cost has shape \(2, 2, 3\)"),
        ([[1.0, np.nan]], 1, 0.0, "cost holds NaN or -inf"),
        ([[1.0, -INF]], 1, 0.0, "cost holds NaN or -inf"),
        (np.ones((2, 2)), -1, 0.0, "k is -1, expected a whole number of columns >= 0"),
        (np.ones((2, 2)), 1.5, 0.0, "k is 1.5"),
        (np.ones((2, 2)), 1, -0.1, "smoothness is -0.1, expected a finite number >= 0"),
        (np.ones((2, 2)), 1, INF, "smoothness is inf"),
        (np.ones((2, 2)), 1, np.nan, "smoothness is nan"),
    ],
)
def test_bad_input_is_refused_in_one_line(cost, k, smoothness, message):
    with pytest.raises(ValueError, match=message) as error:
        shortest_paths(cost, k, smoothness)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        ([7], "column 7 is not in the graph, expected 0 to 6"),
        ([0, -1], "column -1"),
        ([0.5], "whole numbers"),
    ],
)
def test_paths_to_nodes_that_are_not_there(columns, message):
    with pytest.raises(ValueError, match=message):
        shortest_paths(TOY).paths(columns)


def test_paths_of_no_nodes_are_none():
    assert shortest_paths(TOY).paths([]).shape == (0, 7)


def test_the_example_of_the_documentation_runs():
    assert doctest.testmod(module).attempted > 0
    assert doctest.testmod(module).failed == 0
