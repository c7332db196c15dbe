# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Two lines side by side: both given, or one given and the other in its cross section."""

import numpy as np
import pytest

from lane_dp_ros.core.lanes.candidate import LaneLine
from lane_dp_ros.core.lanes.double_line import side_by_side, twin_beside
from lane_dp_ros.core.lanes.line_kind import paint_along

CENTRE = 1.025  # m
PER_ROW = 0.25  # m


def line(n, first=6.0, last=30.0):
    s = np.arange(first, last, PER_ROW)
    rows = np.arange(len(s))[::-1]
    return LaneLine(rows, s, n(s) if callable(n) else np.full(len(s), n), bend=0.0, score=10.0)


def twin(road, n=CENTRE):
    paint = road.bands()
    rows = np.arange(len(paint.view.s))[::-1]
    given = LaneLine(rows, paint.view.s[rows], np.full(len(rows), n), bend=0.0, score=10.0)
    return twin_beside(paint_along([given], paint)[0], PER_ROW)


@pytest.mark.parametrize(
    ("other", "expected"),
    [
        (line(0.5), True),
        (line(-0.7), True),
        (line(0.8), False),
        (line(3.5), False),
        (line(0.5, 10, 16), True),  # a short one, all along
        (line(0.5, 26, 40), False),  # 4 m of 14 m
        (line(0.5, 40, 60), False),  # one after the other
        (line(lambda s: 0.1 * (s - 6)), False),  # it leaves
    ],
)
def test_a_double_line_is_two_lines_that_run_side_by_side(other, expected):
    assert side_by_side(line(0.0), other) is expected
    assert side_by_side(other, line(0.0)) is expected


@pytest.mark.parametrize("side", [-1, 1])
@pytest.mark.parametrize("slit", [0.10, 0.15, 0.20])
def test_the_other_line_of_a_narrow_double_one_is_seen_beside_it(painted_road, side, slit):
    other = CENTRE + side * (0.10 + slit)
    assert twin(painted_road(length=30).line(CENTRE, 0.10).line(other, 0.10)) == (side, "solid")


@pytest.mark.parametrize("side", [-1, 1])
def test_the_other_line_may_be_dashed(painted_road, side):
    road = painted_road(length=30).line(CENTRE, 0.10)
    assert twin(road.line(CENTRE + side * 0.25, 0.10, dash=(3.0, 6.0))) == (side, "dashed")


@pytest.mark.parametrize("width", [0.10, 0.15, 0.25, 0.35])
def test_one_line_has_no_twin(painted_road, width):
    assert twin(painted_road(length=30).line(CENTRE, width)) is None


def test_a_step_beside_a_line_is_no_twin(painted_road):
    assert twin(painted_road(length=30).line(CENTRE).step(CENTRE + 0.25)) is None


def test_stripes_across_the_road_beside_a_line_are_no_twin(painted_road):
    road = painted_road(length=30).line(CENTRE)
    road.grey[(road.s % 2 < 0.5)[:, None] & (road.n > CENTRE) & (road.n < CENTRE + 1.5)] = 170
    assert twin(road) is None


def test_a_mark_beside_a_line_is_no_twin(painted_road):
    road = painted_road(length=30).line(CENTRE).line(CENTRE + 0.25, 0.10, first=8, last=9)
    assert twin(road) is None


def test_far_off_nothing_is_told(painted_road):
    road = painted_road(length=30).line(CENTRE).line(CENTRE + 0.25, 0.10, first=21)
    assert twin(road) is None
