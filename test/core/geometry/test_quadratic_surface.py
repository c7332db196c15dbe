# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The paper's surface: there and back, its derivatives, what it tells of hills and cross slopes."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.geometry.quadratic_surface import QuadraticSurface

pytestmark = pytest.mark.filterwarnings("error")

ROUND = StereoCamera(fx=500.0, fy=500.0, cx=300.0, cy=100.0, baseline=0.4)  # numbers for the head
X = np.array([0.0, -3.0, 4.0])
Z = np.array([5.0, 10.0, 30.0])
# Coefficients (b0, b1, b2, b3): a road that lies 1.2 to 2 m below, climbs, sags or bulges, and leans.
SURFACES = st.tuples(st.floats(-8, 8), st.floats(20, 35), st.floats(-1, 1), st.floats(-1.5, 1.5))


def arrays(*numbers):
    return [np.array([number], dtype=float) for number in numbers]


@given(coefficients=SURFACES)
def test_ground_comes_back_from_its_pixels(camera, coefficients):
    road = QuadraticSurface(camera, coefficients)
    u, v = road.ground_to_pixel(X, Z)
    assume(np.all(road.gradient(u, v)[1] > 0.05))  # beyond a crest there is no ground to be seen
    np.testing.assert_allclose(road.pixel_to_ground(u, v), (X, Z), rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(road.disparity(u, v), camera.fx * camera.baseline / Z)


@given(coefficients=SURFACES, u=st.floats(0, 640), v=st.floats(150, 300))
def test_the_gradient_is_that_of_the_disparity(camera, coefficients, u, v):
    road = QuadraticSurface(camera, coefficients)
    u, v = arrays(u, v)
    across = road.disparity(u + 0.5, v) - road.disparity(u - 0.5, v)
    along = road.disparity(u, v + 0.5) - road.disparity(u, v - 0.5)
    np.testing.assert_allclose(road.gradient(u, v), (across, along), atol=1e-9)


@given(coefficients=SURFACES, u=st.floats(0, 640), v=st.floats(150, 300))
def test_the_disparity_is_linear_in_the_coefficients(camera, coefficients, u, v):
    road = QuadraticSurface(camera, coefficients)
    u, v = arrays(u, v)
    J = road.linearised(u, v)[1]
    assert J.shape == (4, 1)
    np.testing.assert_allclose(np.array(coefficients) @ J, road.disparity(u, v), atol=1e-9)


def test_the_horizon_of_a_row_is_where_the_tangent_of_the_profile_is_zero():
    road = QuadraticSurface(ROUND, (0.0, 10.0, 5.0, 0.0))  # 10 n + 5 n^2; at n = 2: 40, slope 30
    assert road.horizon(300.0) == pytest.approx(300 - 40 / 0.30)


def test_a_camera_that_leans_sees_the_road_lean():
    roll = np.deg2rad(3)
    road = QuadraticSurface(ROUND, (0.0, 10 * np.cos(roll), 0.0, 10 * np.sin(roll)))
    assert road.roll == pytest.approx(roll)


@pytest.mark.parametrize("b2", [-0.3, 0.2])
def test_the_vertical_curvature_is_that_of_the_heights(b2):
    """Of points 9.9, 10 and 10.1 m ahead; it is positive where the road climbs more and more."""
    road = QuadraticSurface(ROUND, (1.0, 20.0, b2, 0.0))
    z = np.array([9.9, 10.0, 10.1])
    _, v = road.ground_to_pixel(np.zeros(3), z)
    down = (v - ROUND.cy) * z / ROUND.fy
    assert road.vertical_curvature == pytest.approx(-np.diff(down, 2)[0] / 0.1**2, rel=1e-3)
    assert np.sign(road.vertical_curvature) == np.sign(b2)
