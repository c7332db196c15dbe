# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The road's surface out of disparities: planes and hills, with walls and cars in the way; or none."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lane_dp_ros.core.geometry.disparity_map import DisparityMap
from lane_dp_ros.core.geometry.road_surface import RoadSurface
from lane_dp_ros.core.road.disparity import DisparityConfig, dense_disparity
from lane_dp_ros.core.road.road_profile import (
    RoadProfileConfig,
    fit_road_surface,
    v_disparity,
    v_disparity_path,
)
from lane_dp_ros.core.types import StereoFrame
from lane_dp_ros.scenes import CAMERA

pytestmark = pytest.mark.filterwarnings("error")

CONFIG = RoadProfileConfig()
HEIGHT, PITCH = 1.6, 0.02  # m, rad


def fit(disparity, camera, config=CONFIG, seed=0):
    """Return the surface in a map, or in a picture of disparities."""
    if isinstance(disparity, np.ndarray):
        disparity = DisparityMap(disparity.shape, 0, disparity)
    return fit_road_surface(disparity, camera, config, np.random.default_rng(seed))


@pytest.fixture(scope="module")
def flat(camera):
    return RoadSurface.plane(camera, HEIGHT, PITCH)


@pytest.fixture
def cluttered(camera, flat, disparity_of):
    """A flat road with noise and holes, a wall on the right and a car ahead that hides the road behind it."""
    rng = np.random.default_rng(4)
    disparity = disparity_of(flat).matched + rng.normal(0, 0.3, (300, 640))
    disparity[rng.random(disparity.shape) < 0.2] = np.nan
    disparity[:260, 480:] = np.fmax(disparity[:260, 480:], np.linspace(10, 30, 160))
    disparity[:200, 280:400] = camera.fx * camera.baseline / 13  # 13 m ahead, down to where it stands
    return disparity.astype(np.float32)


def test_v_disparity_counts_the_disparities_of_each_row():
    rows = np.array([0, 0, 0, 1, 1])
    disparity = np.array([1.0, 1.9, 2.0, 0.5, 9.0])  # the last bin takes what is too large
    assert v_disparity(rows, disparity, (2, 4)).tolist() == [[0, 2, 1, 0], [1, 0, 0, 1]]


def test_the_path_follows_the_road_past_a_wall():
    histogram = np.zeros((5, 12), np.float32)
    road = [1, 3, 5, 7, 7]  # two pixels a row, as steep as it may be; the bottom row costs nothing
    histogram[range(5), road] = 5
    histogram[:3, 6] = 4  # a wall 6 px near
    rows, path = v_disparity_path(histogram)
    assert rows.tolist() == [0, 1, 2, 3, 4]
    assert path.tolist() == [1.5, 3.5, 5.5, 7.5, 7.5]  # middles of the bins


def test_rows_without_a_vote_are_not_on_the_path():
    histogram = np.zeros((5, 5), np.float32)
    histogram[[0, 1, 3, 4], [1, 2, 3, 3]] = 1
    rows, path = v_disparity_path(histogram)
    assert rows.tolist() == [0, 1, 3, 4]
    assert path.tolist() == [1.5, 2.5, 3.5, 3.5]


@pytest.mark.parametrize("roll", [True, False])
def test_height_and_pitch_of_a_cluttered_road(camera, cluttered, roll):
    road = fit(cluttered, camera, replace(CONFIG, roll=roll))
    assert road.camera_height == pytest.approx(HEIGHT, abs=0.03)
    assert road.pitch == pytest.approx(PITCH, abs=np.deg2rad(0.3))
    assert road.roll == pytest.approx(0, abs=np.deg2rad(0.3))


@pytest.mark.parametrize("b2", [-1.0, 1.5], ids=["falls away", "climbs"])
def test_a_quadratic_profile(camera, disparity_of, cluttered, flat, b2):
    b0, b1, _, _ = flat.coefficients
    hill = RoadSurface(camera, (b0, b1, b2, 0.0))
    things = cluttered > disparity_of(flat).matched + 2
    disparity = np.where(things, cluttered, disparity_of(hill).matched)
    road = fit(disparity, camera)
    rows = np.arange(150.0, 300.0)
    middle = np.full_like(rows, camera.cx)
    np.testing.assert_allclose(road.disparity(middle, rows), hill.disparity(middle, rows), atol=0.3)


@pytest.mark.parametrize("degrees", [-3, 2])
def test_a_road_that_leans(camera, disparity_of, flat, degrees):
    b0, b1, _, _ = flat.coefficients
    leaning = RoadSurface(camera, (b0, b1, 0.0, b1 * np.tan(np.deg2rad(degrees))))
    road = fit(disparity_of(leaning), camera)
    assert np.rad2deg(road.roll) == pytest.approx(degrees, abs=0.1)
    assert road.camera_height == pytest.approx(HEIGHT, abs=0.02)


