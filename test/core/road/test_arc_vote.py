# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The road's axis: recovered from hand-made edges, drawn lines and a rendered road; or straight ahead."""

import numpy as np
import pytest

from lane_dp_ros.core.geometry.quadratic_surface import QuadraticSurface
from lane_dp_ros.core.geometry.road_axis import RoadAxis
from lane_dp_ros.core.road.arc_vote import arc_of_edges
from lane_dp_ros.core.road.disparity import DisparityConfig, dense_disparity
from lane_dp_ros.core.road.edge_pixels import EdgePixels, edge_pixels
from lane_dp_ros.core.types import StereoFrame
from lane_dp_ros.scenes import CAMERA

pytestmark = pytest.mark.filterwarnings("error")

HEADING_MAX, CURVATURE_MAX = 0.5, 0.05  # rad, 1/m
DEGREE = np.deg2rad(1)


def voted(edges):
    return arc_of_edges(edges, HEADING_MAX, CURVATURE_MAX)


def edges_along(axis, offsets, s=None, turned=0.0):
    """Exact edges, 0.1 m long, along lines of `offsets`, each turned by an angle against its line."""
    s = np.arange(4.0, 30.0, 0.1) if s is None else s
    s, n = (grid.ravel() for grid in np.meshgrid(s, offsets))
    x, z = axis.to_ground(s, n)
    unused = np.zeros_like(s)
    heading = axis.heading + axis.curvature * s + turned
    return EdgePixels(unused, unused, unused, unused, x, z, heading, np.full_like(s, 0.1))


def together(*edges):
    return EdgePixels(
        *(np.concatenate(fields) for fields in zip(*(vars(e).values() for e in edges), strict=True))
    )


def drift(axis, truth):
    """How far [m] apart the nearest and farthest offset from `axis` are of a true line 4 to 25 m ahead."""
    s = np.arange(4.0, 25.0, 0.5)
    return np.ptp(axis.offset(*truth.to_ground(s, np.full_like(s, -1.8))))


@pytest.mark.parametrize("curvature", [-0.04, -0.01, 0.0, 0.003, 0.03])
@pytest.mark.parametrize("heading", [-0.2, 0.0, 0.1])
def test_the_axis_of_exact_edges(heading, curvature):
    truth = RoadAxis(heading, curvature)
    axis = voted(edges_along(truth, (-1.8, 1.7)))
    assert drift(axis, truth) < 0.35
    assert axis.heading == pytest.approx(heading, abs=3 * DEGREE)  # the prior straightens sharp bends and
    assert axis.curvature == pytest.approx(curvature, abs=0.0025)  # turns them: one makes up for the other
    assert type(axis.heading) is type(axis.curvature) is float


@pytest.mark.parametrize("curvature", [-0.02, 0.0, 0.01])
@pytest.mark.parametrize("heading", [-0.1, 0.05])
def test_the_axis_of_a_drawn_road(camera, picture_of, disparity_of, heading, curvature):
    road = QuadraticSurface.plane(camera, 1.6, 0.02)
    truth = RoadAxis(heading, curvature)
    picture = picture_of(road, truth, (-1.8, 1.7))
    axis = voted(edge_pixels(picture, disparity_of(road), road))
    assert drift(axis, truth) < 0.35
    assert axis.heading == pytest.approx(heading, abs=1.5 * DEGREE)
    assert axis.curvature == pytest.approx(curvature, abs=0.0025)


def test_the_axis_of_a_rendered_road(scene):
    road, pair = scene
    surface = QuadraticSurface.plane(CAMERA, road.camera_height, road.pitch)
    disparity = dense_disparity(StereoFrame(pair.left, pair.right), CAMERA, DisparityConfig(), 103.0)
    axis = voted(edge_pixels(pair.left, disparity, surface))
    assert axis.heading == pytest.approx(0, abs=DEGREE)
    assert axis.curvature == pytest.approx(road.curvature, abs=0.003)


def test_one_long_line_beats_the_many_short_stripes_of_hatching():
    line = edges_along(RoadAxis(0.05), (-1.8,))
    stripes = edges_along(RoadAxis(-0.25), np.arange(-4, 7.0, 0.5), s=np.arange(10.0, 12.5, 0.1))
    assert stripes.length.sum() > 2 * line.length.sum()
    axis = voted(together(line, stripes))
    assert axis.heading == pytest.approx(0.05, abs=DEGREE)


def test_scattered_edges_do_not_turn_the_road():
    rng = np.random.default_rng(2)
    scattered = edges_along(RoadAxis(), (0.0,) * 3, turned=0)
    x, z = rng.uniform(-8, 8, scattered.x.size), rng.uniform(4, 30, scattered.x.size)
    scattered = EdgePixels(*[x] * 4, x, z, rng.uniform(-1.5, 1.5, x.size), scattered.length)
    axis = voted(together(edges_along(RoadAxis(0.1, -0.01), (-1.8, 1.7)), scattered))
    assert axis.heading == pytest.approx(0.1, abs=DEGREE)
    assert axis.curvature == pytest.approx(-0.01, abs=0.003)


@pytest.mark.parametrize("count", [0, 19])
def test_too_few_edges_mean_straight_ahead(count):
    edges = edges_along(RoadAxis(0.2), (-1.8,), s=np.linspace(4, 30, count))
    assert voted(edges) == RoadAxis()


def test_edges_that_no_axis_runs_along_mean_straight_ahead():
    across = edges_along(RoadAxis(), (0.0,), s=np.arange(4.0, 10.0, 0.1), turned=np.pi / 2)
    assert voted(across) == RoadAxis()


def test_edges_without_length_mean_straight_ahead():
    edges = edges_along(RoadAxis(0.2), (-1.8,))
    weightless = EdgePixels(*list(vars(edges).values())[:-1], np.zeros_like(edges.length))
    assert voted(weightless) == RoadAxis()


def test_edges_far_aside_give_an_axis():
    assert np.isfinite(voted(edges_along(RoadAxis(0.1, 0.05), (-12.0, 12.0))).heading)


@pytest.mark.parametrize("sign", [-1, 1])
def test_the_vote_is_bounded(sign):
    """By 0.2 rad and 0.01 1/m, give or take the half cell about a peak."""
    axis = arc_of_edges(edges_along(RoadAxis(sign * 0.35, sign * 0.03), (-1.8, 1.7)), 0.2, 0.01)
    assert abs(axis.heading) <= 0.2 + 0.5 * DEGREE + 1e-9
    assert abs(axis.curvature) <= 0.01 + 0.002 + 1e-9
