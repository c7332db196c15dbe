# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The road's surface to a tenth of a pixel: it is moved until the right image fits the left one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.dp.robust_fit import solved, tukey_weights
from lane_dp_ros.core.geometry.disparity_map import DisparityMap
from lane_dp_ros.core.geometry.vertical_curve import VerticalCurve
from lane_dp_ros.core.road.crest_search import search_crest
from lane_dp_ros.core.road.road_bands import (
    FARTHEST,
    HALF_WIDTH,
    MAD_TO_SIGMA,
    TUKEY,
    BandPixels,
    RoadBand,
    grey_tolerance,
    road_bands,
)
from lane_dp_ros.core.types import StereoFrame

Floats = NDArray[Any]

CREST = 80.0  # m; a crest that hides the road from there on may be a sharper one, nearer by
MAX_PIXELS = 2500  # of near and of far road each; more make it no better
MIN_PIXELS = 400
CELLS, SHARE = 0.25, 0.03  # of a cell, and of the road's disparity, by which a matched one may be off it
ROUNDS, CHOOSING_ROUNDS, INNER_ROUNDS = 4, 3, 3  # of registration; those of them that choose pixels
MAX_ERROR = 12.0  # grey levels; more is another thing, not the same one moved
STILL = np.array([2e-3, 2e-4, 2e-5, 2e-4])  # m, -, 1/m, -; a smaller step ends it
CURVATURE = 0.01  # 1/m; standard deviation of what roads have: holds a profile straight that is not seen far
CORRELATED = 10  # neighbouring pixels that say the same
DAMPING = np.diag([1e-6, 1e-6, 1e-3, 1e-6])
BLOCK_LENGTH, BLOCKS = 3.0, 20  # m of road, left and right apart, that may be off as a whole


@dataclass(frozen=True, eq=False)
class _Linearised:
    """`error` + J db [grey levels] of N pixels, for a change db of the coefficients; `J` (4, N).

    `usable` (N,) is 1 or 0; `block` (N,) counts the pieces of road.
    """

    J: Floats
    error: Floats
    usable: Floats
    block: NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class _Fit:
    """The change `step` (4,) of the coefficients, its `normal` matrix (4, 4), and w J (4, N)."""

    step: Floats
    normal: Floats
    weighted: Floats


@dataclass(frozen=True)
class Alignment:
    """A surface moved onto both images.

    `agreement` is the share of its pixels that differ by no more than 12 grey levels between the images, 1
    where too little was to be seen to tell.
    """

    surface: VerticalCurve
    agreement: float = 1.0


def aligned(surface: VerticalCurve, frame: StereoFrame, disparity: DisparityMap) -> Alignment:
    """Return a surface nearby on which a grey pair agrees best, with its covariance.

    Registration of the right image, moved by the surface's disparity, with the left one (Lucas & Kanade
    1981) in the surface's four coefficients, on pixels whose matched disparity lies on the surface. Matching
    lags behind a road whose disparity changes from row to row; the images themselves do not. Where a crest
    hides the road in view its curvature is searched, too. The surface itself is returned, without covariance,
    where too little is to be seen.
    """
    if frame.right is None:
        return Alignment(surface)
    bands = road_bands(frame, disparity, surface)
    found = _registered(surface, bands, disparity)
    if found.surface.summit < CREST:
        found = _registered(search_crest(found.surface, bands[0], disparity), bands, disparity)
    return found


def _registered(
    surface: VerticalCurve, bands: tuple[RoadBand, RoadBand], disparity: DisparityMap
) -> Alignment:
    """Return the surface nearby on which the bands agree best."""
    chosen: list[BandPixels] = []
    last: tuple[_Linearised, _Fit] | None = None
    for i in range(ROUNDS):
        if i < CHOOSING_ROUNDS:
            on_road = _on_road(surface, disparity)
            chosen = [band.strong_pixels(on_road[band.rows], MAX_PIXELS) for band in bands]
        seen = _linearised(surface, bands, chosen)
        if len(seen.error) < MIN_PIXELS:
            break
        fit = _fit(surface, seen)
        moved = surface.with_coefficients(np.array(surface.coefficients) + fit.step)
        if not moved.is_below_camera:
            break
        surface, last = moved, (seen, fit)
        if np.all(np.abs(fit.step) < STILL):
            break
    if last is None:
        return Alignment(surface)
    measured = surface.with_coefficients(surface.coefficients, _covariance(*last))
    return Alignment(measured, float(np.mean(last[0].usable)))


