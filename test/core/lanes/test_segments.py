# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Values of several lines in one array: three lines of 2, 1 and 3 values, by hand, and any by a property."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lane_dp_ros.core.lanes.segments import Segments

THREE = Segments([2, 1, 3])
VALUES = np.array([1.0, 3.0, 7.0, 5.0, 4.0, 9.0])


def test_each_value_belongs_to_its_line():
    assert len(THREE) == 3
    assert THREE.index.tolist() == [0, 0, 1, 2, 2, 2]
    assert [VALUES[THREE.part(i)].tolist() for i in range(3)] == [[1, 3], [7], [5, 4, 9]]


def test_true_values_are_counted():
    assert THREE.count(VALUES > 3).tolist() == [0, 1, 3]


def test_values_are_summed_along_the_last_axis():
    assert THREE.sum(VALUES).tolist() == [4, 7, 18]
    assert THREE.sum(np.stack([VALUES, -VALUES])).tolist() == [[4, 7, 18], [-4, -7, -18]]


def test_a_number_of_each_line_is_spread_over_its_values():
    assert THREE.spread(np.array([10, 20, 30])).tolist() == [10, 10, 20, 30, 30, 30]
    two_rows = THREE.spread(np.array([[1, 2, 3], [4, 5, 6]]))
    assert two_rows.tolist() == [[1, 1, 2, 3, 3, 3], [4, 4, 5, 6, 6, 6]]


def test_the_median_of_an_even_number_is_in_the_middle_of_two():
    assert THREE.median(VALUES) == pytest.approx([2.0, 7.0, 5.0])


def test_a_quantile_lies_straight_between_two_values():
    assert THREE.quantile(VALUES, 0.75) == pytest.approx([2.5, 7.0, 7.0])
    assert THREE.quantile(np.stack([VALUES, -VALUES]), 0.0) == pytest.approx(
        np.array([[1, 7, 4], [-3, -7, -9]])
    )
    lowest = THREE.quantile(VALUES, 1.0, np.array([1, 1, 2]))
    assert lowest == pytest.approx([1.0, 7.0, 5.0])


def test_the_median_of_what_is_known():
    """Of the first line half the values are unknown, of the third a third."""
    values = np.array([np.nan, 3.0, 7.0, 5.0, np.nan, -9.0])
    np.testing.assert_allclose(THREE.median_of_known(values), [np.nan, 7.0, -2.0])
    both = THREE.median_of_known(np.stack([values, VALUES]))
    np.testing.assert_allclose(both, [[np.nan, 7.0, -2.0], [2.0, 7.0, 5.0]])


def test_a_moving_sum_ends_with_its_line():
    assert THREE.moving_sum(VALUES, 1).tolist() == VALUES.tolist()
    assert THREE.moving_sum(VALUES, 2).tolist() == [1, 4, 7, 5, 9, 13]
    assert THREE.moving_sum(np.stack([VALUES, -VALUES]), 3).tolist() == [
        [4, 4, 7, 9, 18, 13],
        [-4, -4, -7, -9, -18, -13],
    ]
    values = np.arange(20.0) ** 2
    assert Segments([20]).moving_sum(values, 8).tolist() == np.convolve(values, np.ones(8), "same").tolist()


def test_slopes_are_central_within_a_line_and_one_sided_at_its_ends():
    lines, s = Segments([2, 3]), np.array([1.0, 2.0, 2.0, 4.0, 6.0])
    assert lines.slopes(s, np.array([0.0, 3.0, 1.0, 2.0, 5.0])).tolist() == [3.0, 3.0, 0.5, 1.0, 1.5]


def test_of_the_values_that_are_kept_each_line_has_its_own():
    kept = np.array([False, True, True, True, False, True])
    assert [VALUES[kept][THREE.of_kept(kept).part(i)].tolist() for i in range(3)] == [[3], [7], [5, 9]]


NUMBERS = st.lists(st.floats(-1e5, 1e5), min_size=1, max_size=6)


@given(lines=st.lists(NUMBERS, min_size=1, max_size=5))
def test_whatever_the_lines_their_medians_and_sums_are_those_of_each(lines):
    segments, values = Segments([len(line) for line in lines]), np.concatenate(lines)
    assert segments.median(values) == pytest.approx([np.median(line) for line in lines], abs=1e-8)
    assert segments.sum(values) == pytest.approx([np.sum(line) for line in lines], abs=1e-6)
    assert values[segments.index == 0].tolist() == lines[0]


@given(
    lines=st.lists(st.lists(st.floats(-300, 300, width=32), min_size=1, max_size=6), min_size=2, max_size=5)
)
def test_single_precision_is_enough_to_keep_lines_apart(lines):
    values = np.concatenate(lines).astype(np.float32)
    medians = Segments([len(line) for line in lines]).median(values)
    assert medians == pytest.approx([np.median(line) for line in lines], abs=1e-6)
