# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The true ground of a frame from the disparity that LiDAR measured, independently of the stereo images."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.dp.robust_fit import ransac_parabola, tukey_fit
from lane_dp_ros.core.geometry.camera import StereoCamera

Floats = NDArray[np.float64]

PIXELS = 100.0  # rows and columns enter the ground in hundreds of pixels
BELOW_HORIZON = 0.017  # of fy; rows nearer to the principal point see road beyond 100 m
MIN_DISPARITY = 3.0  # px
ROAD, VERGE = 3.0, 8.0  # m to the side: where the fit starts, and what takes part in its end
CELL, STANDING = 8, 12  # px; what keeps its disparity over more rows in a strip of columns stands upright
MIN_POINTS = 200
MIN_SHARE = 0.5  # of the points ahead that must lie on what was fitted, or it is no road
RESIDUAL, SAMPLES, TRIALS = 0.5, 4000, 300  # RANSAC: px, points, samples
TOLERANCES = np.array([1.5] + 20 * [1.0])  # px, of the iterated weights
RIDGE = np.diag([1e-9, 1e-9, 2e-4, 1e-9])  # per point; holds a profile that the data leave open straight
REACH = 99.0  # percentile of the depths of the ground's points, up to which it is known


@dataclass(frozen=True, eq=False)
class LidarGround:
    """`coefficients` (4,) of d = g0 + g1 n + g2 n^2 + g3 m, as in the truth format, seen to `reach` [m]."""

    coefficients: Floats
    reach: float


def fit_lidar_ground(
    disparity: NDArray[np.floating], camera: StereoCamera, rng: np.random.Generator
) -> LidarGround | None:
    """Return the ground of a disparity map (H, W) [px], 0 where there is none; None where it shows no road.

    A parabola of what lies ahead, by RANSAC, starts a robust fit of all four numbers to what lies within 8 m
    to the side. What stands upright has no vote.
    """
    v, u = np.nonzero(disparity > MIN_DISPARITY)
    d = disparity[v, u].astype(np.float64)
    aside = np.abs(u - camera.cx) * camera.baseline / d
    taken = (v > camera.cy + BELOW_HORIZON * camera.fy) & (aside < VERGE)
    taken[taken] = ~_stands(u[taken], v[taken], d[taken])
    v, u, d, ahead = v[taken], u[taken], d[taken], aside[taken] < ROAD
    if np.count_nonzero(ahead) < MIN_POINTS:
        return None
    n, m = (v - camera.cy) / PIXELS, (u - camera.cx) / PIXELS
    few = rng.permutation(np.flatnonzero(ahead))[:SAMPLES]
    start = ransac_parabola(n[few], d[few], RESIDUAL, TRIALS, rng)
    if start is None:
        return None
    A = np.column_stack([np.ones_like(n), n, n * n, m])
    ground = tukey_fit(A, d, np.ones_like(d), RIDGE * len(d), TOLERANCES, np.append(start.coefficients, 0.0))
    on_ground = ahead & (np.abs(d - A @ ground) < TOLERANCES[-1])
    if np.count_nonzero(on_ground) < MIN_SHARE * np.count_nonzero(ahead):
        return None
    reach = float(np.percentile(camera.fx * camera.baseline / d[on_ground], REACH))
    return LidarGround(ground, reach)


def _stands(u: NDArray[np.intp], v: NDArray[np.intp], d: Floats) -> NDArray[np.bool_]:
    """Return which points (N,) stand upright: others in their columns, many rows away, have their disparity.

    On the road disparity falls by 1 px over some three rows.
    """
    _, cell = np.unique(np.stack([u // CELL, d.astype(np.intp)]), axis=1, return_inverse=True)
    cell = cell.ravel()
    top = np.full(cell.max(initial=-1) + 1, np.iinfo(np.intp).max)
    bottom = np.zeros_like(top)
    np.minimum.at(top, cell, v)
    np.maximum.at(bottom, cell, v)
    return np.asarray((bottom - top)[cell] > STANDING)
