# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Paths that propose lanes: Algorithm 2 from bottom to top, and the search with free ends."""

from dataclasses import replace

import numpy as np
import pytest

from lane_dp_ros.core.birdseye.paint_map import PaintMap
from lane_dp_ros.core.config import preset
from lane_dp_ros.core.lanes.path_search import FreeEndSearch, FullHeightSearch, PathSearchConfig, path_search

METRES = (0.5, 0.1)  # per row and column
PAPER = replace(preset("paper").path_search, suppression=0.5)  # 5 columns
FREE = PathSearchConfig()


def map_of(feature, seen=None):
    feature = np.asarray(feature, np.float32)
    seen = np.ones(feature.shape, bool) if seen is None else seen
    feature = np.where(seen, feature, 0).astype(np.float32)
    nothing = np.zeros(feature.shape, np.float32)
    return PaintMap(feature, seen, feature, nothing, nothing)


def drawn(*lines, shape=(40, 60)):
    """Return a feature of 1 in the columns of each line (one a row, -1: none), 0 elsewhere."""
    feature = np.zeros(shape, np.float32)
    for line in lines:
        columns = np.broadcast_to(line, shape[:1])
        rows = np.flatnonzero(columns >= 0)
        feature[rows, columns[rows]] = 1
    return feature


def find_paths(paint_map, config):
    return path_search(config).find(paint_map, METRES)


def found_columns(paths):
    return sorted(round(float(np.median(path.columns))) for path in paths)


def assert_near_to_far(paths):
    for path in paths:
        assert np.all(np.diff(path.rows) == -1)
        assert len(path.rows) == len(path.columns)


def test_algorithm_2_finds_every_line_once():
    paths = find_paths(map_of(drawn(12, 45)), PAPER)
    assert found_columns(paths) == [12, 45]
    assert_near_to_far(paths)
    for path in paths:
        assert path.rows[0] == 39
        assert path.rows[-1] == 0
        assert np.ptp(path.columns) == 0
        assert path.score == pytest.approx(40 * 0.5)  # m of paint


def test_algorithm_2_takes_the_best_first():
    feature = drawn(12, 45)
    feature[:, 12] *= 0.8
    assert [path.columns[0] for path in find_paths(map_of(feature), PAPER)] == [45, 12]


def test_algorithm_2_closes_a_band_around_every_path_whatever_becomes_of_it():
    """All is bright: whether a path is a lane is judged later; the next one keeps 5 columns clear of it."""
    paths = find_paths(map_of(np.ones((40, 60))), PAPER)
    columns = np.sort([path.columns for path in paths], axis=0)
    assert len(paths) >= 5
    assert np.diff(columns, axis=0).min() == 6


@pytest.mark.parametrize(("apart", "count"), [(5, 1), (6, 2)])
def test_lines_within_the_closed_band_are_one(apart, count):
    paths = find_paths(map_of(drawn(20, 20 + apart)), PAPER)
    assert len(paths) == count


@pytest.mark.parametrize(("epsilon", "count"), [(0.29, 0), (0.31, 1), (0.49, 1), (0.51, 2)])
def test_a_mean_cost_above_epsilon_ends_the_search(epsilon, count):
    feature = drawn(12, 45)
    feature[:, 12] *= 0.7
    feature[:, 45] *= 0.5
    assert len(find_paths(map_of(feature), replace(PAPER, max_mean_cost=epsilon))) == count


@pytest.mark.parametrize(("k", "count"), [(1, 0), (2, 1), (3, 1)])
def test_k_limits_how_far_a_path_moves_aside(k, count):
    steep = np.arange(10, 50, 2)  # two columns a row
    paint_map = map_of(drawn(steep, shape=(20, 60)))
    config = replace(PAPER, neighbours=k, smoothness=0.0, max_mean_cost=0.5)
    paths = find_paths(paint_map, config)
    assert len(paths) == count
    # The nearest node is left out: Algorithm 1 does not count its cost.
    assert all(np.array_equal(path.columns[:0:-1], steep[:-1]) for path in paths)


@pytest.mark.parametrize(("smoothness", "column"), [(0.0, 22), (0.4, 22), (0.6, 20)])
def test_lambda_charges_for_moving_aside(smoothness, column):
    """To follow a jut of four rows, two columns aside, saves four nodes of cost 1.

    There and back costs 2 * 4 lambda in leaps of two columns, or 4 lambda and two blank nodes in single
    steps: both pay for lambda < 0.5.
    """
    line = np.full(20, 20)
    line[8:12] = 22
    config = replace(PAPER, neighbours=2, smoothness=smoothness)
    path = find_paths(map_of(drawn(line, shape=(20, 40))), config)[0]
    assert path.columns[np.flatnonzero(path.rows == 10)[0]] == column