def test_without_roll_the_road_does_not_lean(camera, cluttered):
    assert fit(cluttered, camera, replace(CONFIG, roll=False)).coefficients[3] == 0


@pytest.mark.parametrize("degrees", [-5, 5])
def test_a_bush_beside_the_road_is_not_taken_for_the_road(camera, disparity_of, flat, degrees):
    """Its one disparity gets more votes in a row than those of a road that leans."""
    b0, b1, _, _ = flat.coefficients
    leaning = RoadSurface(camera, (b0, b1, 0.0, b1 * np.tan(np.deg2rad(degrees))))
    disparity = disparity_of(leaning).matched
    bush = np.zeros(disparity.shape, bool)
    bush[:260, 400:560] = True
    disparity[bush] = np.fmax(disparity[bush], np.float32(camera.fx * camera.baseline / 9))
    road = fit(disparity, camera)
    assert road.camera_height == pytest.approx(HEIGHT, abs=0.03)
    assert np.rad2deg(road.roll) == pytest.approx(degrees, abs=0.3)


@pytest.mark.parametrize("baseline", [0.1, 1.0])  # m
def test_road_does_not_stand_whatever_the_baseline(camera, disparity_of, baseline):
    """By a short one its disparity falls by 1 px over many rows."""
    camera = replace(camera, baseline=baseline, disparity_offset=0.0)
    road = fit(disparity_of(RoadSurface.plane(camera, HEIGHT, PITCH)), camera)
    assert road.camera_height == pytest.approx(HEIGHT, abs=0.03)


def test_whatever_the_seed_the_road_is_the_same(camera, cluttered, disparity_of, flat):
    b0, b1, _, _ = flat.coefficients
    leaning_hill = RoadSurface(camera, (b0, b1, 2.5, 4.0))
    things = cluttered > disparity_of(flat).matched + 2
    disparity = np.where(things, cluttered, disparity_of(leaning_hill).matched).astype(np.float32)
    rows = np.arange(150.0, 300.0)
    middle = np.full_like(rows, camera.cx)
    first, *others = (fit(disparity, camera, seed=seed).disparity(middle, rows) for seed in range(8))
    for other in others:
        np.testing.assert_allclose(other, first, atol=1e-4)


def test_the_same_seed_gives_the_same_road(camera, cluttered):
    assert fit(cluttered, camera, seed=3) == fit(cluttered, camera, seed=3)


def test_a_rendered_road(scene):
    road, pair = scene
    disparity = dense_disparity(StereoFrame(pair.left, pair.right), CAMERA, DisparityConfig())
    found = fit(disparity, CAMERA)
    assert found.camera_height == pytest.approx(road.camera_height, abs=0.03)
    assert found.pitch == pytest.approx(road.pitch, abs=np.deg2rad(0.2))
    assert found.roll == pytest.approx(0, abs=np.deg2rad(0.3))


@pytest.mark.parametrize("height", [0.9, 3.0])
def test_no_road_at_an_impossible_height(camera, disparity_of, height):
    assert fit(disparity_of(RoadSurface.plane(camera, height, PITCH)), camera) is None


@pytest.mark.parametrize(("height", "believed"), [(1.1, False), (1.2, True), (1.95, True), (2.3, False)])
def test_a_height_is_possible_within_a_factor_of_the_nominal_one(camera, disparity_of, height, believed):
    disparity = disparity_of(RoadSurface.plane(camera, height, PITCH))
    road = fit(disparity, camera, replace(CONFIG, camera_height=1.6))
    assert (road is not None) == believed


@pytest.mark.parametrize(("nominal", "believed"), [(0.0, False), (0.2, True)])
def test_a_pitch_is_possible_about_the_nominal_one(camera, disparity_of, nominal, believed):
    disparity = disparity_of(RoadSurface.plane(camera, HEIGHT, 0.25))
    assert (fit(disparity, camera, replace(CONFIG, camera_pitch=nominal)) is not None) == believed


def test_a_road_that_leans_as_no_road_does(camera, disparity_of, flat):
    b0, b1, _, _ = flat.coefficients
    assert fit(disparity_of(RoadSurface(camera, (b0, b1, 0.0, 0.3 * b1))), camera) is None


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


def test_no_road_in_rows_too_few_for_a_parabola(camera, disparity_of, flat):
    disparity = disparity_of(flat, (300, 1600)).matched
    disparity[:-4] = np.nan  # 200 samples in two rows
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
