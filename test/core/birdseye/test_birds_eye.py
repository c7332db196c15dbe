# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The bird's-eye view: its grid in metres, what it shows, what is hidden and what stands on the road."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lane_dp_ros.core.birdseye.birds_eye import BirdsEyeConfig, birds_eye_view, right_view
from lane_dp_ros.core.geometry.disparity_map import DisparityMap
from lane_dp_ros.core.geometry.quadratic_surface import QuadraticSurface
from lane_dp_ros.core.geometry.road_axis import RoadAxis
from lane_dp_ros.core.geometry.vertical_curve import VerticalCurve

pytestmark = pytest.mark.filterwarnings("error")

CONFIG = BirdsEyeConfig(near=4.0, length=20.0, width=8.0, forward_resolution=0.5, lateral_resolution=0.1)
SMALL = replace(CONFIG, length=10.0, width=4.0, forward_resolution=1.0, lateral_resolution=0.2)
AXIS = RoadAxis(heading=-0.05, curvature=0.01)
AXES = {"straight": RoadAxis(), "turned": RoadAxis(0.1), "bend": RoadAxis(-0.05, 0.02)}
HEIGHT = 1.6  # m


@pytest.fixture(scope="module")
def road(camera):
    """A road that climbs and leans."""
    b0, b1, _, _ = QuadraticSurface.plane(camera, HEIGHT, 0.02).coefficients
    return QuadraticSurface(camera, (b0, b1, 0.4, 0.5))


@pytest.fixture(scope="module")
def blank():
    return np.full((300, 640), 90, np.uint8)


@pytest.fixture(scope="module")
def view(road, picture_of, disparity_of):
    return birds_eye_view(picture_of(road, AXIS, (-1.8, 1.2)), disparity_of(road), road, AXIS, CONFIG)


def test_rows_come_nearer_and_columns_go_right_by_the_resolution(view):
    assert view.image.shape == (40, 80)  # 20 m / 0.5 m, 8 m / 0.1 m
    assert view.resolution == pytest.approx((0.5, 0.1))
    assert (view.s[0], view.s[-1]) == pytest.approx((23.75, 4.25))  # cells' centres
    assert (view.n[0], view.n[-1]) == pytest.approx((-3.95, 3.95))


def test_lines_along_the_axis_stand_upright_at_their_offset(view):
    brightest = [half + view.image[:, half : half + 40].argmax(axis=1) for half in (0, 40)]
    for columns, offset in zip(brightest, (-1.8, 1.2), strict=True):
        seen = view.seen[np.arange(40), columns]
        assert np.count_nonzero(seen) > 25
        np.testing.assert_allclose(view.n[columns][seen], offset, atol=0.1)


def test_cells_outside_the_image_are_unseen_and_repeat_its_border(road, disparity_of):
    image = np.full((300, 640), 90, np.uint8)
    image[:, 0], image[:, -1] = 10, 200
    view = birds_eye_view(image, disparity_of(road), road, RoadAxis(), replace(CONFIG, width=12.0))
    nearest = view.image[-1]  # 4.25 m ahead the camera sees 2 m to each side
    assert (nearest[0], nearest[-1]) == (10, 200)
    assert not view.seen[-1, [0, -1]].any()
    assert not view.on_road[-1, [0, -1]].any()
    assert view.seen[0, 60]
    assert np.array_equal(view.seen, (view.warp(image) > 0))


def test_the_bonnet_is_not_looked_at(road, disparity_of):
    tall = np.full((900, 640), 90, np.uint8)  # shows the ground from 1.4 m on
    view = birds_eye_view(tall, disparity_of(road, tall.shape), road, RoadAxis(), replace(CONFIG, near=0.0))
    assert view.seen[view.s > 3, 40].all()
    assert not view.seen[view.s < 3].any()


