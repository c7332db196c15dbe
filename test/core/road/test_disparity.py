# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Disparity of shifted noise and of a rendered road; NaN where nothing can be matched."""

from dataclasses import replace
from functools import cache

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.geometry.vertical_curve import VerticalCurve
from lane_dp_ros.core.parameter import parameters
from lane_dp_ros.core.road.disparity import DisparityConfig, dense_disparity
from lane_dp_ros.core.types import StereoFrame
from lane_dp_ros.scenes import CAMERA

pytestmark = pytest.mark.filterwarnings("error")

LEVEL = StereoCamera(fx=300.0, fy=300.0, cx=160.0, cy=30.0, baseline=0.5)
FIRST_ROW = 21  # cy - 3 % of fy: higher rows show no road
CONFIG = DisparityConfig()
SMALL = st.tuples(st.integers(1, 40), st.integers(1, 120))
BESIDE = 900  # columns of the texture on either side of the left image


@cache
def texture():
    """Smooth noise that no pair shows to its end."""
    noise = np.random.default_rng(1).integers(0, 256, (80, 4096 + 2 * BESIDE)).astype(np.float32)
    smooth = cv2.GaussianBlur(noise, (0, 0), 3)
    return cv2.normalize(smooth, None, 0, 255, cv2.NORM_MINMAX, cv2.CV_8U)


def shifted_pair(disparity, columns=320):
    """Smooth noise (80, columns), seen by the right camera `disparity` pixels farther left."""
    return tuple(texture()[:, first : first + columns].copy() for first in (BESIDE, BESIDE + disparity))


def full_disparity(left, right, camera=LEVEL, config=CONFIG, largest=64.0):
    """Return the disparity (H, W) of every pixel."""
    return dense_disparity(StereoFrame(left, right), camera, config, largest).full


@pytest.mark.parametrize("largest", [32, 64, 96, 128])  # at full, half, third and quarter resolution
@pytest.mark.parametrize("disparity", [12, 24])  # whole pixels at each scale: SGBM drifts between
def test_a_shifted_picture_has_its_shift_for_disparity(disparity, largest):
    found = full_disparity(*shifted_pair(disparity), largest=largest)
    assert found.shape == (80, 320)
    assert found.dtype == np.float32
    inner = found[30:-10, 40:-10]
    assert np.mean(np.isfinite(inner)) > 0.8
    assert np.nanmedian(inner) == pytest.approx(disparity, abs=0.25)


