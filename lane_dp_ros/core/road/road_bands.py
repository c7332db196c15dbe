# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The road in both images, as its surface is aligned with them: far and near, without brightness."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.geometry.disparity_map import DisparityMap
from lane_dp_ros.core.geometry.road_surface import RoadSurface
from lane_dp_ros.core.types import StereoFrame

Floats = NDArray[Any]
Image = NDArray[np.uint8]

NEAR_SCALE, FAR_SCALE = 2, 4  # times the resolution of the disparity: far road is small, near road is large
FARTHEST = 45.0  # m
HALF_WIDTH = 4.5  # m; farther aside are verges and pavements, some centimetres above the road
SPLIT_DEPTH = 12.0  # m; far road begins here
BELOW_HORIZON = 0.03  # of fy; rows nearer to the principal point see road beyond 55 m
HIGH_PASS = 9  # px; what is broader is brightness, in which the cameras differ
MIN_GRADIENT = 2.0  # grey levels per px across the image; less tells nothing of the disparity

TUKEY = 2.5  # standard deviations
MAD_TO_SIGMA = 1.4826
MIN_TOLERANCE = 3.0  # grey levels; noise of any camera


def grey_tolerance(errors: Floats) -> float:
    """Return the difference [grey levels] beyond which a pixel is an outlier among `errors` (N,)."""
    middle = len(errors) // 2  # a partial sort takes a third of the time of `np.median`
    return max(TUKEY * MAD_TO_SIGMA * float(np.partition(np.abs(errors), middle)[middle]), MIN_TOLERANCE)


@dataclass(frozen=True, eq=False)
class BandPixels:
    """N pixels of a band, float32, at its `row` and `column`.

    `u`, `v` [px] are where they lie in the whole image, `grey` and `gradient` what the left band shows there.
    """

    row: Floats
    column: Floats
    u: Floats
    v: Floats
    grey: Floats
    gradient: Floats


@dataclass(frozen=True, eq=False)
class RoadBand:
    """Some rows of both images (h, w), high-passed, and their gradients across [grey levels / px].

    `u` (w,) and `v` (h,) [px] are where its columns and rows lie in the whole image, `step` [px] is between
    two columns, `rows` are those of the disparity's cells; `strong` (h, w) where there is enough gradient.
    """

    left: Floats
    right: Floats
    left_gradient: Floats
    right_gradient: Floats
    u: Floats
    v: Floats
    step: float
    rows: slice
    strong: NDArray[np.bool_]

    def strong_pixels(self, cells: NDArray[np.bool_], most: int) -> BandPixels:
        """Return the pixels with gradient in cells (rows, columns) that are chosen, thinned out to `most`."""
        height, width = self.left.shape
        mask = cv2.resize(cells.view(np.uint8), (width, height), interpolation=cv2.INTER_NEAREST)
        chosen = np.flatnonzero(self.strong & mask.view(np.bool_))
        pixels = chosen[:: max(1, -(-len(chosen) // most))]
        row, column = np.divmod(pixels, width)
        return BandPixels(
            row.astype(np.float32),
            column.astype(np.float32),
            self.u[column],
            self.v[row],
            self.left.ravel()[pixels],
            self.left_gradient.ravel()[pixels],
        )

    def right_columns(self, pixels: BandPixels, disparity: Floats, camera: StereoCamera) -> Floats:
        """Return the columns (N,) of the right band in which its camera sees pixels of that `disparity`."""
        shift = disparity + np.float32(camera.disparity_offset)
        return np.asarray(pixels.column - shift * np.float32(1 / self.step), np.float32)


def road_bands(
    frame: StereoFrame, disparity: DisparityMap, surface: RoadSurface
) -> tuple[RoadBand, RoadBand]:
    """Return far and near road of a grey pair, as a camera of the surface's height sees it on a plane."""
    camera, rows = surface.camera, disparity.matched.shape[0]
    split = camera.cy + camera.fy * surface.camera_height / SPLIT_DEPTH
    horizon = camera.cy + BELOW_HORIZON * camera.fy
    first, middle = (
        int(np.clip((v - disparity.first) / disparity.cell, 0, rows - 1)) for v in (horizon, split)
    )
    middle = max(first, middle)  # a camera near to the ground sees no far road
    far, near = (min(disparity.cell, scale) for scale in (FAR_SCALE, NEAR_SCALE))
    return (
        _band(frame, disparity, slice(first, min(middle + 3, rows)), far),
        _band(frame, disparity, slice(middle, rows), near),
    )


def _band(frame: StereoFrame, disparity: DisparityMap, rows: slice, scale: int) -> RoadBand:
    """Return the rows of cells at `scale` times their resolution."""
    assert frame.right is not None
    count, cell = disparity.matched.shape[1], disparity.cell
    top, bottom = (disparity.first + row * cell for row in (rows.start, rows.stop))
    size = count * scale, (rows.stop - rows.start) * scale
    grey = [_resized(image[top:bottom, : count * cell], size) for image in (frame.left, frame.right)]
    passed = [cv2.subtract(x, cv2.blur(x, (HIGH_PASS, HIGH_PASS)), dtype=cv2.CV_32F) for x in grey]
    gradients = [cv2.Sobel(x, cv2.CV_32F, 1, 0, ksize=1, scale=0.5) for x in passed]
    step = cell / scale
    u, v = ((np.arange(n) + 0.5) * step - 0.5 for n in size)
    return RoadBand(
        left=passed[0],
        right=passed[1],
        left_gradient=gradients[0],
        right_gradient=gradients[1],
        u=u.astype(np.float32),
        v=(v + top).astype(np.float32),
        step=step,
        rows=rows,
        strong=cv2.inRange(gradients[0], -MIN_GRADIENT, MIN_GRADIENT) == 0,
    )


def _resized(image: Image, size: tuple[int, int]) -> Image:
    if (image.shape[1], image.shape[0]) == size:
        return image
    return np.asarray(cv2.resize(image, size, interpolation=cv2.INTER_AREA), dtype=np.uint8)
