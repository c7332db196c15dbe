# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What a pair is worth in the light of those before it, on a real drive."""

import cv2
import numpy as np
import pytest

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.detector import LaneDetector
from lane_dp_ros.core.parameter import replaced
from lane_dp_ros.core.pipeline import FrameResult, LanePipeline
from lane_dp_ros.tools.evaluation.truth_file import load_truth

PAIRS = range(10, 18)
HATCHED = 16  # by itself this pair's hatching is taken for the direction of the road
PERIOD = 100_000_000  # ns


@pytest.fixture(scope="module")
def camera(kitti_data):
    truth = load_truth(kitti_data / "labels/lanes.json")
    return next(frame.camera for frame in truth if "/01/" in frame.name)


@pytest.fixture(scope="module")
def answers(kitti_data, camera):
    folder = kitti_data / "kitti_odometry/sequences/01"
    found = []
    for i in PAIRS:
        left, right = (
            cv2.imread(str(folder / side / f"{i:06d}.png"), cv2.IMREAD_GRAYSCALE)
            for side in ("image_0", "image_1")
        )
        detection = LaneDetector(camera).detect(left, right)
        found.append(FrameResult(left, "", camera, detection, detection.lanes, right=right))
    return found


def followed(answers, config):
    pipeline = LanePipeline()
    return [pipeline.follow(answer, i * PERIOD, config) for i, answer in zip(PAIRS, answers, strict=True)]


def at_ten_metres(lanes):
    """Return where the lanes run 10 m ahead."""
    return [float(np.interp(10.0, lane.points[:, 2], lane.points[:, 0])) for lane in lanes]


def test_a_leap_of_the_roads_axis_is_looked_at_along_the_axis_before(answers):
    alone = answers[HATCHED - PAIRS[0]]
    held = followed(answers, DetectorConfig())[HATCHED - PAIRS[0]]
    before = answers[HATCHED - PAIRS[0] - 1].detection
    assert abs(alone.detection.birds_eye.axis.curvature - before.birds_eye.axis.curvature) > 0.01
    assert held.detection.score > alone.detection.score
    assert at_ten_metres(held.lanes) == pytest.approx(at_ten_metres(before.lanes), abs=0.2)


def test_without_tracking_every_pair_stands_for_itself(answers):
    off = replaced(DetectorConfig(), {"tracking.enabled": False})
    for answer, single in zip(followed(answers, off), answers, strict=True):
        assert answer.detection is single.detection
