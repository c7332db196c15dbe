# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The cost of cells: bright bands of a paint's width, and the paper's edges and grey values."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from lane_dp_ros.core.birdseye.birds_eye import BirdsEyeConfig, birds_eye_view, right_view
from lane_dp_ros.core.birdseye.paint_map import (
    BandsPaintMap,
    EdgesPaintMap,
    PaintMap,
    PaintMapConfig,
    band_contrast,
    paint_map_builder,
    road_texture,
)
from lane_dp_ros.core.birdseye.paint_profile import PaintProfile
from lane_dp_ros.core.config import preset
from lane_dp_ros.core.geometry.quadratic_surface import QuadraticSurface
from lane_dp_ros.core.geometry.road_axis import RoadAxis

ASPHALT = 90  # grey level of the drawn pictures
CENTRE = 1.025  # m, the middle of a column
ROW = 40
EDGES = preset("paper").paint_map
BANDS = BandsPaintMap(PaintMapConfig())


def column(view, n):
    return int(np.abs(view.n - n).argmin())


def seen(road):
    """Return the view of a road and its map of bright bands."""
    paint = road.bands()
    return paint.view, paint.paint_map


@pytest.mark.parametrize("width", [0.10, 0.15, 0.20, 0.25, 0.30])
def test_a_line_of_a_paints_width_is_certain_paint_at_its_centre(painted_road, width):
    view, paint_map = seen(painted_road().line(CENTRE, width))
    assert paint_map.contrast[ROW].argmax() == column(view, CENTRE)
    assert paint_map.feature[ROW, column(view, CENTRE)] == 1
    assert not paint_map.feature[:, np.abs(view.n - CENTRE) > 0.5].any()


def test_contrast_is_in_units_of_the_sensors_noise_on_smooth_ground(painted_road):
    """0.15 m are three cells of 0.05 m of nothing but paint, 80 levels above both flanks."""
    view, paint_map = seen(painted_road().line(CENTRE, 0.15, brightness=80))
    assert paint_map.contrast[ROW, column(view, CENTRE)] == pytest.approx(80 / 3.0)


def test_the_feature_rises_between_two_contrasts(painted_road):
    view, paint_map = seen(painted_road().line(CENTRE, brightness=6))  # contrast 6 / 3 = 2
    expected = (2 - 0.35) / (2.8 - 0.35)  # the defaults of contrast_min and contrast_max
    assert paint_map.feature[ROW, column(view, CENTRE)] == pytest.approx(expected)
    np.testing.assert_allclose(paint_map.cost, 1 - paint_map.feature)


def test_paint_has_its_peak_where_the_feature_is_flat(painted_road):
    view, paint_map = seen(painted_road().line(CENTRE, brightness=80))
    assert np.count_nonzero(paint_map.feature[ROW] == 1) > 1
    assert np.flatnonzero(paint_map.paint[ROW] == paint_map.paint[ROW].max()).tolist() == [
        column(view, CENTRE)
    ]


@pytest.mark.parametrize(
    "road",
    [
        lambda road: road,
        lambda road: road.step(CENTRE),
        lambda road: road.line(CENTRE, brightness=-60),
        lambda road: road.line(CENTRE, width=1.5),
    ],
    ids=["blank", "kerb", "dark line", "bright lane"],
)
def test_no_line_no_feature(painted_road, road):
    _, paint_map = seen(road(painted_road()))
    assert not paint_map.feature.any()


def test_it_takes_more_to_be_paint_on_rough_ground(painted_road):
    smooth_view, smooth = seen(painted_road().line(CENTRE, brightness=40))
    _, rough = seen(painted_road().line(CENTRE, brightness=40).grass(-5, 5, roughness=20))
    centre = column(smooth_view, CENTRE)
    assert smooth.feature[:, centre].min() == 1
    assert np.median(rough.contrast[:, centre]) < 0.3 * smooth.contrast[ROW, centre]
    assert rough.feature[:, centre].mean() < 0.9


def test_texture_is_the_change_along_the_road(painted_road):
    along = painted_road().line(CENTRE).line(-2, 0.25).view()
    assert not road_texture(along).any()  # paint that runs along the road
    rough = painted_road().grass(-5, 5, roughness=20).view()
    # White noise: smoothing over three columns leaves 1 / sqrt(3) of it, the difference is halved again.
    assert np.median(road_texture(rough)) == pytest.approx(20 / np.sqrt(3), rel=0.1)