def _linearised(
    surface: VerticalCurve, bands: tuple[RoadBand, RoadBand], chosen: list[BandPixels]
) -> _Linearised:
    """Return how the chosen pixels of each band differ, and how that changes with the surface."""
    parts = [_of_band(surface, band, pixels) for band, pixels in zip(bands, chosen, strict=True)]
    return _Linearised(*(np.concatenate(each, axis=-1) for each in zip(*parts, strict=True)))


def _on_road(surface: VerticalCurve, disparity: DisparityMap) -> NDArray[np.bool_]:
    """Return the cells of the disparity that lie on the surface, in the lane and beside it."""
    camera, (u, v) = surface.camera, disparity.centres
    d = surface.disparity(u[None], v[:, None])
    within = np.float32(CELLS * disparity.cell) + np.float32(SHARE) * d
    aside = np.abs(u - camera.cx) * np.float32(camera.baseline / HALF_WIDTH)
    with np.errstate(invalid="ignore"):
        on = np.abs(disparity.matched - d) < within
    return np.asarray(on & (aside < d) & (d > camera.fx * camera.baseline / FARTHEST))


def _of_band(
    surface: VerticalCurve, band: RoadBand, pixels: BandPixels
) -> tuple[Floats, Floats, Floats, NDArray[np.intp]]:
    """Return the fields of `_Linearised` for pixels of one band."""
    if not len(pixels.u):
        return np.zeros((4, 0), np.float32), pixels.u, pixels.u, np.zeros(0, np.intp)
    camera = surface.camera
    d, J = surface.linearised(pixels.u, pixels.v)
    columns = band.right_columns(pixels, d, camera)
    right, right_gradient = (
        cv2.remap(x, columns, pixels.row, cv2.INTER_LINEAR).reshape(-1)
        for x in (band.right, band.right_gradient)
    )
    J *= (pixels.gradient + right_gradient) * np.float32(0.5 / band.step)
    error = pixels.grey - right
    inside = (columns > 1) & (columns < len(band.u) - 2)
    usable = inside & (np.abs(error) < MAX_ERROR) & (d > 0)
    pieces = camera.fx * camera.baseline / (BLOCK_LENGTH * np.maximum(d, 1))
    block = 2 * np.minimum(pieces, BLOCKS - 1).astype(np.intp) + (pixels.u > camera.cx)
    return J, error, usable.astype(np.float32), block


def _fit(surface: VerticalCurve, seen: _Linearised) -> _Fit:
    """Return the change of the coefficients after which the pixels differ least, by Tukey's weights."""
    tolerance = grey_tolerance(seen.error)
    noise = tolerance / (TUKEY * MAD_TO_SIGMA)
    curvature = np.array([0, 0, surface.coefficients[2], 0])
    ridge = np.diag([0, 0, CORRELATED * (noise / CURVATURE) ** 2, 0]) + DAMPING
    step: Floats = np.zeros(4)
    normal, weighted = ridge, seen.J
    for _ in range(INNER_ROUNDS):
        residual = step.astype(np.float32) @ seen.J + seen.error
        weighted = seen.J * (tukey_weights(residual, tolerance) * seen.usable)
        normal = (weighted @ seen.J.T).astype(np.float64) + ridge
        step = -solved(normal, (weighted @ seen.error).astype(np.float64) + ridge @ curvature)
    return _Fit(step, normal, weighted)


def _covariance(seen: _Linearised, fit: _Fit) -> NDArray[np.float64]:
    """Return the covariance (4, 4) of the coefficients after a step.

    That of an M-estimator with the pieces of road for clusters (Liang & Zeger 1986): neighbouring pixels are
    off together.
    """
    residual = fit.step.astype(np.float32) @ seen.J + seen.error
    scores = np.stack([np.bincount(seen.block, each, 2 * BLOCKS) for each in fit.weighted * residual])
    inverse = np.linalg.inv(fit.normal)
    covariance = inverse @ (scores @ scores.T + DAMPING) @ inverse
    return np.asarray((covariance + covariance.T) / 2)  # rounding leaves it not quite symmetric
