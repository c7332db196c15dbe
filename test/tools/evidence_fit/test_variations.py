# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Pairs as they could have been taken as well: their labels go with them."""

from dataclasses import replace

import numpy as np
import pytest

from lane_dp_ros.core.detector import LaneDetector
from lane_dp_ros.core.types import StereoFrame
from lane_dp_ros.tools.evaluation.matching import judge
from lane_dp_ros.tools.evidence_fit.collecting import KnownPair
from lane_dp_ros.tools.evidence_fit.variations import exposed, mirrored, resized


@pytest.fixture
def pair(scene_pairs) -> KnownPair:
    rendered = scene_pairs[0]
    frame = StereoFrame(rendered.left, rendered.right).grey()
    return KnownPair(rendered.truth.name, frame, rendered.truth.camera, rendered.truth)


@pytest.mark.parametrize(
    "vary",
    [mirrored, lambda pair: exposed(pair, 0.7), lambda pair: resized(pair, 0.7)],
    ids=["mirrored", "exposed", "resized"],
)
def test_the_lines_are_found_where_the_labels_are(pair, vary):
    view = vary(pair)
    verdict = judge(view.truth, LaneDetector(view.camera).detect(view.frame).lanes, view.truth.camera)
    assert verdict.name == view.name != pair.name
    assert len(verdict.found) == len(verdict.labels) == 3
    assert not verdict.false_lines
    assert max(match.error for match in verdict.found) < 0.05


def test_a_mirrored_mirror_is_the_pair(pair):
    once, twice = mirrored(pair), mirrored(mirrored(pair))
    np.testing.assert_array_equal(once.frame.left, pair.frame.right[:, ::-1])
    np.testing.assert_array_equal(twice.frame.left, pair.frame.left)
    assert twice.camera.cx == pytest.approx(pair.camera.cx)
    np.testing.assert_allclose(twice.truth.ground, pair.truth.ground)
    assert (once.truth.ego_left, once.truth.ego_right) == (pair.truth.ego_right, pair.truth.ego_left)
    for label, same in zip(twice.truth.labels, pair.truth.labels, strict=True):
        np.testing.assert_allclose(label.uv, same.uv)
        np.testing.assert_allclose(label.xz, same.xz)


def test_a_frame_without_paint_is_mirrored_without_labels(pair):
    assert mirrored(replace(pair, truth=None)).truth is None


def test_another_exposure_leaves_black_and_white(pair):
    dark = exposed(pair, 2.0)
    np.testing.assert_array_equal(dark.frame.left, np.rint(255 * (pair.frame.left / 255) ** 2))


def test_a_picture_of_half_the_size_has_half_the_focal_length(pair):
    half = resized(pair, 0.5)
    assert half.frame.left.shape == (188, 621)
    assert half.camera.fx == pair.camera.fx / 2
    assert half.camera.cx == (pair.camera.cx + 0.5) / 2 - 0.5  # pixel centres lie half a pixel in
    assert half.camera.fy == pytest.approx(188 / 375 * pair.camera.fy)
