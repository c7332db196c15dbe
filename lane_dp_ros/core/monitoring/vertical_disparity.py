# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Whether the rows of left and right correspond, as those of a rectified pair must."""

from __future__ import annotations

from typing import Any, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.geometry.disparity_map import DisparityMap

Floats = NDArray[Any]

ROW_STEP = 4  # a sample of the rows says as much
MIN_GRADIENT = 6.0  # grey levels per pixel down the image; less tells no offset
MIN_PIXELS = 500
CLIP = 20.0  # grey levels; more difference is another thing, not the same one moved
DAMPING = 1e-6 * np.eye(4)


class VerticalDisparity(NamedTuple):
    """By how many rows [px] the right image is lower than the left one: `shift` in its middle.

    It is `turn` more at the right border, and as much less at the left one: the cameras are rotated against
    each other about their optical axes.
    """

    shift: float
    turn: float


def vertical_disparity(
    left: NDArray[np.uint8],
    right: NDArray[np.uint8],
    disparity: DisparityMap,
    camera: StereoCamera,
) -> VerticalDisparity | None:
    """Return the offset of the right image against the left one, None where too little is to be seen.

    Both are uint8, (H, W) grey or (H, W, 3) BGR, of which green is looked at.

    One step of registration (Lucas & Kanade 1981) of the right image, moved by the `disparity`, onto
    the left; what the disparity lacks, the same in columns, is taken out. Offsets of several pixels are
    underestimated, as the matcher has found other partners by then.
    """
    left, right = (image[..., 1] if image.ndim == 3 else image for image in (left, right))
    first, last = int(np.clip(camera.cy, 1, len(left) - 1)), len(left) - 1
    rows = np.arange(first, last, ROW_STEP)
    if len(rows) * left.shape[1] < MIN_PIXELS or left.shape[1] < 2:
        return None
    u, v = np.meshgrid(np.arange(left.shape[1], dtype=np.float32), rows.astype(np.float32))
    moved = (
        u - disparity.at(rows[:, None], np.arange(left.shape[1])[None]) - np.float32(camera.disparity_offset)
    )
    seen = np.isfinite(moved) & (moved >= 0)
    moved = np.where(seen, moved, 0).astype(np.float32)
    above, right_rows, below = (
        cv2.remap(right, moved, v + row, cv2.INTER_LINEAR).astype(np.float32) for row in (-1, 0, 1)
    )
    left_rows = left[rows].astype(np.float32)
    down = (left[rows + 1].astype(np.float32) - left[rows - 1] + below - above) / 4
    across = (_across(left_rows) + _across(right_rows)) / 2
    error = left_rows - right_rows
    used = seen & (np.abs(down) > MIN_GRADIENT)
    if np.count_nonzero(used) < MIN_PIXELS:
        return None
    error -= np.median(error[used])  # one camera may be brighter
    m = 2 * u[used] / left.shape[1] - 1
    A = np.stack([down[used], down[used] * m, across[used], across[used] * m], axis=1).astype(np.float64)
    b = np.clip(error[used], -CLIP, CLIP)
    shift, turn, *_ = np.linalg.solve(A.T @ A + DAMPING, A.T @ b)
    return VerticalDisparity(float(shift), float(turn))


def _across(rows: Floats) -> Floats:
    return np.asarray(np.gradient(rows, axis=1), dtype=np.float32)
