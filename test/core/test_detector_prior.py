# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""A second look at a pair along another axis: it counts where it shows more paint."""

import numpy as np
import pytest

from lane_dp_ros.core.detector import LaneDetection, LaneDetector
from lane_dp_ros.core.geometry.road_axis import RoadAxis
from lane_dp_ros.scenes import CAMERA, Road, render_pair

DETECTOR = LaneDetector(CAMERA)


@pytest.fixture(scope="module")
def pair():
    return render_pair(Road(curvature=0.006, swing=0), position=50.0, seed=2)


@pytest.fixture(scope="module")
def detection(pair):
    return DETECTOR.detect(pair.left, pair.right)


def test_an_axis_with_less_paint_changes_nothing_but_the_time(pair, detection):
    again = DETECTOR.detect_along(RoadAxis(0.4, -0.03), pair.left, pair.right, detection)
    assert again.lanes is detection.lanes and again.birds_eye is detection.birds_eye
    assert again.score == detection.score > 0
    assert again.seconds["path_search"] > detection.seconds["path_search"]


def test_the_right_axis_brings_the_lanes_back(pair, detection):
    wrong = DETECTOR.detect_along(RoadAxis(0.4, -0.03), pair.left, pair.right, LaneDetection(
        disparity=detection.disparity, road=detection.road, birds_eye=detection.birds_eye, score=-1.0
    ))  # fmt: skip
    assert wrong.score < detection.score
    found = DETECTOR.detect_along(detection.birds_eye.axis, pair.left, pair.right, wrong)
    assert found.score == detection.score and len(found.lanes) == len(detection.lanes)
    for lane, before in zip(found.lanes, detection.lanes, strict=True):
        np.testing.assert_array_equal(lane.points, before.points)
    np.testing.assert_array_equal(found.graph.feature, detection.graph.feature)  # both images served
    assert found.vanishing_point == pytest.approx(detection.vanishing_point)
    assert not found.note


def test_a_pair_without_a_road_stays_as_it_is(pair):
    nothing = LaneDetection(note="no road")
    assert DETECTOR.detect_along(RoadAxis(), pair.left, pair.right, nothing) is nothing


def test_images_of_different_size_are_an_error(pair, detection):
    with pytest.raises(ValueError, match="differ in size"):
        DETECTOR.detect_along(RoadAxis(), pair.left, pair.right[:, :-2], detection)
