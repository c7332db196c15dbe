# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Disparities at half resolution, looked up by pixels: a map of four cells, and any by a property."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lane_dp_ros.core.geometry.disparity_map import DisparityMap

NAN = np.nan
FOUR = DisparityMap((6, 4), 2, np.array([[10, 20], [30, NAN]], np.float32), 2)  # two rows above


def test_every_pixel_has_the_disparity_of_its_cell():
    expected = [
        [NAN, NAN, NAN, NAN],
        [NAN, NAN, NAN, NAN],
        [10, 10, 20, 20],
        [10, 10, 20, 20],
        [30, 30, NAN, NAN],
        [30, 30, NAN, NAN],
    ]
    assert FOUR.full.dtype == np.float32
    np.testing.assert_array_equal(FOUR.full, expected)


def test_cells_have_their_middles_between_pixels():
    """Rows 2 and 3 have theirs at 2.5."""
    u, v = FOUR.centres
    assert u.dtype == v.dtype == np.float32
    assert (u.tolist(), v.tolist()) == ([0.5, 2.5], [2.5, 4.5])


def test_pixels_are_looked_up_one_by_one():
    found = FOUR.at(np.array([3, 2, 5, 0]), np.array([1, 2, 3, 1]))
    np.testing.assert_array_equal(found, [10, 20, NAN, NAN])
    assert found.dtype == np.float32


def test_rows_and_columns_may_be_a_grid():
    found = FOUR.at(np.array([2, 4])[:, None], np.array([0, 2, 3])[None])
    np.testing.assert_array_equal(found, [[10, 20, 20], [30, NAN, NAN]])


def test_between_pixels_the_nearest_one_counts():
    u, v = np.array([[0.4, 1.6], [0.0, 2.4]], np.float32), np.array([[1.6, 2.4], [3.6, 3.4]], np.float32)
    np.testing.assert_array_equal(FOUR.nearest(u, v), [[10, 20], [30, 20]])


def test_far_above_the_matched_rows_nothing_is_known():
    """Farther above than there are rows that were matched."""
    low = DisparityMap((100, 40), 80, np.ones((10, 20), np.float32), 2)
    found = low.at(np.array([0, 50, 79, 80, 99]), np.zeros(5, int))
    np.testing.assert_array_equal(found, [NAN, NAN, NAN, 1, 1])


@pytest.mark.parametrize("shape", [(1, 1), (3, 5)])
def test_of_an_image_of_which_nothing_was_matched_nothing_is_known(shape):
    unknown = DisparityMap.unknown(shape)
    assert unknown.full.shape == unknown.shape == shape
    assert np.isnan(unknown.full).all()
    assert np.isnan(unknown.at(np.array([0]), np.array([shape[1] - 1]))).all()


def test_without_a_row_below_the_first_one_nothing_is_known():
    assert np.isnan(DisparityMap((4, 4), 4, np.ones((1, 1), np.float32)).full).all()


@given(
    rows=st.integers(1, 60),
    columns=st.integers(1, 60),
    above=st.integers(0, 80),
    downscale=st.integers(1, 4),
)
def test_every_cell_covers_a_square(rows, columns, above, downscale):
    """Those at the right and at the lower border have the rest of the image, too."""
    size = rows * downscale + min(rows, downscale) - 1, columns * downscale + min(columns, downscale) - 1
    cells = np.arange(rows * columns, dtype=np.float32).reshape(rows, columns)
    disparity = DisparityMap((above + size[0], size[1]), above, cells, downscale)
    full = disparity.full
    assert np.isnan(full[:above]).all()
    row, column = np.divmod(full[above:], columns)
    assert np.ptp(row, axis=1).max() == np.ptp(column, axis=0).max() == 0
    for index, count, pixels in ((row[:, 0], rows, size[0]), (column[0], columns, size[1])):
        assert index.tolist() == [min(i // downscale, count - 1) for i in range(pixels)]
    v, u = np.indices(disparity.shape)
    np.testing.assert_array_equal(disparity.at(v, u), full)
    u, v = np.meshgrid(*disparity.centres)
    np.testing.assert_array_equal(disparity.nearest(u, v), cells)
