# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The baseline's vanishing point: none where edges meet beyond the picture, exact on a straight road."""

import cv2
import numpy as np

from lane_dp_ros.scenes import CAMERA, SIZE
from lane_dp_ros.tools.evaluation.global_vanishing_point import vanishing_point


def picture(*lines: tuple[tuple[int, int], tuple[int, int]]) -> np.ndarray:
    grey = np.full(SIZE[::-1], 90, np.uint8)
    for start, end in lines:
        cv2.line(grey, start, end, 220, 4, cv2.LINE_AA)
    return grey


def test_edges_that_meet_far_outside_vote_for_nothing() -> None:
    assert vanishing_point(picture(((0, 350), (40, 360))), CAMERA) is None


def test_a_picture_without_edges_has_none() -> None:
    assert vanishing_point(picture(), CAMERA) is None


def test_two_lines_of_a_straight_road_meet_where_it_vanishes() -> None:
    centre = round(CAMERA.cx), round(CAMERA.cy)
    point = vanishing_point(picture((centre, (200, 370)), (centre, (1000, 370))), CAMERA)
    np.testing.assert_allclose(point, centre, atol=6)
