# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Parabolic roads: crests and sags by hand, there and back, derivatives, and what lies behind a summit."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.geometry.road_surface import geometry
from lane_dp_ros.core.geometry.vertical_curve import VerticalCurve

pytestmark = pytest.mark.filterwarnings("error")

ROUND = StereoCamera(fx=500.0, fy=500.0, cx=300.0, cy=100.0, baseline=0.4)  # numbers for the head
X = np.array([0.0, -3.0, 4.0])
Z = np.array([5.0, 10.0, 30.0])
# Camera height [m], pitch [rad], vertical curvature [1/m], roll [rad]: crests, sags, banked roads.
GEOMETRIES = st.tuples(
    st.floats(1.0, 3.0),
    st.floats(-0.15, 0.15),
    st.integers(-4000, 4000).map(lambda millionths: millionths * 1e-6),
    st.floats(-0.15, 0.15),
)
STEPS = np.array([1e-4, 1e-5, 1e-6, 1e-5])  # m, -, 1/m, -


def arrays(*numbers):
    return [np.array([number], dtype=float) for number in numbers]


def ground_in_view(road):
    """Return points (x, z) [m] on this side of the summit."""
    return X, np.minimum(Z, 0.8 * road.summit)


@given(values=GEOMETRIES)
def test_a_surface_has_the_geometry_that_it_is_made_of(camera, values):
    road = VerticalCurve.of_geometry(camera, np.array(values))
    np.testing.assert_allclose(geometry(road), values, rtol=1e-6, atol=1e-9)


def test_the_coefficients_are_those_of_the_tangent_ten_metres_ahead():
    road = VerticalCurve(ROUND, (2.0, 0.05, 0.004, 0.0))
    z = np.array([8.0, 10.0, 12.0])
    _, v = road.ground_to_pixel(np.zeros(3), z)
    down = (v - ROUND.cy) * z / ROUND.fy
    assert down[1] == pytest.approx(2.0 - 0.05 * 10)
    assert (down[2] - down[0]) / 4 == pytest.approx(-0.05)  # a parabola's chord has its middle's slope
    assert np.diff(down, 2)[0] / 2.0**2 == pytest.approx(-0.004)  # it climbs more and more


def test_a_surface_may_be_given_by_its_height_and_slope_below_the_camera():
    road = VerticalCurve.of_foot(ROUND, foot=2.0, slope=0.02, curvature=0.004)
    assert road.coefficients == pytest.approx((2.2, 0.06, 0.004, 0.0))  # 0.004 / 2 * 10^2, 0.004 * 10
    # 20 m ahead: 2 - 0.02 * 20 - 0.002 * 400 = 0.8 m below the axis, 500 * 0.8 / 20 = 20 px
    assert np.ravel(road.ground_to_pixel(*arrays(-1.0, 20.0))) == pytest.approx((275, 120))


@pytest.mark.parametrize("curvature", [-0.004, 0.0, 0.004])
def test_rows_are_a_hyperbola_of_the_disparity(curvature):
    """v - cy = a d + b + c / d: a = 500 * 2 / 200, b = -500 * 0.02, c = -500 * 200 * curvature / 2."""
    road = VerticalCurve.of_foot(ROUND, foot=2.0, slope=0.02, curvature=curvature)
    d = np.array([40.0, 20.0, 10.0])  # 5, 10 and 20 m ahead
    v = 100 + 5 * d - 10 - 50_000 * curvature / d
    np.testing.assert_allclose(road.disparity(np.full(3, 300.0), v), d)


