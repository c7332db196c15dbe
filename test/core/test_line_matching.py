# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The matching of known lines with found ones."""

from itertools import combinations, pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from lane_dp_ros.core.line_matching import match_in_order


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
