# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What both models of the road's surface have in common: planes by hand, heights above them, uncertainty."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.geometry.quadratic_surface import QuadraticSurface
from lane_dp_ros.core.geometry.road_surface import geometry
from lane_dp_ros.core.geometry.vertical_curve import VerticalCurve

pytestmark = pytest.mark.filterwarnings("error")

ROUND = StereoCamera(fx=500.0, fy=500.0, cx=300.0, cy=100.0, baseline=0.4)  # numbers for the head
MODELS = [QuadraticSurface, VerticalCurve]


@pytest.fixture(scope="module", params=MODELS, ids=lambda model: model.__name__)
def model(request):
    return request.param


def arrays(*numbers):
    return [np.array([number], dtype=float) for number in numbers]


def test_a_level_road_by_hand(model):
    road = model.plane(ROUND, height=2.0, pitch=0.0)
    u, v = road.ground_to_pixel(*arrays(1.0, 10.0))  # 500 px * 1 m / 10 m to the right, 500 * 2 / 10 down
    assert (u[0], v[0]) == pytest.approx((350, 200))
    assert road.disparity(u, v) == pytest.approx(20)  # 500 px * 0.4 m / 10 m
    assert np.ravel(road.gradient(u, v)) == pytest.approx([0, 0.2])  # 20 px over 100 rows
    assert road.horizon(v) == pytest.approx(100)  # cy
    assert road.near_row == pytest.approx(200)
    assert geometry(road) == pytest.approx([2, 0, 0, 0])
    assert road.summit == np.inf
    assert road.covariance is None


@pytest.mark.parametrize("pitch", [-0.05, 0.0, 0.02, 0.2])
@pytest.mark.parametrize("height", [1.2, 1.65, 2.3])
def test_a_plane_tells_its_height_and_pitch(model, camera, height, pitch):
    road = model.plane(camera, height, pitch)
    assert geometry(road) == pytest.approx([height, pitch, 0, 0])
    assert road.horizon(300.0) == pytest.approx(camera.cy - camera.fy * np.tan(pitch))
    x, y, z = 2.0, (height - 12.0 * np.sin(pitch)) / np.cos(pitch), 12.0  # y cos + z sin = height
    pixel = camera.project(np.array([[x, y, z]]) - camera.left_translation)[0]
    assert np.ravel(road.ground_to_pixel(*arrays(x, z))) == pytest.approx(pixel)


@given(height=st.floats(1, 3), pitch=st.floats(-0.2, 0.2), u=st.floats(0, 640), v=st.floats(0, 400))
def test_a_plane_is_the_same_in_both_models(camera, height, pitch, u, v):
    quadratic, curve = (each.plane(camera, height, pitch) for each in MODELS)
    u, v = arrays(u, v)
    np.testing.assert_allclose(curve.disparity(u, v), np.maximum(quadratic.disparity(u, v), 0), atol=1e-9)
    np.testing.assert_allclose(curve.pixel_to_ground(u, v), quadratic.pixel_to_ground(u, v), rtol=1e-6)
    x, z = arrays(2.0, 15.0)
    np.testing.assert_allclose(curve.ground_to_pixel(x, z), quadratic.ground_to_pixel(x, z))


def test_height_above_the_road_is_that_of_a_point(model, camera):
    road = model.plane(camera, height=1.6, pitch=0.0)
    points = np.array([[1.0, 1.6 - 0.3, 10.0], [1.0, 1.6, 10.0], [-2.0, 1.6 + 0.2, 20.0]])  # y is down
    u, v = camera.project(points - camera.left_translation).T
    disparity = camera.fx * camera.baseline / points[:, 2]
    np.testing.assert_allclose(road.height_above(disparity, u, v), [0.3, 0.0, -0.2], atol=1e-9)


def test_no_height_without_disparity(model, camera):
    road = model.plane(camera, height=1.6, pitch=0.0)
    assert np.isnan(road.height_above(np.array([np.nan]), *arrays(100, 200)))
    assert not np.isfinite(road.height_above(*arrays(0, 100, 200)))


