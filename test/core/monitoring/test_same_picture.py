# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""One picture on both sides, coded anew or not, against pairs of two cameras: rendered ones and KITTI's."""

import cv2
import numpy as np
import pytest

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.geometry.vertical_curve import VerticalCurve
from lane_dp_ros.core.monitoring.same_picture import is_same_picture
from lane_dp_ros.scenes import CAMERA
from lane_dp_ros.scenes.suite import Drive
from lane_dp_ros.tools.datasets import kitti

NOMINAL = VerticalCurve.plane(CAMERA, 1.65, 0.0)
CATEGORIES = ("straight", "night_in_town", "bridge", "slush", "unequal_cameras", "no_paint_crack_sealing")


def as_jpeg(image, quality):
    data = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, quality])[1]
    return cv2.imdecode(data, cv2.IMREAD_GRAYSCALE)


def noisy(image):
    return np.clip(image + np.random.default_rng(0).normal(0, 4, image.shape), 0, 255).astype(np.uint8)


COPIES = {
    "equal": lambda image: image,
    "JPEG 90": lambda image: as_jpeg(image, 90),
    "JPEG 30": lambda image: as_jpeg(image, 30),
    "brighter": lambda image: cv2.convertScaleAbs(image, alpha=1.0, beta=20),
    "less contrast": lambda image: cv2.convertScaleAbs(image, alpha=0.6, beta=10),
    "noise": noisy,
    "darker JPEG": lambda image: as_jpeg(cv2.convertScaleAbs(image, alpha=0.8), 75),
}


@pytest.fixture(scope="module", params=CATEGORIES)
def pair(request, rendered):
    """A rendered pair, grey."""
    found = rendered(Drive.render, Drive(request.param), 1)
    return tuple(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY) for image in (found.left, found.right))


@pytest.mark.parametrize("copy", COPIES.values(), ids=COPIES)
def test_a_copy_is_the_same_picture(pair, copy):
    assert is_same_picture(pair[0], copy(pair[0]), NOMINAL)
    assert is_same_picture(copy(pair[1]), pair[1], NOMINAL)


def test_two_cameras_are_not(pair):
    left, right = pair
    assert not is_same_picture(left, right, NOMINAL)
    assert not is_same_picture(right, left, NOMINAL)  # swapped is another fault
    assert not is_same_picture(as_jpeg(left, 30), as_jpeg(right, 30), NOMINAL)


def test_a_short_baseline_and_small_pictures_are_not(rendered):
    """7.5 cm, 621 columns: 5 px of disparity 8 m ahead."""
    left, _ = (
        cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)
        for image in (rendered(Drive.render, Drive("straight"), 1).left,) * 2
    )
    small = cv2.resize(left, None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA)
    camera = StereoCamera(360.0, 360.0, 305.0, 86.0, 0.075)
    surface = VerticalCurve.plane(camera, 1.65, 0.0)
    v, u = np.indices(small.shape, dtype=np.float32)
    moved = cv2.remap(small, (u + surface.disparity(u, v)).astype(np.float32), v, cv2.INTER_LINEAR)
    assert not is_same_picture(small, moved, surface)
    assert is_same_picture(small, small, surface)


@pytest.mark.parametrize("grey", [0, 128, 255])
def test_a_covered_camera_and_an_empty_wall_tell_nothing(grey):
    left, right = (np.full((375, 1242), value, np.uint8) for value in (grey, 128))
    assert not is_same_picture(left, left, NOMINAL)
    assert not is_same_picture(left, right, NOMINAL)
    assert not is_same_picture(noisy(left), noisy(left)[:, ::-1], NOMINAL)


@pytest.mark.parametrize("shape", [(1, 1), (2, 1242), (375, 1), (375, 2)])
def test_tiny_pictures_tell_nothing(shape):
    noise = np.random.default_rng(0).integers(0, 256, shape, dtype=np.uint8)
    assert not is_same_picture(noise[:90], noise[:90], NOMINAL)


def test_a_pair_whose_principal_points_differ(pair):
    camera = StereoCamera(CAMERA.fx, CAMERA.fy, CAMERA.cx, CAMERA.cy, CAMERA.baseline, disparity_offset=20.0)
    assert is_same_picture(pair[0], pair[0], VerticalCurve.plane(camera, 1.65, 0.0))


@pytest.mark.parametrize("name", ["01", "02", "06"])
def test_real_pairs(kitti_data, name):
    sequence = kitti.read_odometry(kitti_data / "kitti_odometry" / "sequences" / name)
    camera = StereoCamera.from_projections(sequence.P_left, sequence.P_right)
    nominal = VerticalCurve.plane(camera, 1.65, 0.0)
    for found in list(kitti.load_pairs(sequence))[::5]:
        left, right = (
            cv2.cvtColor(image, cv2.COLOR_BGR2GRAY) if image.ndim == 3 else image
            for image in (found.left, found.right)
        )
        assert not is_same_picture(left, right, nominal)
        assert is_same_picture(left, as_jpeg(left, 50), nominal)
