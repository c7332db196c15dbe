# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Pairs of messages, read and matched apart from the pipeline that follows them in order."""

import pickle

import numpy as np
import pytest

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.detector import LaneDetector
from lane_dp_ros.core.parameter import replaced
from lane_dp_ros.core.types import StereoFrame
from lane_dp_ros.messages.bag_message import bag_message
from lane_dp_ros.messages.camera import camera_info_to_ros
from lane_dp_ros.messages.image import image_to_ros
from lane_dp_ros.messages.stamp import stamp_to_ros
from lane_dp_ros.messages.stereo_pipeline import StereoPipeline, detect_alone, match_pair
from lane_dp_ros.messages.stereo_sync import StereoPair
from lane_dp_ros.scenes import CAMERA

CONFIG = DetectorConfig()
P_LEFT = CAMERA.P_left
P_RIGHT = P_LEFT - np.array([[0, 0, 0, CAMERA.fx * CAMERA.baseline], [0] * 4, [0] * 4])
HEADER = bag_message("std_msgs/msg/Header", stamp=stamp_to_ros(0, bag_message))


@pytest.fixture(scope="module")
def drive(scene_pairs):
    """Three pairs of messages, and the camera infos of all."""
    pairs = [
        StereoPair(
            *(image_to_ros(each, HEADER, bag_message) for each in (pair.left, pair.right)), pair.stamp_ns
        )
        for pair in scene_pairs
    ]
    shape = scene_pairs[0].left.shape
    return pairs, tuple(camera_info_to_ros(P, shape, HEADER, bag_message) for P in (P_LEFT, P_RIGHT))


def assert_same_lanes(one, other):
    assert one.problem == other.problem
    assert [lane.id for lane in one.lanes] == [lane.id for lane in other.lanes]
    for a, b in zip(one.lanes, other.lanes, strict=True):
        np.testing.assert_array_equal(a.points, b.points)
        assert (a.role, a.confidence) == (b.role, b.confidence)


def test_a_pair_is_read_with_its_disparity(drive, scene_pairs):
    pairs, infos = drive
    read = match_pair(pairs[0], infos, CONFIG)
    assert (read.stamp_ns, read.problem) == (scene_pairs[0].stamp_ns, "")
    assert read.camera == CAMERA
    np.testing.assert_array_equal(read.frame.left, scene_pairs[0].left)
    matched = LaneDetector(CAMERA).match(StereoFrame(scene_pairs[0].left, scene_pairs[0].right))
    np.testing.assert_array_equal(read.disparity.matched, matched.matched)


def test_the_disparity_is_that_of_the_configuration(drive):
    pairs, infos = drive
    broad = replaced(CONFIG, {"disparity.correlation_window_size": 11})
    one, other = (match_pair(pairs[0], infos, config).disparity.matched for config in (CONFIG, broad))
    assert not np.array_equal(one, other, equal_nan=True)


def test_pairs_that_another_process_matched_have_the_same_answers(drive):
    pairs, infos = drive
    here, elsewhere = StereoPipeline(monitored=False), StereoPipeline(monitored=False)
    for pair in pairs:
        sent = pickle.loads(pickle.dumps(match_pair(pair, infos, CONFIG)))
        answer = here.answer(pair, infos, CONFIG)
        assert len(answer.lanes) >= 3
        assert_same_lanes(elsewhere.follow(sent, CONFIG), answer)


def test_the_time_of_an_answer_begins_with_the_conversion(drive):
    pairs, infos = drive
    answer = StereoPipeline().answer(pairs[0], infos, CONFIG)
    assert list(answer.seconds)[:2] == ["conversion", "disparity"]


def test_a_pair_is_looked_at_without_those_before(drive, scene_pairs):
    pairs, infos = drive
    read, found = detect_alone(pairs[0], infos, CONFIG)
    alone = LaneDetector(CAMERA).detect(StereoFrame(scene_pairs[0].left, scene_pairs[0].right))
    assert read.problem == ""
    assert found.road == alone.road
    assert found.score == alone.score > 0


def test_of_a_left_image_alone_nothing_is_matched(drive):
    pairs, infos = drive
    alone = pairs[0]._replace(right=None)
    read = match_pair(alone, infos, CONFIG)
    assert read.frame.right is None and not read.problem
    assert np.isnan(read.disparity.matched).all()
    read, found = detect_alone(alone, infos, CONFIG)
    assert read.frame.right is None and not read.problem
    assert found is None
    here, elsewhere = StereoPipeline(), StereoPipeline()
    assert_same_lanes(
        elsewhere.follow(match_pair(alone, infos, CONFIG), CONFIG), here.answer(alone, infos, CONFIG)
    )


def test_images_that_their_camera_info_contradicts_are_a_problem(drive):
    pairs, _ = drive
    infos = tuple(camera_info_to_ros(P, (300, 400), HEADER, bag_message) for P in (P_LEFT, P_RIGHT))
    problem = "images are 1242x375, their CameraInfo says 400x300, expected equal sizes"
    read = match_pair(pairs[0], infos, CONFIG)
    assert (read.camera, read.disparity, read.problem) == (None, None, problem)
    answer = StereoPipeline().follow(read, CONFIG)
    assert (answer.lanes, answer.detection, answer.problem) == ((), None, problem)
    read, found = detect_alone(pairs[0], infos, CONFIG)
    assert (read.problem, found) == (problem, None)


@pytest.mark.parametrize("look", [match_pair, detect_alone, StereoPipeline().answer])
def test_an_image_that_cannot_be_read_is_an_error(drive, look):
    pairs, infos = drive
    odd = image_to_ros(np.zeros((4, 6), np.uint8), HEADER, bag_message)
    odd.encoding = "32FC1"
    with pytest.raises(ValueError, match="left image: encoding is '32FC1'"):
        look(pairs[0]._replace(left=odd), infos, CONFIG)


def test_whatever_goes_wrong_in_matching_is_one_line(drive, monkeypatch):
    def fail(*_):
        raise RuntimeError("out of\nmemory")

    monkeypatch.setattr(LaneDetector, "match", fail)
    pairs, infos = drive
    matched, (alone, found) = match_pair(pairs[0], infos, CONFIG), detect_alone(pairs[0], infos, CONFIG)
    assert found is matched.camera is matched.disparity is None
    for read in (matched, alone, StereoPipeline().follow(matched, CONFIG)):
        assert "out of memory" in read.problem
        assert "\n" not in read.problem
