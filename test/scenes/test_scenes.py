# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The rendered road: repeatable, true to its lines, one world for both cameras and all frames."""

import cv2
import numpy as np
import pytest

from lane_dp_ros.scenes import CAMERA, SIZE, Road, render_pair, render_sequence
from lane_dp_ros.scenes.course import Course
from lane_dp_ros.scenes.road import SOLID

BENDS = {
    "straight": Road(swing=0),
    "left": Road(curvature=-0.008, swing=0),
    "right": Road(curvature=0.008, swing=0),
}
pytestmark = pytest.mark.filterwarnings("error")  # no pixel may be NaN or out of range
GREY = cv2.COLOR_BGR2GRAY


@pytest.fixture(scope="module")
def pair():
    return render_pair(Road(), 100.0, 1)


def ground_disparity(road, v):
    """Disparity [px] of a flat road in picture row v: y cos(pitch) + z sin(pitch) = camera height."""
    slope = (v - CAMERA.cy) / CAMERA.fy
    return (
        CAMERA.fx * CAMERA.baseline * (slope * np.cos(road.pitch) + np.sin(road.pitch)) / road.camera_height
    )


def test_pictures_are_of_kitti_size_and_in_colour(pair):
    for image in (pair.left, pair.right):
        assert image.shape == (SIZE[1], SIZE[0], 3)
        assert image.dtype == np.uint8
    assert np.ptp(pair.left[200].astype(int), axis=1).max() > 30


def test_the_same_seed_gives_the_same_pictures_and_another_does_not(pair):
    again, other = render_pair(Road(), 100.0, 1), render_pair(Road(), 100.0, 2)
    np.testing.assert_array_equal(pair.left, again.left)
    np.testing.assert_array_equal(pair.right, again.right)
    assert np.mean(pair.left != other.left) > 0.5


@pytest.mark.parametrize("road", BENDS.values(), ids=BENDS)
def test_the_true_lines_lie_on_the_middle_of_the_paint(road):
    pair = render_pair(road, 50.0, 3)
    grey = cv2.cvtColor(pair.left, GREY).astype(float)
    assert len(pair.lanes) == 3
    for lane, least in zip(pair.lanes, (30, 10, 30), strict=True):  # the middle one is dashed
        errors = np.array(list(distances_to_paint(grey, CAMERA.project(lane)[::-1])))
        assert len(errors) > least
        assert abs(np.median(errors)) < 0.2
        assert np.percentile(np.abs(errors), 90) < 0.5


def distances_to_paint(grey, line):
    """Yield, every third row, how far [px] the line is from the paint's middle, where there is paint."""
    for v in range(int(line[0, 1]) + 8, int(line[-1, 1]), 3):
        u = np.interp(v, line[:, 1], line[:, 0])
        if 30 < u < SIZE[0] - 30:
            first = round(u) - 25
            window = grey[v, first : first + 51]
            if window.max() > np.median(window) + 50:
                yield u - first - middle_of_brightest_band(window)


def middle_of_brightest_band(window):
    """Centroid of the one band that is brighter than half-way from the asphalt to the brightest."""
    weight = np.maximum(0, window - (np.median(window) + window.max()) / 2)
    band = cv2.connectedComponents((weight > 0).astype(np.uint8)[None])[1].ravel()
    inside = band == band[window.argmax()]
    return np.average(np.flatnonzero(inside), weights=weight[inside])


def test_the_lines_are_on_the_road_surface_from_near_to_far(pair):
    road = Road()
    assert len(pair.lanes) == 3
    for lane in pair.lanes:
        height = lane[:, 1] * np.cos(road.pitch) + lane[:, 2] * np.sin(road.pitch)
        np.testing.assert_allclose(height, 1.65, atol=1e-9)
        assert np.all(np.diff(lane[:, 2]) > 0)
        assert np.linalg.norm(np.diff(lane, axis=0), axis=1).max() < 0.55
        assert lane[-1, 2] > 30
    assert pair.lanes[0][-1, 0] < pair.lanes[1][-1, 0] < pair.lanes[2][-1, 0]