def test_behind_a_crest_nothing_is_seen(camera, blank, disparity_of):
    """From 1.6 m above it the summit of a curvature of -0.0125 1/m is sqrt(2 * 1.6 / 0.0125) = 16 m ahead."""
    crest = VerticalCurve.of_foot(camera, 1.6, 0.0, -0.0125)
    view = birds_eye_view(blank, disparity_of(crest), crest, RoadAxis(), CONFIG)
    assert view.seen[(view.s > 8) & (view.s < 16), 40].all()
    assert not view.seen[view.s > 16].any()
    assert not view.on_road[view.s > 16].any()


def test_an_empty_road_has_no_height_and_is_all_road(view):
    np.testing.assert_allclose(view.height[view.seen], 0, atol=0.05)
    assert np.array_equal(view.on_road, view.seen)


def test_what_stands_on_the_road_is_not_road(camera, blank, disparity_of):
    road = QuadraticSurface.plane(camera, HEIGHT, 0.0)
    disparity = disparity_of(road)
    rows, columns = slice(200, 220), slice(300, 360)  # 13 m to 10.4 m ahead
    disparity.matched[rows, columns] *= HEIGHT / (HEIGHT - 0.4)  # 0.4 m above the ground
    disparity.matched[240:245, columns] *= HEIGHT / (HEIGHT - 0.05)  # less than the tolerance
    disparity.matched[250:, :300] = np.nan
    view = birds_eye_view(blank, disparity, road, RoadAxis(), CONFIG)
    high = (view.map_v > 201) & (view.map_v < 219) & (view.map_u > 301) & (view.map_u < 359)
    assert np.count_nonzero(high) > 30
    np.testing.assert_allclose(view.height[high], 0.4, atol=0.02)
    assert not view.on_road[high].any()
    unmatched = np.isnan(view.height)
    assert unmatched.any()
    assert np.array_equal(view.on_road, view.seen & ~(view.height > CONFIG.height_tolerance))


def test_less_than_a_pixel_of_disparity_is_noise_whatever_height_it_means(camera, blank, disparity_of):
    road = QuadraticSurface.plane(camera, HEIGHT, 0.0)
    disparity = disparity_of(road)
    disparity.matched[:] += 0.8
    view = birds_eye_view(blank, disparity, road, RoadAxis(), BirdsEyeConfig())
    assert np.nanmax(view.height) > BirdsEyeConfig().height_tolerance
    assert np.array_equal(view.on_road, view.seen)


def test_the_plane_that_is_given_makes_the_map_and_the_surface_the_heights(camera, blank, disparity_of, road):
    flat = QuadraticSurface.plane(camera, HEIGHT, 0.03)
    view = birds_eye_view(blank, disparity_of(road), road, AXIS, CONFIG, flat)
    x, z = AXIS.to_ground(view.s[:, None], view.n[None])
    u, v = flat.ground_to_pixel(x, z)
    np.testing.assert_allclose(view.map_u[view.seen], u[view.seen], atol=0.01)
    np.testing.assert_allclose(view.map_v[view.seen], v[view.seen], atol=0.01)
    np.testing.assert_allclose(view.height[view.seen], 0, atol=0.05)


@given(s=st.floats(4.5, 30), n=st.floats(-6, 6))
def test_points_lie_on_the_surface_where_the_map_shows_them(camera, view, s, n):
    plane = QuadraticSurface.plane(camera, HEIGHT, 0.03)
    for seen_as in (view, replace(view, ipm_plane=plane)):
        points = seen_as.to_points([s], [n])
        pixels = camera.project(points)
        np.testing.assert_allclose(pixels, seen_as.to_pixels([s], [n]), atol=1e-6)
        depth = points[:, 2] + camera.left_translation[2]
        expected = seen_as.road_surface.disparity(*pixels.T)
        np.testing.assert_allclose(camera.fx * camera.baseline / depth, expected, atol=1e-6)
        np.testing.assert_allclose(np.ravel(seen_as.to_road(points)), [s, n], atol=1e-6)
        column, row = seen_as.cells(points)[0]
        assert (column, row) == pytest.approx(((n + 3.95) / 0.1, (23.75 - s) / 0.5), abs=1e-4)


def test_points_above_the_horizon_are_in_no_cell(view):
    assert np.isnan(view.cells([[0.0, -3.0, 10.0]])).all()


