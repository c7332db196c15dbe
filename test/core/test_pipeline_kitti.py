# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Lanes over time on real drives, judged by their labels: a bent ramp with hatching, and a straight road."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.detector import LaneDetection, LaneDetector
from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.parameter import replaced
from lane_dp_ros.core.pipeline import FrameResult, LanePipeline
from lane_dp_ros.core.types import Lane, StereoFrame
from lane_dp_ros.tools.datasets import kitti
from lane_dp_ros.tools.evaluation.matching import judge
from lane_dp_ros.tools.evaluation.summary import Summary, summarise
from lane_dp_ros.tools.evaluation.truth_file import load_truth

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"  # scripts that import one another
DRIVES = ("01", "02")
Frames = list[tuple[int, tuple[Lane, ...]]]  # stamp [ns] and lanes
Detections = list[tuple[int, StereoFrame, LaneDetection]]  # stamp [ns], frame, and what it shows by itself

HATCHED = 16  # by itself this frame's hatching is taken for the direction of the road
BEFORE_HATCHED = 10
DEPTH = 15.0  # m


@pytest.fixture(scope="module")
def detected(kitti_data) -> Callable[[str], tuple[StereoCamera, Detections]]:
    """Return a function: the camera of a drive, and what its frames show, each by itself."""

    @cache
    def of_drive(name):
        sequence = kitti.read_odometry(kitti_data / "kitti_odometry" / "sequences" / name)
        camera = StereoCamera.from_projections(sequence.P_left, sequence.P_right)
        detector = LaneDetector(camera)
        frames = [(pair.stamp_ns, StereoFrame(pair.left, pair.right)) for pair in kitti.load_pairs(sequence)]
        return camera, [(stamp_ns, frame, detector.detect(frame)) for stamp_ns, frame in frames]

    return of_drive


@pytest.fixture(scope="module")
def labels(kitti_data):
    return {frame.name: frame for frame in load_truth(kitti_data / "labels" / "lanes.json")}


def followed(camera: StereoCamera, detections: Detections, enabled: bool = True) -> list[FrameResult]:
    pipeline, config = LanePipeline(), replaced(DetectorConfig(), {"tracking.enabled": enabled})
    return [
        pipeline.process(frame, camera, stamp_ns, config, alone.disparity)
        for stamp_ns, frame, alone in detections
    ]


def tracked(camera: StereoCamera, detections: Detections, enabled: bool = True) -> Frames:
    results = followed(camera, detections, enabled)
    return [(stamp_ns, result.lanes) for (stamp_ns, *_), result in zip(detections, results, strict=True)]


def judged(name: str, camera: StereoCamera, frames: Frames, labels) -> Summary:
    named = [(labels.get(f"kitti_odometry/sequences/{name}/{i:06d}"), *f) for i, f in enumerate(frames)]
    return summarise(
        judge(replace(label, stamp_ns=stamp_ns), lanes, camera)
        for label, stamp_ns, lanes in named
        if label is not None
    )


@pytest.mark.parametrize("name", DRIVES)
def test_every_painted_line_keeps_its_id(name, detected, labels):
    camera, frames = detected(name)
    assert judged(name, camera, tracked(camera, frames), labels).id_switches == 0


ONE_LINE = 0.046  # of the 22 beside the vehicle on 01: another OpenCV rounds otherwise


MISSED = "frame 12: of the right line one path is measured 0.16 m high, and a parallel is too improbable"


@pytest.mark.parametrize(
    ("name", "recall"),
    [("01", 0.74), pytest.param("02", 1.0, marks=pytest.mark.xfail(strict=True, reason=MISSED))],
)
def test_frames_in_order_show_the_lines(name, recall, detected, labels):
    camera, frames = detected(name)
    found = judged(name, camera, tracked(camera, frames), labels)
    assert found.paper_precision >= 1 - ONE_LINE
    assert found.lane_recall >= recall


@pytest.mark.parametrize(("name", "detection_precision"), [("01", 0.93), ("02", 1.0)])
def test_frames_in_order_show_hardly_anything_else(name, detection_precision, detected, labels):
    camera, frames = detected(name)
    found = judged(name, camera, tracked(camera, frames), labels)
    assert found.detection_precision >= detection_precision


@pytest.mark.parametrize("name", DRIVES)
def test_tracking_finds_no_less_and_invents_nothing(name, detected, labels):
    camera, frames = detected(name)
    alone, over_time = (judged(name, camera, tracked(camera, frames, on), labels) for on in (False, True))
    assert over_time.paper_precision >= alone.paper_precision - ONE_LINE
    assert over_time.lane_recall >= alone.lane_recall - ONE_LINE
    assert over_time.false_lanes <= alone.false_lanes + 1
    assert over_time.duplicates <= alone.duplicates


