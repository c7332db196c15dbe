# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The road's surface out of disparities: planes and hills, with walls and cars in the way; or none."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.geometry.disparity_map import DisparityMap
from lane_dp_ros.core.geometry.quadratic_surface import QuadraticSurface
from lane_dp_ros.core.geometry.road_surface import geometry
from lane_dp_ros.core.geometry.vertical_curve import VerticalCurve
from lane_dp_ros.core.road.disparity import DisparityConfig, dense_disparity
from lane_dp_ros.core.road.road_profile import (
    RoadProfileConfig,
    is_plausible,
    largest_disparity,
    road_profile,
)
from lane_dp_ros.core.types import StereoFrame
from lane_dp_ros.scenes import CAMERA

pytestmark = pytest.mark.filterwarnings("error")

CONFIG = RoadProfileConfig()
QUADRATIC = RoadProfileConfig(model="quadratic")
HEIGHT, PITCH = 1.6, 0.02  # m, rad
CELL = 4  # px; of disparities with a quarter of the resolution


def fit(disparity, camera, config=CONFIG, seed=0, known=None):
    """Return the surface in a map, or in a picture of disparities, by the left image alone: not aligned."""
    if isinstance(disparity, np.ndarray):
        disparity = DisparityMap(disparity.shape, 0, disparity)
    left = StereoFrame(np.zeros(disparity.shape, np.uint8))
    return road_profile(config).measure(left, disparity, camera, np.random.default_rng(seed), known)


def measured(pair, config=CONFIG, known=None):
    """Return the surface in a rendered pair."""
    frame = StereoFrame(pair.left, pair.right)
    largest = largest_disparity(CAMERA, pair.left.shape[0], config)
    disparity = dense_disparity(frame, CAMERA, DisparityConfig(), largest)
    return road_profile(config).measure(frame, disparity, CAMERA, np.random.default_rng(0), known)


def hill(camera, curvature, roll=0.0):
    return VerticalCurve.of_geometry(camera, np.array([HEIGHT, PITCH, curvature, roll]))


def noisy(disparity, seed, outliers=0.0):
    """Return a map with noise of a twentieth of a cell and a share of cells with any disparity."""
    rng = np.random.default_rng(seed)
    matched = disparity.matched + rng.normal(0, 0.05 * disparity.cell, disparity.matched.shape)
    wrong = rng.random(matched.shape) < outliers
    matched = np.where(wrong, rng.uniform(0, 90, matched.shape), matched)
    return replace(disparity, matched=matched.astype(np.float32))


@pytest.fixture(scope="module")
def flat(camera):
    return VerticalCurve.plane(camera, HEIGHT, PITCH)


@pytest.fixture
def cluttered(camera, flat, disparity_of):
    """A flat road with noise and holes, a wall on the right and a car ahead that hides the road behind it."""
    rng = np.random.default_rng(4)
    disparity = disparity_of(flat).matched + rng.normal(0, 0.1, (300, 640))
    disparity[rng.random(disparity.shape) < 0.2] = np.nan
    disparity[:260, 480:] = np.fmax(disparity[:260, 480:], np.linspace(10, 30, 160))
    disparity[:200, 280:400] = camera.fx * camera.baseline / 13  # 13 m ahead, down to where it stands
    return disparity.astype(np.float32)


@pytest.mark.parametrize("config", [CONFIG, QUADRATIC], ids=lambda config: config.model)
def test_height_and_pitch_of_a_cluttered_road(camera, cluttered, config):
    road = fit(cluttered, camera, config)
    assert road.camera_height == pytest.approx(HEIGHT, abs=0.02)
    assert road.pitch == pytest.approx(PITCH, abs=np.deg2rad(0.2))
    assert road.roll == pytest.approx(0, abs=np.deg2rad(0.2))


@given(curvature=st.floats(-3e-3, 4e-3), roll=st.floats(-0.06, 0.06))
def test_hills_and_cross_slopes(camera, disparity_of, curvature, roll):
    truth = hill(camera, curvature, roll)
    road = fit(noisy(disparity_of(truth, cell=CELL), seed=0), camera)
    assert np.all(np.abs(geometry(road) - geometry(truth)) < [0.005, 1e-3, 2e-4, 1e-3])


