# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The exact truth of rendered scenes: rows straight ahead and points of lines, on hills and in bends."""

import numpy as np
import pytest

from lane_dp_ros.scenes import CAMERA, SIZE, Road
from lane_dp_ros.scenes.course import Course
from lane_dp_ros.scenes.heightfield import ground_depth
from lane_dp_ros.scenes.road_ahead import profile_ahead
from lane_dp_ros.scenes.scene import Motion, Scene, render_frame
from lane_dp_ros.scenes.suite import Drive
from lane_dp_ros.scenes.view import Pose, View
from lane_dp_ros.tools.evaluation.depth import DEPTHS

HILL = Road(hill=5.0, hill_length=160.0, swing=0)
CREST, SAG = 45.0, 135.0  # m along it


def view_of(road, position, pose=None):
    return View(CAMERA, SIZE, Course(road, position), pose or Pose(0.0, road.pitch), 0.0, 1, 0.0)


def test_the_rows_of_a_flat_road():
    """y cos(pitch) + z sin(pitch) = camera height, on the plane below the camera."""
    z, v = profile_ahead(view_of(Road(swing=0), 0.0)).T
    assert z.tolist() == list(range(6, 36))  # at 5 m the road is below the picture
    y = (1.65 - z * np.sin(0.012)) / np.cos(0.012)
    np.testing.assert_allclose(v, CAMERA.cy + CAMERA.fy * y / z, atol=1e-6)


@pytest.mark.parametrize("position", [CREST, SAG, 90.0])
def test_the_rows_of_a_hill_are_where_the_road_is_as_high_as_the_hill(position):
    """Each pixel, put at its depth, lies on the hill's own cosine above the plane that touches it."""
    view = view_of(HILL, position)
    z, v = profile_ahead(view).T
    optical = np.column_stack([np.zeros_like(z), (v - CAMERA.cy) / CAMERA.fy * z, z])
    _, up, ahead = (view.origin + optical @ view.axes).T
    turn = 2 * np.pi / 160
    height = 2.5 * (np.cos(turn * position) - np.cos(turn * (position + ahead)))
    tangent = 2.5 * turn * np.sin(turn * position) * ahead
    np.testing.assert_allclose(up, height - tangent, atol=1e-4)


@pytest.mark.parametrize("category", ["straight", "tight_curve", "roll", "crest", "dip", "kerbs"])
def test_the_rows_are_those_of_the_picture(category):
    scene = Drive(category).scene()
    view = view_of(scene.road, scene.motion.start, scene.motion.pose(0.0, scene.road.pitch))
    profile = profile_ahead(view)
    near = profile[(profile[:, 0] > 7) & (profile[:, 0] < 26)]
    column = ground_depth(view)[:, 609:611].astype(np.float64) @ (0.4, 0.6)  # cx is 609.6
    seen = 1 / np.interp(near[:, 1], np.arange(SIZE[1]), 1 / column)
    np.testing.assert_allclose(seen, near[:, 0], rtol=2e-3)
    assert len(near) == 18


def test_what_a_crest_hides_has_no_row():
    profile = profile_ahead(view_of(Road(hill=8.0, hill_length=100.0, swing=0), 40.0))
    assert np.all(np.diff(profile[:, 1]) < 0) and 10 < profile[-1, 0] < 30


def test_a_road_beside_the_picture_has_no_profile():
    assert profile_ahead(view_of(Road(swing=0), 0.0, Pose(0.0, -0.6))) is None  # looks into the sky


@pytest.mark.parametrize("position", [CREST, SAG])
def test_the_truth_of_a_hill_is_exact_where_its_ground_is_not(rendered, position):
    scene = Scene(HILL, motion=Motion(start=position))
    pair = rendered(render_frame, scene, 0, 1)
    truth = pair.truth
    rows = truth.rows_ahead(DEPTHS)
    np.testing.assert_allclose(truth.profile, profile_ahead(view_of(HILL, position)))
    depths = truth.on_ground(np.column_stack([np.full(4, CAMERA.cx), rows]))[:, 1]
    assert np.abs(depths / DEPTHS - 1).max() > 0.02  # the error of the quadratic, not of a detector
    painted = [label for label in truth.labels if label.painted]
    assert len(painted) == 3
    for label, lane in zip(painted, pair.lanes, strict=True):
        z = np.arange(10.0, 26.0)
        assert np.all(np.diff(label.xyz[:, 2]) > 0) and np.diff(label.xyz[:, 2]).max() < 1.1
        for axis in (0, 1):
            found, exact = (np.interp(z, line[:, 2], line[:, axis]) for line in (label.xyz, lane))
            np.testing.assert_allclose(found, exact, atol=2e-3)
        np.testing.assert_allclose(CAMERA.project(label.xyz)[0], label.uv[0], atol=1e-9)
