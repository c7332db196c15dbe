# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The road's direction, by an arc or by the paper's formulas, and the angles that a vanishing point tells."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.geometry.disparity_map import DisparityMap
from lane_dp_ros.core.geometry.quadratic_surface import QuadraticSurface
from lane_dp_ros.core.geometry.road_axis import RoadAxis
from lane_dp_ros.core.road.arc_vote import arc_of_edges
from lane_dp_ros.core.road.dense_vote import quartic_vanishing_point
from lane_dp_ros.core.road.edge_pixels import edge_pixels
from lane_dp_ros.core.road.vanishing_point import (
    ArcVanishingPoint,
    DenseVanishingPoint,
    VanishingPointConfig,
    direction_along,
    direction_estimator,
    pitch_and_yaw,
    vanishing_point_of,
)

pytestmark = pytest.mark.filterwarnings("error")

SHAPE = (300, 640)
# KITTI raw, 2011_09_26, calib_cam_to_cam.txt: P_rect_02 and S_rect_02 (1242 x 375)
KITTI = StereoCamera(fx=721.5377, fy=721.5377, cx=609.5593, cy=172.854, baseline=0.5327)
KITTI_SHAPE = (375, 1242)
ARC, DENSE = VanishingPointConfig(), VanishingPointConfig(method="dense")


@pytest.fixture(scope="module")
def road(camera):
    return QuadraticSurface.plane(camera, 1.6, 0.02)


def test_an_arc_is_that_of_the_edges_on_the_measured_surface(road, picture_of, disparity_of):
    axis = RoadAxis(0.05, 0.01)
    picture, disparity = picture_of(road, axis, (-1.8, 1.7)), disparity_of(road)
    found = ArcVanishingPoint(ARC).estimate(picture, disparity, road)
    assert found.axis == arc_of_edges(edge_pixels(picture, disparity, road), 0.5, 0.05)
    assert found.ipm_plane is road
    assert found.vanishing_point == vanishing_point_of(found.axis, road)
    assert found.u_of_row == ()


def test_the_bounds_of_an_arc_are_those_of_the_configuration(road, picture_of, disparity_of):
    picture = picture_of(road, RoadAxis(0.3, 0.03), (-1.8, 1.7))
    bounds = VanishingPointConfig(heading_max=0.1, curvature_max=0.005)
    axis = ArcVanishingPoint(bounds).estimate(picture, disparity_of(road), road).axis
    assert abs(axis.heading) < 0.11 and abs(axis.curvature) < 0.0075


@pytest.mark.parametrize("centred", [False, True])
def test_the_papers_direction_is_a_straight_road_on_a_plane(road, picture_of, disparity_of, centred):
    picture, disparity = picture_of(road, RoadAxis(0.08), (-1.8, 1.7)), disparity_of(road)
    config = VanishingPointConfig(method="dense", centred_principal_point=centred)
    found = DenseVanishingPoint(config).estimate(picture, disparity, road)
    point = quartic_vanishing_point(edge_pixels(picture, disparity, road), road, SHAPE)
    assert found.vanishing_point == (point.u, point.v)
    assert found.u_of_row == point.u_of_row
    assert len(found.u_of_row) == 5  # a quartic
    pitch, yaw = pitch_and_yaw((point.u, point.v), road.camera, SHAPE, centred)
    assert found.axis == RoadAxis(yaw)
    assert found.ipm_plane == QuadraticSurface.plane(road.camera, road.camera_height, pitch)
    assert (found.ipm_plane.pitch, found.ipm_plane.camera_height) == pytest.approx((pitch, 1.6))


def test_without_edges_the_road_goes_straight_ahead(camera, road):
    """By the principal point; the paper's formula, with the middle of the image, looks elsewhere."""
    blank, unknown = np.zeros(SHAPE, np.uint8), DisparityMap.unknown(SHAPE)
    ahead = camera.cx, camera.cy - camera.fy * np.tan(0.02)
    arc, dense = (direction_estimator(each).estimate(blank, unknown, road) for each in (ARC, DENSE))
    for found in (arc, dense):
        assert found.vanishing_point == pytest.approx(ahead)
        assert found.u_of_row == ()
        assert (found.axis.heading, found.axis.curvature) == pytest.approx((0, 0), abs=1e-12)
        assert (found.ipm_plane.pitch, found.ipm_plane.camera_height) == pytest.approx((0.02, 1.6))


