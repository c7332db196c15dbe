# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""How lines lie to one another, on lines made by hand."""

import numpy as np
import pytest

from lane_dp_ros.core.lanes.candidate import LaneLine
from lane_dp_ros.core.lanes.evidence_model import PAIRS, EvidenceModel, Term
from lane_dp_ros.core.lanes.neighbours import EDGE, PAINT, Neighbours, relations


def line(n, first=5.0, last=25.0, slope=0.0):
    s = np.linspace(first, last, 81)
    return LaneLine(np.arange(81), s, n + slope * (s - first), 0.0, 10.0)


def gap(a, b):
    """Return the gap of two lines, and see to it that it is the same either way."""
    found, other = Neighbours.of([a, b]), Neighbours.of([b, a])
    assert found.gap[0, 1] == pytest.approx(found.gap[1, 0])
    assert found.gap[0, 1] == pytest.approx(other.gap[0, 1])
    return found.gap[0, 1]


def overlap(a, b):
    return Neighbours.of([a, b]).overlap[0, 1]


def test_the_gap_of_lines_side_by_side_is_their_mean_distance():
    assert gap(line(-1.75), line(1.75)) == pytest.approx(3.5)
    assert gap(line(-1.75), line(1.75, first=20)) == pytest.approx(3.5)
    assert gap(line(0.0), line(0.0, slope=0.1)) == pytest.approx(1.0, abs=0.05)  # 0 to 2 m


def test_the_gap_of_lines_one_behind_the_other_is_that_of_their_ends():
    near, far = line(0.0, last=15.0, slope=0.1), line(3.0, first=20.0)  # the near one ends at n = 1
    assert gap(near, far) == pytest.approx(2.0)


def test_a_line_has_no_gap_to_itself_and_covers_itself():
    found = Neighbours.of([line(-2.0), line(1.0)])
    assert np.diag(found.gap).tolist() == [0.0, 0.0]
    assert np.diag(found.overlap).tolist() == [1.0, 1.0]


@pytest.mark.parametrize(
    ("other", "share"),
    [
        (line(1.75), 1.0),
        (line(1.90), 1.0),
        (line(2.0), 0.0),
        (line(1.75, first=10, last=15), 1.0),  # all of the shorter one
        (line(1.75, first=15, last=35), 11 / 21),
        (line(1.75, first=30, last=40), 0.0),
        (line(1.75, slope=0.04), 6 / 21),  # within 0.2 m for 5 m
    ],
)
def test_the_overlap_is_the_share_of_the_shorter_one_in_the_same_place(other, share):
    assert overlap(line(1.75), other) == pytest.approx(share, abs=0.03)


def test_lines_that_are_near_on_average_are_one_line():
    found = Neighbours.of([line(-1.75), line(-1.45), line(-1.35), line(1.75)])
    assert found.one_line.astype(int).tolist() == [[1, 1, 0, 0], [1, 1, 1, 0], [0, 1, 1, 0], [0, 0, 0, 1]]


def test_of_no_lines_there_are_no_neighbours():
    found = Neighbours.of([])
    assert found.gap.shape == found.overlap.shape == found.one_line.shape == (0, 0)


def test_sides_are_those_where_the_lines_begin():
    assert Neighbours.of([line(-1.0, slope=0.2), line(0.0), line(2.0)]).left.tolist() == [True, False, False]


# Of a pair from left to right, both left of the vehicle, across it, or both right of it.
LEFT, ACROSS, RIGHT = [True, True], [True, False], [False, False]


@pytest.mark.parametrize(
    ("left", "kinds", "names"),
    [
        (LEFT, (PAINT, PAINT), {"paint_beside_paint", "paint_on_paint"}),
        (ACROSS, (PAINT, PAINT), {"paint_beside_paint", "paint_on_paint"}),
        (RIGHT, (PAINT, PAINT), {"paint_beside_paint", "paint_on_paint"}),
        (LEFT, (EDGE, PAINT), {"paint_before_edge"}),
        (LEFT, (PAINT, EDGE), {"paint_behind_edge"}),
        (RIGHT, (PAINT, EDGE), {"paint_before_edge"}),
        (RIGHT, (EDGE, PAINT), {"paint_behind_edge"}),
        (ACROSS, (PAINT, EDGE), {"paint_across_edge"}),
        (ACROSS, (EDGE, PAINT), {"paint_across_edge"}),
        (LEFT, (EDGE, EDGE), {"edge_behind_edge"}),
        (RIGHT, (EDGE, EDGE), {"edge_behind_edge"}),
        (ACROSS, (EDGE, EDGE), {"edge_across_edge"}),
    ],
)
def test_each_two_lines_have_the_terms_of_their_classes_and_sides(left, kinds, names):
    where = relations(np.array(left))
    assert {name for name in PAIRS if where[name][0, 1, kinds[0], kinds[1]]} == names


def test_log_odds_of_two_lines_are_those_of_their_gap_and_overlap():
    """Each term is worth as much as its gap [m], times its place in the list, or as its overlap."""
    at = np.array([0.0, 10.0])
    pairs = {name: Term(at, at * (k + 1)) for k, name in enumerate(PAIRS)}
    found = Neighbours.of([line(-2.0), line(1.0), line(1.1, slope=0.01)])
    worth = found.log_odds(EvidenceModel({}, {}, pairs, {}))
    assert worth[0, 1, PAINT, PAINT] == pytest.approx(3.0 * 1)
    gap, overlap = found.gap[1, 2], found.overlap[1, 2]
    assert (gap, overlap) == pytest.approx((0.2, 0.5), abs=0.03)
    assert worth[1, 2, PAINT, PAINT] == pytest.approx(gap * 1 + overlap * 2)
    assert worth[1, 2, PAINT, EDGE] == pytest.approx(gap * 3)
    assert worth[1, 2, EDGE, PAINT] == pytest.approx(gap * 4)
    assert worth[1, 2, EDGE, EDGE] == pytest.approx(gap * 5)
    assert worth[0, 1, EDGE, PAINT] == pytest.approx(3.0 * 6)
    assert worth[0, 1, EDGE, EDGE] == pytest.approx(3.0 * 7)


def test_two_lines_in_one_place_are_not_both_paint():
    pairs = {name: Term(np.array([0.0]), np.array([50.0])) for name in PAIRS}
    worth = Neighbours.of([line(1.0), line(1.1)]).log_odds(EvidenceModel({}, {}, pairs, {}))
    assert worth[0, 1, PAINT, PAINT] == -1e9
    assert worth[0, 1, PAINT, EDGE] == 50.0