def test_rows_that_are_not_seen_count_neither_for_nor_against():
    seen = np.ones((40, 60), bool)
    seen[30:] = False
    paths = find_paths(map_of(drawn(12), seen), replace(PAPER, max_mean_cost=0.01))
    assert len(paths) == 1
    assert paths[0].rows.tolist() == list(range(29, -1, -1))
    assert paths[0].score == pytest.approx(30 * 0.5)


def test_algorithm_2_finds_no_more_than_it_may():
    assert len(find_paths(map_of(np.ones((40, 60))), replace(PAPER, max_paths=2))) == 2


def test_algorithm_2_ends_when_every_column_is_closed():
    assert len(find_paths(map_of(np.ones((10, 8))), PAPER)) == 2  # columns 0 to 5, then 6 or 7


def test_algorithm_2_ends_when_no_path_leads_to_the_top():
    """A line from corner to corner cuts the picture in two: each row has open nodes, but none are joined."""
    config = replace(PAPER, neighbours=1, smoothness=0.0, suppression=0.2)
    paths = find_paths(map_of(drawn(np.arange(20), shape=(20, 20))), config)
    assert len(paths) == 1


@pytest.mark.parametrize("config", [PAPER, FREE], ids=["algorithm 2", "free ends"])
@pytest.mark.parametrize("seen", [True, False])
def test_nothing_is_found_where_there_is_nothing(config, seen):
    paint_map = map_of(np.zeros((40, 60)), np.full((40, 60), seen))
    assert find_paths(paint_map, config) == []


def test_a_free_path_starts_and_ends_with_the_paint():
    line = np.full(40, 30)
    line[:10] = line[32:] = -1
    paths = find_paths(map_of(drawn(line)), FREE)
    assert len(paths) == 1
    assert_near_to_far(paths)
    assert (paths[0].rows[0], paths[0].rows[-1]) == (31, 10)
    assert np.all(paths[0].columns == 30)
    assert paths[0].score == pytest.approx(11 * (1 - 0.14))  # 22 rows of 0.5 m, each less the blank cost


def test_a_free_path_bridges_the_gaps_of_a_dashed_line():
    line = np.full(40, 30)
    line[8:20] = -1  # 6 m of gap between 4 m and 10 m of paint
    paths = find_paths(map_of(drawn(line)), FREE)
    assert len(paths) == 1
    assert (paths[0].rows[0], paths[0].rows[-1]) == (39, 0)
    assert paths[0].score == pytest.approx(14 * 0.86 - 6 * 0.14)


def test_a_gap_too_long_to_pay_is_not_bridged():
    line = np.full(60, 30)
    line[6:50] = -1  # 22 m of blank road cost 3.1, 3 m of paint gain 2.6
    paths = find_paths(map_of(drawn(line, shape=(60, 60))), FREE)
    assert sorted((path.rows[0], path.rows[-1]) for path in paths) == [(5, 0), (59, 50)]


def test_unseen_rows_cost_a_free_path_nothing():
    line = np.full(40, 30)
    seen = np.ones((40, 60), bool)
    seen[10:30] = False
    paths = find_paths(map_of(drawn(line), seen), FREE)
    assert paths[0].score == pytest.approx(10 * 0.86)


def test_a_free_path_follows_a_slanted_line():
    line = np.repeat(np.arange(20), 2) + 10  # one column a segment of two rows: slope 0.1
    paths = find_paths(map_of(drawn(line, line - 1)), FREE)
    assert len(paths) == 1
    error = paths[0].columns - (line[paths[0].rows] - 0.5)  # the middle of the two columns
    assert np.abs(error).max() <= 0.5
    assert np.abs(error.mean()) < 0.1
    steepness = 4.0 * 0.1**2 * 20  # slope_cost times slope^2 over 20 m
    assert paths[0].score == pytest.approx(20 * 0.86 - steepness, abs=0.1)


def test_lines_close_together_are_found_pass_by_pass():
    paths = find_paths(map_of(drawn(20, 25, 50)), FREE)  # 0.5 m and 2.5 m apart
    assert found_columns(paths) == [20, 25, 50]


def test_a_line_within_the_suppressed_band_is_not_found_again():
    wide = np.zeros((40, 60))
    wide[:, 29:32] = 1
    assert len(find_paths(map_of(wide), FREE)) == 1