def test_the_road_bends_as_told():
    """A curvature of 1/125 m to the right takes a line (20 m)^2 / (2 * 125 m) = 1.6 m aside at 20 m."""
    straight, right = (render_pair(BENDS[name], 0.0, 0).lanes[2] for name in ("straight", "right"))
    aside = [np.interp(20.0, lane[:, 2], lane[:, 0]) for lane in (straight, right)]
    assert aside[0] == pytest.approx(1.75)
    assert aside[1] - aside[0] == pytest.approx(1.6, abs=0.1)


def test_a_stereo_matcher_finds_the_ground(pair):
    matcher = cv2.StereoSGBM_create(0, 96, 5, 200, 800, mode=cv2.STEREO_SGBM_MODE_SGBM_3WAY)
    disparity = matcher.compute(cv2.cvtColor(pair.left, GREY), cv2.cvtColor(pair.right, GREY)) / 16.0
    for v in (210, 240, 280, 330):  # 30 m to 7 m
        on_road = disparity[v, 580:680]
        valid = on_road > 0
        assert valid.mean() > 0.9
        assert np.median(np.abs(on_road[valid] - ground_disparity(Road(), v))) < 0.3


def test_both_cameras_take_their_own_noise(pair):
    """Equal noise would help a stereo matcher find a shift of zero: skies must not be equal."""
    assert np.mean(pair.left[:20] != pair.right[:20]) > 0.5


def test_the_texture_moves_with_the_road():
    """Warped by the plane's homography of 0.4 m of driving, a frame is the next one; unmoved, it is not."""
    road = Road(swing=0)
    before, after = (
        cv2.cvtColor(render_pair(road, p, 5).left, GREY).astype(np.float32) for p in (20.0, 20.4)
    )
    K = np.array([[CAMERA.fx, 0, CAMERA.cx], [0, CAMERA.fy, CAMERA.cy], [0, 0, 1]])
    normal = np.array([0, np.cos(road.pitch), np.sin(road.pitch)]) / road.camera_height
    ahead = 0.4 * np.array([0, -np.sin(road.pitch), np.cos(road.pitch)])
    H_after_before = K @ (np.eye(3) - np.outer(ahead, normal)) @ np.linalg.inv(K)
    moved = cv2.warpPerspective(before, H_after_before, SIZE)
    part = np.s_[260:360, 480:660]  # asphalt only
    assert np.corrcoef(moved[part].ravel(), after[part].ravel())[0, 1] > 0.6
    assert abs(np.corrcoef(before[part].ravel(), after[part].ravel())[0, 1]) < 0.45


def test_a_sequence_drives_at_15_m_a_second():
    pairs = list(render_sequence(frames=3, rate=10.0, seed=7))
    assert np.diff([pair.stamp_ns for pair in pairs]).tolist() == [100_000_000] * 2
    assert len({pair.left.tobytes() for pair in pairs}) == 3
    again = next(render_sequence(frames=1, rate=10.0, seed=7))
    np.testing.assert_array_equal(pairs[0].left, again.left)


@pytest.mark.parametrize("curvature", [-0.03, -0.01, 0.0, 0.01, 0.03])
def test_places_on_the_road_are_found_again_on_the_ground(curvature):
    course = Course(Road(curvature=curvature, swing=0), 10.0)
    s = np.arange(3.0, 40.0, 1.7)
    for n in (-6.0, 0.0, 4.0):
        x, z = course.places(s, n)
        s_found, n_found, _ = course.locate(x.astype(np.float32), z.astype(np.float32))
        np.testing.assert_allclose(s_found, s, atol=0.02)
        np.testing.assert_allclose(n_found, n, atol=0.005)


def test_a_road_that_cannot_be_is_refused():
    with pytest.raises(
        ValueError, match="2 lines, 2 lanes, driven lane 1: expected one line more than lanes"
    ):
        Road(lines=(SOLID, SOLID))
    with pytest.raises(ValueError, match="driven lane 2"):
        Road(driven=2)
    with pytest.raises(ValueError, match=r"curvature up to 0.056 1/m, expected at most 0.035 1/m"):
        Road(curvature=0.05)