def test_cells_are_means_of_the_picture_where_they_cover_many_pixels(camera, disparity_of):
    """Near, a cell of 0.05 m by 0.25 m covers hundreds of pixels; eight samples of it are looked at."""
    road = QuadraticSurface.plane(camera, HEIGHT, 0.0)
    noise = np.random.default_rng(0).normal(0, 20, (300, 640))
    image = np.clip(np.rint(120 + noise), 0, 255).astype(np.uint8)
    view = birds_eye_view(image, disparity_of(road), road, RoadAxis(), BirdsEyeConfig())
    near = view.seen & (view.s < 8)[:, None]
    once = cv2.remap(image, view.map_u, view.map_v, cv2.INTER_LINEAR)
    assert np.std(once[near]) > 12  # one sample of four pixels each
    assert np.std(view.image[near]) < 20 / np.sqrt(2 * 4)
    assert np.mean(view.image[near]) == pytest.approx(120, abs=0.5)


@pytest.mark.parametrize("resolution", [(0.25, 0.05), (0.5, 0.1), (1 / 15, 0.05)])
@pytest.mark.parametrize("axis", [RoadAxis(), AXIS], ids=["straight", "bend"])
@pytest.mark.parametrize("offset", [-1.26, 0.0, 1.013])
def test_the_mean_does_not_shift_a_line(camera, disparity_of, resolution, axis, offset):
    """A line of bell-shaped brightness has its centroid where it was drawn."""
    road = QuadraticSurface.plane(camera, HEIGHT, 0.02)
    v, u = np.mgrid[:300, :640].astype(float)
    x, z = road.pixel_to_ground(u, v)
    n = axis.offset(x, z)
    paint = np.where(np.isfinite(n), 160 * np.exp(-0.5 * ((n - offset) / 0.1) ** 2), 0)
    image = np.rint(80 + paint).astype(np.uint8)
    config = BirdsEyeConfig(forward_resolution=resolution[0], lateral_resolution=resolution[1])
    view = birds_eye_view(image, disparity_of(road), road, axis, config)
    rows = (view.s > 6) & (view.s < 12)
    near = np.abs(view.n - offset) < 0.45
    bright = view.image[rows][:, near].astype(float) - 80
    centroid = (bright * view.n[near]).sum(axis=1) / bright.sum(axis=1)
    assert centroid.mean() == pytest.approx(offset, abs=0.001)


@pytest.mark.parametrize("place", [7.03, 9.5])
def test_the_mean_does_not_shift_a_line_across_the_road(camera, disparity_of, place):
    road = QuadraticSurface.plane(camera, HEIGHT, 0.02)
    v, u = np.mgrid[:300, :640].astype(float)
    _, z = road.pixel_to_ground(u, v)
    paint = np.where(np.isfinite(z), 160 * np.exp(-0.5 * ((z - place) / 0.4) ** 2), 0)
    image = np.rint(80 + paint).astype(np.uint8)
    view = birds_eye_view(image, disparity_of(road), road, RoadAxis(), BirdsEyeConfig())
    rows = np.abs(view.s - place) < 1.8
    middle = np.abs(view.n) < 1
    bright = view.image[rows][:, middle].astype(float) - 80
    centroid = (bright * view.s[rows, None]).sum(axis=0) / bright.sum(axis=0)
    assert centroid.mean() == pytest.approx(place, abs=0.01)


@settings(max_examples=200)  # every pair of values
@given(data=st.data())
def test_awkward_input_gives_a_view(awkward, data):
    image, disparity, camera = data.draw(awkward)
    road = QuadraticSurface.plane(camera, HEIGHT, 0.02)
    view = birds_eye_view(image, disparity, road, RoadAxis(0.1, -0.05), SMALL)
    assert view.image.shape == view.height.shape == view.on_road.shape == (10, 20)
    assert not np.any(view.on_road & ~view.seen)


