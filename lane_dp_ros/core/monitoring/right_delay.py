# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Whether the right picture is of another time than the left one, told while the vehicle drives."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.geometry.road_surface import RoadSurface

Floats = NDArray[Any]
Grey = NDArray[np.uint8]

MAX_CORNERS, QUALITY, DISTANCE = 200, 0.01, 7.0  # at most; of the best one; px
COLUMNS = 640  # px; larger pictures are made smaller: it takes a third of the time and tells as much
WINDOW, LEVELS = 15, 3  # px and pyramid of the tracking
RETURNED = 0.5  # px; a corner that is not found again from where it went is no corner
MIN_POINTS = 40
MAX_ERROR = 0.05  # standard error of the delay, in times between the pictures; more tells nothing
NOISE = 0.15  # px; tracking is no better, however few points there are
TUKEY, MAD_TO_SIGMA, ROUNDS = 4.685, 1.4826, 8


def right_delay(left: Grey, before: Grey, right: Grey, nominal: RoadSurface) -> float | None:
    """Return by how much the right picture is older than the left one, None where that cannot be told.

    In times from the left picture `before` to `left`, all three grey (H, W): 0 for a sound pair, 1 for a
    right picture as old as `before`, negative for one that is newer. `nominal` is the road expected, where
    the search of the corners in the right picture begins.

    In a rectified pair of one instant a corner is in one row left and right. In a right picture that is
    older by a share of the time, it is off that row by that share of its way since then: the share is the
    slope of a robust line through (way down the left image, rows between left and right) of all corners.
    Cameras rotated against each other move the line, or tilt it by the column, but not by the way. A vehicle
    that stands tells nothing.
    """
    scale = max(1.0, left.shape[1] / COLUMNS)
    left, before, right = (_smaller(image, scale) for image in (left, before, right))
    found = cv2.goodFeaturesToTrack(left, MAX_CORNERS, QUALITY, DISTANCE)
    if found is None or len(found) < MIN_POINTS:
        return None
    corners = found.reshape(-1, 2).astype(np.float32)
    disparity = nominal.disparity(*(scale * corners.T)) + nominal.camera.disparity_offset
    expected = corners - np.stack([disparity / scale, np.zeros_like(disparity)], axis=1).astype(np.float32)
    earlier, seen_before = _tracked(left, before, corners, corners)
    other, seen_right = _tracked(left, right, corners, expected)
    seen = seen_before & seen_right
    if np.count_nonzero(seen) < MIN_POINTS:
        return None
    way, rows = (np.asarray(to - corners, np.float64)[seen, 1] for to in (earlier, other))
    return _slope(way, rows, 2 * corners[seen, 0] / left.shape[1] - 1)


def _smaller(image: Grey, scale: float) -> Grey:
    size = round(image.shape[1] / scale), round(image.shape[0] / scale)
    return np.asarray(cv2.resize(image, size, interpolation=cv2.INTER_AREA), dtype=np.uint8)


def _tracked(image: Grey, other: Grey, corners: Floats, start: Floats) -> tuple[Floats, NDArray[np.bool_]]:
    """Return where corners (N, 2) [px] are in the other image, and which of them are found there and back."""
    options: dict[str, Any] = {
        "winSize": (WINDOW, WINDOW), "maxLevel": LEVELS, "flags": cv2.OPTFLOW_USE_INITIAL_FLOW,
    }  # fmt: skip
    there, found, _ = cv2.calcOpticalFlowPyrLK(image, other, corners, start.copy(), **options)
    back, found_back, _ = cv2.calcOpticalFlowPyrLK(other, image, there, corners.copy(), **options)
    returned = np.linalg.norm(back - corners, axis=1) < RETURNED
    return there, returned & (found.ravel() == 1) & (found_back.ravel() == 1)


def _slope(way: Floats, rows: Floats, aside: Floats) -> float | None:
    """Return b of rows = b way + c + d aside, by Tukey's weights, None where it is not sure."""
    A = np.column_stack([way, np.ones_like(way), aside])
    weights = np.ones_like(way)
    for _ in range(ROUNDS):
        weighted = A * weights[:, None]
        normal = weighted.T @ A + 1e-6 * np.eye(3)
        b = np.linalg.solve(normal, weighted.T @ rows)
        residuals = rows - A @ b
        sigma = max(NOISE, MAD_TO_SIGMA * float(np.median(np.abs(residuals))))
        weights = np.maximum(1 - (residuals / (TUKEY * sigma)) ** 2, 0) ** 2
    error = sigma * np.sqrt(np.linalg.inv(normal)[0, 0])
    return float(b[0]) if error <= MAX_ERROR else None
