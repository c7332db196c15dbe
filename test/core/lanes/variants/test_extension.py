# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Lines that go on behind a gap, on drawn roads whose dashes are known."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lane_dp_ros.core.lanes.candidate import LaneLine
from lane_dp_ros.core.lanes.variants.extension import ExtensionConfig, extend_line

N = -1.725  # m
ROW = 0.25  # m, a row of a drawn road
BLANK_COST = 0.14
CONFIG = ExtensionConfig()
LENGTH = 36.0  # m, from 4 m to 40 m
FIRST, LAST = 12.0, 16.0  # m; the piece that the search found


def straight(s):
    return np.full_like(s, N)


def bend(s):
    return N + 0.002 * (s - 4) ** 2


def slanted(s):
    return N + 0.1 * (s - 4)


def paint(road, course, *pieces):
    for first, last in pieces:
        road.line(course, first=first, last=last)
    return road


def piece(view, course, first=FIRST, last=LAST, score=3.4):
    """Return the line through the paint from s = first to last."""
    rows = np.flatnonzero((view.s > first) & (view.s < last))[::-1]
    s = view.s[rows]
    return LaneLine(rows, s, course(s), 0.0, score)


def extended(road, course, first=FIRST, last=LAST, score=3.4, config=CONFIG):
    profile = road.bands()
    line = piece(profile.view, course, first, last, score)
    return line, extend_line(line, profile, BLANK_COST, config)


def spans(line, first, last):
    return line.s[0] == pytest.approx(first + ROW / 2) and line.s[-1] == pytest.approx(last - ROW / 2)


@pytest.mark.parametrize("course", [straight, bend, slanted])
@pytest.mark.parametrize("gap", [2.0, 6.0])
def test_a_line_goes_on_with_the_next_dash_at_both_ends(painted_road, course, gap):
    pieces = (FIRST - gap - 2, FIRST - gap), (FIRST, LAST), (LAST + gap, LAST + gap + 4)
    line, longer = extended(paint(painted_road(length=LENGTH), course, *pieces), course)
    assert spans(longer, pieces[0][0], pieces[2][1])
    assert np.abs(longer.n - course(longer.s)).max() < 0.02
    gain = 6.0 - BLANK_COST * (6.0 + 2 * gap)
    assert longer.score == pytest.approx(line.score + gain, abs=0.01)


@pytest.mark.parametrize("end", ["far", "near"])
@pytest.mark.parametrize(("more", "bridged"), [(-ROW, True), (0.0, True), (ROW, False), (3.0, False)])
def test_the_longest_gap_is_bridged_and_a_longer_one_is_not(painted_road, end, more, bridged):
    gap = 12.0 + more  # m
    near, far = (4.0, 8.0), (8.0 + gap, 12.0 + gap)
    road = paint(painted_road(length=LENGTH), straight, near, far)
    line, longer = extended(road, straight, *(near if end == "far" else far))
    assert spans(longer, near[0], far[1]) == bridged
    assert (longer is line) != bridged


def test_from_dash_to_dash_it_goes_on_to_the_last_one(painted_road):
    pieces = [(s, s + 3.0) for s in (4.0, 12.0, 20.0, 28.0, 36.0)]
    line, longer = extended(paint(painted_road(length=LENGTH), bend, *pieces), bend, 12.0, 15.0)
    assert longer.s[0] == 4.0 + ROW / 2
    assert longer.s[-1] > 38.5  # the bend takes the last row of the dash
    assert np.abs(longer.n - bend(longer.s)).max() < 0.01
    gain = (1 - BLANK_COST) * 4 * 3.0 - BLANK_COST * 4 * 5.0
    assert longer.score == pytest.approx(line.score + gain, abs=2 * ROW)


def test_a_bend_that_is_found_is_its_curvature(painted_road):
    _, longer = extended(paint(painted_road(length=LENGTH), bend, (4, 8), (12, 16), (20, 24)), bend)
    assert longer.bend == pytest.approx(0.004, abs=0.0005)  # twice the coefficient of s^2


def test_paint_that_does_not_pay_for_its_gap_takes_no_score(painted_road):
    """1 m of paint behind 10 m without: 11 m cost 1.54 m of paint."""
    line, longer = extended(paint(painted_road(length=LENGTH), straight, (FIRST, LAST), (26, 27)), straight)
    assert longer.s[-1] > 26
    assert longer.score == line.score


@pytest.mark.parametrize(("length", "is_dash"), [(0.5, True), (0.5 - ROW, False)])
def test_a_spot_is_no_dash(painted_road, length, is_dash):
    road = paint(painted_road(length=LENGTH), straight, (FIRST, LAST), (20, 20 + length))
    line, longer = extended(road, straight)
    assert (longer is not line) == is_dash


def test_beside_the_line_there_is_no_dash_of_it(painted_road):
    road = paint(painted_road(length=LENGTH), straight, (FIRST, LAST)).line(N + 0.5, first=18)
    line, longer = extended(road, straight)
    assert longer is line


