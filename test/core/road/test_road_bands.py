# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Far and near road of a pair: which rows they are, and where in the whole image their pixels lie."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.geometry.disparity_map import DisparityMap
from lane_dp_ros.core.geometry.vertical_curve import VerticalCurve
from lane_dp_ros.core.road.road_bands import BandPixels, road_bands
from lane_dp_ros.core.types import StereoFrame

pytestmark = pytest.mark.filterwarnings("error")

FOCAL, HEIGHT = 500.0, 1.5  # px, m
CAMERA = StereoCamera(fx=FOCAL, fy=FOCAL, cx=300.0, cy=60.0, baseline=0.4, disparity_offset=7.0)
ROAD = VerticalCurve.plane(CAMERA, HEIGHT, 0.0)
SIZES = st.tuples(st.integers(240, 330), st.integers(560, 700))  # rows, columns
SPLIT_ROW = 60 + 500 * 1.5 / 12  # 122.5: the plane 12 m ahead
HORIZON_ROW = 60 + 0.03 * 500  # 75


def unmatched(shape, first, downscale):
    """Return a map of whole cells: at the right and below some pixels of the image may be left over."""
    rows, columns = (shape[0] - first) // downscale, shape[1] // downscale
    return DisparityMap(shape, first, np.full((rows, columns), np.nan, np.float32), downscale)


def blob(shape, u, v, sigma):
    """Return a grey image with a bright bell at (u, v)."""
    y, x = np.ogrid[: shape[0], : shape[1]]
    return np.rint(60 + 180 * np.exp(-((x - u) ** 2 + (y - v) ** 2) / (2 * sigma**2))).astype(np.uint8)


def centroid(passed):
    """Return column and row of what is brighter than its surroundings."""
    bright = np.maximum(passed - 0.5 * passed.max(), 0)
    row, column = np.indices(bright.shape)
    return (bright * column).sum() / bright.sum(), (bright * row).sum() / bright.sum()


def chosen(band, cells, most):
    """Return row and column of the strong pixels in cells, each as its band shows it."""
    pixels = band.strong_pixels(cells, most)
    row, column = pixels.row.astype(int), pixels.column.astype(int)
    np.testing.assert_array_equal(pixels.u, band.u[column])
    np.testing.assert_array_equal(pixels.v, band.v[row])
    np.testing.assert_array_equal(pixels.grey, band.left[row, column])
    np.testing.assert_array_equal(pixels.gradient, band.left_gradient[row, column])
    return row, column


@given(
    shape=SIZES,
    first=st.integers(40, 50),
    downscale=st.integers(1, 9),
    u=st.floats(150, 400),
    depth=st.sampled_from([20.0, 6.0]),
)
def test_pixels_lie_where_the_image_shows_them(shape, first, downscale, u, depth):
    """A bell on the far or on the near road, in the right image where the surface has it."""
    (v,) = ROAD.ground_to_pixel(np.zeros(1), np.full(1, depth))[1]
    d = FOCAL * 0.4 / depth
    images = [blob(shape, at, v, sigma=1.5 * max(downscale / 2, 1)) for at in (u, u - d - 7.0)]
    bands = road_bands(StereoFrame(*images), unmatched(shape, first, downscale), ROAD)
    band = bands[0] if depth > 12 else bands[1]
    column, row = centroid(band.left)
    columns, rows = np.arange(len(band.u)), np.arange(len(band.v))
    assert np.interp(column, columns, band.u) == pytest.approx(u, abs=0.1 * band.step + 0.1)
    assert np.interp(row, rows, band.v) == pytest.approx(v, abs=0.1 * band.step + 0.1)
    fields = round(row), round(column), band.u[round(column)], band.v[round(row)], 0, 0
    nearest = BandPixels(*np.array(fields, np.float32)[:, None])
    (right_column,) = band.right_columns(nearest, ROAD.disparity(nearest.u, nearest.v), CAMERA)
    expected_column, _ = centroid(band.right)
    slope = 0.4 * FOCAL / (FOCAL * HEIGHT)  # px of disparity a row
    tolerance = 0.2 + (0.5 + 0.1) * slope
    assert right_column - round(column) == pytest.approx(expected_column - column, abs=tolerance)


@given(shape=SIZES, first=st.integers(40, 50), downscale=st.integers(1, 9))
def test_far_road_begins_twelve_metres_ahead_and_near_road_ends_with_the_image(shape, first, downscale):
    image = np.zeros(shape, np.uint8)
    far, near = road_bands(StereoFrame(image, image), unmatched(shape, first, downscale), ROAD)
    cell = 1.3 * downscale + 1  # px
    assert far.v[0] == pytest.approx(HORIZON_ROW, abs=cell)
    assert SPLIT_ROW < far.v[-1] < SPLIT_ROW + 4 * cell  # a few rows more, of those that both have
    assert near.v[0] == pytest.approx(SPLIT_ROW, abs=cell)
    assert near.v[-1] == pytest.approx(shape[0] - 1, abs=cell)
    for band in (far, near):
        assert band.left.shape == band.right.shape == band.strong.shape == (len(band.v), len(band.u))
        assert band.u[0] == pytest.approx((band.step - 1) / 2, abs=1e-3)
        assert np.allclose(np.diff(band.u), band.step, atol=1e-3)
        assert not band.strong.any()


@pytest.mark.parametrize(("downscale", "far_step", "near_step"), [(1, 1, 1), (2, 1, 1), (4, 1, 2), (8, 2, 4)])
def test_far_road_is_looked_at_more_finely_than_near_road(downscale, far_step, near_step):
    """Four and two pixels a cell, and never more than the image has."""
    image = np.zeros((300, 640), np.uint8)
    far, near = road_bands(StereoFrame(image, image), unmatched((300, 640), 44, downscale), ROAD)
    assert (far.step, near.step) == (far_step, near_step)


def test_brightness_is_not_looked_at():
    left = np.random.default_rng(0).integers(50, 150, (300, 640)).astype(np.uint8)
    for band in road_bands(StereoFrame(left, left + 40), unmatched((300, 640), 44, 4), ROAD):
        np.testing.assert_allclose(band.left, band.right, atol=1.5)
        assert abs(band.left.mean()) < 0.5


def test_strong_pixels_are_those_of_chosen_cells_with_a_gradient():
    left = np.full((300, 640), 90, np.uint8)
    left[:, 320:] = 150  # an edge; the cells of 4 px at both its sides
    disparity = unmatched((300, 640), 44, 4)
    _, near = road_bands(StereoFrame(left, left), disparity, ROAD)
    cells = np.zeros((near.rows.stop - near.rows.start, 160), bool)
    assert len(near.strong_pixels(cells, 100).u) == 0
    cells[2] = True
    row, column = chosen(near, cells, 100)
    assert set(row) == {4, 5}  # of two pixels a cell
    assert {159, 160} <= set(column) <= set(range(153, 167))  # what is high-passed rings
    cells[:, :80] = True
    assert len(near.strong_pixels(cells, 7).u) in range(4, 8)


def test_no_more_pixels_than_asked_for_are_taken():
    noise = np.random.default_rng(0).integers(0, 256, (300, 640)).astype(np.uint8)
    for band in road_bands(StereoFrame(noise, noise), unmatched((300, 640), 44, 4), ROAD):
        cells = np.ones((band.rows.stop - band.rows.start, 160), bool)
        for most in (1, 100, 10_000_000):
            row, column = chosen(band, cells, most)
            assert 0 < len(row) <= most
            assert np.all(np.diff(row * len(band.u) + column) > 0)