def test_a_change_of_object_is_no_texture(painted_road):
    road = painted_road(ground=0)
    road.grey[::8] = 255
    assert road_texture(road.view()).max() <= 30.0  # grey levels


def test_texture_beside_the_road_does_not_count(painted_road):
    road = painted_road().grass(0, 5, roughness=30)
    edge = column(road, -0.2)  # where the neighbourhood is half grass
    open_view = road_texture(road.view())[:, edge]
    road.seen = np.repeat(road.n[None] < 0, len(road.s), axis=0)
    assert road_texture(road.view())[:, edge].mean() < 0.5 * open_view.mean()
    assert not road_texture(road.view())[:, road.n < -0.6].any()
    road.seen[:] = False
    assert not road_texture(road.view()).any()


def test_contrast_is_that_against_the_less_different_side(painted_road):
    """Paint beside a kerb: 60 levels above the asphalt, but 20 above what lies on the right."""
    view = painted_road().line(CENTRE, brightness=60).view()
    view.image[:, view.n > CENTRE + 0.1] += np.uint8(40)
    contrast = band_contrast(view.image, np.zeros(view.image.shape, np.float32), 0.05)
    assert contrast[ROW, column(view, CENTRE)] == pytest.approx(20 / 3.0)


@pytest.mark.parametrize("feature", ["bands", "edges_and_grey"])
def test_cells_that_show_no_road_are_no_paint(painted_road, feature):
    road = painted_road().line(CENTRE)
    road.seen[:20] = False
    road.height[60:] = 0.5  # a wall, m
    paint_map = paint_map_builder(PaintMapConfig(feature=feature)).build(road.view())
    rows = paint_map.seen.any(axis=1)
    assert np.flatnonzero(rows).tolist() == list(range(20, 60))
    assert paint_map.feature[rows].any()
    assert not paint_map.feature[~rows].any()
    assert np.all(paint_map.cost[~rows] == 1)


@pytest.fixture
def two_sights(camera, picture_of, right_of, disparity_of):
    """Return a function: view and right image of a flat road, by the lines n [m] that each camera sees."""
    surface = QuadraticSurface.plane(camera, 1.6, 0.02)

    def two_sights(left, right):
        by_left, by_right = (picture_of(surface, RoadAxis(), offsets) for offsets in (left, right))
        view = birds_eye_view(by_left, disparity_of(surface), surface, RoadAxis(), BirdsEyeConfig())
        return view, right_of(by_right, surface)

    return two_sights


def test_a_band_counts_by_the_camera_that_shows_it_better(two_sights):
    """Glare hides one line from the left camera, another one from the right camera."""
    view, right = two_sights(left=(-1.825, 0.525), right=(0.525, 1.775))
    alone, both = (BANDS.build(view, image) for image in (None, right))
    found = [n for n in (-1.825, 0.525, 1.775) if both.feature[ROW, column(view, n)] == 1]
    assert found == [-1.825, 0.525, 1.775]
    assert alone.feature[ROW, column(view, 1.775)] == 0
    assert np.all(both.contrast >= alone.contrast)
    assert np.count_nonzero(both.feature[ROW]) < 40  # nothing else, 0.05 m a column
    np.testing.assert_array_equal(both.texture, alone.texture)
    np.testing.assert_array_equal(both.seen, alone.seen)


def test_where_the_right_camera_does_not_see_the_ground_the_left_image_counts(two_sights):
    view, right = two_sights(left=(-1.825,), right=())
    right[:] = np.random.default_rng(0).integers(0, 255, right.shape)
    alone, both = (BANDS.build(view, image) for image in (None, right))
    hidden = view.seen & ~right_view(right, view).seen
    assert np.count_nonzero(hidden) > 50
    np.testing.assert_array_equal(both.contrast[hidden], alone.contrast[hidden])