@pytest.mark.parametrize("side", [-1, 1])
def test_it_does_not_go_on_beside_the_view(painted_road, side):
    """It leaves the view at 20 m; what is painted along the border is another line."""

    def course(s):
        return side * (2.575 + 0.15 * (s - 4))

    road = paint(painted_road(length=LENGTH), course, (4, 8), (12, 16)).line(side * 4.975, first=21)
    _, longer = extended(road, course, 4, 8)
    assert longer.s[-1] < 20.5
    assert np.abs(longer.n).max() < 5.0


@pytest.mark.parametrize("seed", range(5))
def test_noise_is_no_dash(painted_road, seed):
    road = paint(painted_road(length=LENGTH), straight, (FIRST, LAST)).grass(-5, 5, 8, seed)
    line, longer = extended(road, straight)
    assert longer is line


@pytest.mark.parametrize("seed", range(3))
def test_in_noise_the_next_dash_is_found(painted_road, seed):
    road = paint(painted_road(length=LENGTH), bend, (4, 8), (12, 16), (22, 26)).grass(-5, 5, 5, seed)
    _, longer = extended(road, bend)
    assert spans(longer, 4.0, 26.0)
    assert np.abs(longer.n - bend(longer.s)).max() < 0.04


def test_a_whole_line_stays_what_it_is(painted_road):
    road = painted_road(length=LENGTH).line(N)
    line, longer = extended(road, straight, 0.0, 100.0)
    assert longer is line


@settings(deadline=None, max_examples=60)
@given(
    dash=st.tuples(st.floats(0.5, 6), st.floats(0.5, 20)),
    shape=st.tuples(st.floats(-0.3, 0.3), st.floats(-0.01, 0.01)),
    noise=st.sampled_from([0, 4, 15]),
    span=st.tuples(st.integers(0, 140), st.integers(4, 140)),
    seed=st.integers(0, 99),
)
def test_whatever_is_painted_a_longer_line_is_a_line(painted_road, dash, shape, noise, span, seed):
    def course(s):
        return shape[0] * (s - 20) + shape[1] * (s - 20) ** 2

    road = painted_road(length=LENGTH).line(course, dash=dash).grass(-5, 5, noise, seed)
    profile = road.bands()
    view = profile.view
    rows = np.arange(len(view.s))[::-1][span[0] : sum(span)]
    line = LaneLine(rows, view.s[rows], course(view.s[rows]), 0.0, 2.0)
    longer = extend_line(line, profile, BLANK_COST, CONFIG)
    assert longer.score >= line.score
    assert np.all(np.diff(longer.rows) == -1)
    assert set(line.rows) <= set(longer.rows) <= set(range(len(view.s)))
    np.testing.assert_array_equal(longer.s, view.s[longer.rows])
    assert longer.n.shape == longer.s.shape
    assert np.isfinite([*longer.n, longer.bend]).all()


@pytest.mark.parametrize("slope", [-0.15, 0.15])
def test_paint_of_a_line_that_it_crosses_is_not_its_own(painted_road, slope):
    """A streak that runs into a border line is not that line."""

    def streak(s):
        return N + slope * (s - 12)

    profile = painted_road(length=LENGTH).line(N).line(streak, first=20).bands()
    line = piece(profile.view, streak, 20, 40, score=10.0)
    assert extend_line(line, profile, BLANK_COST, CONFIG) is line
    steep = ExtensionConfig(turn_max=0.2)
    assert extend_line(line, profile, BLANK_COST, steep) is not line


def test_it_does_not_go_on_over_paint_of_a_line_beside_it(painted_road):
    """A streak 12 m ahead points back to the border line, which runs on past it."""

    def streak(s):
        return N + 0.08 * (s - 14)

    profile = paint(painted_road(length=LENGTH).line(N), streak, (22, 30)).bands()
    line, border = piece(profile.view, streak, 22, 30), piece(profile.view, straight, 4, 40, score=30.0)
    assert extend_line(line, profile, BLANK_COST, CONFIG).s[0] < 18
    assert extend_line(line, profile, BLANK_COST, CONFIG, [border]) is line


def test_it_takes_in_the_dash_that_was_found_as_a_line_of_its_own(painted_road):
    """What ends before it begins is a piece of it."""
    profile = paint(painted_road(length=LENGTH), straight, (FIRST, LAST), (LAST + 6, LAST + 10)).bands()
    line, dash = piece(profile.view, straight), piece(profile.view, straight, LAST + 6, LAST + 10)
    assert spans(extend_line(line, profile, BLANK_COST, CONFIG, [dash]), FIRST, LAST + 10)


@pytest.mark.parametrize(("gap_max", "bridged"), [(3.75, False), (4.0, True)])
def test_the_longest_gap_is_that_of_the_configuration(painted_road, gap_max, bridged):
    road = paint(painted_road(length=LENGTH), straight, (FIRST, LAST), (LAST + 4, LAST + 8))
    line, longer = extended(road, straight, config=ExtensionConfig(gap_max=gap_max))
    assert (longer is not line) == bridged