def test_no_ground_at_and_above_the_horizon(model, camera):
    road = model.plane(camera, height=1.6, pitch=0.0)
    u, v = np.array([camera.cx, 0.0, camera.cx]), np.array([camera.cy, camera.cy - 50, -1e6])
    assert np.isnan(road.pixel_to_ground(u, v)).all()


def test_ground_behind_the_camera_gives_some_pixel_below_the_image(model, camera):
    road = model.plane(camera, height=1.6, pitch=0.0)
    _, v = road.ground_to_pixel(np.zeros(3), np.array([-5.0, 0.0, 0.5]))
    assert np.all(v > 1000)


def test_single_precision_stays_single(model, camera):
    road = model.plane(camera, 1.6, 0.02)
    a = np.full(3, 200, np.float32)
    results = [road.disparity(a, a), road.height_above(a, a, a), road.linearised(a, a)[1]]
    for pair in (road.gradient, road.ground_to_pixel, road.pixel_to_ground):
        results += pair(a, a)
    assert {result.dtype for result in results} == {np.dtype(np.float32)}


def test_the_covariance_is_no_part_of_what_makes_surfaces_equal(model):
    road = model.plane(ROUND, 2.0, 0.0)
    assert replace(road, covariance=np.eye(4)) == road


def deviation(road, covariance, v=200.0):
    measured = replace(road, covariance=np.asarray(covariance, dtype=float))
    return measured.depth_deviation(*arrays(300.0, v))[0]


def test_how_exact_a_depth_is_by_hand():
    """10 m ahead d = 20 px, and 1 px of disparity is 10^2 / (500 * 0.4) = 0.5 m of depth.

    The rectification is good to 0.2 px; 0.012 m of 2 m are 0.12 px; 0.02 m of height are 0.2 px.
    """
    road = VerticalCurve.plane(ROUND, height=2.0, pitch=0.0)
    assert deviation(road, np.zeros((4, 4))) == pytest.approx(0.5 * np.hypot(0.2, 0.12))
    by_height = deviation(road, np.diag([0.02**2, 0, 0, 0]))
    assert by_height == pytest.approx(0.5 * np.sqrt(0.2**2 + 0.2**2 + 0.12**2))
    # 0.001 of slope move the row by 0.5 px, 0.1 px of disparity
    by_slope = deviation(road, np.diag([0, 0.001**2, 0, 0]))
    assert by_slope == pytest.approx(0.5 * np.sqrt(0.2**2 + 0.1**2 + 0.12**2))


def test_errors_of_height_and_slope_may_cancel_each_other():
    """The height is 0.02 m more where the slope is 0.002 more: nothing moves 10 m ahead."""
    together = np.zeros((4, 4))
    together[:2, :2] = np.outer([0.02, 0.002], [0.02, 0.002])
    road = VerticalCurve.plane(ROUND, height=2.0, pitch=0.0)
    assert deviation(road, together) == pytest.approx(deviation(road, np.zeros((4, 4))))
    assert deviation(road, together, v=150.0) > deviation(road, np.zeros((4, 4)), v=150.0)


@given(height=st.floats(0, 0.1), curvature=st.floats(0, 1e-3), v=st.floats(140, 300))
def test_an_uncertain_surface_makes_no_depth_more_exact(model, height, curvature, v):
    road = model.plane(ROUND, 2.0, 0.0)
    least = deviation(road, np.zeros((4, 4)), v)
    assert deviation(road, np.diag([height**2, 0, curvature**2, 0]), v) >= least


def test_a_surface_that_was_not_measured_has_no_exactness(model):
    u, v = np.full(3, 300.0), np.array([50.0, 150.0, 250.0])
    road = model.plane(ROUND, 2.0, 0.0)
    assert np.isnan(road.depth_deviation(u, v)).all()
    measured = replace(road, covariance=np.eye(4) * 1e-6)
    assert np.isnan(measured.depth_deviation(u, v)).tolist() == [True, False, False]  # above the horizon