@pytest.mark.parametrize("curvature", [-3e-3, 4e-3], ids=["falls away", "climbs"])
def test_a_hill_behind_cars_and_walls(camera, disparity_of, cluttered, flat, curvature):
    truth = hill(camera, curvature)
    things = cluttered > disparity_of(flat).matched + 2
    road = fit(np.where(things, cluttered, disparity_of(truth).matched), camera)
    rows = np.arange(180.0, 300.0)
    middle = np.full_like(rows, camera.cx)
    np.testing.assert_allclose(road.disparity(middle, rows), truth.disparity(middle, rows), atol=0.1)


@pytest.mark.parametrize("b2", [-1.0, 1.5], ids=["falls away", "climbs"])
def test_the_papers_profile_is_a_quadratic(camera, disparity_of, cluttered, flat, b2):
    b0, b1, _, _ = QuadraticSurface.plane(camera, HEIGHT, PITCH).coefficients
    truth = QuadraticSurface(camera, (b0, b1, b2, 0.0))
    things = cluttered > disparity_of(flat).matched + 2
    road = fit(np.where(things, cluttered, disparity_of(truth).matched), camera, QUADRATIC)
    assert isinstance(road, QuadraticSurface)
    rows = np.arange(150.0, 300.0)
    middle = np.full_like(rows, camera.cx)
    np.testing.assert_allclose(road.disparity(middle, rows), truth.disparity(middle, rows), atol=0.3)


def test_the_papers_road_does_not_lean(camera, cluttered):
    assert fit(cluttered, camera, QUADRATIC).coefficients[3] == 0


@pytest.mark.parametrize("degrees", [-5, 5])
def test_a_bush_beside_the_road_is_not_taken_for_the_road(camera, disparity_of, degrees):
    """Its one disparity gets more votes in a row than those of a road that leans."""
    disparity = disparity_of(hill(camera, 0.0, np.deg2rad(degrees)), cell=CELL)
    bush = disparity.matched[:65, 100:140]
    bush[:] = np.fmax(bush, np.float32(camera.fx * camera.baseline / 9))
    road = fit(disparity, camera)
    assert road.camera_height == pytest.approx(HEIGHT, abs=0.01)
    assert np.rad2deg(road.roll) == pytest.approx(degrees, abs=0.2)


@pytest.mark.parametrize("baseline", [0.1, 1.0])  # m
def test_road_does_not_stand_whatever_the_baseline(camera, disparity_of, baseline):
    """By a short one its disparity falls by 1 px over many rows."""
    camera = replace(camera, baseline=baseline, disparity_offset=0.0)
    road = fit(disparity_of(VerticalCurve.plane(camera, HEIGHT, PITCH)), camera)
    assert road.camera_height == pytest.approx(HEIGHT, abs=0.02)


def test_whatever_the_seed_the_road_is_the_same(camera, cluttered, disparity_of, flat):
    things = cluttered > disparity_of(flat).matched + 2
    truth = hill(camera, 2e-3, 0.08)
    disparity = np.where(things, cluttered, disparity_of(truth).matched).astype(np.float32)
    for seed in range(8):
        road = geometry(fit(disparity, camera, seed=seed))
        assert np.all(np.abs(road - geometry(truth)) < [0.005, 2e-3, 2e-4, 5e-3])


def test_the_same_seed_gives_the_same_road(camera, cluttered):
    assert fit(cluttered, camera, seed=3) == fit(cluttered, camera, seed=3)


def test_a_rendered_road(scene):
    road, pair = scene
    found = geometry(measured(pair))
    truth = [road.camera_height, road.pitch, 0.0, 0.0]
    assert np.all(np.abs(found - truth) < [0.003 * road.camera_height, 5e-4, 1e-4, 5e-4])


def test_a_rendered_road_by_the_papers_profile(scene):
    road, pair = scene
    found = measured(pair, QUADRATIC)
    assert found.camera_height == pytest.approx(road.camera_height, abs=0.05)
    assert found.pitch == pytest.approx(road.pitch, abs=np.deg2rad(0.3))


@pytest.mark.parametrize("bend", [-0.002, 0.004], ids=["crest", "sag"])
def test_the_depth_of_a_rendered_hill(hill_of, bend):
    """25 m ahead it is right to 2 %; the truth are points of the painted lines."""
    pair = hill_of(bend)
    points = np.concatenate(pair.lanes)
    points = points[np.abs(points[:, 2] - 25) < 2]
    _, depth = measured(pair).pixel_to_ground(*CAMERA.project(points).T)
    assert len(points) > 10
    error = np.abs(depth / points[:, 2] - 1)
    assert np.median(error) < 0.02
    assert error.max() < 0.03


