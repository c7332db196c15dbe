# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Vanishing points of drawn roads by the dense vote, and none where nothing votes."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lane_dp_ros.core.geometry.disparity_map import DisparityMap
from lane_dp_ros.core.geometry.quadratic_surface import QuadraticSurface
from lane_dp_ros.core.geometry.road_axis import RoadAxis
from lane_dp_ros.core.road.dense_vote import quartic_vanishing_point
from lane_dp_ros.core.road.edge_pixels import EdgePixels, edge_pixels
from lane_dp_ros.core.road.vanishing_point import vanishing_point_of

pytestmark = pytest.mark.filterwarnings("error")

SHAPE = (300, 640)


def dense_point(road, axis, picture_of, disparity_of):
    edges = edge_pixels(picture_of(road, axis, (-1.8, 1.7)), disparity_of(road), road)
    return quartic_vanishing_point(edges, road, SHAPE)


@pytest.fixture(scope="module")
def road(camera):
    return QuadraticSurface.plane(camera, 1.6, 0.02)


@pytest.mark.parametrize("heading", [-0.1, 0.0, 0.08])
def test_a_straight_road_has_one_vanishing_point(road, picture_of, disparity_of, heading):
    point = dense_point(road, RoadAxis(heading), picture_of, disparity_of)
    expected = vanishing_point_of(RoadAxis(heading), road)
    assert (point.u, point.v) == pytest.approx(expected, abs=8)  # px; a cell is 4
    rows = np.array([160.0, 200.0, 290.0])
    u_of_row = np.polynomial.polynomial.polyval(rows, point.u_of_row)
    np.testing.assert_allclose(u_of_row, expected[0], atol=15)


@pytest.mark.parametrize("curvature", [-0.006, 0.006])
def test_the_vanishing_point_of_a_bend_moves_along_the_road(road, picture_of, disparity_of, curvature):
    axis = RoadAxis(curvature=curvature)
    point = dense_point(road, axis, picture_of, disparity_of)
    assert len(point.u_of_row) == 5  # a quartic
    s = np.array([8.0, 10.0, 20.0])
    _, v = road.ground_to_pixel(*axis.to_ground(s, np.zeros(3)))
    there = [vanishing_point_of(RoadAxis(curvature * along), road)[0] for along in s]
    u_of_row = np.polynomial.polynomial.polyval(v, point.u_of_row)
    np.testing.assert_allclose(u_of_row, there, atol=15)
    assert point.u == pytest.approx(there[1], abs=15)  # near the vehicle is 10 m ahead


def test_the_horizon_is_that_of_the_profile_ten_metres_ahead(camera, picture_of, disparity_of):
    b0, b1, _, _ = QuadraticSurface.plane(camera, 1.6, 0.02).coefficients
    hill = QuadraticSurface(camera, (b0, b1, 1.0, 0.0))
    point = dense_point(hill, RoadAxis(), picture_of, disparity_of)
    _, row = hill.ground_to_pixel(np.zeros(1), np.full(1, 10.0))
    assert point.v == pytest.approx(hill.horizon(row)[0])


@pytest.mark.parametrize(("count", "voted"), [(0, False), (19, False), (20, True)])
def test_too_few_edges_show_no_vanishing_point(road, picture_of, disparity_of, count, voted):
    edges = edge_pixels(picture_of(road, RoadAxis(), (-1.8, 1.7)), disparity_of(road), road)
    few = EdgePixels(**{name: values[:count] for name, values in vars(edges).items()})
    assert (quartic_vanishing_point(few, road, SHAPE) is not None) == voted


def test_edges_in_a_few_rows_only_give_a_point_there(camera, road, disparity_of):
    hill = QuadraticSurface(camera, (*road.coefficients[:2], 1.0, 0.0))
    picture = np.zeros(SHAPE, np.uint8)
    picture[296:, ::20] = 255
    edges = edge_pixels(picture, disparity_of(hill), hill)
    assert len(edges.u) > 20
    point = quartic_vanishing_point(edges, hill, SHAPE)
    assert 1 < len(point.u_of_row) < 5
    assert -SHAPE[1] / 2 <= point.u <= 1.5 * SHAPE[1]
    assert hill.horizon(290.0) < point.v < hill.horizon(304.0)  # not that of 10 m ahead, where nothing voted


@settings(max_examples=200)  # every pair of values
@given(data=st.data())
def test_awkward_images_and_cameras_give_a_point(awkward, data):
    image, _, camera = data.draw(awkward)
    road = QuadraticSurface.plane(camera, 1.6, 0.02)
    edges = edge_pixels(image, DisparityMap.unknown(image.shape), road)
    point = quartic_vanishing_point(edges, road, image.shape)
    assert point is None or np.isfinite([point.u, point.v]).all()