def test_the_right_image_shows_the_same_ground_in_the_same_cells(camera, picture_of, right_of, disparity_of):
    road = QuadraticSurface.plane(camera, HEIGHT, 0.02)
    left = picture_of(road, AXIS, (-1.8, 1.2))
    view = birds_eye_view(left, disparity_of(road), road, AXIS, CONFIG)
    other = right_view(right_of(left, road), view)
    both = view.seen & other.seen
    assert np.count_nonzero(both) > 0.5 * both.size
    apart = np.abs(view.image.astype(int) - other.image)[both]
    assert np.mean(apart) < 1 and np.percentile(apart, 99) < 10  # paint is 110 grey levels brighter


def test_what_either_camera_does_not_see_or_stands_on_the_road_is_not_on_the_right_views_road(
    camera, blank, disparity_of
):
    road = QuadraticSurface.plane(camera, HEIGHT, 0.02)
    disparity = disparity_of(road)
    disparity.matched[200:210] += 20  # a bar across the road
    view = birds_eye_view(blank, disparity, road, RoadAxis(), replace(CONFIG, width=12.0))
    other = right_view(blank, view)
    assert np.any(view.on_road & ~other.seen)  # at the left border the left camera alone sees the ground
    assert np.any(other.seen & ~view.on_road)
    assert np.array_equal(other.on_road, view.on_road & other.seen)
    assert not np.any(other.seen & ~view.seen)


def test_a_disparity_offset_moves_the_right_view(camera, picture_of, right_of, disparity_of):
    """The principal points of the two cameras differ by 5 px; depth is fx * baseline / (d - 5)."""
    road = QuadraticSurface.plane(replace(camera, disparity_offset=5.0), HEIGHT, 0.02)
    left = picture_of(road, RoadAxis(), (0.55,))  # the middle of a column
    view = birds_eye_view(left, disparity_of(road), road, RoadAxis(), CONFIG)
    other = right_view(right_of(left, road), view)
    rows = view.seen[:, 45] & other.seen[:, 45]
    assert np.count_nonzero(rows) > 25
    np.testing.assert_array_equal(view.image[rows].argmax(axis=1), 45)
    np.testing.assert_array_equal(other.image[rows].argmax(axis=1), 45)


def test_cells_that_a_standing_thing_hides_from_the_right_camera_are_not_on_its_road(
    camera, blank, disparity_of
):
    """A kerb 0.3 m high, 2 m to the right: the right camera sees it b h / (H - h) further left."""
    road = QuadraticSurface.plane(camera, HEIGHT, 0.02)
    height = 0.3
    v, u = np.indices(blank.shape, dtype=np.float32)
    x, z = road.pixel_to_ground(u, v)
    disparity = disparity_of(road)
    # Where the left camera looks past the top of the kerb; what is that high has the larger disparity.
    standing = (x * (1 - height / HEIGHT) > 2.0) & (x * (1 - height / HEIGHT) < 2.2) & (z < 30)
    disparity.matched[standing] /= 1 - height / HEIGHT
    view = birds_eye_view(blank, disparity, road, RoadAxis(), CONFIG)
    other = right_view(blank, view)
    row = int(np.argmin(np.abs(view.s - 12.0)))
    kerb = view.n[view.seen[row] & ~view.on_road[row]]
    hidden = view.n[view.on_road[row] & other.seen[row] & ~other.on_road[row]]
    assert len(kerb) and len(hidden)
    aside = camera.baseline * height / (HEIGHT - height)
    assert hidden.min() == pytest.approx(kerb.min() - aside, abs=0.15)
    assert hidden.max() <= kerb.max()


def test_a_road_that_climbs_far_above_the_matched_rows_is_looked_at(camera):
    """A few rows at the bottom were matched; above them nothing is known of heights, as without a match."""
    road = QuadraticSurface.plane(camera, HEIGHT, 0.05)
    image = np.random.default_rng(0).integers(0, 256, (300, 640), np.uint8)
    low = DisparityMap(image.shape, 270, np.full((15, 320), 3.0, np.float32), 2)
    view = birds_eye_view(image, low, road, RoadAxis(), CONFIG)
    above = view.map_v < 269.5
    assert np.count_nonzero(above) > 1000
    assert np.isnan(view.height[above]).all()
    assert np.array_equal(view.on_road[above], view.seen[above])


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