@given(values=GEOMETRIES)
def test_ground_comes_back_from_its_pixels(camera, values):
    road = VerticalCurve.of_geometry(camera, np.array(values))
    x, z = ground_in_view(road)
    u, v = road.ground_to_pixel(x, z)
    np.testing.assert_allclose(road.pixel_to_ground(u, v), (x, z), rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(road.disparity(u, v), camera.fx * camera.baseline / z)


@given(values=GEOMETRIES)
def test_single_precision_stays_single_and_is_enough(camera, values):
    road = VerticalCurve.of_geometry(camera, np.array(values))
    x, z = (a.astype(np.float32) for a in ground_in_view(road))
    u, v = road.ground_to_pixel(x, z)
    results = [*road.pixel_to_ground(u, v), *road.gradient(u, v), road.linearised(u, v)[1], u, v]
    assert {result.dtype for result in results} == {np.dtype(np.float32)}
    np.testing.assert_allclose(results[:2], (x, z), rtol=1e-3)


@given(values=GEOMETRIES)
def test_the_gradient_is_that_of_the_disparity(camera, values):
    road = VerticalCurve.of_geometry(camera, np.array(values))
    u, v = road.ground_to_pixel(*ground_in_view(road))
    across = (road.disparity(u + 1e-4, v) - road.disparity(u - 1e-4, v)) / 2e-4
    along = (road.disparity(u, v + 1e-4) - road.disparity(u, v - 1e-4)) / 2e-4
    np.testing.assert_allclose(road.gradient(u, v), (across, along), rtol=1e-5, atol=1e-7)


@given(values=GEOMETRIES)
def test_the_jacobian_is_that_of_the_disparity(camera, values):
    road = VerticalCurve.of_geometry(camera, np.array(values))
    u, v = road.ground_to_pixel(*ground_in_view(road))
    for row, step in zip(road.linearised(u, v)[1], np.diag(STEPS), strict=True):
        more, less = (
            road.with_coefficients(road.coefficients + sign * step).disparity(u, v) for sign in (1, -1)
        )
        np.testing.assert_allclose(row, (more - less) / (2 * step.max()), rtol=1e-3, atol=1e-5)


@given(values=GEOMETRIES)
def test_the_horizon_near_the_vehicle_is_that_of_the_pitch(camera, values):
    """The tangent plane's; what leans to the side has it at the principal column."""
    road = VerticalCurve.of_geometry(camera, np.array(values))
    expected = camera.cy - camera.fy * np.tan(values[1])
    assert road.horizon(road.near_row) == pytest.approx(expected, abs=1e-6)


def test_a_crest_hides_what_lies_behind_its_summit():
    """Seen from 2 m above it, of the curvature -0.0025 1/m: sqrt(2 * 2 / 0.0025) = 40 m ahead."""
    crest = VerticalCurve.of_foot(ROUND, foot=2.0, slope=0.0, curvature=-0.0025)
    assert crest.summit == pytest.approx(40)
    u, v = crest.ground_to_pixel(np.zeros(4), np.array([39.0, 40.0, 41.0, 500.0]))
    assert v[0] > v[1] == v[2] == v[3] == pytest.approx(150)  # 2 + 2 = 4 m below, 500 * 4 / 40 = 50 px
    assert np.all(u == 300)
    _, z = crest.pixel_to_ground(np.full(3, 300.0), np.array([149.9, 150.1, 100.0]))
    assert np.isnan(z).tolist() == [True, False, True]
    assert 35 < z[1] < 40
    assert crest.disparity(*arrays(300.0, 149.9)) == 0


def test_a_point_behind_a_crest_is_seen_in_its_direction():
    crest = VerticalCurve.of_foot(ROUND, foot=2.0, slope=0.0, curvature=-0.0025)
    u, _ = crest.ground_to_pixel(*arrays(10.0, 100.0))
    assert u == pytest.approx(300 + 500 * 10 / 100)


@pytest.mark.parametrize("curvature", [0.0, 0.004])
def test_without_a_crest_there_is_no_summit(curvature):
    assert VerticalCurve.of_foot(ROUND, 2.0, 0.1, curvature).summit == np.inf


def test_a_sag_is_seen_above_the_horizon_of_the_road_below_the_camera():
    """50 m ahead the road is 0.004 / 2 * 50^2 = 5 m higher: 3 m above the camera."""
    sag = VerticalCurve.of_foot(ROUND, foot=2.0, slope=0.0, curvature=0.004)
    u, v = sag.ground_to_pixel(*arrays(0.0, 50.0))
    assert v == pytest.approx(100 - 500 * 3 / 50)
    assert sag.pixel_to_ground(u, v)[1] == pytest.approx(50)


@pytest.mark.parametrize(("foot", "below"), [(-1.0, False), (0.15, False), (0.25, True), (2.0, True)])
def test_a_road_passes_below_the_camera_by_more_than_twenty_centimetres(foot, below):
    assert VerticalCurve.of_foot(ROUND, foot, 0.0, 0.002).is_below_camera == below


def test_other_coefficients_are_those_of_another_surface_of_the_camera():
    road = VerticalCurve.plane(ROUND, 2.0, 0.0)
    covariance = np.eye(4)
    moved = road.with_coefficients(np.array([1.9, 0.01, 0.001, 0.02]), covariance)
    assert moved == VerticalCurve(ROUND, (1.9, 0.01, 0.001, 0.02))
    assert moved.covariance is covariance
    assert {type(value) for value in moved.coefficients} == {float}  # NumPy's would not stay single