def test_the_direction_along_a_known_axis_is_on_the_measured_surface(road):
    axis = RoadAxis(0.1, 0.01)
    found = direction_along(axis, road)
    assert found.axis is axis and found.ipm_plane is road
    assert found.vanishing_point == vanishing_point_of(axis, road)


def test_the_configuration_names_the_estimator():
    assert isinstance(direction_estimator(ARC), ArcVanishingPoint)
    assert isinstance(direction_estimator(DENSE), DenseVanishingPoint)


@given(heading=st.floats(-0.5, 0.5), pitch=st.floats(-0.1, 0.1))
def test_the_angles_come_back_from_the_vanishing_point(camera, heading, pitch):
    point = vanishing_point_of(RoadAxis(heading), QuadraticSurface.plane(camera, 1.6, pitch))
    assert pitch_and_yaw(point, camera, SHAPE) == pytest.approx((pitch, heading), abs=1e-9)


def test_the_vanishing_point_is_where_points_far_along_the_road_are_seen(camera):
    heading, pitch = 0.1, 0.05
    ahead = np.array([np.sin(heading), -np.cos(heading) * np.sin(pitch), np.cos(heading) * np.cos(pitch)])
    point = vanishing_point_of(
        RoadAxis(np.arctan2(ahead[0], ahead[2])), QuadraticSurface.plane(camera, 1.6, pitch)
    )
    expected = camera.project(1e7 * ahead)[0]
    assert point[1] == pytest.approx(expected[1], abs=0.01)
    assert point[0] == pytest.approx(expected[0], abs=0.2)  # heading over depth or over ground: cos(pitch)


def test_the_papers_formula_by_hand():
    """Half the image is 250 rows and 500 columns: tan(alpha_v) = 250/500 and tan(alpha_u) = 500/500."""
    camera = StereoCamera(fx=500.0, fy=500.0, cx=500.0, cy=250.0, baseline=0.5)
    pitch, yaw = pitch_and_yaw((600.0, 200.0), camera, (500, 1000), centred=True)
    assert np.tan(pitch) == pytest.approx(0.5 * (1 - 2 * 200 / 500))  # 0.1
    assert np.tan(yaw) == pytest.approx(1.0 * (2 * 600 / 1000 - 1))  # 0.2
    assert np.rad2deg([pitch, yaw]) == pytest.approx([5.7106, 11.3099], abs=1e-4)


def test_with_k_the_pitch_is_the_papers_and_the_yaw_is_over_the_ground():
    camera = StereoCamera(fx=500.0, fy=500.0, cx=500.0, cy=250.0, baseline=0.5)
    pitch, yaw = pitch_and_yaw((600.0, 200.0), camera, (500, 1000))
    assert (np.tan(pitch), np.tan(yaw)) == pytest.approx((0.1, 0.2 * np.cos(pitch)))


def test_the_papers_formula_is_biased_on_kitti():
    """Its principal point is not the image's middle: 1.16 deg of pitch and 0.91 deg of yaw."""
    straight_ahead = KITTI.cx, KITTI.cy
    assert pitch_and_yaw(straight_ahead, KITTI, KITTI_SHAPE) == pytest.approx((0, 0))
    pitch, yaw = pitch_and_yaw(straight_ahead, KITTI, KITTI_SHAPE, centred=True)
    assert np.rad2deg([pitch, yaw]) == pytest.approx([1.16, -0.91], abs=0.005)


@pytest.mark.parametrize(("sign", "read"), [(1, 8.9), (-1, 11.4)])
def test_what_that_bias_makes_of_ten_metres(sign, read):
    level, tilted = (QuadraticSurface.plane(KITTI, 1.65, pitch) for pitch in (0.0, sign * np.deg2rad(1.163)))
    pixel = level.ground_to_pixel(np.zeros(1), np.full(1, 10.0))
    assert tilted.pixel_to_ground(*pixel)[1] == pytest.approx(read, abs=0.05)
