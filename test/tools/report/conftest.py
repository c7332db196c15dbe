# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""A tiny evaluation made by hand: a flat road with labelled lines, and detections that are right or wrong."""

from collections.abc import Callable

import numpy as np
import pytest

from lane_dp_ros.core.types import Lane
from lane_dp_ros.scenes import CAMERA, SIZE
from lane_dp_ros.tools.evaluation.annotations import Label, LabelledFrame
from lane_dp_ros.tools.evaluation.matching import judge
from lane_dp_ros.tools.evaluation.scores import FrameScore

HEIGHT = 1.65  # m
GROUND = np.array([0.0, 100 * CAMERA.baseline / HEIGHT * CAMERA.fx / CAMERA.fy, 0.0, 0.0])


def points(x: float) -> np.ndarray:
    z = np.arange(5.0, 28.0, 0.5)
    return np.column_stack([np.full_like(z, x), np.full_like(z, HEIGHT), z])


def lane(x: float, confidence: float) -> Lane:
    return Lane(points(x), confidence, 0.12, "ego_left" if x < 0 else "ego_right", 0.0, x, 7)


def label(x: float, name: str) -> Label:
    return Label(name, "solid", True, CAMERA.project(points(x)), points(x)[:, [0, 2]])


def labelled(name: str, category: str = "", **fields) -> LabelledFrame:
    """Return a frame with lines L and R beside the vehicle and another one, LL, at -5.4 m."""
    labels = label(-1.8, "L"), label(1.8, "R"), label(-5.4, "LL")
    size = (SIZE[0], SIZE[1])
    return LabelledFrame(name, CAMERA, size, GROUND, labels, "L", "R", category=category, **fields)


@pytest.fixture(scope="module")
def frames() -> list[LabelledFrame]:
    return [
        labelled("drive/fine", "kerbs", stamp_ns=1),
        labelled("drive/blind", "over_exposure", stamp_ns=2),
        labelled("drive/<b>&", "kerbs", stamp_ns=3),
        labelled("drive/plain", stamp_ns=4),
    ]


@pytest.fixture(scope="module")
def results(frames) -> list[FrameScore]:
    """All right; L and LL missed; L found 0.05 m aside, a false line, a duplicate; LL not found."""
    lanes = [
        (lane(-1.8, 0.95), lane(1.8, 0.95), lane(-5.4, 0.85)),
        (lane(1.8, 0.85),),
        (lane(-1.75, 0.95), lane(1.8, 0.85), lane(-5.4, 0.65), lane(3.8, 0.65), lane(1.9, 0.35)),
        (lane(-1.8, 1.0), lane(1.8, 0.95)),
    ]
    return [judge(frame, found, CAMERA) for frame, found in zip(frames, lanes, strict=True)]


@pytest.fixture
def make_labelled() -> Callable[..., LabelledFrame]:
    return labelled
