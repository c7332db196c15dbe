# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The road's surface: hand-made numbers, and every coordinate there and back."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.geometry.road_surface import RoadSurface

pytestmark = pytest.mark.filterwarnings("error")

ROUND = StereoCamera(fx=500.0, fy=500.0, cx=300.0, cy=100.0, baseline=0.4)  # numbers for the head
X = np.array([0.0, -3.0, 4.0])
Z = np.array([5.0, 10.0, 30.0])
# Coefficients (b0, b1, b2, b3): a road that lies 1.2 to 2 m below, climbs, sags or bulges, and leans.
SURFACES = st.tuples(st.floats(-8, 8), st.floats(20, 35), st.floats(-1, 1), st.floats(-1.5, 1.5))


def arrays(*numbers):
    return [np.array([number], dtype=float) for number in numbers]


def test_a_level_road_by_hand():
    road = RoadSurface.plane(ROUND, height=2.0, pitch=0.0)
    u, v = road.ground_to_pixel(*arrays(1.0, 10.0))  # 500 px * 1 m / 10 m to the right, 500 * 2 / 10 down
    assert (u[0], v[0]) == pytest.approx((350, 200))
    assert road.disparity(u, v) == pytest.approx(20)  # 500 px * 0.4 m / 10 m
    assert road.gradient(v) == pytest.approx(0.2)  # 20 px over 100 rows
    assert road.horizon(v) == pytest.approx(100)  # cy
    assert (road.camera_height, road.pitch, road.roll, road.gradient_u) == pytest.approx((2, 0, 0, 0))


@pytest.mark.parametrize("pitch", [-0.05, 0.0, 0.02, 0.2])
@pytest.mark.parametrize("height", [1.2, 1.65, 2.3])
def test_a_plane_tells_its_height_and_pitch(camera, height, pitch):
    road = RoadSurface.plane(camera, height, pitch)
    assert (road.camera_height, road.pitch) == pytest.approx((height, pitch))
    assert road.horizon(300.0) == pytest.approx(camera.cy - camera.fy * np.tan(pitch))
    x, y, z = 2.0, (height - 12.0 * np.sin(pitch)) / np.cos(pitch), 12.0  # y cos + z sin = height
    pixel = camera.project(np.array([[x, y, z]]) - camera.left_translation)[0]
    assert np.ravel(road.ground_to_pixel(*arrays(x, z))) == pytest.approx(pixel)


@given(coefficients=SURFACES)
def test_ground_comes_back_from_its_pixels(camera, coefficients):
    road = RoadSurface(camera, coefficients)
    u, v = road.ground_to_pixel(X, Z)
    assume(np.all(road.gradient(v) > 0.05))  # beyond a crest there is no ground to be seen
    np.testing.assert_allclose(road.pixel_to_ground(u, v), (X, Z), rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(road.disparity(u, v), camera.fx * camera.baseline / Z)


@given(coefficients=SURFACES, u=st.floats(0, 640), v=st.floats(150, 300))
def test_the_gradient_is_that_of_the_disparity(camera, coefficients, u, v):
    road = RoadSurface(camera, coefficients)
    u, v = arrays(u, v)
    along = road.disparity(u, v + 0.5) - road.disparity(u, v - 0.5)
    across = road.disparity(u + 0.5, v) - road.disparity(u - 0.5, v)
    np.testing.assert_allclose(road.gradient(v), along, atol=1e-9)
    np.testing.assert_allclose(road.gradient_u, across, atol=1e-9)


def test_the_horizon_of_a_row_is_where_the_tangent_of_the_profile_is_zero():
    road = RoadSurface(ROUND, (0.0, 10.0, 5.0, 0.0))  # 10 n + 5 n^2; at n = 2: 40, slope 30
    assert road.horizon(300.0) == pytest.approx(300 - 40 / 0.30)


def test_a_camera_that_leans_sees_the_road_lean():
    roll = np.deg2rad(3)
    road = RoadSurface(ROUND, (0.0, 10 * np.cos(roll), 0.0, 10 * np.sin(roll)))
    assert road.roll == pytest.approx(roll)


def test_height_above_the_road_is_that_of_a_point(camera):
    road = RoadSurface.plane(camera, height=1.6, pitch=0.0)
    points = np.array([[1.0, 1.6 - 0.3, 10.0], [1.0, 1.6, 10.0], [-2.0, 1.6 + 0.2, 20.0]])  # y is down
    u, v = camera.project(points - camera.left_translation).T
    disparity = camera.fx * camera.baseline / points[:, 2]
    np.testing.assert_allclose(road.height_above(disparity, u, v), [0.3, 0.0, -0.2], atol=1e-9)


def test_no_height_without_disparity(camera):
    road = RoadSurface.plane(camera, height=1.6, pitch=0.0)
    assert np.isnan(road.height_above(np.array([np.nan]), *arrays(100, 200)))
    assert not np.isfinite(road.height_above(*arrays(0, 100, 200)))


def test_no_ground_at_and_above_the_horizon(camera):
    road = RoadSurface.plane(camera, height=1.6, pitch=0.0)
    u, v = np.array([camera.cx, 0.0, camera.cx]), np.array([camera.cy, camera.cy - 50, -1e6])
    assert np.isnan(road.pixel_to_ground(u, v)).all()


def test_ground_behind_the_camera_gives_some_pixel_below_the_image(camera):
    road = RoadSurface.plane(camera, height=1.6, pitch=0.0)
    _, v = road.ground_to_pixel(np.zeros(3), np.array([-5.0, 0.0, 0.5]))
    assert np.all(v > 1000)


def test_single_precision_stays_single(camera):
    road = RoadSurface.plane(camera, 1.6, 0.02)
    a = np.full(3, 20, np.float32)
    results = [road.disparity(a, a), road.height_above(a, a, a)]
    for pair in (road.ground_to_pixel, road.pixel_to_ground):
        results += pair(a, a)
    assert {result.dtype for result in results} == {np.dtype(np.float32)}