@given(columns=st.integers(320, 4096), share=st.floats(0.02, 0.05))
def test_images_are_reduced_until_there_are_32_disparities(columns, share):
    """Whatever their size; what is found is exact to a part of a cell."""
    disparity = round(share * columns)
    found = dense_disparity(StereoFrame(*shifted_pair(disparity, columns)), LEVEL, CONFIG, 1.2 * disparity)
    downscale = -(-12 * disparity // 320)
    assert found.matched.shape == (59 // downscale, columns // downscale)
    shown_by_both = found.matched[:, disparity // downscale + 8 : -4]
    assert np.nanmedian(shown_by_both) == pytest.approx(disparity, abs=0.4 * downscale)


def test_rows_above_the_horizon_are_not_matched():
    found = full_disparity(*shifted_pair(20))
    assert np.isnan(found[:FIRST_ROW]).all()
    assert np.isfinite(found[FIRST_ROW]).any()


def test_at_the_left_border_there_is_disparity_where_the_right_image_shows_the_pixel():
    """Column u of the left image is column u - 24 of the right one."""
    found = full_disparity(*shifted_pair(24))[30:-10]
    assert np.mean(np.isfinite(found[:, :20])) < 0.15  # by chance, with other disparities
    assert np.isfinite(found[:, 32:60]).all()
    assert not np.any(found > np.arange(320) + 1)  # the middle of a cell lies beside its first pixel


@pytest.mark.parametrize("offset", [5.0, 4.5, -2.4])
def test_the_cameras_offset_is_taken_off(offset):
    found = full_disparity(*shifted_pair(20), replace(LEVEL, disparity_offset=offset))
    assert np.nanmedian(found[30:-10, 50:-10]) == pytest.approx(20 - offset, abs=0.3)


@settings(max_examples=30)
@given(offset=st.integers(-400, 400))
def test_principal_points_that_lie_apart_give_the_same_disparity(offset):
    """In the columns that both cameras show: the right one looks so many pixels to the side."""
    as_before = full_disparity(*shifted_pair(20, 1242))
    camera = replace(LEVEL, disparity_offset=float(offset))
    found = full_disparity(*shifted_pair(20 + offset, 1242), camera)
    both = slice(max(offset, 0) + 40, 1242 + min(offset, 0) - 10)
    assert np.nanmax(np.abs(found - as_before)[30:-10, both]) < 0.2  # SGBM is not local
    assert np.mean(np.isfinite(found[30:-10, both])) > 0.98


@pytest.mark.parametrize("offset", [-400, -30, 30, 400])
def test_what_the_right_camera_does_not_show_has_no_disparity(offset):
    camera = replace(LEVEL, disparity_offset=float(offset))
    found = full_disparity(*shifted_pair(20 + offset, 1242), camera)[30:-10]
    beside = found[:, : offset + 16] if offset > 0 else found[:, offset + 24 :]
    assert np.mean(np.isfinite(beside)) < 0.05


@pytest.mark.parametrize("offset", [-320, 320, 5000])
def test_cameras_that_show_nothing_in_common_have_no_disparity(offset):
    found = full_disparity(*shifted_pair(20), replace(LEVEL, disparity_offset=float(offset)))
    assert np.isnan(found).all()


def test_what_lies_behind_infinity_is_not_found():
    left, right = shifted_pair(20)
    found = full_disparity(right, left)
    assert not np.any(found < 0)


def test_a_rendered_road_has_the_disparity_of_its_plane(scene):
    """Matched at a quarter of the resolution: 103 px are the largest disparity there may be."""
    road, pair = scene
    plane = VerticalCurve.plane(CAMERA, road.camera_height, road.pitch)
    found = dense_disparity(StereoFrame(pair.left, pair.right), CAMERA, CONFIG, 103.0)
    assert found.cell == 4
    points = CAMERA.project(np.concatenate(pair.lanes))
    u, v = np.rint(points).astype(int).T
    errors = np.abs(found.at(v, u) - plane.disparity(u, v))
    assert np.mean(np.isfinite(errors)) > 0.9  # the left border of the image has no partner
    assert np.nanmedian(errors) < 1.0  # px
    assert np.nanpercentile(errors, 90) < 2.0


@pytest.mark.parametrize("shape", [(1, 1), (40, 64), (2000, 20)])
def test_images_too_small_to_match_have_no_disparity(shape):
    image = np.zeros(shape, np.uint8)
    found = full_disparity(image, image, largest=96.0)
    assert found.shape == shape
    assert np.isnan(found).all()


def test_an_image_above_the_horizon_has_no_disparity():
    left, right = shifted_pair(20)
    assert np.isnan(full_disparity(left, right, replace(LEVEL, cy=1e9))).all()


def test_without_a_right_image_nothing_is_known():
    left, _ = shifted_pair(20)
    found = dense_disparity(StereoFrame(left), LEVEL, CONFIG, 64.0)
    assert found.shape == (80, 320)
    assert np.isnan(found.full).all()


@pytest.mark.parametrize(("largest", "downscale"), [(0.0, 1), (32.0, 1), (32.1, 2), (64.0, 2), (65.0, 3)])
def test_it_is_held_at_the_resolution_at_which_it_was_matched(largest, downscale):
    found = dense_disparity(StereoFrame(*shifted_pair(20)), LEVEL, CONFIG, largest)
    assert found.first == FIRST_ROW
    assert found.matched.shape == ((80 - FIRST_ROW) // downscale, 320 // downscale)


@settings(max_examples=200)  # every pair of values
@given(data=st.data())
def test_awkward_images_and_cameras_give_a_picture(awkward, data):
    image, _, camera = data.draw(awkward)
    assert full_disparity(image, image, camera).shape == image.shape


@pytest.mark.parametrize("name", parameters(CONFIG))
@pytest.mark.parametrize("end", ["minimum", "maximum"])
def test_every_parameter_works_at_its_limits(name, end):
    """OpenCV may end the process instead."""
    limit = int(getattr(parameters(CONFIG)[name], end))
    left = np.random.default_rng(0).integers(0, 256, (100, 1200)).astype(np.uint8)
    config = replace(CONFIG, **{"P1": 0, "P2": 16000, name: limit})
    assert full_disparity(left, left, replace(LEVEL, cy=0.0), config).shape == left.shape


@settings(max_examples=100)
@given(
    shape=SMALL, window=st.sampled_from([1, 5, 31]), largest=st.floats(0, 1e6), offset=st.floats(-200, 200)
)
def test_no_size_of_image_is_too_awkward(shape, window, largest, offset):
    config = replace(CONFIG, correlation_window_size=window)
    left = np.random.default_rng(0).integers(0, 256, shape).astype(np.uint8)
    camera = replace(LEVEL, cy=0.0, disparity_offset=offset)
    found = full_disparity(left, left, camera, config, largest)
    assert found.shape == shape
    assert not np.any(found < -0.5)  # what is left of an offset of whole pixels


def test_below_an_image_that_ends_above_the_road_there_is_nothing_to_match():
    left, right = shifted_pair(20)
    camera = replace(LEVEL, cy=200.0, disparity_offset=40.0)
    assert np.isnan(full_disparity(left, right, camera)).all()
