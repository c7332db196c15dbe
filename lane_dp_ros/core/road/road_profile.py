# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The road's surface from the disparity: v-disparity, its DP path, a robust quadratic, then the roll."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.dp.robust_fit import ransac_parabola, tukey_fit
from lane_dp_ros.core.dp.shortest_paths import shortest_paths
from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.geometry.disparity_map import DisparityMap
from lane_dp_ros.core.geometry.road_surface import PIXELS, RoadSurface
from lane_dp_ros.core.parameter import Parameters, parameter

Floats = NDArray[Any]

BELOW_HORIZON = 0.017  # of fy; rows nearer to the principal point see road beyond 100 m
MIN_DISPARITY = 3.0  # px; farther road says nothing of its surface
HALF_WIDTH = 8.0  # m; what lies farther aside is not taken for road
COLUMN_STEP, ROW_STEP = 8, 3  # px; the surface is smooth, a sample of the pixels fits it as well
STANDING = 4.0  # times the rows over which a road's disparity falls by 1 px; what keeps its own longer stands
MIN_POINTS = 200  # fewer samples are no road
MIN_INLIERS = 0.2  # of the pixels, matched or not; fewer and what was fitted is not the road
HEIGHT_FACTOR = 1.4  # by which the camera may stand higher or lower than its nominal height
PITCH_RANGE = 0.15  # rad about the nominal pitch: vehicle and hill together
ROLL_MAX = 0.15  # rad; a road banked by 15 %
MAX_TRIALS = 80  # RANSAC samples
NEIGHBOURS = 2  # disparities [px] by which the v-disparity path may move from row to row
NARROWING = np.array([3.0] + 19 * [2.0])  # times residual_threshold; by then the fit stands still
RIDGE = np.diag([1e-9, 1e-9, 2e-4, 1e-9])  # per sample; holds a profile that the data leave open straight


@dataclass(frozen=True)
class RoadProfileConfig(Parameters):
    """The road's surface from the disparity."""

    roll: bool = parameter(True, "Fit the road's cross slope, too.")
    camera_height: float = parameter(
        1.65,
        "Camera above the road; the measured one is within a factor of 1.4. Serves where none is measured.",
        unit="m",
        limits=(0.3, 5.0),
    )
    camera_pitch: float = parameter(
        0.0, "Camera looks down on the road; serves where none is measured.", unit="rad", limits=(-0.3, 0.3)
    )
    residual_threshold: float = parameter(
        1.0, "Disparities farther from the surface do not belong to it.", unit="px", limits=(0.2, 5.0)
    )


def v_disparity(rows: NDArray[np.intp], disparity: Floats, shape: tuple[int, int]) -> NDArray[np.float32]:
    """Return the histogram (rows, bins of 1 px) of the disparities in each row (Labayrade et al. 2002)."""
    bins = np.minimum(disparity.astype(np.intp), shape[1] - 1)
    flat = np.bincount(rows * shape[1] + bins, minlength=shape[0] * shape[1])
    return flat.reshape(shape).astype(np.float32)


def v_disparity_path(histogram: NDArray[np.float32]) -> tuple[NDArray[np.intp], Floats]:
    """Return rows and disparities [px] of the road's path through a v-disparity histogram.

    The shortest path from the bottom row up, by the same DP as the lanes (Ozgunalp et al. 2017, section
    III-A). Rows without a vote on the path are left out.
    """
    peak = np.maximum(histogram.max(axis=1, keepdims=True), 1)
    column = shortest_paths(1 - histogram / peak, k=NEIGHBOURS).best()
    voted = np.flatnonzero(histogram[np.arange(len(histogram)), column] > 0)
    return voted, column[voted] + 0.5


def plausible_heights(config: RoadProfileConfig) -> tuple[float, float]:
    """Return the lowest and the highest height [m] that the camera may have above the road."""
    return config.camera_height / HEIGHT_FACTOR, config.camera_height * HEIGHT_FACTOR


def fit_road_surface(
    disparity: DisparityMap, camera: StereoCamera, config: RoadProfileConfig, rng: np.random.Generator
) -> RoadSurface | None:
    """Return the road's surface, or None where the disparity shows no road at a possible camera height.

    The v-disparity path, without what stands upright, gives the quadratic profile f(v) by RANSAC (Fan &
    Dahnoun 2018); with `config.roll` all pixels near it then give profile and cross slope together, by
    iterated Tukey weights.
    """
    first = int(np.clip(camera.cy + BELOW_HORIZON * camera.fy, 0, disparity.shape[0] - 1))
    v = np.arange(first, disparity.shape[0], ROW_STEP)[:, None]
    u = np.arange(COLUMN_STEP // 2, disparity.shape[1], COLUMN_STEP)[None]
    d = disparity.at(v, u)
    with np.errstate(invalid="ignore"):
        matched = (d > MIN_DISPARITY) & (d < disparity.shape[1])
        near = matched & (np.abs(u - camera.cx) * camera.baseline < HALF_WIDTH * d)
    if np.count_nonzero(near) < MIN_POINTS:
        return None
    rows_per_px = config.camera_height * camera.fy / (camera.baseline * camera.fx)
    lies = ~_stands(np.where(near, d, 0), rows_per_px)[near]
    row, column = np.nonzero(near)
    d = d[near].astype(np.float64)
    n, m = (v[row, 0] - camera.cy) / PIXELS, (u[0, column] - camera.cx) / PIXELS
    histogram = v_disparity(row[lies], d[lies], (int(row.max()) + 1, int(d.max()) + 1))
    path_rows, path = v_disparity_path(histogram)
    n_of_path = (v[path_rows, 0] - camera.cy) / PIXELS
    profile = ransac_parabola(n_of_path, path, config.residual_threshold, MAX_TRIALS, rng)
    if profile is None:
        return None
    b = np.append(profile.coefficients, 0.0)
    A = np.stack([np.ones_like(n), n, n * n, m], axis=1)
    if config.roll:
        b = tukey_fit(A, d, np.ones_like(d), RIDGE * len(d), config.residual_threshold * NARROWING, b)
    surface = RoadSurface(camera, (float(b[0]), float(b[1]), float(b[2]), float(b[3])))
    on_surface = float(np.mean(np.abs(A @ b - d) < 2 * config.residual_threshold)) * float(np.mean(matched))
    return surface if on_surface >= MIN_INLIERS and _plausible(surface, config) else None


def _stands(disparity: Floats, rows_per_px: float) -> NDArray[np.bool_]:
    """Return which samples (rows, columns) stand upright: many in one column have the same disparity [px].

    On a flat road it falls by 1 px over `rows_per_px` rows; a bush or a wall keeps its own, and in
    v-disparity outweighs a road that leans (u-disparity, Hu & Uchimura 2005). 0 is no disparity.
    """
    cells = disparity.astype(np.intp) * disparity.shape[1] + np.arange(disparity.shape[1])
    rows = ROW_STEP * np.bincount(cells.ravel())[cells]
    return np.asarray((disparity > 0) & (rows > STANDING * rows_per_px))


def _plausible(surface: RoadSurface, config: RoadProfileConfig) -> bool:
    lowest, highest = plausible_heights(config)
    return (
        lowest <= surface.camera_height <= highest
        and abs(surface.pitch - config.camera_pitch) <= PITCH_RANGE
        and abs(surface.roll) <= ROLL_MAX
    )
