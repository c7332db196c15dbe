# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""How sharp a crest is, where its road is seen so flat that no matcher follows it."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.geometry.disparity_map import DisparityMap
from lane_dp_ros.core.geometry.vertical_curve import VerticalCurve
from lane_dp_ros.core.road.road_bands import FARTHEST, HALF_WIDTH, BandPixels, RoadBand, grey_tolerance

Floats = NDArray[Any]

CURVATURES = np.arange(-10, 11) * 3e-4  # 1/m; more or less than the one known
STANDS = 4.0  # px of disparity; what is so much nearer than the road hides it
MAX_PIXELS = 1500
MIN_PIXELS = 100
NO_ROAD = 0.5  # of the tolerance; the price of a pixel in which no road is seen


def search_crest(surface: VerticalCurve, far: RoadBand, disparity: DisparityMap) -> VerticalCurve:
    """Return the surface whose curvature fits the far road of both images best; the near road stays.

    Each pixel costs how much it differs from the place in the right image in which the surface has it, up to
    a limit, and half of that where the surface has no road at all: a horizon too low is as dear as one too
    high. (Registration goes one pixel far, and over the crest the disparity changes by more in a row.)
    """
    pixels = far.strong_pixels(_corridor(surface, far, disparity), MAX_PIXELS)
    if len(pixels.u) < MIN_PIXELS:
        return surface
    known = _differences(surface, far, pixels)
    if np.isnan(known).all():
        return surface
    limit = grey_tolerance(known[np.isfinite(known)])

    def cost(tried: VerticalCurve) -> float:
        """Return the mean cost of the pixels, from 0 to 1."""
        share = np.minimum(_differences(tried, far, pixels) / limit, 1)
        return float(np.mean(np.where(np.isnan(share), NO_ROAD, share)))

    b = np.array(surface.coefficients)
    tried = [surface.with_coefficients(b + np.array([0, 0, k, 0])) for k in CURVATURES]
    return min((each for each in tried if each.is_below_camera), key=cost, default=surface)


def _corridor(surface: VerticalCurve, far: RoadBand, disparity: DisparityMap) -> NDArray[np.bool_]:
    """Return the cells of the far road that show the lane ahead, or what lies over the crest."""
    camera, (u, v) = surface.camera, disparity.centres
    d = surface.disparity(u[None], v[far.rows, None])
    near = np.abs(u - camera.cx) * np.float32(camera.baseline / HALF_WIDTH)
    nearest = np.maximum(d, np.float32(camera.fx * camera.baseline / FARTHEST))
    with np.errstate(invalid="ignore"):
        hidden = disparity.matched[far.rows] - nearest > STANDS
    return np.asarray((near < nearest) & ~hidden)


def _differences(surface: VerticalCurve, far: RoadBand, pixels: BandPixels) -> Floats:
    """Return how much pixels (N,) differ between left and right [grey levels], NaN where there is no road."""
    d = surface.disparity(pixels.u, pixels.v)
    columns = far.right_columns(pixels, d, surface.camera)
    right = cv2.remap(far.right, columns, pixels.row, cv2.INTER_LINEAR).ravel()
    seen = d > surface.camera.fx * surface.camera.baseline / FARTHEST
    return np.where(seen, np.abs(pixels.grey - right), np.nan)
