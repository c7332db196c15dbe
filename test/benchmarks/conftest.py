# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What the tests of the benchmarks share: the way to the scripts, and a pair of rendered frames to judge."""

import sys
from pathlib import Path

import pytest

from lane_dp_ros.core.types import StereoFrame
from lane_dp_ros.scenes.scene import CAMERA, Motion, Scene, render_frame

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))  # scripts that import one another

import study_runner


@pytest.fixture(scope="session")
def pairs():
    """Two consecutive frames of an ordinary road."""
    frames = [render_frame(Scene(motion=Motion(start=100.0)), i, 1) for i in range(2)]
    return [
        study_runner.JudgedPair(
            f"road/{i:02d}",
            "road",
            StereoFrame(frame.left, frame.right).grey(),
            CAMERA,
            frame.truth,
            frame.stamp_ns,
        )
        for i, frame in enumerate(frames)
    ]
