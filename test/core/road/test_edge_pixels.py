# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Edges of painted lines: where they are on the ground and which way they run."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.geometry.quadratic_surface import QuadraticSurface
from lane_dp_ros.core.geometry.road_axis import RoadAxis
from lane_dp_ros.core.road.edge_pixels import edge_pixels

pytestmark = pytest.mark.filterwarnings("error")

AXIS = RoadAxis(heading=0.05, curvature=-0.01)
OFFSETS = (-1.8, 1.6)  # m


@pytest.fixture(scope="module", params=[0.0, 2.0], ids=["upright", "leaning"])
def road(camera, request):
    b0, b1, _, _ = QuadraticSurface.plane(camera, 1.6, 0.02).coefficients
    return QuadraticSurface(camera, (b0, b1, 0.3, b1 * np.tan(np.deg2rad(request.param))))


@pytest.fixture(scope="module")
def flat(camera):
    return QuadraticSurface.plane(camera, 1.6, 0.02)


def test_edges_of_paint_have_the_place_and_the_heading_of_its_borders(road, picture_of, disparity_of):
    edges = edge_pixels(picture_of(road, AXIS, OFFSETS), disparity_of(road), road)
    near = edges.z < 20
    assert np.count_nonzero(near) > 300
    s, n = AXIS.from_ground(edges.x[near], edges.z[near])
    borders = np.add.outer(OFFSETS, (-0.075, 0.075)).ravel()
    assert np.median(np.abs(n[:, None] - borders).min(axis=1)) < 0.03
    error = edges.heading[near] - (AXIS.heading + AXIS.curvature * s)
    assert np.median(error) == pytest.approx(0, abs=np.deg2rad(0.5))
    assert np.percentile(np.abs(error), 80) < np.deg2rad(4)


def test_an_edge_stands_for_the_ground_that_its_pixel_covers(flat, picture_of, disparity_of):
    edges = edge_pixels(picture_of(flat, RoadAxis(), (0.0,)), disparity_of(flat), flat)
    near = edges.z < 8
    rows = len(np.unique(edges.v[near]))  # a border has one edge pixel in each row
    expected = 2 * (edges.z[near].max() - edges.z[near].min())
    assert np.count_nonzero(near) == pytest.approx(2 * rows, rel=0.2)
    assert edges.length[near].sum() == pytest.approx(expected, rel=0.2)
    assert edges.length.max() <= 0.5  # m


def test_an_edge_across_the_road_heads_across(flat, disparity_of):
    picture = np.full((300, 640), 90, np.uint8)
    picture[240:] = 200
    edges = edge_pixels(picture, disparity_of(flat), flat)
    assert len(edges.u) > 500
    np.testing.assert_allclose(np.abs(edges.heading), np.pi / 2, atol=np.deg2rad(1))


def test_edges_above_the_road_are_left_out_and_unmatched_ones_kept(flat, picture_of, disparity_of):
    picture = picture_of(flat, RoadAxis(), OFFSETS)
    disparity = disparity_of(flat)
    free = edge_pixels(picture, disparity, flat)
    disparity.matched[:, :320] = np.nan  # the left line has no disparity, a box stands on the right one
    disparity.matched[:, 320:] *= 1.5
    edges = edge_pixels(picture, disparity, flat)
    assert np.array_equal(edges.u, free.u[free.u < 320])
    assert len(edges.u) < len(free.u)


def test_only_the_road_ahead_and_near_the_middle_is_looked_at(flat, disparity_of):
    picture = np.random.default_rng(0).integers(0, 256, (300, 640)).astype(np.uint8)
    edges = edge_pixels(picture, disparity_of(flat), flat)
    assert 3 < edges.z.min() < edges.z.max() < 35  # m
    assert np.abs(edges.x).max() < 10


def test_many_edges_are_thinned_out_and_count_more(flat, disparity_of):
    small = np.random.default_rng(0).integers(0, 256, (300, 640)).astype(np.uint8)
    picture = np.tile(small, (1, 3))
    edges = [edge_pixels(image, disparity_of(flat, image.shape), flat) for image in (small, picture)]
    few, many = (sum(e.length[(e.u < 600) & (e.z < 20)]) for e in edges)
    assert len(edges[0].u) > 3000
    assert len(edges[1].u) <= 4000
    assert many == pytest.approx(few, rel=0.1)


def test_every_field_has_a_value_for_every_edge(flat, picture_of, disparity_of):
    edges = edge_pixels(picture_of(flat, AXIS, OFFSETS), disparity_of(flat), flat)
    assert {len(field) for field in vars(edges).values()} == {len(edges.u)}
    assert all(np.isfinite(field).all() for field in vars(edges).values())


@pytest.mark.parametrize("grey", [0, 90, 255])
def test_no_edges_in_a_blank_picture(flat, disparity_of, grey):
    picture = np.full((300, 640), grey, np.uint8)
    assert len(edge_pixels(picture, disparity_of(flat), flat).u) == 0


@settings(max_examples=200)  # every pair of values
@given(data=st.data(), pitch=st.sampled_from([-0.2, 0.02]))
def test_awkward_input_gives_edges_on_the_ground(awkward, data, pitch):
    image, disparity, camera = data.draw(awkward)
    edges = edge_pixels(image, disparity, QuadraticSurface.plane(camera, 1.6, pitch))
    assert all(np.isfinite(field).all() for field in vars(edges).values())


@settings(max_examples=200)  # every pair of values
@given(data=st.data())
def test_awkward_images_before_an_upright_camera_give_edges_on_the_ground(awkward, data):
    """In whose pictures there is a road; with the cameras drawn there mostly is none."""
    image, disparity, _ = data.draw(awkward)
    road = QuadraticSurface.plane(StereoCamera(700.0, 690.0, 200.0, 20.0, 0.5), 1.6, 0.02)
    edges = edge_pixels(image, disparity, road)
    assert all(np.isfinite(field).all() for field in vars(edges).values())
