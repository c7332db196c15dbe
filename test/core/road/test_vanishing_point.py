# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Vanishing points of drawn roads, and the angles they tell: with K, and by the paper's formula."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.geometry.road_axis import RoadAxis
from lane_dp_ros.core.geometry.road_surface import RoadSurface
from lane_dp_ros.core.road.edge_pixels import road_edges
from lane_dp_ros.core.road.vanishing_point import dense_vanishing_point, pitch_and_yaw, vanishing_point_of
from lane_dp_ros.core.types import VanishingPoint

pytestmark = pytest.mark.filterwarnings("error")

SHAPE = (300, 640)
# KITTI raw, 2011_09_26, calib_cam_to_cam.txt: P_rect_02 and S_rect_02 (1242 x 375)
KITTI = StereoCamera(fx=721.5377, fy=721.5377, cx=609.5593, cy=172.854, baseline=0.5327)
KITTI_SHAPE = (375, 1242)


def dense_point(road, axis, picture_of, disparity_of):
    edges = road_edges(picture_of(road, axis, (-1.8, 1.7)), disparity_of(road), road)
    return dense_vanishing_point(edges, road, SHAPE)


@pytest.fixture(scope="module")
def road(camera):
    return RoadSurface.plane(camera, 1.6, 0.02)


@pytest.mark.parametrize("heading", [-0.1, 0.0, 0.08])
def test_a_straight_road_has_one_vanishing_point(road, picture_of, disparity_of, heading):
    point = dense_point(road, RoadAxis(heading), picture_of, disparity_of)
    expected = vanishing_point_of(RoadAxis(heading), road)
    assert (point.u, point.v) == pytest.approx((expected.u, expected.v), abs=8)  # px; a cell is 4
    rows = np.array([160.0, 200.0, 290.0])
    u_of_row = np.polynomial.polynomial.polyval(rows, point.u_of_row)
    np.testing.assert_allclose(u_of_row, expected.u, atol=15)


@pytest.mark.parametrize("curvature", [-0.006, 0.006])
def test_the_vanishing_point_of_a_bend_moves_along_the_road(road, picture_of, disparity_of, curvature):
    axis = RoadAxis(curvature=curvature)
    point = dense_point(road, axis, picture_of, disparity_of)
    assert len(point.u_of_row) == 5  # a quartic
    s = np.array([8.0, 10.0, 20.0])
    _, v = road.ground_to_pixel(*axis.to_ground(s, np.zeros(3)))
    there = [vanishing_point_of(RoadAxis(curvature * along), road).u for along in s]
    u_of_row = np.polynomial.polynomial.polyval(v, point.u_of_row)
    np.testing.assert_allclose(u_of_row, there, atol=15)
    assert point.u == pytest.approx(there[1], abs=15)  # near the vehicle is 10 m ahead


def test_the_horizon_is_that_of_the_profile_ten_metres_ahead(camera, picture_of, disparity_of):
    b0, b1, _, _ = RoadSurface.plane(camera, 1.6, 0.02).coefficients
    hill = RoadSurface(camera, (b0, b1, 1.0, 0.0))
    point = dense_point(hill, RoadAxis(), picture_of, disparity_of)
    _, row = hill.ground_to_pixel(np.zeros(1), np.full(1, 10.0))
    assert point.v == pytest.approx(hill.horizon(row)[0])


def test_too_few_edges_mean_straight_ahead(camera, road, disparity_of):
    edges = road_edges(np.zeros(SHAPE, np.uint8), disparity_of(road), road)
    point = dense_vanishing_point(edges, road, SHAPE)
    assert (point.u, point.v) == pytest.approx((camera.cx, camera.cy - camera.fy * np.tan(0.02)))
    assert point.u_of_row == ()


def test_edges_in_a_few_rows_only_give_a_point_there(camera, road, disparity_of):
    hill = RoadSurface(camera, (*road.coefficients[:2], 1.0, 0.0))
    picture = np.zeros(SHAPE, np.uint8)
    picture[296:, ::20] = 255
    edges = road_edges(picture, disparity_of(hill), hill)
    assert len(edges.u) > 20
    point = dense_vanishing_point(edges, hill, SHAPE)
    assert 1 < len(point.u_of_row) < 5
    assert -SHAPE[1] / 2 <= point.u <= 1.5 * SHAPE[1]
    assert hill.horizon(290.0) < point.v < hill.horizon(304.0)  # not that of 10 m ahead, where nothing voted


