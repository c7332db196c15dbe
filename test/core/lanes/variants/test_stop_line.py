# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Lines that end at a stop line, on drawn junctions."""

from dataclasses import replace

import numpy as np
import pytest

from lane_dp_ros.core.lanes.candidate import LaneLine
from lane_dp_ros.core.lanes.variants.stop_line import StopLineConfig, end_at_stop_line

pytestmark = pytest.mark.filterwarnings("error")

N = 1.525  # m
STOP = 9.0  # m ahead, where the stop line begins
JUNCTION = 9.0  # m without paint behind it
LENGTH = 40.0  # m
BLANK_COST = 0.15
WHITE = 70.0  # grey levels above the road
CONFIG = StopLineConfig()


@pytest.fixture
def junction(painted_road):
    """Return a function: a line up to a bar across the road, and from `beyond` on; what is left of it."""

    def junction(
        beyond=STOP + JUNCTION + 1,
        *,
        across=(-6.0, 1.6),
        brightness=WHITE,
        depth=0.5,
        last=STOP,
        config=CONFIG,
        **more,
    ):
        road = painted_road(length=LENGTH).line(N, brightness=WHITE, last=last)
        road.line(N, brightness=WHITE, first=beyond, last=more.get("until", 100.0))
        road.line(N, brightness=WHITE, first=more.get("again", 100.0))
        bar = (road.s >= more.get("stop", STOP)) & (road.s < more.get("stop", STOP) + depth)
        cells = np.ix_(bar, (road.n > across[0]) & (road.n < across[1]))
        road.grey[cells] = 90 + brightness
        road.height[cells] = more.get("height", 0.0)
        if "verge" in more:
            road.grey[:, road.n > N + 0.4] = more["verge"] + np.random.default_rng(0).normal(
                0, 4, (len(road.s), np.count_nonzero(road.n > N + 0.4))
            )
        paint = road.bands()
        view = paint.view
        rows = np.arange(len(view.s))[::-1]
        line = LaneLine(rows, view.s[rows], np.full(len(rows), N), bend=0.01, score=15.0)
        return line, end_at_stop_line(line, paint, BLANK_COST, config)

    return junction


@pytest.mark.parametrize("across", [(-6.0, 1.6), (1.4, 6.0), (-6.0, 6.0), (-6.0, 1.2)])
@pytest.mark.parametrize("depth", [0.3, 0.5, 0.7])
def test_a_line_ends_at_the_stop_line(junction, across, depth):
    line, ended = junction(across=across, depth=depth)
    assert ended.s[0] == line.s[0]
    assert ended.s[-1] == pytest.approx(STOP, abs=0.3)
    assert len(ended.rows) == len(ended.s) == len(ended.n)
    assert ended.bend == line.bend
    assert ended.score == pytest.approx(ended.length * (1 - BLANK_COST), abs=0.5)


def test_of_two_gaps_the_one_with_the_stop_line_ends_the_line(junction):
    gap = {"beyond": STOP + JUNCTION + 1, "until": STOP + JUNCTION + 5, "again": STOP + 2 * JUNCTION + 7}
    line, ended = junction(**gap, stop=STOP + JUNCTION + 5)
    assert ended.s[-1] == pytest.approx(STOP + JUNCTION + 5, abs=0.3)
    assert ended.s[0] == line.s[0]
    assert junction(**gap)[1].s[-1] == pytest.approx(STOP, abs=0.3)


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
        {"stop": STOP - 2},  # a bar beside the line
        {"beyond": 100.0},  # nothing behind
        {"last": 0.0, "beyond": 100.0},  # no paint at all
        {"height": 0.8},  # a bumper
        {"brightness": 0.0, "verge": 170.0},  # concrete beside the line, brighter than the paint
        {"brightness": 0.0, "verge": 158.0},
    ],
)
def test_other_lines_stay_as_they_are(junction, drawn):
    line, same = junction(**drawn)
    assert same is line


@pytest.mark.parametrize("last", [4.3, 4.6, 4.8])
def test_no_line_is_left_with_too_few_rows_to_be_one(junction, last):
    line, same = junction(last=last, stop=last)
    assert same is line


@pytest.mark.parametrize(
    ("limits", "drawn", "ends"),
    [
        ({"unpainted_min": 12.0}, {}, False),
        ({"unpainted_min": 5.0}, {"beyond": STOP + 6}, True),
        ({"rise_min": 0.9}, {"brightness": 0.7 * WHITE}, False),
        ({"rise_min": 0.2}, {"brightness": 0.35 * WHITE}, True),
    ],
    ids=str,
)
def test_the_limits_are_those_of_the_configuration(junction, limits, drawn, ends):
    line, same = junction(**drawn)
    assert (same is line) == ends
    line, ended = junction(**drawn, config=replace(CONFIG, **limits))
    assert (ended is not line) == ends
