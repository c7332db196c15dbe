# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Heights along lines, to a centimetre: how far the right image has to move to fit the left one.

A plane sweep (Collins, "A space-sweep approach to true multi-image matching", CVPR 1996) over surfaces above
and below the road's. The dense disparity is smooth where a kerb is not; a line is long enough to be matched
by itself.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.birdseye.birds_eye import BirdsEyeView
from lane_dp_ros.core.geometry.road_surface import RoadSurface
from lane_dp_ros.core.lanes.candidate import LaneLine
from lane_dp_ros.core.lanes.cross_section import row_medians
from lane_dp_ros.core.lanes.segments import Segments
from lane_dp_ros.core.types import StereoFrame

Floats = NDArray[Any]

STEP = 0.04  # m between the planes
PLANES = np.arange(-0.10, 0.22 + STEP / 2, STEP)  # m above the road's surface
FAR = 18.0  # m; farther, a centimetre is less than 0.15 px of disparity with KITTI's cameras
ALONG, ACROSS = 0.25, 0.05  # m between the samples
LINE = 0.2  # m to each side of the line: the paint with its borders
GROUND = (0.3, 1.2)  # m aside; the ground beside it
ASIDE = np.arange(-GROUND[1], GROUND[1] + ACROSS / 2, ACROSS)
PARTS = tuple(  # of the samples across: the line, the ground to the left, to the right
    slice(*np.searchsorted(ASIDE, (first - ACROSS / 2, last + ACROSS / 2)))
    for first, last in ((-LINE, LINE), (-GROUND[1], -GROUND[0]), GROUND)
)
MIN_ROWS = 10  # of samples across the line; with fewer a height is chance
GAIN = 0.5, 2.0  # of the left camera over the right one
OUTLIER = 20.0  # grey levels; more difference counts no more
DISTINCT = 0.3  # the planes' median difference exceeds the least by this share; with less a height is chance
NOISE = 0.5  # grey levels; less difference is none


@dataclass(frozen=True)
class LineHeights:
    """Heights [m] above the road's surface: of a line, and of the ground to both sides; NaN if unknown.

    What stands as high as the last of the planes, or a little higher, has that height.
    """

    line: float = np.nan
    left: float = np.nan
    right: float = np.nan


def line_heights(lines: Sequence[LaneLine], view: BirdsEyeView, frame: StereoFrame) -> list[LineHeights]:
    """Return the heights along lines in the view of a grey frame; unknown of a short, far, or mono one."""
    found = [LineHeights()] * len(lines)
    places = [np.arange(line.s[0], min(line.s[-1], FAR), ALONG) for line in lines]
    swept = [i for i, s in enumerate(places) if len(s) >= MIN_ROWS]
    if frame.right is None or not swept or view.road_surface.camera_height <= PLANES[-1]:
        return found
    s = np.concatenate([places[i] for i in swept])
    n = np.concatenate([np.interp(places[i], lines[i].s, lines[i].n) for i in swept])
    x, z = view.axis.to_ground(s[:, None], n[:, None] + ASIDE)
    u, v = (np.asarray(each, dtype=np.float32) for each in view.ipm_plane.ground_to_pixel(x, z))
    u_right = _right_columns(u, v, view.road_surface)
    seen = _seen(u, v, u_right, frame.left.shape)
    left, right = _sampled(frame.left, u[None], v)[0], _sampled(frame.right, u_right, v)
    lines_of_rows = Segments([len(places[i]) for i in swept])
    differences = [
        _differences(left[:, part], right[:, :, part], np.asarray(seen[:, part].all(axis=1)), lines_of_rows)
        for part in PARTS
    ]
    heights = _best_heights(np.concatenate(differences, axis=1)).reshape(len(PARTS), -1)
    for i, (of_line, of_left, of_right) in zip(swept, heights.T.tolist(), strict=True):
        found[i] = LineHeights(of_line, of_left, of_right)
    return found


def _right_columns(u: Floats, v: Floats, surface: RoadSurface) -> NDArray[np.float32]:
    """Return where the right camera sees pixels (rows, columns) of the left one, for each of `PLANES`."""
    # What stands h above the road, below cameras at the height H, is nearer by (H - h) / H.
    nearer = surface.camera_height / (surface.camera_height - PLANES)
    disparity = nearer.astype(np.float32)[:, None, None] * surface.disparity(u, v)
    return np.asarray(u - np.float32(surface.camera.disparity_offset) - disparity, dtype=np.float32)


def _seen(u: Floats, v: Floats, u_right: Floats, shape: tuple[int, ...]) -> NDArray[np.bool_]:
    """Return which pixels (rows, columns) both images show, on every plane."""
    rows, columns = shape
    # The first plane is the lowest: what stands higher is seen farther to the left.
    right = (u_right[-1] >= 0) & (u_right[0] <= columns - 1)
    return np.asarray((u >= 0) & (u <= columns - 1) & (v >= 0) & (v <= rows - 1) & right)


def _sampled(image: NDArray[np.uint8], u: Floats, v: Floats) -> NDArray[np.float32]:
    """Return the grey values at columns u (planes, rows, columns) and rows v (rows, columns)."""
    # Plane by plane: OpenCV samples at most 32,766 rows at once, fewer than many lines have on all planes.
    return np.stack([cv2.remap(image, plane, v, cv2.INTER_LINEAR) for plane in u]).astype(np.float32)


def _differences(left: Floats, right: Floats, seen: NDArray[np.bool_], lines: Segments) -> Floats:
    """Return the mean difference [grey levels] of the images, (planes, lines), NaN where too little is seen.

    `left` (rows, columns) and `right` (planes, rows, columns) hold the rows of all `lines`; rows count that
    are `seen` (rows,) from end to end.
    """
    counts = lines.count(seen)
    if counts.max() < MIN_ROWS:
        return np.full((len(PLANES), len(lines)), np.nan)
    weight = seen.astype(np.float32)[:, None]
    scale = np.float32(1 / left.shape[1])
    left = (left - left.sum(axis=1, keepdims=True) * scale) * weight
    right = (right - right.sum(axis=2, keepdims=True) * scale) * weight
    power = lines.sum(np.einsum("prc,prc->pr", right, right))
    gain = lines.sum(np.einsum("prc,rc->pr", right, left)) / np.maximum(power, 1.0)
    gain = np.minimum(np.maximum(gain, GAIN[0]), GAIN[1])
    right *= lines.spread(gain.astype(np.float32))[:, :, None]
    right -= left
    np.minimum(np.abs(right, out=right), np.float32(OUTLIER), out=right)
    difference = lines.sum(right.sum(axis=2)) / np.maximum(counts * left.shape[1], 1)
    return np.where(counts < MIN_ROWS, np.nan, difference)


def _best_heights(difference: Floats) -> NDArray[np.float64]:
    """Return, of each line, the height [m] where `difference` (planes, lines) is least.

    NaN unless it is distinct, and where the difference is NaN.
    """
    best = difference.argmin(axis=0)
    line = np.arange(len(best))
    least, median = difference[best, line], row_medians(difference.T)
    inside = np.clip(best, 1, len(PLANES) - 2)
    before, middle, after = (difference[inside + k, line] for k in (-1, 0, 1))
    curved = np.where(inside == best, np.maximum(before - 2 * middle + after, 1e-9), 1.0)
    heights = PLANES[best] + np.where(inside == best, 0.5 * STEP * (before - after) / curved, 0.0)
    known = (best > 0) & (median >= (1 + DISTINCT) * np.maximum(least, NOISE))
    return np.where(known, heights, np.nan)
