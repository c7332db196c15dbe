# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Random scenes to fit a detector by: what they are mixed of, before which cameras, with which truth."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.scenes import CAMERA, SIZE, Road
from lane_dp_ros.scenes.categories import CATEGORIES
from lane_dp_ros.scenes.course import Course
from lane_dp_ros.scenes.distractors import DISTRACTORS
from lane_dp_ros.scenes.heightfield import ground_depth
from lane_dp_ros.scenes.scene import Scene, render_frame
from lane_dp_ros.scenes.sensor import Sensor, expose
from lane_dp_ros.scenes.training import training_pair, training_scene, training_scenes
from lane_dp_ros.scenes.view import Pose, View
from lane_dp_ros.tools.evaluation.truth_file import load_truth, save_truth

pytestmark = pytest.mark.filterwarnings("error")
GREY = cv2.COLOR_BGR2GRAY
LOW_AND_WIDE = StereoCamera(fx=430.0, fy=430.0, cx=600.0, cy=140.0, baseline=0.3)
HIGH_AND_FAR = StereoCamera(fx=1150.0, fy=1150.0, cx=610.0, cy=180.0, baseline=0.15)


@pytest.fixture(scope="module")
def scenes():
    return [training_scene(np.random.default_rng([1, number])) for number in range(150)]


def test_cameras_differ_from_scene_to_scene(scenes):
    cameras, sizes = [scene.camera for scene, _ in scenes], [scene.size for scene, _ in scenes]
    widths = np.array([size[0] for size in sizes])
    focal = np.array([camera.fx for camera in cameras]) / (CAMERA.fx * widths / SIZE[0])
    for values, low, high in (
        (focal, 0.6, 1.6),
        (widths / SIZE[0], 0.5, 1.5),
        ([camera.baseline for camera in cameras], 0.12, 0.6),
        ([scene.road.camera_height for scene, _ in scenes], 1.1, 2.2),
        ([scene.sensor.gamma for scene, _ in scenes], 0.7, 1.5),
    ):
        span = high - low
        assert low - 0.01 <= np.min(values) < low + 0.1 * span
        assert high - 0.1 * span < np.max(values) <= high + 0.01


def test_the_category_names_all_that_a_scene_is_mixed_of(scenes):
    names = [category.split("+") for _, category in scenes]
    assert all(len(set(each)) == len(each) and each[0] in CATEGORIES for each in names)
    assert {name for each in names for name in each} >= set(DISTRACTORS)
    for scene, category in scenes:
        assert bool(scene.road.snow) == ("slush" in category)
    mixed = [len(each) for each in names]
    assert min(mixed) == 1 and max(mixed) >= 4


def test_lines_of_every_colour_kind_and_wear_are_among_them(scenes):
    lines = [line for scene, _ in scenes for _, line in scene.road.placed_lines]
    yellow = np.mean([line.colour == "yellow" for line in lines])
    assert 0.1 < yellow < 0.5
    assert 0.2 < np.mean([line.painted == "dashed" for line in lines]) < 0.8
    assert np.percentile([line.wear for line in lines], 90) > 0.35
    widths = [line.width for line in lines]
    assert 0.08 <= min(widths) < 0.1
    assert 0.3 < max(widths) <= 0.35


def test_pairs_come_again_and_each_with_its_camera(tmp_path):
    pairs = list(training_scenes(2, seed=3))
    again = training_pair(3, 1)
    np.testing.assert_array_equal(pairs[1].left, again.left)
    np.testing.assert_array_equal(pairs[1].right, again.right)
    assert pairs[0].truth.camera != pairs[1].truth.camera
    for number, pair in enumerate(pairs):
        truth = pair.truth
        assert truth.name == f"training/{number:06d}"
        assert pair.left.shape == pair.right.shape == (*truth.size[::-1], 3)
        assert truth.category.split("+")[0] in CATEGORIES
    assert len({pair.stamp_ns for pair in pairs}) == 2
    save_truth([pair.truth for pair in pairs], tmp_path / "truth.json")
    frames = load_truth(tmp_path / "truth.json")
    assert [frame.camera for frame in frames] == [pair.truth.camera for pair in pairs]
    assert [frame.category for frame in frames] == [pair.truth.category for pair in pairs]


@pytest.mark.parametrize("number", range(6))
def test_the_truth_goes_with_the_camera(number):
    truth = training_pair(0, number).truth
    assert truth.labels
    for label in truth.labels:
        uv = truth.camera.project(label.xyz)
        assert np.all((uv > -1) & (uv < np.array(truth.size)))
        np.testing.assert_allclose(uv[0], label.uv[0], atol=1e-6)


@pytest.mark.parametrize("camera", [LOW_AND_WIDE, HIGH_AND_FAR], ids=["low and wide", "high and far"])
@pytest.mark.parametrize("road", [Road(swing=0), Road(swing=0, kerb=0.14)], ids=["flat", "kerb"])
def test_a_stereo_matcher_finds_the_ground_of_another_camera(camera, road):
    height = {LOW_AND_WIDE: 1.1, HIGH_AND_FAR: 2.2}[camera]
    road = replace(road, camera_height=height)
    pair = render_frame(Scene(road, camera=camera), 0, 1)
    view = View(camera, SIZE, Course(road, 0.0), Pose(pitch=road.pitch), 0.0, 1, 0.0)
    depth = ground_depth(view)
    matcher = cv2.StereoSGBM_create(0, 128, 5, 200, 800, mode=cv2.STEREO_SGBM_MODE_SGBM_3WAY)
    found = matcher.compute(cv2.cvtColor(pair.left, GREY), cv2.cvtColor(pair.right, GREY)) / 16.0
    part = np.zeros(found.shape, bool)
    part[230:, 450:800] = True  # down to the last row
    part &= (found > 0) & (depth < 30)
    errors = found[part] - camera.fx * camera.baseline / depth[part]
    assert part.sum() > 20_000
    assert abs(np.median(errors)) < 0.25
    assert abs(np.median(errors[-2000:])) < 0.3  # the lowest rows


def test_ground_right_before_a_low_camera_is_where_it_is():
    """A plane and a road with a kerb far aside have the same depth, down to the last row."""
    roads = [Road(swing=0, pitch=0.0, camera_height=1.1, shoulder=30.0, kerb=kerb) for kerb in (0.0, 0.1)]
    flat, kerbed = (
        ground_depth(View(LOW_AND_WIDE, SIZE, Course(road, 0.0), Pose(), 0.0, 1, 0.0)) for road in roads
    )
    assert flat[-1].min() < 2.5
    np.testing.assert_allclose(kerbed[-100:, 500:700], flat[-100:, 500:700], rtol=2e-3)


@pytest.mark.parametrize("gamma", [0.7, 1.0, 1.5])
def test_a_tone_curve_raises_the_root_of_the_light_to_a_power(gamma):
    light = np.full((60, 80, 3), 0.45**2, np.float32)
    view = View(CAMERA, SIZE, Course(Road(), 0.0), Pose(), 0.0, 1, 0.0)
    sensor = Sensor(gamma=gamma, vignette=0.0, full_well=1e9, dark=0.0)
    image = expose(light, view, sensor, np.random.default_rng(0))
    assert np.unique(image).tolist() == [round(255 * 0.45**gamma)]
