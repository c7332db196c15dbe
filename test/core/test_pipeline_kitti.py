# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Lanes over time on real drives, judged by their labels: a bent ramp with hatching, and a straight road."""

import sys
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.detector import LaneDetector
from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.parameter import replaced
from lane_dp_ros.core.pipeline import FrameResult, LanePipeline
from lane_dp_ros.core.types import Lane
from lane_dp_ros.tools.datasets import kitti
from lane_dp_ros.tools.evaluation.matching import judge
from lane_dp_ros.tools.evaluation.summary import Summary, summarise
from lane_dp_ros.tools.evaluation.truth_file import load_truth

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))  # scripts that import one another

from steady_lines import DRIVES, jitters

Frames = list[tuple[int, tuple[Lane, ...]]]  # stamp [ns] and lanes
Answers = list[tuple[int, FrameResult]]


@pytest.fixture(scope="module")
def detected(kitti_data) -> Callable[[str], tuple[StereoCamera, Answers]]:
    """Return a function: the camera of a drive, and the answers to its pairs, each by itself."""

    @cache
    def of_drive(name):
        sequence = kitti.read_odometry(kitti_data / "kitti_odometry" / "sequences" / name)
        camera = StereoCamera.from_projections(sequence.P_left, sequence.P_right)
        detector = LaneDetector(camera)
        pairs = kitti.load_pairs(sequence)

        def answer(pair):
            detection = detector.detect(pair.left, pair.right)
            return FrameResult(pair.left, "", camera, detection, detection.lanes, right=pair.right)

        return camera, [(pair.stamp_ns, answer(pair)) for pair in pairs]

    return of_drive


@pytest.fixture(scope="module")
def labels(kitti_data):
    return {frame.name: frame for frame in load_truth(kitti_data / "labels" / "lanes.json")}


def tracked(answers: Answers, enabled: bool = True) -> Frames:
    pipeline, config = LanePipeline(), replaced(DetectorConfig(), {"tracking.enabled": enabled})
    return [(stamp_ns, pipeline.follow(answer, stamp_ns, config).lanes) for stamp_ns, answer in answers]


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
    assert judged(name, camera, tracked(frames), labels).id_switches == 0


@pytest.mark.parametrize("name", DRIVES)
def test_tracking_finds_no_less_and_invents_nothing(name, detected, labels):
    camera, frames = detected(name)
    alone, over_time = (judged(name, camera, tracked(frames, on), labels) for on in (False, True))
    assert over_time.paper_precision >= alone.paper_precision
    assert over_time.lane_recall >= alone.lane_recall
    assert over_time.false_lanes <= alone.false_lanes
    assert over_time.duplicates <= alone.duplicates


def test_tracking_is_as_exact_as_each_frame_by_itself(detected, labels):
    sums = [Summary(), Summary()]
    for name in DRIVES:
        camera, frames = detected(name)
        for i, enabled in enumerate((False, True)):
            sums[i] += judged(name, camera, tracked(frames, enabled), labels)
    alone, over_time = (total.localisation_error for total in sums)
    assert over_time <= 0.014
    assert over_time <= alone + 0.0005


def test_lines_are_steady(detected):
    """Taken over both drives; on the ramp half of it is the vehicle's own turning."""
    values = [value for name in DRIVES for value in jitters(lanes for _, lanes in tracked(detected(name)[1]))]
    assert np.mean(values) <= 0.0105


@pytest.mark.parametrize("name", DRIVES)
def test_no_frame_is_without_an_answer(name, detected):
    """Nor has it a line without an id of its own."""
    for _, lanes in tracked(detected(name)[1]):
        assert lanes
        assert len({lane.id for lane in lanes}) == len(lanes)
