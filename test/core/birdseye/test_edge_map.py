# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Where the carriageway may end, on drawn roads with a kerb, or a verge, at a known place."""

import numpy as np
import pytest

from lane_dp_ros.core.birdseye.edge_map import edge_map

BORDER = 3.0  # m beside the vehicle
KERB = 0.12  # m

pytestmark = pytest.mark.filterwarnings("error")


def mapped(road):
    paint = road.bands()
    return edge_map(paint.view, paint.paint_map)


def behind(road, side):
    """Return which columns of a road lie behind the border on a side, -1 left or 1 right."""
    return side * road.n > BORDER


def with_kerb(road, side, height=KERB):
    road.height[:, behind(road, side)] = height
    return road


def at_border(edges, values, side):
    """Return a map's values (rows,) at the border."""
    return values[:, np.argmin(np.abs(edges.n - side * BORDER))]


def is_at_border(edges, side):
    """Return which rows are surest of the border where it is."""
    return np.abs(edges.n[edges.feature.argmax(axis=1)] - side * BORDER) <= 0.3


def test_a_cell_is_about_a_metre_long_and_a_fifth_of_one_wide(painted_road):
    road = painted_road()
    edges = mapped(road)
    assert edges.resolution == pytest.approx((1.0, 0.2))
    assert edges.feature.shape == (len(edges.s), len(edges.n)) == (20, 50)
    assert edges.s[[0, -1]].tolist() == pytest.approx([23.5, 4.5])
    assert edges.n[[0, -1]].tolist() == pytest.approx([-4.9, 4.9])


def test_on_blank_flat_road_is_no_border(painted_road):
    edges = mapped(painted_road())
    assert not edges.feature.any()
    assert not edges.rise.any() and not edges.grey_step.any() and not edges.texture_step.any()
    assert edges.seen.all()


@pytest.mark.parametrize("side", [-1, 1], ids=["left", "right"])
@pytest.mark.parametrize("height", [KERB, -0.1], ids=["kerb", "ditch"])
def test_a_kerb_is_a_rise_away_from_the_vehicle(painted_road, side, height):
    edges = mapped(with_kerb(painted_road(), side, height))
    assert at_border(edges, edges.rise, side) == pytest.approx(np.full(20, height), abs=0.01)
    assert at_border(edges, edges.far_rise, side) == pytest.approx(np.full(20, height), abs=0.03)
    assert at_border(edges, edges.ground, side) == pytest.approx(np.zeros(20), abs=0.01)
    assert is_at_border(edges, side).all()
    assert not edges.feature[:, np.abs(edges.n - side * BORDER) > 1].any()


@pytest.mark.parametrize("side", [-1, 1], ids=["left", "right"])
def test_a_step_of_brightness_is_a_border_and_leads_away_from_the_vehicle(painted_road, side):
    """From 90 to 60 levels: (60 - 90) / (90 + 10)."""
    road = painted_road()
    road.grey[:, behind(road, side)] = 60
    edges = mapped(road)
    assert at_border(edges, edges.grey_step, side) == pytest.approx(np.full(20, -0.3), abs=0.02)
    assert at_border(edges, edges.far_grey_step, side) == pytest.approx(np.full(20, -0.3), abs=0.05)
    assert is_at_border(edges, side).all()
    assert not np.nan_to_num(edges.rise).any()


@pytest.mark.parametrize("side", [-1, 1], ids=["left", "right"])
def test_grass_is_rougher_than_the_road_before_it(painted_road, side):
    first, last = sorted((side * BORDER, side * 5.0))
    edges = mapped(painted_road().grass(first, last, roughness=20))
    assert at_border(edges, edges.texture_step, side).min() > np.log(1.3)
    assert at_border(edges, edges.far_texture_step, side).min() > np.log(2)


def test_rough_ground_makes_a_step_of_brightness_less_certain(painted_road):
    smooth, rough = painted_road().step(BORDER, 12), painted_road().step(BORDER, 12)
    rough.grass(-5, 5, roughness=10)
    sure, unsure = (at_border(each, each.feature, 1) for each in map(mapped, (smooth, rough)))
    assert unsure.mean() < 0.7 * sure.mean()


def test_both_steps_in_one_place_are_more_certain_than_either(painted_road):
    kerb = with_kerb(painted_road(), 1, 0.06)
    grey, both = painted_road().step(BORDER, 5), with_kerb(painted_road(), 1, 0.06).step(BORDER, 5)
    of_kerb, of_grey, of_both = (
        at_border(each, each.feature, 1).mean() for each in map(mapped, (kerb, grey, both))
    )
    assert of_both == pytest.approx(of_kerb + of_grey, abs=0.02)
    assert max(of_kerb, of_grey) < of_both < 1


def test_paint_is_no_border(painted_road):
    """The steps beside a line are the line's; those of as broad a dark band, which is no paint, stay."""
    line, band = (mapped(painted_road().line(2.0, 0.15, brightness)) for brightness in (80, -60))
    on_line = np.abs(line.n - 2.0) < 0.15
    assert line.feature[:, on_line].max() < 0.2
    assert band.feature.max() > 0.5


def test_what_is_not_seen_is_no_border_and_what_has_no_height_no_step(painted_road):
    road = with_kerb(painted_road(), 1)
    road.seen[:40] = False
    road.height[60:] = np.nan
    edges = mapped(road)
    assert edges.seen[:10].sum() == 0 and edges.seen[10:].all()
    assert not edges.feature[:10].any()
    assert np.isnan(edges.rise[17:]).all() and np.isnan(edges.ground[17:]).all()
    assert not edges.feature[17:].any()
    assert at_border(edges, edges.rise, 1)[12:14] == pytest.approx([KERB, KERB], abs=0.01)


def test_a_wall_is_as_certain_as_a_high_kerb(painted_road):
    edges = mapped(with_kerb(painted_road(), 1, height=2.0))
    assert at_border(edges, edges.rise, 1).max() == pytest.approx(0.3, abs=0.01)


def test_far_off_a_step_has_to_be_higher(painted_road):
    """The disparity's noise grows with the distance."""
    edges = mapped(with_kerb(painted_road(length=40), 1, height=0.08))
    feature = at_border(edges, edges.feature, 1)
    assert feature[0] < 0.7 * feature[-1]
    assert np.all(np.diff(feature[5:-5]) > 0)


def test_cells_are_the_nearest_ones_and_inside(painted_road):
    edges = mapped(painted_road())
    rows, columns = edges.cells(
        np.array([4.5, 23.4, 10.9, 0.0, 99.0]), np.array([-4.9, 4.9, 0.08, -9.0, 9.0])
    )
    assert rows.tolist() == [19, 0, 13, 19, 0]
    assert columns.tolist() == [0, 49, 25, 0, 49]


def test_centres_are_where_the_feature_is(painted_road):
    edges = mapped(with_kerb(painted_road(), 1))
    rows = np.arange(20)
    near = np.argmin(np.abs(edges.n - BORDER))
    for off in (-1, 0, 1):
        n, weight = edges.centres(rows, np.full(20, float(near + off)))
        assert np.abs(n - BORDER).max() < 0.12
        assert weight.min() > 0.1
    n, weight = edges.centres(rows, np.full(20, 10.0))
    assert n == pytest.approx(np.full(20, edges.n[10]))
    assert not weight.any()
