# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The bird's-eye view's ways between cells, road, pixels and points; centres of paint."""

import numpy as np
import pytest

from lane_dp_ros.core.birdseye.paint_map import PaintMap
from lane_dp_ros.core.geometry.road_axis import RoadAxis
from lane_dp_ros.core.lanes.candidate import LaneLine

AXES = {"straight": RoadAxis(), "turned": RoadAxis(0.1), "bend": RoadAxis(-0.05, 0.02)}


def test_resolution_is_metres_per_row_and_column(painted_road):
    assert painted_road().view().resolution == pytest.approx((0.25, 0.05))


def test_columns_count_from_the_left_and_end_with_the_view(painted_road):
    """200 columns of 0.05 m, the first one's centre at -4.975 m."""
    view = painted_road().view()
    np.testing.assert_allclose(view.columns([-4.975, 0.0, 4.975]), [0, 99.5, 199])
    assert view.nearest_columns([-6.0, -4.94, 0.02, 6.0]).tolist() == [0, 1, 100, 199]


def test_pixels_of_a_flat_straight_road_are_those_of_a_pinhole(painted_road):
    view = painted_road().view()
    # u = cx + fx n / s, v = cy + fy h / s with f = 721.5, cx = 609.6, cy = 172.9, h = 1.65 m
    expected = [[609.6, 172.9 + 721.5 * 1.65 / 10], [609.6 + 721.5 * 2 / 20, 172.9 + 721.5 * 1.65 / 20]]
    np.testing.assert_allclose(view.to_pixels([10, 20], [0, 2]), expected)


def test_points_of_a_flat_straight_road_lie_under_the_camera(painted_road):
    points = painted_road().view().to_points([10, 20], [0, 2])
    np.testing.assert_allclose(points, [[0, 1.65, 10], [2, 1.65, 20]], atol=1e-9)


@pytest.mark.parametrize("axis", AXES.values(), ids=AXES)
def test_cells_road_and_points_go_round(painted_road, axis):
    view = painted_road(axis=axis).view()
    rows, columns = np.array([0, 40, 79]), np.array([0, 120, 199])
    points = view.to_points(view.s[rows], view.n[columns])
    np.testing.assert_allclose(view.cells(points), np.column_stack([columns, rows]), atol=1e-6)
    s, n = view.to_road(points)
    np.testing.assert_allclose(s, view.s[rows])
    np.testing.assert_allclose(n, view.n[columns])
    np.testing.assert_allclose(
        view.to_pixels(s, n),
        np.column_stack([view.map_u[rows, columns], view.map_v[rows, columns]]),
        rtol=1e-5,
    )


@pytest.mark.parametrize("channels", [(), (3,)], ids=["grey", "colour"])
def test_warp_shows_any_image_from_above_and_black_where_unseen(painted_road, channels):
    road = painted_road()
    road.seen[:, :100] = False
    image = np.broadcast_to(
        np.arange(375, dtype=np.uint8).reshape(-1, 1, *[1] * len(channels)), (375, 1242, *channels)
    )
    warped = road.view().warp(np.ascontiguousarray(image))
    assert warped.dtype == np.uint8
    assert warped.shape == (80, 200, *channels)
    assert not warped[:, :100].any()
    # Row v has grey value v: at 13.875 m ahead v = 172.9 + 721.5 * 1.65 / 13.875 = 258.7, less 256.
    assert np.all(np.abs(warped[road.s == 13.875][:, 100:].astype(int) - 2.7) <= 1.0)


def test_the_length_of_a_line_is_that_along_the_road():
    line = LaneLine(np.arange(3), np.array([4.0, 10.0, 24.0]), np.zeros(3), 0.0, 1.0)
    assert line.length == 20.0


@pytest.mark.parametrize("width", [0.10, 0.15, 0.25])
@pytest.mark.parametrize("brightness", [15, 80])
def test_the_centre_of_paint_is_found_within_a_centimetre(painted_road, width, brightness):
    for centre in np.arange(1.0, 1.05, 0.01):  # over the width of a column
        view, graph = painted_road().line(centre, width, brightness).bands()
        rows = np.arange(0, 80, 10)
        for aside in (-2, 0, 2):  # columns by which the path is off the centre
            columns = np.full(len(rows), aside + (centre - view.n[0]) / 0.05)
            n, weight = view.paint_centres(graph, rows, columns)
            np.testing.assert_allclose(n, centre, atol=0.01)
            assert np.all(weight > 0.5)


def test_without_paint_the_centre_is_the_path_itself_and_weighs_nothing(painted_road):
    view, graph = painted_road().line(1.0, first=10).bands()
    rows = np.array([79, 70, 20])
    n, weight = view.paint_centres(graph, rows, np.array([50.25, 60.5, 30.0]))
    np.testing.assert_allclose(n, view.n[0] + 0.05 * np.array([50.25, 60.5, 30.0]))
    assert not weight.any()


@pytest.mark.parametrize("side", [-1, 1])
def test_the_window_for_paint_ends_with_the_view(painted_road, side):
    view, graph = painted_road().line(side * 4.825).bands()
    beside = np.array([(side * 4.925 - view.n[0]) / 0.05])  # two columns outwards
    n, weight = view.paint_centres(graph, np.array([40]), beside)
    assert n[0] == pytest.approx(side * 4.825, abs=0.01)
    assert weight[0] > 0.5


def test_a_cell_costs_one_less_its_feature():
    feature = np.array([[0.0, 0.25, 1.0]], np.float32)
    graph = PaintMap(feature, feature > -1, feature, feature, feature)
    assert graph.cost.tolist() == [[1.0, 0.75, 0.0]]
