# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The smooth paths with free ends: by eye on small graphs, against every path there is on tiny ones."""

from __future__ import annotations

import doctest
from collections.abc import Iterator

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst

from lane_dp_ros.core.dp import free_end_paths as module
from lane_dp_ros.core.dp.free_end_paths import free_paths, segment_gain

INF = np.inf


def all_paths(shape: tuple[int, int, int]) -> Iterator[list[tuple[int, int, int]]]:
    """Every path of a graph (rows, slopes, columns), grown node by node: no dynamic programming."""
    rows, slopes, columns = shape
    growing = [[(r, u, i)] for r in range(rows) for u in range(columns) for i in range(slopes)]
    while growing:
        path = growing.pop()
        yield path
        r, u, i = path[-1]
        next_u = u + i - slopes // 2
        if r + 1 < rows and 0 <= next_u < columns:
            growing += [[*path, (r + 1, next_u, n)] for n in (i - 1, i, i + 1) if 0 <= n < slopes]


def gain_of(path: list[tuple[int, int, int]] | np.ndarray, gain: np.ndarray, bend_penalty: float) -> float:
    """Return what a path gains, summed as the definition says it."""
    row, column, slope = np.transpose(path)
    return float(np.sum(gain[row, slope, column]) - bend_penalty * np.sum(np.abs(np.diff(slope))))


@settings(deadline=None, max_examples=100)
@given(
    gain=npst.arrays(
        np.float32,
        st.tuples(st.integers(1, 4), st.sampled_from([1, 3, 5]), st.integers(1, 4)),
        elements=st.one_of(st.floats(-3, 3, width=16), st.integers(-1, 1).map(float), st.just(-INF)),
    ),
    bend_penalty=st.sampled_from([0.0, 0.25, 1.0, 3.0]),
)
def test_scores_are_those_of_the_best_of_all_paths(gain, bend_penalty):
    best = np.full(gain.shape, -INF)
    for path in all_paths(gain.shape):
        row, column, slope = path[-1]
        best[row, slope, column] = max(best[row, slope, column], gain_of(path, gain, bend_penalty))
    found = free_paths(gain, bend_penalty)
    np.testing.assert_allclose(found.values, best, rtol=1e-5, atol=1e-5)
    assert np.array_equal(found.score, found.values.max(axis=1))
    for row, column in np.argwhere(np.isfinite(found.score)):
        nodes = found.trace(row, column)
        assert tuple(nodes[-1]) == (row, column, found.slope[row, column])
        assert gain_of(nodes, gain, bend_penalty) == pytest.approx(found.score[row, column], abs=1e-4)
        assert_connected(nodes, gain.shape[1])