def test_a_road_that_was_known_is_found_where_nothing_else_shows_it(camera, disparity_of):
    """Three in five disparities are wrong, and those of the road that leans are spread over many bins."""
    truth = hill(camera, 0.0, 0.1)
    before = VerticalCurve.of_geometry(camera, np.array([1.62, 0.022, 2e-4, 0.095]))
    alone = []
    for seed in range(4):
        disparity = noisy(disparity_of(truth, cell=CELL), seed, outliers=0.6)
        road = fit(disparity, camera, known=before)
        assert np.all(np.abs(geometry(road) - geometry(truth)) < [0.01, 2e-3, 4e-4, 2e-3])
        alone.append(fit(disparity, camera))
    assert None in alone


@pytest.mark.parametrize("share", [0.3, 0.4])
@pytest.mark.parametrize("step", [-0.3, 0.15])  # m
def test_another_plane_is_not_held_on_to_once_the_road_is_seen(camera, disparity_of, flat, share, step):
    """The pavement at the right, which was taken for the road a moment ago: fewer samples lie on it."""
    pavement = VerticalCurve.plane(camera, HEIGHT + step, PITCH)
    matched = disparity_of(flat).matched
    beside = slice(round((1 - share) * matched.shape[1]), None)
    matched[:, beside] = disparity_of(pavement).matched[:, beside]
    disparity = noisy(DisparityMap(matched.shape, 0, matched), seed=0)
    road = fit(disparity, camera, known=pavement)
    assert road == fit(disparity, camera)
    assert road.camera_height == pytest.approx(HEIGHT, abs=0.01)


def test_a_known_road_of_another_model_is_no_start(camera, cluttered):
    wrong = QuadraticSurface.plane(camera, HEIGHT, PITCH)
    assert fit(cluttered, camera, known=wrong) == fit(cluttered, camera)
    curve = VerticalCurve.plane(camera, HEIGHT, PITCH)
    assert fit(cluttered, camera, QUADRATIC, known=curve) == fit(cluttered, camera, QUADRATIC)


def test_a_known_road_below_which_nothing_lies_does_no_harm(camera, cluttered):
    above = VerticalCurve.plane(camera, -1.0, 0.0)
    assert fit(cluttered, camera, known=above) == fit(cluttered, camera)


ROUND = StereoCamera(fx=500.0, fy=500.0, cx=300.0, cy=100.0, baseline=0.4)  # numbers for the head


@pytest.mark.parametrize(
    ("rows", "pitch", "expected"),
    [
        (400, 0.0, 120.0),  # slope 0.6 over 1.4 m / 1.4 = 1 m: 0.6 / m * 500 px * 0.4 m
        (150, 0.0, (0.1 + np.tan(0.15)) / 1.4 * 200),  # the road as steep as it may be, seen from 1.4 m
        (400, 0.1, (0.6 + np.tan(0.1)) * 200),
        (0, 0.0, 0.0),  # the image ends above the horizon
    ],
)
def test_the_largest_disparity_by_hand(rows, pitch, expected):
    config = RoadProfileConfig(camera_height=1.4, camera_pitch=pitch)
    assert largest_disparity(ROUND, rows, config) == pytest.approx(expected)


@given(height=st.floats(1.25, 2.2), pitch=st.floats(-0.14, 0.14), curvature=st.floats(-4e-3, 4e-3))
def test_no_possible_road_has_a_larger_disparity(height, pitch, curvature):
    """Unless it is low and steep against the camera at once."""
    surface = VerticalCurve.of_geometry(CAMERA, np.array([height, pitch, curvature, 0.0]))
    if pitch > 0 and height < 1.65:
        surface = VerticalCurve.plane(CAMERA, 1.65, pitch)
    nearest = surface.disparity(np.full(1, CAMERA.cx), np.full(1, 374.0))
    assert nearest < 1.1 * largest_disparity(CAMERA, 375, CONFIG)