def test_a_branch_is_found_beside_the_line_it_leaves():
    stem = np.full(60, 30)
    branch = np.full(60, -1)
    branch[:30] = 30 + np.arange(30, 0, -1) // 2  # leaves to the right half-way
    paths = find_paths(map_of(drawn(stem, branch, shape=(60, 80))), FREE)
    assert len(paths) == 2
    assert np.median(paths[0].columns) == 30
    assert paths[1].columns[0] > 32
    assert paths[1].rows[-1] <= 1


def test_free_paths_come_best_first_and_no_more_than_they_may():
    long, short = np.full(40, 10), np.full(40, 45)
    short[:20] = -1
    paint_map = map_of(drawn(short, long))
    assert [path.columns[0] for path in find_paths(paint_map, FREE)] == [10, 45]
    assert [path.columns[0] for path in find_paths(paint_map, replace(FREE, max_paths=1))] == [10]


def test_a_long_line_of_a_later_pass_comes_before_a_short_one():
    short = np.full(40, 50)
    short[:20] = -1
    paths = find_paths(map_of(drawn(20, 25, short)), FREE)
    assert found_columns(paths[:2]) == [20, 25]
    assert found_columns(paths[2:]) == [50]


@pytest.mark.parametrize(("rows", "count"), [(2, 0), (4, 1)])  # 1 and 2 m of paint gain 0.85 and 1.7
def test_what_gains_too_little_is_no_path(rows, count):
    line = np.full(40, -1)
    line[20 : 20 + rows] = 30
    assert len(find_paths(map_of(drawn(line)), FREE)) == count


def test_the_configuration_names_the_search():
    assert isinstance(path_search(PAPER), FullHeightSearch)
    assert isinstance(path_search(FREE), FreeEndSearch)


@pytest.mark.parametrize(("slope_max", "steepest"), [(0.2, 0.2), (0.1, 0.1)])
def test_no_free_path_is_steeper_than_it_may_be(slope_max, steepest):
    """The line, 1 m broad, moves 0.3 m a metre to the right."""
    line = 5 + (np.arange(40)[::-1] * 1.5).astype(int)
    broad = map_of(drawn(*(line + k for k in range(10)), shape=(40, 80)))
    paths = find_paths(broad, replace(FREE, slope_max=slope_max, slope_cost=0.0))
    assert paths
    for path in paths:
        slopes = np.diff(path.columns) * METRES[1] / METRES[0]
        assert np.abs(slopes).max() <= steepest + 1e-9


def test_a_free_path_as_steep_as_the_default_allows_is_found():
    line = 5 + (np.arange(40)[::-1] * 1.5).astype(int)  # 0.3
    (path,) = find_paths(map_of(drawn(line, line + 1, shape=(40, 70))), FREE)
    assert len(path.rows) == 40


@pytest.mark.parametrize(("slope_cost", "score"), [(0.0, 17.2), (4.0, 16.4), (10.0, 15.2)])
def test_a_free_path_pays_for_its_slope(slope_cost, score):
    """20 m of paint less what blank road would cost, and what a slope of 0.1 costs over 20 m."""
    line = np.repeat(np.arange(20), 2) + 10
    paths = find_paths(map_of(drawn(line, line - 1)), replace(FREE, slope_cost=slope_cost))
    assert paths[0].score == pytest.approx(score, abs=0.1)


def test_a_free_path_pays_for_its_bends():
    line = np.concatenate([np.full(20, 20), np.repeat(np.arange(21, 31), 2)])[
        ::-1
    ]  # turns once, by one column
    scores = [
        find_paths(map_of(drawn(line, line - 1)), replace(FREE, slope_cost=0.0, bend_cost=cost))[0].score
        for cost in (0.0, 1.0)
    ]
    assert scores[0] - scores[1] == pytest.approx(1.0, abs=0.2)
    by_default = find_paths(map_of(drawn(line, line - 1)), replace(FREE, slope_cost=0.0))[0].score
    assert scores[0] - by_default == pytest.approx(0.14, abs=0.02)


def test_paths_close_to_a_better_one_wait_for_the_next_pass():
    lines = map_of(drawn(20, 25, 50))  # 0.5 m and 2.5 m apart
    assert found_columns(find_paths(lines, replace(FREE, passes=1))) in ([20, 50], [25, 50])
    assert found_columns(find_paths(lines, replace(FREE, passes=1, separation_min=0.4))) == [20, 25, 50]


@pytest.mark.parametrize(("apart", "count"), [(11, 1), (13, 2)])
def test_in_one_pass_paths_keep_clear_by_more_than_a_metre(apart, count):
    """1.2 m, 12 columns."""
    lines = map_of(drawn(20, 20 + apart))
    assert len(find_paths(lines, replace(FREE, passes=1))) == count
    assert len(find_paths(lines, FREE)) == 2
