# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Disparity of shifted noise and of a rendered road; NaN where nothing can be matched."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.geometry.road_surface import RoadSurface
from lane_dp_ros.core.parameter import parameters
from lane_dp_ros.core.road.disparity import DisparityConfig, dense_disparity
from lane_dp_ros.core.types import StereoFrame
from lane_dp_ros.scenes import CAMERA

pytestmark = pytest.mark.filterwarnings("error")

LEVEL = StereoCamera(fx=300.0, fy=300.0, cx=160.0, cy=30.0, baseline=0.5)
FIRST_ROW = 21  # cy - 3 % of fy: higher rows show no road
CONFIG = DisparityConfig(disparity_range=64)
SMALL = st.tuples(st.integers(1, 40), st.integers(1, 120))


def shifted_pair(disparity, shape=(80, 320)):
    """Smooth noise, seen by the right camera `disparity` pixels farther left."""
    noise = np.random.default_rng(1).integers(0, 256, (shape[0], shape[1] + 64)).astype(np.float32)
    texture = cv2.normalize(cv2.GaussianBlur(noise, (0, 0), 3), None, 0, 255, cv2.NORM_MINMAX, cv2.CV_8U)
    return texture[:, : shape[1]].copy(), texture[:, disparity : shape[1] + disparity].copy()


def full_disparity(left, right, camera=LEVEL, config=CONFIG):
    """Return the disparity (H, W) of every pixel."""
    return dense_disparity(StereoFrame(left, right), camera, config).full


@pytest.mark.parametrize("downscale", [1, 2, 3, 4])
@pytest.mark.parametrize("disparity", [12, 24, 36])  # whole pixels at each scale: SGBM drifts between
def test_a_shifted_picture_has_its_shift_for_disparity(disparity, downscale):
    found = full_disparity(*shifted_pair(disparity), config=replace(CONFIG, downscale=downscale))
    assert found.shape == (80, 320)
    assert found.dtype == np.float32
    inner = found[30:-10, 90:-10]
    assert np.mean(np.isfinite(inner)) > 0.8
    assert np.nanmedian(inner) == pytest.approx(disparity, abs=0.25)


def test_rows_above_the_horizon_are_not_matched():
    found = full_disparity(*shifted_pair(20))
    assert np.isnan(found[:FIRST_ROW]).all()
    assert np.isfinite(found[FIRST_ROW]).any()


def test_the_cameras_offset_is_taken_off():
    found = full_disparity(*shifted_pair(20), replace(LEVEL, disparity_offset=5.0))
    assert np.nanmedian(found[30:-10, 90:-10]) == pytest.approx(15, abs=0.3)


def test_what_lies_behind_infinity_is_not_found():
    left, right = shifted_pair(20)
    found = full_disparity(right, left)
    assert not np.any(found < 0)


def test_a_rendered_road_has_the_disparity_of_its_plane(scene):
    road, pair = scene
    plane = RoadSurface.plane(CAMERA, road.camera_height, road.pitch)
    found = full_disparity(pair.left, pair.right, CAMERA, DisparityConfig())
    u, v = np.rint(CAMERA.project(np.concatenate(pair.lanes))).astype(int).T
    errors = np.abs(found[v, u] - plane.disparity(u, v))
    assert np.mean(np.isfinite(errors)) > 0.85  # the left border of the image has no partner
    assert np.nanmedian(errors) < 0.5  # px
    assert np.nanpercentile(errors, 90) < 2.0


@pytest.mark.parametrize("shape", [(1, 1), (40, 64), (2000, 60)])
def test_images_too_small_to_match_have_no_disparity(shape):
    image = np.zeros(shape, np.uint8)
    found = full_disparity(image, image)
    assert found.shape == shape
    assert np.isnan(found).all()


def test_an_image_above_the_horizon_has_no_disparity():
    left, right = shifted_pair(20)
    assert np.isnan(full_disparity(left, right, replace(LEVEL, cy=1e9))).all()


def test_without_a_right_image_nothing_is_known():
    left, _ = shifted_pair(20)
    found = dense_disparity(StereoFrame(left), LEVEL, CONFIG)
    assert found.shape == (80, 320)
    assert np.isnan(found.full).all()


@pytest.mark.parametrize("downscale", [1, 2])
def test_it_is_held_at_the_resolution_at_which_it_was_matched(downscale):
    found = dense_disparity(StereoFrame(*shifted_pair(20)), LEVEL, replace(CONFIG, downscale=downscale))
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


@settings(deadline=None, max_examples=100)
@given(
    shape=SMALL,
    window=st.sampled_from([1, 5, 31]),
    downscale=st.integers(1, 4),
    disparity_range=st.sampled_from([32, 96]),
)
def test_no_size_of_image_is_too_awkward(shape, window, downscale, disparity_range):
    config = DisparityConfig(
        disparity_range=disparity_range,
        correlation_window_size=window,
        downscale=downscale,
    )
    left = np.random.default_rng(0).integers(0, 256, shape).astype(np.uint8)
    found = full_disparity(left, left, replace(LEVEL, cy=0.0), config)
    assert found.shape == shape
    assert not np.any(found < 0)
