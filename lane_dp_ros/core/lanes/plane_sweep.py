# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Heights along a line, to a centimetre: how far the right image has to move to fit the left one.

A plane sweep (Collins, "A space-sweep approach to true multi-image matching", CVPR 1996) over surfaces above
and below the road's. The dense disparity is smooth where a kerb is not; a line is long enough to be matched
by itself.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.types import BirdsEyeView, LaneLine, StereoFrame

Floats = NDArray[Any]

STEP = 0.02  # m between the surfaces
HEIGHTS = np.arange(-0.10, 0.22 + STEP / 2, STEP)  # m above the road's surface
FAR = 18.0  # m; farther, a centimetre is less than 0.15 px of disparity with KITTI's cameras
ALONG, ACROSS = 0.25, 0.025  # m between the samples
LINE = 0.2  # m to each side of the line: the paint with its borders
GROUND = (0.3, 1.2)  # m aside; the ground beside it
MIN_ROWS = 10  # of samples across the line; with fewer a height is chance
GAIN = 0.5, 2.0  # of the left camera over the right one
OUTLIER = 20.0  # grey levels; more difference counts no more
DISTINCT = 0.3  # of the least difference; less than that below the median of all of them is chance
NOISE = 0.5  # grey levels; less difference is none


@dataclass(frozen=True)
class LineHeights:
    """Heights [m] above the road's surface: of a line, and of the ground to both sides; NaN if unknown.

    What stands as high as the last of `HEIGHTS`, or a little higher, has that height.
    """

    line: float = np.nan
    left: float = np.nan
    right: float = np.nan


def line_heights(line: LaneLine, view: BirdsEyeView, picture: StereoFrame) -> LineHeights:
    """Return the heights along a line in the view of a picture; unknown where it is short, far, or mono."""
    s = np.arange(line.s[0], min(line.s[-1], FAR), ALONG)
    if picture.right is None or len(s) < MIN_ROWS:
        return LineHeights()
    aside = np.arange(-GROUND[1], GROUND[1] + ACROSS / 2, ACROSS)
    x, z = view.axis.to_ground(s[:, None], np.interp(s, line.s, line.n)[:, None] + aside)
    u, v = (np.asarray(each, dtype=np.float32) for each in view.ground.ground_to_pixel(x, z))
    u_right = _right_columns(u, v, view)
    rows, columns = picture.left.shape
    seen = (u >= 0) & (u <= columns - 1) & (v >= 0) & (v <= rows - 1)
    seen &= (u_right.min(axis=0) >= 0) & (u_right.max(axis=0) <= columns - 1)
    left, right = _sampled(picture.left, u[None], v), _sampled(picture.right, u_right, v)

    nearest = GROUND[0] - ACROSS / 2
    parts = np.abs(aside) < LINE + ACROSS / 2, aside < -nearest, aside > nearest
    return LineHeights(*(_height(left[0][:, part], right[:, :, part], seen[:, part]) for part in parts))


def _right_columns(u: Floats, v: Floats, view: BirdsEyeView) -> Floats:
    """Return where the right camera sees pixels (rows, columns) of the left one, for each of `HEIGHTS`."""
    surface = view.surface
    # What stands h above the road, below cameras at the height H, is nearer by (H - h) / H.
    nearer = surface.camera_height / (surface.camera_height - HEIGHTS)
    disparity = nearer[:, None, None] * surface.disparity(u, v) + surface.camera.disparity_offset
    return np.asarray(u - disparity, dtype=np.float32)


def _sampled(image: NDArray[np.uint8], u: Floats, v: Floats) -> Floats:
    """Return the grey values at columns u (heights, rows, columns) and rows v (rows, columns)."""
    map_v = np.broadcast_to(v, u.shape).reshape(-1, u.shape[2])
    sampled = cv2.remap(image, u.reshape(map_v.shape), map_v, cv2.INTER_LINEAR)
    return sampled.reshape(u.shape).astype(np.float32)


def _height(left: Floats, right: Floats, seen: NDArray[np.bool_]) -> float:
    """Return the height [m] at which right (heights, rows, columns) fits left (rows, columns) best, or NaN.

    Rows count that are `seen` from end to end.
    """
    whole = seen.all(axis=1)
    if np.count_nonzero(whole) < MIN_ROWS:
        return float(np.nan)
    left, right = left[whole], right[:, whole]
    left = left - left.mean(axis=1, keepdims=True)
    right = right - right.mean(axis=2, keepdims=True)
    power = np.maximum((right**2).sum(axis=(1, 2)), 1.0)
    gain = np.clip((right * left).sum(axis=(1, 2)) / power, *GAIN)
    difference = np.minimum(np.abs(left - gain[:, None, None] * right), OUTLIER).mean(axis=(1, 2))
    i = int(difference.argmin())
    if i == 0 or np.median(difference) < (1 + DISTINCT) * max(difference[i], NOISE):
        return float(np.nan)
    if i == len(HEIGHTS) - 1:
        return float(HEIGHTS[-1])
    before, least, after = difference[i - 1 : i + 2]
    return float(HEIGHTS[i] + 0.5 * STEP * (before - after) / (before - 2 * least + after))
