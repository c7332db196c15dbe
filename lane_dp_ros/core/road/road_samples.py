# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Pixels of the disparity that may be road, and the road's path through their v-disparity."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.dp.shortest_paths import shortest_paths
from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.geometry.disparity_map import DisparityMap
from lane_dp_ros.core.geometry.road_surface import RoadSurface

Floats = NDArray[Any]

BELOW_HORIZON = 0.017  # of fy; rows nearer to the principal point see road beyond 100 m
FARTHEST = 130.0  # m; farther road says nothing of its surface
HALF_WIDTH = 8.0  # m; what lies farther aside is not taken for road
COLUMNS = 155  # of the samples; the surface is smooth, more of them fit it no better
STANDING = 4.0  # times the rows over which a road's disparity falls as much; what keeps its own longer stands
MIN_POINTS = 200  # fewer samples are no road
NEIGHBOURS = 2  # bins by which the v-disparity path may move from row to row
PATH_BIN, STANDING_BIN = 0.5, 0.25  # cells: what the matcher takes for one pixel
TOLERANCE = 0.25  # cells; disparities of a road are so exact


@dataclass(frozen=True, eq=False)
class RoadSamples:
    """A grid of matched pixels that may be road, N of them, float32.

    `u`, `v`, `d` (N,) [px]: where, and the disparity; `row` (N,) counts the rows of the grid, at `row_v` (R,)
    [px]; `lies` (N,): not part of what stands upright. `resolution` [px] is what the matcher resolves,
    `tolerance` [px] how far off the road's surface a sample of it may be; `matched`: share of
    the cells below the horizon that have a disparity, of those that the right image shows.
    """

    camera: StereoCamera
    u: Floats
    v: Floats
    d: Floats
    row: NDArray[np.intp]
    row_v: Floats
    lies: NDArray[np.bool_]
    resolution: float
    tolerance: float
    matched: float

    def share_on(self, surface: RoadSurface) -> float:
        """Return what share of the samples lies on a surface."""
        return float(np.mean(np.abs(surface.disparity(self.u, self.v) - self.d) < 2 * self.tolerance))

    def path(self) -> tuple[NDArray[np.intp], Floats]:
        """Return rows and disparities [px] of the road's path through the v-disparity histogram."""
        bin_size = PATH_BIN * self.resolution
        bins = (self.d[self.lies] / np.float32(bin_size)).astype(np.float64)
        shape = int(self.row.max()) + 1, int(self.d.max() / bin_size) + 1
        rows, path = v_disparity_path(v_disparity(self.row[self.lies], bins, shape))
        return rows, path * bin_size


def road_samples(disparity: DisparityMap, camera: StereoCamera, camera_height: float) -> RoadSamples | None:
    """Return what may be road, some `camera_height` [m] below the camera; None where that is too little."""
    u, v = disparity.centres
    first = int(np.searchsorted(v, camera.cy + BELOW_HORIZON * camera.fy))
    thinning = max(1, round(len(u) / COLUMNS))
    u, v, d = u[thinning // 2 :: thinning], v[first:], disparity.matched[first:, thinning // 2 :: thinning]
    with np.errstate(invalid="ignore"):
        matched = (d > camera.fx * camera.baseline / FARTHEST) & (d < disparity.shape[1])
        near = matched & (np.abs(u - camera.cx) * np.float32(camera.baseline) < np.float32(HALF_WIDTH) * d)
    if np.count_nonzero(near) < MIN_POINTS:
        return None
    u_right = u - np.float32(camera.disparity_offset)  # of what is far away
    shown = (u_right >= 0) & (u_right <= disparity.shape[1] - 1)
    rows_per_px = camera_height * camera.fy / (camera.baseline * camera.fx)
    bin_size = STANDING_BIN * disparity.cell
    stands = _stands(np.where(near, d, 0) / bin_size, rows_per_px * bin_size / disparity.cell)
    row, column = np.nonzero(near)
    return RoadSamples(
        camera,
        u=u[column],
        v=v[row],
        d=d[near],
        row=row,
        row_v=v,
        lies=~stands[near],
        resolution=disparity.cell,
        tolerance=TOLERANCE * disparity.cell,
        matched=float(np.mean(matched[:, shown])) if shown.any() else 0.0,
    )


def v_disparity(rows: NDArray[np.intp], disparity: Floats, shape: tuple[int, int]) -> NDArray[np.float32]:
    """Return the histogram (rows, bins of 1) of the disparities in each row (Labayrade et al. 2002)."""
    bins = np.minimum(disparity.astype(np.intp), shape[1] - 1)
    flat = np.bincount(rows * shape[1] + bins, minlength=shape[0] * shape[1])
    return flat.reshape(shape).astype(np.float32)


def v_disparity_path(histogram: NDArray[np.float32]) -> tuple[NDArray[np.intp], Floats]:
    """Return rows and disparities [bins] of the road's path through a v-disparity histogram.

    The shortest path from the bottom row up, by the same DP as the lanes (Ozgunalp et al. 2017, section
    III-A). Rows without a vote on the path are left out.
    """
    peak = np.maximum(histogram.max(axis=1, keepdims=True), 1)
    column = shortest_paths(1 - histogram / peak, k=NEIGHBOURS).best()
    voted = np.flatnonzero(histogram[np.arange(len(histogram)), column] > 0)
    return voted, column[voted] + 0.5


def _stands(disparity: Floats, rows_per_bin: float) -> NDArray[np.bool_]:
    """Return which samples (rows, columns) stand upright: many in one column have the same disparity [bins].

    On a flat road it falls by one bin over `rows_per_bin` rows; a bush or a wall keeps its own, and in
    v-disparity outweighs a road that leans (u-disparity, Hu & Uchimura 2005). 0 is no disparity.
    """
    cells = disparity.astype(np.intp) * disparity.shape[1] + np.arange(disparity.shape[1])
    rows = np.bincount(cells.ravel())[cells]
    return np.asarray((disparity > 0) & (rows > STANDING * rows_per_bin))