@settings(max_examples=200)  # every pair of values
@given(data=st.data())
def test_awkward_images_and_cameras_give_a_point(awkward, data):
    image, _, camera = data.draw(awkward)
    road = RoadSurface.plane(camera, 1.6, 0.02)
    edges = road_edges(image, np.full(image.shape, np.nan, np.float32), road)
    point = dense_vanishing_point(edges, road, image.shape)
    assert np.isfinite([point.u, point.v]).all()


@given(heading=st.floats(-0.5, 0.5), pitch=st.floats(-0.1, 0.1))
def test_the_angles_come_back_from_the_vanishing_point(camera, heading, pitch):
    point = vanishing_point_of(RoadAxis(heading), RoadSurface.plane(camera, 1.6, pitch))
    assert pitch_and_yaw(point, camera, SHAPE) == pytest.approx((pitch, heading), abs=1e-9)


def test_the_vanishing_point_is_where_points_far_along_the_road_are_seen(camera):
    heading, pitch = 0.1, 0.05
    ahead = np.array([np.sin(heading), -np.cos(heading) * np.sin(pitch), np.cos(heading) * np.cos(pitch)])
    point = vanishing_point_of(
        RoadAxis(np.arctan2(ahead[0], ahead[2])), RoadSurface.plane(camera, 1.6, pitch)
    )
    expected = camera.project(1e7 * ahead)[0]
    assert point.v == pytest.approx(expected[1], abs=0.01)
    assert point.u == pytest.approx(expected[0], abs=0.2)  # heading over depth or over ground: cos(pitch)


def test_the_papers_formula_by_hand():
    """Half the image is 250 rows and 500 columns: tan(alpha_v) = 250/500 and tan(alpha_u) = 500/500."""
    camera = StereoCamera(fx=500.0, fy=500.0, cx=500.0, cy=250.0, baseline=0.5)
    pitch, yaw = pitch_and_yaw(VanishingPoint(600.0, 200.0), camera, (500, 1000), centred=True)
    assert np.tan(pitch) == pytest.approx(0.5 * (1 - 2 * 200 / 500))  # 0.1
    assert np.tan(yaw) == pytest.approx(1.0 * (2 * 600 / 1000 - 1))  # 0.2
    assert np.rad2deg([pitch, yaw]) == pytest.approx([5.7106, 11.3099], abs=1e-4)


def test_with_k_the_pitch_is_the_papers_and_the_yaw_is_over_the_ground():
    camera = StereoCamera(fx=500.0, fy=500.0, cx=500.0, cy=250.0, baseline=0.5)
    pitch, yaw = pitch_and_yaw(VanishingPoint(600.0, 200.0), camera, (500, 1000))
    assert (np.tan(pitch), np.tan(yaw)) == pytest.approx((0.1, 0.2 * np.cos(pitch)))


def test_the_papers_formula_is_biased_on_kitti():
    """Its principal point is not the image's middle: 1.16 deg of pitch and 0.91 deg of yaw."""
    straight_ahead = VanishingPoint(KITTI.cx, KITTI.cy)
    assert pitch_and_yaw(straight_ahead, KITTI, KITTI_SHAPE) == pytest.approx((0, 0))
    pitch, yaw = pitch_and_yaw(straight_ahead, KITTI, KITTI_SHAPE, centred=True)
    assert np.rad2deg([pitch, yaw]) == pytest.approx([1.16, -0.91], abs=0.005)


@pytest.mark.parametrize(("sign", "read"), [(1, 8.9), (-1, 11.4)])
def test_what_that_bias_makes_of_ten_metres(sign, read):
    level, tilted = (RoadSurface.plane(KITTI, 1.65, pitch) for pitch in (0.0, sign * np.deg2rad(1.163)))
    pixel = level.ground_to_pixel(np.zeros(1), np.full(1, 10.0))
    assert tilted.pixel_to_ground(*pixel)[1] == pytest.approx(read, abs=0.05)
