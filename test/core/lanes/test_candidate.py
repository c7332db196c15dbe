# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Candidates: a line, its evidence, and why it is refused."""

from dataclasses import fields

import numpy as np

from lane_dp_ros.core.lanes.candidate import Candidate, LaneEvidence, LaneLine

LINE = LaneLine(np.arange(3), np.array([4.0, 10.0, 24.0]), np.zeros(3), 0.0, 1.5)
EVIDENCE = LaneEvidence(**{field.name: 0 for field in fields(LaneEvidence)})


def test_the_length_of_a_line_is_that_along_the_road():
    assert LINE.length == 20.0


def test_a_candidate_scores_its_metres_of_paint():
    assert Candidate(LINE, EVIDENCE).score == 1.5
