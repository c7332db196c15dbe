# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Rows of left and right that do not correspond, on a pattern and on rendered pairs."""

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lane_dp_ros.core.geometry.disparity_map import DisparityMap
from lane_dp_ros.core.monitoring.vertical_disparity import vertical_disparity
from lane_dp_ros.core.road.disparity import DisparityConfig, dense_disparity
from lane_dp_ros.core.types import StereoFrame
from lane_dp_ros.scenes import CAMERA

pytestmark = pytest.mark.filterwarnings("error")

SHAPE = (375, 1242)


def pattern(shift=0.0, turn=0.0):
    """A smooth pattern, lower by `shift` px in the middle and by `turn` px more at the right border."""
    v, u = np.mgrid[: SHAPE[0], : SHAPE[1]].astype(float)
    v = v - shift - turn * (2 * u / SHAPE[1] - 1)
    return (120 + 50 * np.sin(v / 3) * np.cos(u / 7)).astype(np.uint8)


def offset(right, disparity=0.0, left=None):
    left = pattern() if left is None else left
    everywhere = DisparityMap(SHAPE, 0, np.full(SHAPE, disparity, np.float32))
    return vertical_disparity(left, right, everywhere, CAMERA)


@pytest.mark.parametrize(("shift", "turn"), [(0.0, 0.0), (0.4, 0.0), (-0.3, 0.0), (0.0, 0.5), (0.2, -0.6)])
def test_the_offset_of_a_pattern_is_measured(shift, turn):
    found = offset(pattern(shift, turn))
    assert (found.shift, found.turn) == pytest.approx((shift, turn), abs=0.05)


def test_the_disparity_is_taken_into_account_and_what_it_lacks_is_no_row_offset():
    right = np.roll(pattern(0.3), -20, axis=1)
    assert offset(right, disparity=20.3).shift == pytest.approx(0.3, abs=0.05)


def test_a_brighter_camera_makes_no_offset():
    found = offset(pattern() + np.uint8(40))
    assert (found.shift, found.turn) == pytest.approx((0, 0), abs=0.02)


def test_of_colour_green_is_looked_at():
    blue_and_red = np.zeros(SHAPE, np.uint8)
    left, right = (cv2.merge([blue_and_red, image, blue_and_red]) for image in (pattern(), pattern(0.4)))
    assert offset(right, left=left) == offset(pattern(0.4))


@pytest.fixture
def offset_of(scene):
    _, pair = scene

    def offset_of(rows=0.0, degrees=0.0):
        """Return the offset of the scene with its right camera pitched and rotated."""
        turn = cv2.getRotationMatrix2D((CAMERA.cx, CAMERA.cy), degrees, 1)
        turn[1, 2] += rows
        size = pair.right.shape[::-1]
        right = cv2.warpAffine(pair.right, turn, size, borderMode=cv2.BORDER_REPLICATE)
        disparity = dense_disparity(StereoFrame(pair.left, right), CAMERA, DisparityConfig(), 103.0)
        return vertical_disparity(pair.left, right, disparity, CAMERA)

    return offset_of


def test_a_rendered_pair_is_aligned(offset_of):
    found = offset_of()
    assert abs(found.shift) < 0.1
    assert abs(found.turn) < 0.2


@pytest.mark.parametrize("rows", [-1.0, 1.0])
def test_a_pitched_camera_shows(offset_of, rows):
    assert 0.35 < offset_of(rows=rows).shift * np.sign(rows) < 1.2


@pytest.mark.parametrize("degrees", [-0.2, 0.2])
def test_a_rotated_camera_shows(offset_of, degrees):
    assert 0.7 < -offset_of(degrees=degrees).turn * np.sign(degrees) < 2.5


@settings(max_examples=200)  # every pair of values
@given(data=st.data())
def test_nothing_to_see_tells_nothing(awkward, data):
    image, disparity, camera = data.draw(awkward)
    found = vertical_disparity(image, image, disparity, camera)
    assert found is None or np.all(np.isfinite(found))
    even = np.zeros_like(image)
    assert vertical_disparity(even, even, disparity, camera) is None
