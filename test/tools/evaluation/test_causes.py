# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Why a label was not found: each stage, of a detector that is made to fail there."""

import re
from dataclasses import replace

import numpy as np
import pytest

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.detector import LaneDetector
from lane_dp_ros.core.lanes.evidence_model import evidence_model
from lane_dp_ros.core.parameter import replaced
from lane_dp_ros.core.types import StereoFrame
from lane_dp_ros.scenes import CAMERA
from lane_dp_ros.tools.evaluation.causes import causes
from lane_dp_ros.tools.evaluation.truth_file import Label


def causes_of(pair, settings=(), truth=None, noise=False):
    """Return the causes of a rendered pair with some parameters changed, or of noise in its place."""
    config = replaced(DetectorConfig(), dict(settings))
    frame = StereoFrame(pair.left, pair.right)
    if noise:
        random = np.random.default_rng(0)
        frame = StereoFrame(*(random.integers(0, 255, pair.left.shape[:2], dtype=np.uint8) for _ in range(2)))
    detection = LaneDetector(CAMERA, config).detect(frame)
    model = evidence_model(config.lane_selection.evidence_model)
    return causes(truth or pair.truth, CAMERA, detection, model)


@pytest.fixture(scope="module")
def pair(scene_pairs):
    return scene_pairs[0]


@pytest.fixture
def wanted(pair):
    return [label.id for label in pair.truth.labels if label.counts]


def test_what_the_detector_finds_is_said_to_be_found(pair, wanted):
    found = causes_of(pair)
    assert [found[label].stage for label in wanted] == ["found in the pair alone"] * len(wanted) != []


def test_no_road(pair, wanted):
    found = causes_of(pair, noise=True)
    assert {found[label].stage for label in wanted} == {"no road surface"}
    assert "no road surface in the disparity" in found[wanted[0]].words


def test_no_candidate(pair, wanted):
    nothing = {"paint_map.contrast_max": 20.0, "paint_map.contrast_min": 10.0}
    found = causes_of(pair, nothing)
    assert {found[label].stage for label in wanted} == {"no candidate"}
    assert re.fullmatch(r"no candidate within 0\.5 m of it \(paths in the view: \d\)", found[wanted[0]].words)


def test_a_candidate_is_refused(pair, wanted):
    found = causes_of(pair, {"lane_selection.paint_width_max": 0.1})
    for label in wanted:
        assert found[label].stage == "candidate refused"
        assert "m broad; most against it: " in found[label].words


def test_a_line_is_published_beside_the_label(pair, wanted):
    """The label is moved by 0.3 m: it is not the line's any more, which is near enough to be meant."""

    def moved(label: Label) -> Label:
        return replace(label, xz=label.xz + np.array([0.3, 0.0]), xyz=None)

    truth = replace(pair.truth, labels=tuple(map(moved, pair.truth.labels)))
    found = causes_of(pair, truth=truth)
    for label in wanted:
        assert found[label].stage == "published beside it"
        assert found[label].words.startswith(("a line was published 0.3", "a line was published 0.2"))
