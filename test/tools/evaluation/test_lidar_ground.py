# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The ground fitted to sparse disparity, with what stands on the road, against what it was made of."""

import cv2
import numpy as np
import pytest

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.tools.evaluation.lidar_ground import fit_lidar_ground
from lane_dp_ros.tools.evaluation.truth_file import load_truth

CAMERA = StereoCamera(720.0, 720.0, 610.0, 172.0, 0.54)
SHAPE = 375, 1242
ROADS = {"flat": (0.0, 32.0, 0.0, 0.0), "leaning": (-1.2, 31.0, 0.4, 0.9), "falling": (1.5, 33.0, -0.5, -0.6)}
AHEAD = np.array([8.0, 12.0, 18.0, 25.0])


def disparity_of(ground):
    v, u = np.mgrid[: SHAPE[0], : SHAPE[1]]
    n, m = (v - CAMERA.cy) / 100, (u - CAMERA.cx) / 100
    return np.maximum(np.stack([np.ones_like(n), n, n * n, m], axis=-1) @ ground, 0)


def with_car(disparity, left=620, right=900, top=170, bottom=260):
    """Return the picture with a car, as far away as the road where it stands, in it."""
    made = disparity.copy()
    made[top:bottom, left:right] = disparity[bottom, (left + right) // 2]
    return made


def scanned(disparity, rng):
    """Return one pixel in six, with LiDAR's noise."""
    return np.where(rng.uniform(size=SHAPE) < 1 / 6, disparity + rng.normal(0, 0.1, SHAPE), 0)


def depth_error(ground, found):
    rows = [depth_row(ground, z) for z in AHEAD]
    return np.array([np.polyval(ground[2::-1], n) / np.polyval(found[2::-1], n) for n in rows]) - 1


def depth_row(ground, z):
    """Return n, the row in hundreds of pixels, in which the ground has a depth."""
    g0, g1, g2, _ = ground
    n = np.linspace(0.1, 2.0, 20001)
    return n[np.abs(g0 + g1 * n + g2 * n * n - CAMERA.fx * CAMERA.baseline / z).argmin()]


@pytest.mark.parametrize("road", ROADS.values(), ids=ROADS)
@pytest.mark.parametrize("car", [False, True])
def test_the_ground_is_found_again(road, car):
    made, rng = disparity_of(road), np.random.default_rng(3)
    found = fit_lidar_ground(scanned(with_car(made) if car else made, rng), CAMERA, rng)
    np.testing.assert_allclose(depth_error(road, found.coefficients), 0, atol=0.003)
    assert found.coefficients[3] == pytest.approx(road[3], abs=0.05)
    assert found.reach > 25


def test_it_reaches_as_far_as_the_ground_is_seen():
    made = disparity_of(ROADS["flat"])
    made[: int(172 + 100 * depth_row(ROADS["flat"], 15.0))] = 0
    found = fit_lidar_ground(made, CAMERA, np.random.default_rng(0))
    assert 14 < found.reach <= 15.1


@pytest.mark.parametrize("disparity", [0.0, 20.0], ids=["nothing", "a wall"])
def test_no_road(disparity):
    assert fit_lidar_ground(np.full(SHAPE, disparity), CAMERA, np.random.default_rng(0)) is None


def test_points_without_any_order_are_no_road():
    rng = np.random.default_rng(0)
    made = np.where(rng.uniform(size=SHAPE) < 0.1, rng.uniform(4, 60, SHAPE), 0)
    assert fit_lidar_ground(made, CAMERA, rng) is None


def test_it_agrees_with_the_labels(kitti_data):
    """The labels' ground was fitted by another hand to the same LiDAR, with the road's border looked at."""
    errors = []
    for frame in load_truth(kitti_data / "labels" / "lanes.json"):
        if frame.sequence == "kitti_stereo_2015":
            path = kitti_data / frame.left.replace("image_2", "disp_occ_0")
            lidar = cv2.imread(str(path), cv2.IMREAD_UNCHANGED) / 256
            found = fit_lidar_ground(lidar, frame.camera, np.random.default_rng(0))
            n = (frame.rows_ahead(AHEAD) - frame.camera.cy) / 100
            ours, theirs = (np.polyval(g[2::-1], n) for g in (found.coefficients, frame.ground))
            errors.append(theirs / ours - 1)
    assert len(errors) == 52
    assert np.abs(np.median(errors, axis=0)).max() < 0.003
    assert np.median(np.abs(errors), axis=0).max() < 0.006
