# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What lanes are told to be by their own paint and by the lines beside them."""

from dataclasses import fields

import numpy as np
import pytest

from lane_dp_ros.core.lanes.candidate import Candidate, LaneEvidence, LaneLine, Marking
from lane_dp_ros.core.lanes.markings import with_markings

ROAD, WHITE, YELLOW = (96, 95, 93), (215, 214, 213), (70, 172, 214)  # BGR
EVIDENCE = LaneEvidence(**{field.name: 0 for field in fields(LaneEvidence)})


def candidates_at(view, places, last=100.0):
    rows = np.flatnonzero(view.s < last)[::-1]
    lines = [LaneLine(rows, view.s[rows], np.full(len(rows), n), 0.0, 10.0) for n in places]
    return [Candidate(line, EVIDENCE) for line in lines]


def markings(road, places, picture=None):
    paint = road.bands()
    found = with_markings(
        candidates_at(paint.view, places),
        paint,
        paint.view.image if picture is None else picture,
    )
    assert [each.line.n[0] for each in found] == places
    return [each.marking for each in found]


@pytest.fixture
def two_lines(painted_road):
    """A road with a solid line at -2.0 m, a dashed one at -1.5 m, and a dashed one at 2 m."""
    return painted_road(length=30).line(-2.0).line(-1.5, dash=(3, 6)).line(2.0, dash=(3, 6))


@pytest.mark.parametrize("order", [[0, 1, 2], [2, 1, 0], [1, 2, 0]])
def test_two_lines_side_by_side_are_a_double_line(two_lines, order):
    places = [-2.0, -1.5, 2.0]
    double, single = Marking("double", "", ("solid", "dashed")), Marking("dashed")
    expected = [double, double, single]
    assert markings(two_lines, [places[i] for i in order]) == [expected[i] for i in order]


def test_lines_of_different_colours_are_not_one_double_line(two_lines, colour_picture):
    """Yellow lines of road works run beside the white ones that they replace."""
    view = two_lines.view()
    picture = colour_picture(view, [(-2.0, WHITE), (-1.5, YELLOW), (2.0, YELLOW)], ROAD)
    assert markings(two_lines, [-2.0, -1.5, 2.0], picture) == [
        Marking("solid", "white"),
        Marking("dashed", "yellow"),
        Marking("dashed", "yellow"),
    ]


@pytest.mark.parametrize(("other", "sides"), [(-0.25, ("dashed", "solid")), (0.25, ("solid", "dashed"))])
def test_a_double_line_of_which_one_was_found_is_double(painted_road, other, sides):
    road = painted_road(length=30).line(-1.5, 0.10).line(-1.5 + other, 0.10, dash=(3, 6))
    assert markings(road, [-1.5, 2.0])[0] == Marking("double", "", sides)


def test_the_lines_of_a_narrow_double_line_have_its_sides_too(painted_road):
    road = painted_road(length=30).line(-1.5, 0.10).line(-1.25, 0.10, dash=(3, 6))
    assert markings(road, [-1.5, -1.25]) == [Marking("double", "", ("solid", "dashed"))] * 2


def test_of_a_line_out_of_sight_nothing_is_known(two_lines):
    two_lines.seen[:, two_lines.n > 0] = False
    assert markings(two_lines, [-2.0, 2.0]) == [Marking("solid"), Marking()]


def test_no_lines_no_markings(two_lines):
    assert markings(two_lines, []) == []
