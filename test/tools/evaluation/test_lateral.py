# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Lines compared in the world: an error of the surface that the image hides is seen here."""

from dataclasses import replace

import numpy as np
import pytest

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.types import Lane
from lane_dp_ros.tools.evaluation.annotations import Label, LabelledFrame
from lane_dp_ros.tools.evaluation.lateral import LateralErrors, LateralSummary, lateral_errors
from lane_dp_ros.tools.evaluation.matching import judge
from lane_dp_ros.tools.evaluation.summary import summarise

CAMERA = StereoCamera(700.0, 700.0, 600.0, 180.0, 0.54)
GROUND = np.array([0.0, 100 * 0.54 / 1.65, 0.0, 0.0])  # a plane 1.65 m below the camera


def line(x, start=5.0, end=30.0):
    z = np.arange(start, end + 0.01, 0.5)
    return np.column_stack([np.full_like(z, x), np.full_like(z, 1.65), z])


def label(points, **fields):
    return Label("L", "solid", True, CAMERA.project(points), points[:, [0, 2]], **fields)


def lane(points):
    return Lane(points, 0.9, 0.12, "other", 0.0, 0.0)


def judged(points, truth, camera=CAMERA):
    frame = LabelledFrame("a/0", CAMERA, (1200, 370), GROUND, (truth,), "L")
    return judge(frame, [lane(points)], camera)


def test_a_surface_that_is_2_per_cent_too_deep_is_seen_in_space_only():
    score = judged(1.02 * line(1.8), label(line(1.8)))  # the same pixels
    (match,) = score.matches
    assert match.error == pytest.approx(0.0, abs=1e-9)
    assert match.in_space.near == pytest.approx(0.036) == pytest.approx(match.in_space.far)
    total = summarise([score, judged(line(1.8), label(line(1.8)))]).in_space
    assert total.near.value == pytest.approx(0.018) == pytest.approx(total.at_10.value)
    assert (total.far.count, total.at_25.count) == (2, 2)


def test_errors_near_and_far_and_at_a_depth():
    z = np.arange(6.0, 25.1, 0.5)
    errors = LateralErrors(z, np.where(z <= 12, 0.01, 0.03))
    assert (errors.near, errors.at(10.0), errors.at(12.0)) == (pytest.approx(0.01), 0.01, 0.01)
    assert (errors.far, errors.at(25.0), errors.at(30.0)) == (pytest.approx(0.03), 0.03, None)
    assert LateralErrors(z[:3], errors.errors[:3]).far is None


def test_only_depths_that_both_reach_are_compared():
    errors = lateral_errors(label(line(1.8, 8.0, 30.0)), lane(line(1.7, 5.0, 14.2)), CAMERA)
    assert errors.depths.tolist() == np.arange(8.0, 14.1, 0.5).tolist()
    np.testing.assert_allclose(errors.errors, 0.1)
    apart = lateral_errors(label(line(1.8, 5, 9)), lane(line(1.8, 12, 14)), CAMERA)
    assert len(apart.depths) == 0 and LateralSummary.of(apart) == LateralSummary()


def test_the_exact_points_go_before_those_on_the_ground():
    truth = label(line(1.8))
    exact = replace(truth, xyz=line(1.75))
    assert lateral_errors(truth, lane(line(1.8)), CAMERA).near == pytest.approx(0.0)
    assert lateral_errors(exact, lane(line(1.8)), CAMERA).near == pytest.approx(0.05)


def test_points_are_moved_into_the_left_camera():
    """KITTI's colour cameras stand beside the frame of their projection matrices."""
    beside = replace(CAMERA, left_translation=(0.06, 0.0, 0.003))
    score = judged(line(1.8) - (0.06, 0.0, 0.003), label(line(1.8)), beside)
    assert score.matches[0].in_space.near == pytest.approx(0.0, abs=1e-9)
    np.testing.assert_allclose(score.matches[0].in_space.far, 0.0, atol=1e-9)


def test_no_error_for_a_line_that_is_not_found():
    total = summarise([judged(line(5.0), label(line(1.8)))])
    assert (total.matched, total.in_space) == (0, LateralSummary())
