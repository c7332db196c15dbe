# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The matching of known lines with found ones."""

from itertools import combinations, pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from lane_dp_ros.core.tracking.association import agreement, match_in_order, shared_rows, strayed
from lane_dp_ros.core.tracking.frenet_line import FrenetLine

S = np.arange(5.0, 25.0, 0.25)


def best_gain(gains):
    """Return the largest sum over every set of pairs that keeps the order."""
    rows, columns = gains.shape
    sets = (
        zip(i, j, strict=True)
        for count in range(min(rows, columns) + 1)
        for i in combinations(range(rows), count)
        for j in combinations(range(columns), count)
    )
    return max(sum(gains[pair] for pair in pairs) for pairs in sets)


@given(arrays(float, st.tuples(st.integers(0, 4), st.integers(0, 4)), elements=st.floats(-0.5, 0.5)))
def test_no_other_matching_in_order_gains_more(gains):
    pairs = match_in_order(gains)
    assert sum(gains[pair] for pair in pairs) == pytest.approx(best_gain(gains), abs=1e-9)
    assert all(gains[pair] > 0 for pair in pairs)
    assert all(a < c and b < d for (a, b), (c, d) in pairwise(pairs))


def test_two_good_pairs_beat_the_nearest_one():
    """The nearest first would pair the known 1.9 with the found 1.75, and leave two lines alone."""
    known, found = np.array([1.5, 1.9]), np.array([1.75, 2.1])
    assert match_in_order(0.5 - np.abs(known[:, None] - found)) == [(0, 0), (1, 1)]


@pytest.mark.parametrize("gain", [-np.inf, np.nan, -0.01, 0.0])
def test_what_gains_nothing_does_not_match(gain):
    assert match_in_order(np.array([[gain]])) == []


@pytest.mark.parametrize("shape", [(0, 0), (0, 3), (3, 0)])
def test_nothing_matches_nothing(shape):
    assert match_in_order(np.empty(shape)) == []


def line(y, s=S):
    """Return the course of a line with that y [m], a function of s or a number."""
    return FrenetLine(s, y(s) if callable(y) else np.full_like(s, y), np.full_like(s, 1.65))


def test_shared_rows_are_those_of_the_picture():
    s = shared_rows(line(0), line(1, S[20:]))
    assert (s[0], s[-1]) == pytest.approx((10.0, 24.75))
    assert np.diff(1 / s) == pytest.approx((1 / 24.75 - 1 / 10) / (len(s) - 1))
    for behind in (-30.0, -25.0):
        assert len(shared_rows(line(0, S + behind), line(0, S))) == 0
    assert len(shared_rows(line(0, S[:40]), line(0, S[30:]))) == 0


def test_agreement_is_rows_times_nearness():
    a, b = line(lambda s: 0.1 * s + 1), line(lambda s: 0.1 * s + 1.4, S[40:])
    assert agreement(a, b, 0.5) == pytest.approx(0.1 * (1 / S[40] - 1 / S[-1]))
    assert agreement(a, b, 0.4) == pytest.approx(0)
    assert agreement(line(0, S[:40]), line(0, S[30:]), 0.5) == 0  # they share less than 3 m


def test_what_lines_share_near_the_camera_counts_most():
    """Of a line's two pieces, and of two lines that fan out, the ones in more rows of the picture."""
    assert agreement(line(0), line(0.1, S[:20]), 0.5) > agreement(line(0), line(0, S[20:]), 0.5)
    fans = [line(lambda s, slope=slope: np.maximum(0, slope * (s - 10))) for slope in (0.0, 0.02, 0.2, 1.0)]
    shares = [agreement(line(0), fan, 0.5) for fan in fans]
    assert np.all(np.diff(shares) < 0)
    assert shares[-1] > 0.5 * shares[0]


def test_lines_that_meet_far_off_only_do_not_agree():
    assert agreement(line(0), line(lambda s: 0.06 * (s - 22)), 0.5) == 0


def joining(s):
    """A line at 0.3 m that, seen from afar, begins on the one at 0."""
    return 0.3 * np.clip((s - 7) / 3, 0, 1)


def test_a_line_found_on_the_paint_of_another_strayed():
    assert strayed(line(joining), line(0.3), [line(0)])
    assert not strayed(line(joining), line(0.3), [])
    assert not strayed(line(joining), line(0.3), [line(0.9)])
    assert not strayed(line(joining), line(0.3), [line(0, S[20:])])  # it runs beyond 10 m only


def test_a_line_that_strayed_before_did_not_stray_now():
    """Found right at last, or on the other line farther on: what was expected had more of it."""
    assert not strayed(line(0.3), line(joining), [line(0)])
    back = line(lambda s: 0.3 * np.clip((17 - s) / 2, 0, 1))
    assert not strayed(back, line(joining), [line(0)])
    assert strayed(back, line(0.3), [line(0)])


@pytest.mark.parametrize("aside", [-0.05, 0.05, 0.3])
def test_lines_that_move_on_the_whole_did_not_stray(aside):
    """By less than half way to the next line, or away from it."""
    assert not strayed(line(0.3 + aside), line(0.3), [line(0)])
