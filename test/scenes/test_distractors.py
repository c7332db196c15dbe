# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What looks like a lane line along a rendered road: that it is there, that it is none, what it covers."""

from dataclasses import replace

import numpy as np
import pytest

from lane_dp_ros.scenes import CAMERA, SIZE, Road
from lane_dp_ros.scenes.categories import CATEGORIES
from lane_dp_ros.scenes.course import Course
from lane_dp_ros.scenes.distractor_categories import DISTRACTOR_CATEGORIES, any_road
from lane_dp_ros.scenes.distractors import DISTRACTORS, footpath_border, light_gutter, light_strip, slush
from lane_dp_ros.scenes.ground import draw_ground
from lane_dp_ros.scenes.kind_categories import KIND_CATEGORIES
from lane_dp_ros.scenes.light import Light, shade
from lane_dp_ros.scenes.objects import composite
from lane_dp_ros.scenes.road import SOLID, UNPAINTED, Line
from lane_dp_ros.scenes.scene import Scene, render_frame
from lane_dp_ros.scenes.suite import Drive
from lane_dp_ros.scenes.surface import Surface
from lane_dp_ros.scenes.vehicles import Vehicle
from lane_dp_ros.scenes.view import Pose, View

pytestmark = pytest.mark.filterwarnings("error")
STRAIGHT = Road(swing=0, pitch=0.0)
BARE = replace(STRAIGHT, lines=(UNPAINTED,) * 3)


def surface_of(road, position=100.0):
    """What the left camera sees of a road's ground."""
    view = View(CAMERA, SIZE, Course(road, position), Pose(0.0, road.pitch, 0.0), 0.0, seed=1, time=0.0)
    surface = Surface.empty(view.shape)
    draw_ground(surface, view)
    return surface


def light_at(surface, n, half=0.05, depths=(8, 14)):
    """The mean albedo of the ground about n [m] right of the axis."""
    near = surface.ground & (np.abs(surface.n - n) < half)
    return surface.albedo[near & (surface.depth > depths[0]) & (surface.depth < depths[1])].mean()


@pytest.mark.parametrize("name", DISTRACTORS)
@pytest.mark.parametrize("seed", range(3))
def test_a_distractor_changes_the_road_but_adds_no_line(name, seed):
    road = DISTRACTORS[name](np.random.default_rng(seed), BARE)
    plain, laid = (surface_of(each) for each in (BARE, road))
    assert np.mean(np.abs(laid.albedo - plain.albedo).max(axis=-1)[200:] > 0.02) > 0.002
    assert not laid.paint.any()
    assert road.placed_lines == ()


@pytest.mark.parametrize("seed", range(8))
def test_a_light_strip_is_a_filled_trench_beside_the_paint(seed):
    rng = np.random.default_rng(seed)
    road = any_road(rng)
    (n, strip), *_ = light_strip(rng, road).strips
    assert 0.2 <= strip.width <= 0.3
    assert min([abs(n - line) for line, _ in road.placed_lines], default=1) > 0.45
    straight = replace(BARE, asphalt=road.asphalt, strips=((n, replace(strip, wobble=0.0)),))
    bare, laid = (light_at(surface_of(each), n) for each in (replace(straight, strips=()), straight))
    assert 1.1 < np.sqrt(laid / bare) < 1.65  # in grey levels; wheel tracks are darker than the asphalt


def test_ragged_borders_waver_and_keep_the_width():
    widths = []
    for ragged in (0.0, 0.05):
        line = Line(width=0.4, ragged=ragged, wear=0.0)
        paint = surface_of(replace(STRAIGHT, lines=(UNPAINTED, line, UNPAINTED))).paint
        row = paint[260:374].sum(axis=1)  # [px] of paint in each row
        depth = CAMERA.fy * 1.65 / (np.arange(260, 374) - CAMERA.cy)
        widths.append(row * depth / CAMERA.fx)
    assert np.std(widths[0]) < 0.005
    assert np.std(widths[1]) > 0.02
    assert np.mean(widths[1]) == pytest.approx(np.mean(widths[0]), abs=0.04)


def test_a_line_that_wavers_later_does_so_elsewhere():
    s = np.linspace(0, 50, 200)
    one, same, other = (
        Line(wobble=0.1, phase=phase).aside(s + shift) for phase, shift in ((0, 7), (7, 0), (9, 0))
    )
    np.testing.assert_allclose(one, same)
    assert np.abs(one - other).max() > 0.1


def test_what_covers_a_line_takes_its_paint_and_its_label():
    cover = Line(width=0.8, colour=(200.0, 200.0, 200.0), wear=0.0, begin=112.0)
    covered = replace(STRAIGHT, lines=(UNPAINTED, UNPAINTED, SOLID), covers=((1.75, cover),))
    surface = surface_of(covered)
    near, far = (
        surface.paint[surface.ground & (surface.depth > a) & (surface.depth < b)]
        for a, b in ((7, 11), (13, 30))
    )
    assert near.max() > 0.9
    assert far.max() < 0.1
    pair = render_frame(Scene(covered), 0, 1)  # from 0 m on: the cover lies beyond what is labelled
    assert pair.truth.labels[0].xz[-1, 1] > 40
    here = replace(covered, covers=((1.75, replace(cover, begin=12.0)),))
    label = next(label for label in render_frame(Scene(here), 0, 1).truth.labels if label.id == "line0")
    assert label.xz[-1, 1] == pytest.approx(12, abs=0.8)