def assert_connected(nodes, slopes):
    rows, columns, slope = nodes.T
    assert np.all(np.diff(rows) == 1)
    assert np.array_equal(np.diff(columns), slope[:-1] - slopes // 2)
    assert np.all(np.abs(np.diff(slope)) <= 1)


def test_a_path_starts_and_ends_where_it_gains_most():
    gain = np.array([-1.0, 2.0, -1.0, 2.0, -3.0, 1.0]).reshape(6, 1, 1)
    found = free_paths(gain, 0.0)
    assert found.score[:, 0].tolist() == [-1.0, 2.0, 1.0, 3.0, 0.0, 1.0]
    assert found.trace(3, 0).tolist() == [[1, 0, 0], [2, 0, 0], [3, 0, 0]]
    assert found.trace(0, 0).tolist() == [[0, 0, 0]]
    assert found.trace(5, 0).tolist() == [[5, 0, 0]]  # going on from 0 gains nothing


def test_a_steady_slope_is_free_and_a_bend_is_not():
    gain = np.full((4, 3, 4), -1.0)
    gain[[0, 1, 2, 3], 2, [0, 1, 2, 3]] = 1.0  # the diagonal, one column to the right a row
    found = free_paths(gain, bend_penalty=0.5)
    assert found.score[3, 3] == 4.0
    assert found.trace(3, 3).tolist() == [[0, 0, 2], [1, 1, 2], [2, 2, 2], [3, 3, 2]]
    gain[3, 2, 3], gain[3, 1, 3] = -1.0, 1.0  # straight on in the last row
    bent = free_paths(gain, bend_penalty=0.5)
    assert bent.score[3, 3] == 3.5
    assert bent.slope[3, 3] == 1


def test_of_equal_slopes_the_straightest():
    found = free_paths(np.ones((2, 5, 3)), 1.0)
    assert np.all(found.slope[0] == 2)
    assert found.trace(1, 1).tolist() == [[0, 1, 2], [1, 1, 2]]


def test_segments_average_the_reward_along_their_slope():
    reward = np.arange(8.0).reshape(2, 4)
    gain = segment_gain(reward, max_slope=2, step=2)
    assert gain.shape == (1, 5, 4)
    assert gain[0, 2].tolist() == [2.0, 3.0, 4.0, 5.0]  # straight on: (0 + 4) / 2 ...
    assert gain[0, 4].tolist() == [3.0, 4.0, -INF, -INF]  # columns u + 0.5 and u + 1.5: u and u + 2
    assert gain[0, 0].tolist() == [-INF, -INF, 3.0, 4.0]  # the same to the left


def test_segments_leave_out_an_unfinished_block():
    assert segment_gain(np.ones((7, 5)), max_slope=0, step=3).tolist() == [[[1.0] * 5]] * 2


def test_a_curved_dashed_line_is_found_from_its_start_to_its_end():
    """A parabola, painted from row 40 to row 199 with gaps, in noise."""
    rows, columns, step = 240, 160, 4
    v = np.arange(rows)
    truth = 30 + 0.002 * v**2
    paint = (np.abs(np.arange(columns) - truth[:, np.newaxis]) < 1.5) * 1.0
    paint[(v < 40) | (v >= 200) | (v % 40 >= 28)] = 0
    picture = paint + np.random.default_rng(5).normal(0, 0.1, paint.shape)
    found = free_paths(segment_gain(picture - 0.3, max_slope=5, step=step), bend_penalty=0.1)
    nodes = found.trace(*np.unravel_index(found.score.argmax(), found.score.shape))
    assert (nodes[0, 0] * step, nodes[-1, 0] * step) == (40, 184)  # the last paint: rows 160 to 187
    assert np.max(np.abs(nodes[:, 1] - truth[nodes[:, 0] * step])) <= 2.0


@pytest.mark.parametrize(
    ("gain", "bend_penalty", "message"),
    [
        (np.ones((3, 3)), 1.0, r"gain has shape \(3, 3\), expected \(rows, slopes, columns\), slopes odd"),
        (np.ones((3, 2, 3)), 1.0, r"gain has shape \(3, 2, 3\)"),
        (np.ones((0, 3, 3)), 1.0, r"gain has shape \(0, 3, 3\)"),
        ([[[np.nan]]], 1.0, "gain holds NaN or inf"),
        ([[[INF]]], 1.0, "gain holds NaN or inf"),
        (np.ones((3, 3, 3)), -1.0, "bend_penalty is -1.0, expected a finite number >= 0"),
        (np.ones((3, 3, 3)), np.nan, "bend_penalty is nan"),
    ],
)
def test_bad_gain_is_refused(gain, bend_penalty, message):
    with pytest.raises(ValueError, match=message):
        free_paths(gain, bend_penalty)


@pytest.mark.parametrize(
    ("shape", "max_slope", "step", "message"),
    [
        ((4,), 1, 1, r"reward has shape \(4,\)"),
        ((3, 4), 1, 4, r"reward has shape \(3, 4\), expected \(rows, columns\) with >= 4 rows"),
        ((3, 0), 1, 1, r"reward has shape \(3, 0\)"),
        ((3, 4), 1, 0, "step is 0"),
        ((3, 4), -1, 1, "max_slope -1"),
    ],
)
def test_bad_reward_is_refused(shape, max_slope, step, message):
    with pytest.raises(ValueError, match=message):
        segment_gain(np.ones(shape), max_slope, step)


def test_traces_of_nodes_that_are_not_there():
    gain = np.ones((2, 1, 2))
    gain[1, 0, 1] = -INF
    found = free_paths(gain, 0.0)
    with pytest.raises(ValueError, match=r"\(2, 0\) is not in the graph, expected below \(2, 2\)"):
        found.trace(2, 0)
    with pytest.raises(ValueError, match=r"no path may end in \(1, 1\)"):
        found.trace(1, 1)


def test_the_example_of_the_documentation_runs():
    assert doctest.testmod(module).attempted > 0
    assert doctest.testmod(module).failed == 0