@pytest.mark.parametrize(
    ("values", "plausible"),
    [
        ([1.65, 0.0, 0.0, 0.0], True),
        ([1.19, 0.0, 0.0, 0.0], True),  # 1.65 m / 1.4 = 1.179 m
        ([1.17, 0.0, 0.0, 0.0], False),
        ([2.30, 0.0, 0.0, 0.0], True),  # 1.65 m * 1.4 = 2.31 m
        ([2.32, 0.0, 0.0, 0.0], False),
        ([1.65, 0.149, 0.0, 0.0], True),
        ([1.65, -0.151, 0.0, 0.0], False),
        ([1.65, 0.0, 0.0, -0.149], True),
        ([1.65, 0.0, 0.0, 0.151], False),
    ],
)
def test_where_a_road_may_lie(values, plausible):
    assert is_plausible(VerticalCurve.of_geometry(CAMERA, np.array(values)), CONFIG) == plausible


@pytest.mark.parametrize("height", [0.9, 3.0])
def test_no_road_at_an_impossible_height(camera, disparity_of, height):
    assert fit(disparity_of(VerticalCurve.plane(camera, height, PITCH)), camera) is None


@pytest.mark.parametrize(("height", "believed"), [(1.1, False), (1.2, True), (1.95, True), (2.3, False)])
def test_a_height_is_possible_within_a_factor_of_the_nominal_one(camera, disparity_of, height, believed):
    disparity = disparity_of(VerticalCurve.plane(camera, height, PITCH))
    road = fit(disparity, camera, replace(CONFIG, camera_height=1.6))
    assert (road is not None) == believed


@pytest.mark.parametrize(("nominal", "believed"), [(0.0, False), (0.2, True)])
def test_a_pitch_is_possible_about_the_nominal_one(camera, disparity_of, nominal, believed):
    disparity = disparity_of(VerticalCurve.plane(camera, HEIGHT, 0.25))
    assert (fit(disparity, camera, replace(CONFIG, camera_pitch=nominal)) is not None) == believed


def test_a_road_that_leans_as_no_road_does(camera, disparity_of):
    assert fit(disparity_of(hill(camera, 0.0, 0.3)), camera) is None


def test_a_few_chance_matches_on_a_plane_are_not_believed(camera, disparity_of, flat):
    """The right camera sees something else: little is matched at all, whatever plane that little lies on."""
    disparity = disparity_of(flat).matched
    rng = np.random.default_rng(0)
    for share, believed in [(0.1, False), (0.5, True)]:
        there = rng.random(disparity.shape) < share
        road = fit(np.where(there, disparity, np.nan).astype(np.float32), camera)
        assert (road is not None) == believed


def test_no_road_in_a_wall(camera):
    assert fit(np.full((300, 640), 20.0, np.float32), camera) is None


def test_no_road_in_noise(camera):
    noise = np.random.default_rng(0).uniform(0, 100, (300, 640)).astype(np.float32)
    assert fit(noise, camera) is None


def test_a_road_in_a_tenth_of_the_picture_is_not_believed(camera, disparity_of, flat):
    rng = np.random.default_rng(0)
    disparity = rng.uniform(0, 100, (300, 640)).astype(np.float32)
    for share, believed in [(0.1, False), (0.4, True)]:
        there = rng.random(disparity.shape) < share
        road = fit(np.where(there, disparity_of(flat).matched, disparity), camera)
        assert (road is not None) == believed


def test_no_road_in_too_few_disparities(camera, disparity_of, flat):
    disparity = disparity_of(flat).matched
    disparity[:, 100:] = np.nan
    disparity[:270] = np.nan  # 10 rows of 12 samples are left
    assert fit(disparity, camera) is None


def test_no_road_in_a_few_rows(camera, disparity_of, flat):
    disparity = disparity_of(flat, (300, 1600)).matched
    disparity[:-4] = np.nan  # 400 samples in four rows
    assert fit(disparity, replace(camera, cx=800.0)) is None


def test_a_few_mad_disparities_do_no_harm(camera, cluttered):
    cluttered[::7, ::5] = np.inf
    cluttered[::11, ::3] = 1e9
    assert fit(cluttered, camera).camera_height == pytest.approx(HEIGHT, abs=0.03)


@settings(max_examples=200)  # every pair of values
@given(data=st.data())
def test_awkward_disparities_hold_no_road(awkward, data):
    _, disparity, camera = data.draw(awkward)
    assert fit(disparity, camera) is None
