# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Lines that end at a stop line, on drawn junctions."""

import numpy as np
import pytest

from lane_dp_ros.core.data import LaneLine
from lane_dp_ros.core.stop_lines import JUNCTION, end_at_stop_lines

pytestmark = pytest.mark.filterwarnings("error")

N = 1.525  # m
STOP = 9.0  # m ahead, where the stop line begins
BLANK_COST = 0.15
WHITE = 70.0  # grey levels above the road


@pytest.fixture
def junction(painted_road):
    """Return a function: a line up to a bar across the road, and from `beyond` on; its pieces."""

    def junction(beyond=STOP + JUNCTION + 1, across=(-6.0, 1.6), brightness=WHITE, depth=0.5, last=STOP):
        road = painted_road(length=26.0).line(N, brightness=WHITE, last=last)
        road.line(N, brightness=WHITE, first=beyond)
        bar = (road.s >= STOP) & (road.s < STOP + depth)
        road.grey[np.ix_(bar, (road.n > across[0]) & (road.n < across[1]))] = 90 + brightness
        view, graph = road.bands()
        rows = np.arange(len(view.s))[::-1]
        line = LaneLine(rows, view.s[rows], np.full(len(rows), N), bend=0.0, score=15.0)
        return line, end_at_stop_lines(line, view, graph, BLANK_COST)

    return junction


@pytest.mark.parametrize("across", [(-6.0, 1.6), (1.4, 6.0), (-6.0, 6.0)])
def test_a_line_ends_at_the_stop_line_and_another_one_begins_behind_the_junction(junction, across):
    _, (before, behind) = junction(across=across)
    assert before.s[-1] == pytest.approx(STOP, abs=0.3)
    assert behind.s[0] == pytest.approx(STOP + JUNCTION + 1, abs=0.3)
    for piece in (before, behind):
        assert len(piece.rows) == len(piece.s) == len(piece.n)
        assert piece.score == pytest.approx(piece.length * (1 - BLANK_COST), abs=0.5)


@pytest.mark.parametrize(
    "drawn",
    [
        {"beyond": STOP + 0.5},  # the line goes on
        {"beyond": STOP + JUNCTION - 1},  # a crossing
        {"brightness": 0.0},  # a gap between dashes
        {"brightness": 0.3 * WHITE},  # a joint in the asphalt
        {"depth": 4.0},  # a light patch
        {"across": (-6.0, 0.4)},  # it ends well before the line
        {"last": STOP - 2},  # the line ended before
        {"beyond": 100.0},  # nothing behind
        {"last": 0.0, "beyond": 100.0},  # no paint at all
    ],
)
def test_other_lines_stay_as_they_are(junction, drawn):
    line, pieces = junction(**drawn)
    assert len(pieces) == 1
    assert pieces[0] is line
