# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The second look: faint lines parallel to the strongest."""

import numpy as np
import pytest

from lane_dp_ros.core.lanes.candidate import LaneLine
from lane_dp_ros.core.lanes.line_fit import MIN_ROWS
from lane_dp_ros.core.lanes.variants import parallel
from lane_dp_ros.core.lanes.variants.parallel import ParallelConfig, best_stretches, parallel_lines

CONFIG = ParallelConfig()
FAINT = 4  # grey levels, as much as the noise


def line_at(view, course, score=10.0, first=0.0):
    rows = np.flatnonzero(view.s >= first)[::-1]
    s = view.s[rows]
    n = course(s) if callable(course) else np.full(len(s), float(course))
    return LaneLine(rows, s, n, 0.0, score)


def look(road, *lines, config=CONFIG):
    """Look beside lines given by their courses, the first the strongest."""
    paint = road.bands()
    given = [line_at(paint.view, course, score=10.0 - i) for i, course in enumerate(lines)]
    return parallel_lines(given, paint, config)


@pytest.mark.parametrize("given", [-1.725, 1.725], ids=["left", "right"])
def test_a_faint_line_is_found_on_the_other_side(painted_road, given):
    found = look(painted_road().line(given).line(-given, brightness=FAINT).grass(-5, 5, 4), given)
    assert len(found) == 1
    assert np.abs(found[0].n + given).max() < 0.05
    assert np.all(np.diff(found[0].s) > 0)
    assert found[0].length > 18  # of 20 m
    assert found[0].score > 1.9  # m


def test_a_parallel_line_has_the_shape_of_the_given_one(painted_road):
    def course(s):
        return -1.725 + 0.003 * (s - 4) ** 2

    road = painted_road().line(course).line(lambda s: course(s) + 3.5, brightness=FAINT).grass(-5, 5, 4)
    found = look(road, course)
    assert len(found) == 1
    assert np.abs(found[0].n - course(found[0].s) - 3.5).mean() < 0.03


def test_its_ends_are_those_of_the_paint(painted_road):
    road = painted_road().line(-1.725).line(1.725, brightness=6, first=10, last=20).grass(-5, 5, 2)
    found = look(road, -1.725)
    assert found[0].s[0] == pytest.approx(10, abs=1)  # blurred by half of the 2 m that are averaged
    assert found[0].s[-1] == pytest.approx(20, abs=1)


@pytest.mark.parametrize("rough", [0, 3, 5])
def test_nothing_is_found_on_blank_road(painted_road, rough):
    assert look(painted_road().line(-1.725).grass(-1, 5, rough), -1.725) == []


def test_what_is_not_seen_is_not_found(painted_road):
    road = painted_road().line(-1.725).line(1.725, brightness=10)
    road.seen[:, road.n > 0] = False
    assert look(road, -1.725) == []


@pytest.mark.parametrize("n", [0.5, 3.3], ids=["inside the lane", "beyond the lane"])
def test_only_a_lanes_width_aside_is_looked_at(painted_road, n):
    assert look(painted_road().line(-1.725).line(n, brightness=FAINT), -1.725) == []


def test_a_border_of_the_own_lane_is_not_far_aside(painted_road):
    """The vehicle drives on a line: 3.4 m to the left of it there may be one, but not that of its lane."""
    assert look(painted_road().line(0.225).line(-3.175, brightness=FAINT), 0.225) == []
    assert len(look(painted_road().line(0.225).line(-2.775, brightness=FAINT), 0.225)) == 1


def test_each_side_gets_one_border(painted_road):
    road = painted_road().line(-2.525).line(0.275, brightness=FAINT + 2).line(2.775, brightness=FAINT + 1)
    found = look(road, -2.525)
    assert [round(float(line.n[0]), 1) for line in found] == [0.3]


def test_the_sides_are_those_at_the_vehicle(painted_road):
    """A bend: the left border lies right of the vehicle's axis at its far end."""

    def course(s):
        return -1.0 + 0.006 * (s - 4) ** 2

    road = painted_road().line(course).line(lambda s: course(s) + 2.5, brightness=FAINT)
    found = look(road, course)
    assert [round(float(line.n[0]), 1) for line in found] == [1.5]


def test_one_bright_spot_is_no_line(painted_road):
    assert look(painted_road().line(-1.725).line(1.725, brightness=160, first=10, last=10.5), -1.725) == []


def test_a_lane_with_two_borders_needs_no_second_look(painted_road):
    road = painted_road().line(-1.725).line(1.725).line(4.7, brightness=FAINT)
    assert look(road, -1.725, 1.725) == []


def test_without_a_line_there_is_nothing_to_be_parallel_to(painted_road):
    assert look(painted_road().line(1.725, brightness=FAINT)) == []


def test_both_borders_can_be_found_beside_a_line_farther_off(painted_road):
    road = painted_road().line(-4.6).line(-1.1, brightness=10).line(2.4, brightness=10).grass(-5, 5, 2)
    found = look(road, -4.6)
    assert sorted(round(float(line.n[0]), 1) for line in found) == [-1.1, 2.4]
    assert found[0].score >= found[1].score


def test_best_stretches_by_hand():
    gain = np.array(
        [
            [1, -1, 0, -1, 2],
            [-3, -1, 0, 2, 2],
            [2, -1, 0, -1, -1],
            [2, -1, 0, 2, 2],
        ],
        np.float32,
    )
    score, first, last = best_stretches(gain)
    assert score.tolist() == [4, 0, 0, 3, 5]
    assert first[[0, 3, 4]].tolist() == [2, 1, 0]
    assert last[[0, 3, 4]].tolist() == [3, 3, 3]


@pytest.mark.parametrize(
    ("limits", "found"),
    [
        ({}, [1.7]),
        ({"contrast_min": 2.0, "contrast_max": 4.0}, []),
        ({"blank_cost": 1.0}, []),
        ({"score_min": 20.0}, []),
        ({"ego_max": 1.5}, []),
    ],
    ids=str,
)
def test_the_limits_are_those_of_the_configuration(painted_road, limits, found):
    road = painted_road().line(-1.725).line(1.725, brightness=FAINT)
    lines = look(road, -1.725, config=ParallelConfig(**limits))
    assert [round(float(line.n[0]), 1) for line in lines] == found


@pytest.mark.parametrize(
    ("limits", "found"), [({"lane_width_max": 3.2}, 0), ({"lane_width_min": 3.6}, 0), ({}, 1)]
)
def test_a_lane_is_as_wide_as_the_configuration_lets_it_be(painted_road, limits, found):
    """The lines are 3.45 m apart."""
    road = painted_road().line(-1.725).line(1.725, brightness=FAINT)
    assert len(look(road, -1.725, config=ParallelConfig(**limits))) == found


@pytest.mark.parametrize(("rows", "found"), [(MIN_ROWS - 1, 0), (MIN_ROWS, 1)])
def test_as_many_rows_as_a_fit_needs_are_wanted(painted_road, monkeypatch, rows, found):
    """Where rows are long, a stretch of one or two scores enough."""

    def short(gain):
        score, first, _ = best_stretches(gain)
        return score, first, first + rows - 1

    monkeypatch.setattr(parallel, "best_stretches", short)
    assert len(look(painted_road().line(-1.725).line(1.725, brightness=FAINT), -1.725)) == found