def test_tracking_is_as_exact_as_each_frame_by_itself(detected, labels):
    sums = [Summary(), Summary()]
    for name in DRIVES:
        camera, frames = detected(name)
        for i, enabled in enumerate((False, True)):
            sums[i] += judged(name, camera, tracked(camera, frames, enabled), labels)
    alone, over_time = (total.localisation_error for total in sums)
    assert over_time <= 0.0149
    assert over_time <= alone + 0.0015


def test_lines_are_steady(detected, monkeypatch):
    """Taken over both drives; on the ramp half of it is the vehicle's own turning."""
    monkeypatch.syspath_prepend(BENCHMARKS)
    from steady_lines import jitters

    values = [value for name in DRIVES for value in jitters(lanes for _, lanes in tracked(*detected(name)))]
    assert np.mean(values) <= 0.0125


@pytest.mark.parametrize("name", DRIVES)
def test_no_frame_is_without_an_answer(name, detected):
    """Nor has it a line without an id of its own."""
    for _, lanes in tracked(*detected(name)):
        assert lanes
        assert len({lane.id for lane in lanes}) == len(lanes)


def at_ten_metres(lanes):
    """Return where the lanes run 10 m ahead."""
    return [float(np.interp(10.0, lane.points[:, 2], lane.points[:, 0])) for lane in lanes]


@pytest.mark.parametrize(("first", "voted"), [(0, False), (1, True)])
def test_hatching_that_misleads_the_edges_does_no_harm(first, voted, detected):
    """The axis of the frame before explains the pair, and has more paint than theirs where the edges vote."""
    camera, frames = detected("01")
    *_, last, held = followed(camera, frames[first : HATCHED + 1])
    before, alone = (frames[i][2] for i in (HATCHED - 1, HATCHED))
    assert abs(alone.birds_eye.axis.curvature - before.birds_eye.axis.curvature) > 0.01
    assert held.detection.score > alone.score
    assert held.detection.voted or not voted
    own = [lane for lane in last.lanes if lane.role != "other"]
    assert len(own) == 2
    for place in at_ten_metres(own):
        assert min(abs(place - there) for there in at_ten_metres(held.lanes)) < 0.2


@pytest.mark.parametrize(("name", "due", "most"), [("01", 17, 20), ("02", 7, 7)])
def test_the_edges_are_seldom_asked(name, due, most, detected):
    """Of 51 frames of the ramp, and of 20 of the straight road, every third; of a left image alone each."""
    measured = [result for result in followed(*detected(name)) if result.road_profile == "measured"]
    voted = [result.detection.voted for result in measured]
    assert voted[0]
    assert due <= sum(voted) <= most
    assert all(any(voted[i : i + 3]) for i in range(len(voted) - 2))


@pytest.mark.parametrize("name", DRIVES)
def test_the_surface_is_that_of_the_frame_whatever_the_one_before(name, detected):
    """Depths on it are those of each frame by itself."""
    camera, frames = detected(name)
    results = followed(camera, frames)
    depths = []
    for result, (*_, alone) in zip(results, frames, strict=True):
        u, v = alone.road.ground_to_pixel(np.zeros(1), np.full(1, DEPTH))
        depths.append(float(result.detection.road.pixel_to_ground(u, v)[1][0]))
    np.testing.assert_allclose(depths, DEPTH, rtol=0.02)


def test_without_tracking_every_frame_stands_for_itself(detected):
    camera, frames = detected("01")
    frames = frames[BEFORE_HATCHED : HATCHED + 2]
    for result, (*_, alone) in zip(followed(camera, frames, enabled=False), frames, strict=True):
        assert result.detection.road == alone.road
        assert result.detection.birds_eye.axis == alone.birds_eye.axis
        assert result.detection.score == alone.score


def test_the_answer_is_the_same_whether_or_not_a_frame_was_matched_before(detected):
    """Over the hatching, frame by frame, down to the last bit."""
    camera, frames = detected("01")
    frames = frames[BEFORE_HATCHED : HATCHED + 2]
    pipeline, config = LanePipeline(), DetectorConfig()
    fresh = [pipeline.process(frame, camera, stamp_ns, config) for stamp_ns, frame, _ in frames]
    for one, other in zip(followed(camera, frames), fresh, strict=True):
        assert (one.problem, one.road_profile) == (other.problem, other.road_profile)
        assert [lane.id for lane in one.lanes] == [lane.id for lane in other.lanes]
        for a, b in zip(one.lanes, other.lanes, strict=True):
            np.testing.assert_array_equal(a.points, b.points)
            assert a.confidence == b.confidence
