# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Runs of true rows, at both ends and in the middle."""

import numpy as np
import pytest

from lane_dp_ros.core.birdseye.paint_profile import runs_of


@pytest.mark.parametrize(
    ("rows", "runs"),
    [
        ([], []),
        ([0, 0], []),
        ([1], [[0, 1]]),
        ([1, 1, 0, 1], [[0, 2], [3, 4]]),
        ([0, 1, 1, 0, 0, 1, 0], [[1, 3], [5, 6]]),
    ],
)
def test_each_run_has_its_first_row_and_the_one_after_its_last(rows, runs):
    found = runs_of(np.array(rows, bool))
    assert found.shape == (len(runs), 2)
    assert found.tolist() == runs