def test_slush_lies_between_the_wheel_tracks_and_on_the_verge():
    for seed in range(6):
        road = slush(np.random.default_rng(seed), STRAIGHT)
        tracks = np.array([-4.3, -2.7, -0.8, 0.8])  # two in each lane
        on_road = [n for n, _ in road.covers if -5.85 < n < 2.35]
        assert len(on_road) >= 2
        assert min(np.abs(tracks - n).min() for n in on_road) > 0.3
    white, green = (surface_of(replace(STRAIGHT, snow=snow)) for snow in (1.0, 0.0))
    assert light_at(white, 6.0, 0.5) > 3 * light_at(green, 6.0, 0.5)


@pytest.mark.parametrize("seed", range(4))
def test_a_footpath_runs_beside_the_road_not_on_it(seed):
    rng = np.random.default_rng(seed)
    road = any_road(rng)
    left, right = road.borders
    for n, strip in footpath_border(rng, road).covers:
        assert n + strip.width / 2 < left or n - strip.width / 2 > right


def test_the_outer_border_of_a_gutter_is_the_edge():
    road = light_gutter(np.random.default_rng(0), STRAIGHT)
    pair = render_frame(Scene(road), 0, 1)
    edges = [label for label in pair.truth.labels if label.kind == "edge"]
    assert [(label.border, label.sure) for label in edges] == [("gutter", True)] * 2
    for label, x in zip(edges, (-5.85, 2.35), strict=True):
        np.testing.assert_allclose(label.xyz[:, 0], x, atol=1e-6)


def test_a_wet_road_draws_lamps_out_into_streaks():
    car = (Vehicle(120.0, 0.0, oncoming=True, lamps=1.0),)
    view = View(CAMERA, SIZE, Course(STRAIGHT, 100.0), Pose(), 0.0, seed=1, time=0.0)
    surface = Surface.empty(view.shape)
    draw_ground(surface, view)
    composite(surface, view, car)
    lengths = []
    for streak in (7.0, 20.0):
        light = shade(surface, view, Light(sky=0.05, wetness=0.9, streak=streak), car).sum(axis=-1)
        column = light[240:360, 570:610].max(axis=1)  # below its right lamp
        lengths.append(np.count_nonzero(column > 0.3 * column.max()))
    assert lengths[1] > 1.5 * lengths[0]


@pytest.mark.parametrize("name", [*DISTRACTOR_CATEGORIES, *KIND_CATEGORIES])
def test_new_categories_are_the_same_again_and_others_from_seed_to_seed(name):
    one, same, other = (CATEGORIES[name](np.random.default_rng(seed)) for seed in (3, 3, 4))
    assert one == same
    assert one != other
    assert one.road != other.road


MIXED = {("solid", "dashed"), ("dashed", "solid")}


@pytest.mark.parametrize(("name", "kinds"), [("double_solid", {("solid", "solid")}), ("double_mixed", MIXED)])
def test_double_lines_are_of_the_kinds_that_their_name_says(name, kinds):
    seen = set()
    for seed in range(6):
        truth = Drive(name, seed=seed).render(0).truth
        pair = sorted((label for label in truth.labels if label.double), key=lambda label: label.xz[0, 0])
        if pair:  # haze may hide one of them
            seen.add(tuple(label.kind for label in pair))
            assert len({label.colour for label in pair}) == 1
    assert seen == kinds


def test_yellow_lines_have_many_widths():
    scenes = [KIND_CATEGORIES["yellow_widths"](np.random.default_rng(seed)) for seed in range(12)]
    yellow = [line.width for scene in scenes for line in scene.road.lines if line.colour == "yellow"]
    assert min(yellow) == 0.10 and max(yellow) == 0.30
    assert len(set(yellow)) >= 5


@pytest.mark.parametrize("name", [name for name in DISTRACTOR_CATEGORIES if not name.startswith("no_paint")])
def test_the_lines_beside_distractors_are_labelled(name):
    """But for wet roads at dusk, where few are seen."""
    counted = 0
    for seed in range(3):
        pair = Drive(name, seed=seed).render(0)
        counted += sum(label.counts for label in pair.truth.labels)
    assert counted >= (1 if name == "wet_reflections" else 3)


def test_edges_of_a_snowy_road_are_those_of_the_asphalt():
    road = replace(STRAIGHT, snow=1.0, asphalt=75.0)
    pair = render_frame(Scene(road), 0, 1)
    assert [label.sure for label in pair.truth.labels if label.kind == "edge"] == [True, True]
