# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The nearer half of a line, on drawn roads."""

import numpy as np
import pytest

from lane_dp_ros.core.lanes.candidate import LaneLine
from lane_dp_ros.core.lanes.line_fit import MIN_ROWS
from lane_dp_ros.core.lanes.variants.near_half import near_half

pytestmark = pytest.mark.filterwarnings("error")

N, TURN = 1.525, 14.0  # m
BLANK_COST = 0.15


@pytest.fixture
def halved(painted_road):
    """Return a function: a line that turns aside, as a path follows it, and what is left of it."""

    def halved(count=80, first=0.0, last=100.0, unseen=()):
        road = painted_road().line(lambda s: N + 0.3 * np.maximum(0, s - TURN), first=first, last=last)
        road.seen[np.isin(np.arange(len(road.s)), unseen)] = False
        paint = road.bands()
        view = paint.view
        rows = np.arange(len(view.s))[::-1][:count]
        s = view.s[rows]
        bent = np.polyval(np.polyfit(s, N + 0.3 * np.maximum(0, s - TURN), 3), s)  # as far as a cubic can be
        line = LaneLine(rows, s, bent, bend=0.01, score=15.0)
        return line, near_half(line, paint, BLANK_COST)

    return halved


def test_the_nearer_half_of_a_line_lies_on_its_own_paint(halved):
    line, half = halved()
    assert np.abs(line.n[:40] - N).max() > 0.1
    np.testing.assert_allclose(half.n, N, atol=0.01)
    assert half.rows.tolist() == line.rows[:40].tolist()
    assert half.s.tolist() == line.s[:40].tolist()
    assert half.bend == pytest.approx(0, abs=1e-3)


def test_its_score_is_its_paint_less_the_blank_road(halved):
    assert halved()[1].score == pytest.approx(10 * (1 - BLANK_COST), abs=0.2)
    assert halved(first=9.0)[1].score == pytest.approx(5 - 10 * BLANK_COST, abs=0.4)


def test_it_ends_with_its_paint(halved):
    half = halved(last=9.0)[1]
    assert half.s[-1] == pytest.approx(9.0, abs=0.3)
    assert half.score == pytest.approx(5 * (1 - BLANK_COST), abs=0.4)


def test_without_paint_there_is_no_half(halved):
    assert halved(first=15.0)[1] is None


def test_what_is_not_seen_counts_neither_way(halved):
    assert halved(unseen=range(50, 70))[1].score == pytest.approx(5 * (1 - BLANK_COST), abs=0.4)


@pytest.mark.parametrize(("count", "known"), [(2 * MIN_ROWS - 1, False), (2 * MIN_ROWS, True)])
def test_too_little_has_no_half(halved, count, known):
    assert (halved(count)[1] is not None) == known