@pytest.mark.parametrize("apart", [0.05, 0.1, 0.15])
@pytest.mark.parametrize("share", [0.3, 1.0])
def test_a_line_lies_where_the_left_image_shows_it(two_sights, apart, share):
    """A surface a little wrong moves what the right camera sees; to the left one paint may be fainter."""
    view, right = two_sights(left=(0.525,), right=(0.525 + apart,))
    faint = ASPHALT + share * (view.image.astype(float) - ASPHALT)
    view = replace(view, image=np.rint(faint).astype(np.uint8))
    rows = np.flatnonzero(view.seen[:, column(view, 0.525)])[:80]
    paint = PaintProfile(view, BANDS.build(view, right))
    n, weight = paint.centres(rows, np.full(len(rows), float(column(view, 0.525))))
    assert weight.min() > 0.5
    assert np.median(n) == pytest.approx(0.525, abs=0.01)


@pytest.mark.parametrize("weight", [0.0, 0.6, 1.0])  # 0.6: w_e of the paper
def test_the_papers_feature_is_edges_and_grey_by_their_weights(painted_road, weight):
    view = painted_road().line(CENTRE, 0.35).view()
    paint_map = EdgesPaintMap(replace(EDGES, edge_weight=weight)).build(view)
    edges = cv2.Canny(view.image, 50, 150)[ROW] > 0
    paint = np.abs(view.n - CENTRE) < 0.17
    assert np.count_nonzero(edges) == 2
    assert set(view.image[ROW, paint]) == {170}
    expected = weight * edges + (1 - weight) * paint
    np.testing.assert_allclose(paint_map.feature[ROW], expected, atol=1e-6)
    np.testing.assert_allclose(paint_map.cost[ROW], 1 - expected, atol=1e-6)


def test_the_papers_weights_add_up_to_one():
    assert EDGES.edge_weight == 0.6
    assert 1 - EDGES.edge_weight == pytest.approx(0.4)


def test_paint_of_the_papers_map_has_its_peak_between_the_edges(painted_road):
    view = painted_road().line(CENTRE, 0.15).view()
    paint_map = paint_map_builder(EDGES).build(view)
    strip = paint_map.paint[ROW, np.abs(view.n - CENTRE) < 0.11]
    np.testing.assert_allclose(strip, strip[::-1], atol=1e-6)
    assert (
        paint_map.feature[ROW, column(view, CENTRE)] < paint_map.feature[ROW].max()
    )  # the path runs on an edge
    assert not paint_map.contrast.any()
    assert not paint_map.texture.any()


@pytest.mark.parametrize("is_seen", [True, False])
def test_blank_and_unseen_views_have_no_feature(painted_road, is_seen):
    road = painted_road()
    road.seen[:] = is_seen
    paint_map = paint_map_builder(EDGES).build(road.view())
    assert not paint_map.feature.any()
    assert not paint_map.paint.any()


def test_contrast_at_the_border_of_the_view_is_as_if_it_went_on():
    """The outermost cells are repeated: a line there has a flank on its inner side only."""
    image = np.full((2, 30), 90, np.uint8)
    contrast = band_contrast(image, np.zeros(image.shape, np.float32), 0.05)
    assert contrast.shape == image.shape
    assert not contrast.any()
    image[0, :3] = 170
    assert band_contrast(image, np.zeros(image.shape, np.float32), 0.05).max() == 0


def test_contrast_by_hand():
    """A band of three cells 60 levels bright; texture of 3 levels beside it doubles the unit of noise."""
    image = np.full((1, 60), 90, np.uint8)
    image[0, 29:32] = 150
    smooth, rough = np.zeros(image.shape, np.float32), np.full(image.shape, 3.0, np.float32)
    contrast = band_contrast(image, smooth, 0.05)[0]
    assert contrast.argmax() == 30
    assert contrast[30] == pytest.approx(60 / 3)
    assert band_contrast(image, rough, 0.05)[0, 30] == pytest.approx(60 / 6)
    for one_side in (slice(36, None), slice(None, 25)):  # the flank there counts by the texture 0.6 m aside
        rough[:] = 0
        rough[0, one_side] = 3
        assert band_contrast(image, rough, 0.05)[0, 30] == pytest.approx(60 / 6)


def test_the_configuration_names_the_feature():
    assert isinstance(paint_map_builder(PaintMapConfig()), BandsPaintMap)
    assert isinstance(paint_map_builder(EDGES), EdgesPaintMap)


def test_a_cell_costs_one_less_its_feature():
    feature = np.array([[0.0, 0.25, 1.0]], np.float32)
    paint_map = PaintMap(feature, feature > -1, feature, feature, feature)
    assert paint_map.cost.tolist() == [[1.0, 0.75, 0.0]]
