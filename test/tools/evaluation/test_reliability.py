# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Confidence against truth: bins, the expected calibration error, as text and in the JSON file."""

import math

import numpy as np
import pytest

from lane_dp_ros.core.types import Lane
from lane_dp_ros.tools.evaluation.json_file import as_json
from lane_dp_ros.tools.evaluation.reliability import reliability
from lane_dp_ros.tools.evaluation.scores import FrameScore, JudgedLine
from lane_dp_ros.tools.evaluation.text import tables


def frame(*lines):
    """A frame of lines (confidence, verdict)."""
    points = np.array([[0.0, 1.6, 6.0], [0.0, 1.6, 20.0]])
    lanes = [(Lane(points, confidence, 0.15, "other", 0.0, 0.0), verdict) for confidence, verdict in lines]
    return FrameScore("a/0", "a", "", None, tuple(JudgedLine(lane, verdict) for lane, verdict in lanes))


RESULTS = [
    frame((0.95, "match"), (0.97, "match"), (0.91, "ignored")),
    frame((0.55, "match"), (0.52, "false"), (0.58, "duplicate"), (1.0, "match")),
]


def test_a_line_that_is_published_with_one_half_is_right_every_other_time():
    assert reliability([0.5] * 4, [True, False, True, False]).error == 0
    assert reliability([0.9] * 10, [True] * 9 + [False]).error == pytest.approx(0)
    assert reliability([0.9] * 10, [True] * 5 + [False] * 5).error == pytest.approx(0.4)


def test_bins_weigh_by_their_lines():
    bins = reliability([0.25, 0.75, 0.75, 0.75], [False, True, True, True])
    assert bins.counts.tolist() == [0, 0, 1, 0, 0, 0, 0, 3, 0, 0]
    assert bins.right.tolist() == [0, 0, 0, 0, 0, 0, 0, 3, 0, 0]
    assert bins.error == pytest.approx(0.25)


def test_the_json_file_has_the_bins():
    found = as_json(RESULTS, ())["reliability"]
    assert [(row["from"], row["right"], row["lines"]) for row in found["bins"] if row["lines"]] == [
        (0.5, 1, 3),
        (0.9, 4, 4),
    ]
    assert found["bins"][5]["mean"] == pytest.approx(0.55)
    assert found["bins"][0]["mean"] is None
    expected = (3 * abs(0.55 - 1 / 3) + 4 * abs(0.9575 - 1)) / 7
    assert found["expected_calibration_error"] == pytest.approx(expected)


def test_the_text_says_how_many_are_right_in_each_bin():
    assert "from 0.5: 1 of 3, 0.9: 4 of 4; expected calibration error 0.117" in tables(RESULTS)
    assert "no lines were published" in tables([frame()])


def test_nothing_published_has_no_error():
    assert math.isnan(reliability([], []).error)
    assert as_json([frame()], ())["reliability"]["expected_calibration_error"] is None
