# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The age of the right picture: rendered drives by day and night, at several rates, and KITTI's."""

import cv2
import numpy as np
import pytest

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.geometry.vertical_curve import VerticalCurve
from lane_dp_ros.core.monitoring.right_delay import right_delay
from lane_dp_ros.scenes import CAMERA
from lane_dp_ros.scenes.suite import Drive
from lane_dp_ros.tools.datasets import kitti

NOMINAL = VerticalCurve.plane(CAMERA, 1.65, 0.0)
DRIVES = (Drive("straight", rate=20.0), Drive("night_in_town", rate=40.0), Drive("motorway", rate=20.0))


def grey(image):
    return cv2.cvtColor(image, cv2.COLOR_BGR2GRAY) if image.ndim == 3 else image


@pytest.fixture(scope="module", params=DRIVES, ids=lambda drive: drive.category)
def frames(request, rendered):
    """Five pairs of a drive, grey."""
    pairs = [rendered(Drive.render, request.param, index) for index in range(5)]
    return [(grey(pair.left), grey(pair.right)) for pair in pairs]


def test_a_sound_pair_is_of_one_time(frames):
    assert right_delay(frames[2][0], frames[1][0], frames[2][1], NOMINAL) == pytest.approx(0, abs=0.08)


def test_a_right_picture_of_the_frame_before_is_one_frame_old(frames):
    assert right_delay(frames[2][0], frames[1][0], frames[1][1], NOMINAL) == pytest.approx(1, abs=0.1)


def test_half_a_frame_is_measured_too(frames):
    """The left pictures are every other one of those rendered."""
    assert right_delay(frames[2][0], frames[0][0], frames[1][1], NOMINAL) == pytest.approx(0.5, abs=0.1)


def test_a_right_picture_of_the_frame_after_is_newer(frames):
    assert right_delay(frames[2][0], frames[1][0], frames[3][1], NOMINAL) == pytest.approx(-1, abs=0.25)


@pytest.mark.parametrize("category", ["straight", "slush", "night_in_town"])
def test_a_quarter_of_a_metre_between_frames_is_enough(rendered, category):
    """9 km/h at 10 Hz."""
    pairs = [rendered(Drive.render, Drive(category, rate=60.0), index) for index in range(3)]
    (before, other), (left, right) = ((grey(pair.left), grey(pair.right)) for pair in pairs[1:])
    assert right_delay(left, before, right, NOMINAL) == pytest.approx(0, abs=0.08)
    assert right_delay(left, before, other, NOMINAL) == pytest.approx(1, abs=0.08)


@pytest.mark.parametrize("category", ["straight", "slush", "night_in_town"])
def test_a_vehicle_that_creeps_gives_no_false_delay(rendered, category):
    """4 cm between frames."""
    pairs = [rendered(Drive.render, Drive(category, rate=400.0), index) for index in range(3)]
    left, before, right = (grey(image) for image in (pairs[2].left, pairs[1].left, pairs[2].right))
    found = right_delay(left, before, right, NOMINAL)
    assert found is None or abs(found) < 0.1


def test_rows_that_do_not_meet_are_no_delay(frames):
    """Cameras pitched or rolled against each other: that is another fault, and told as such."""
    left, before, right = frames[2][0], frames[1][0], frames[2][1]
    size, centre = left.shape[::-1], (CAMERA.cx, CAMERA.cy)
    rolled = cv2.getRotationMatrix2D(centre, 0.5, 1.0)
    for moved in (np.roll(right, 3, axis=0), cv2.warpAffine(right, rolled, size)):
        assert right_delay(left, before, moved, NOMINAL) == pytest.approx(0, abs=0.12)


def test_a_vehicle_that_stands_tells_nothing(frames):
    left, right = frames[2]
    assert right_delay(left, left, right, NOMINAL) is None
    again = np.clip(left + np.random.default_rng(0).normal(0, 2, left.shape), 0, 255).astype(np.uint8)
    assert right_delay(left, again, right, NOMINAL) is None


@pytest.mark.parametrize("shape", [(1, 1), (2, 400), (400, 3), (375, 1242)])
def test_empty_walls_and_tiny_pictures_tell_nothing(shape):
    image = np.full(shape, 90, np.uint8)
    assert right_delay(image, image, image, NOMINAL) is None


def test_another_place_tells_nothing(frames):
    noise = np.random.default_rng(0).integers(0, 256, frames[0][0].shape, dtype=np.uint8)
    assert right_delay(frames[2][0], frames[1][0], noise, NOMINAL) is None


@pytest.mark.parametrize("name", ["01", "02", "06"])
@pytest.mark.parametrize(("late", "tolerance"), [(0, 0.04), (1, 0.04), (-1, 0.3)])
def test_real_drives(kitti_data, name, late, tolerance):
    """A single measurement is off by up to 0.13, the median of a drive by 0.03; newer pictures by a fifth."""
    sequence = kitti.read_odometry(kitti_data / "kitti_odometry" / "sequences" / name)
    camera = StereoCamera.from_projections(sequence.P_left, sequence.P_right)
    nominal = VerticalCurve.plane(camera, 1.65, 0.0)
    frames = [(grey(pair.left), grey(pair.right)) for pair in kitti.load_pairs(sequence)]
    found = [
        right_delay(frames[i][0], frames[i - 1][0], frames[i - late][1], nominal)
        for i in range(1, len(frames) - 1, 3)
    ]
    assert None not in found
    assert np.median(found) == pytest.approx(late, abs=tolerance)
    assert np.abs(np.array(found) - np.median(found)).max() < 0.7
