# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The dense vanishing point of Ozgunalp et al. 2017: a vote for u_vp(v), a shortest path, a quartic."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.dp.shortest_paths import shortest_paths
from lane_dp_ros.core.geometry.road_surface import RoadSurface
from lane_dp_ros.core.road.edge_pixels import EdgePixels

CELL = 4  # px, rows and columns of the accumulator
MARGIN = 0.5  # of the image's width; how far beside the image a vanishing point is looked for
BLUR = (9, 5)  # cells across and along; edges point a few pixels beside their vanishing point
NEIGHBOURS, SMOOTHNESS = 2, 0.02  # small steps in u: the vanishing point moves slowly along the road
DEGREE = 4
MIN_EDGES = 20


@dataclass(frozen=True)
class QuarticVanishingPoint:
    """The vanishing point (u, v) [px] near the vehicle, and the quartic u_vp(v) along the road ahead.

    `u_of_row` are its coefficients, constant first.
    """

    u: float
    v: float
    u_of_row: tuple[float, ...]


def quartic_vanishing_point(
    edges: EdgePixels, surface: RoadSurface, shape: tuple[int, ...]
) -> QuarticVanishingPoint | None:
    """Return the vanishing point near the vehicle, with the quartic u_vp(v) of the road ahead.

    Every edge votes in the accumulator (v, u_vp), weighted by its gradient, for u_vp = u + (v - v_vp(v))
    g_v / g_u, v_vp(v) being the horizon that the road's profile has at its row. A shortest path from the
    bottom row up, then a quartic through it, is u_vp(v). `shape` is the image's (rows, columns). With too
    few edges there is none.
    """
    if len(edges.u) < MIN_EDGES:
        return None
    votes, first = _accumulate(edges, surface, shape)
    peak = np.maximum(votes.max(axis=1, keepdims=True), 1e-6)
    column = shortest_paths(1 - votes / peak, k=NEIGHBOURS, smoothness=SMOOTHNESS).best()
    rows = np.arange(len(votes))
    v = first + (rows + 0.5) * CELL
    u = (column + 0.5) * CELL - MARGIN * shape[1]
    degree = min(DEGREE, len(v) - 1)
    polynomial = np.polynomial.Polynomial.fit(v, u, degree, w=np.sqrt(votes[rows, column] + 1e-3))
    near = float(np.clip(surface.near_row, v[0], v[-1]))  # where nothing votes the quartic runs wild
    return QuarticVanishingPoint(
        float(polynomial(near)), float(surface.horizon(near)), tuple(polynomial.convert().coef)
    )


def _accumulate(
    edges: EdgePixels, surface: RoadSurface, shape: tuple[int, ...]
) -> tuple[NDArray[np.float32], float]:
    """Return the smoothed votes (row cells, column cells) and the image row where they begin."""
    first = float(edges.v.min()) if len(edges.v) else 0.0
    size = int((shape[0] - first) // CELL) + 1, int((1 + 2 * MARGIN) * shape[1] // CELL) + 1
    with np.errstate(divide="ignore", invalid="ignore"):
        u_vp = edges.u + (edges.v - surface.horizon(edges.v)) * edges.gradient_v / edges.gradient_u
        column = (u_vp + MARGIN * shape[1]) / CELL
    inside = (column >= 0) & (column < size[1])
    row = ((edges.v[inside] - first) // CELL).astype(np.intp)
    weight = np.hypot(edges.gradient_u, edges.gradient_v)[inside]
    flat = np.bincount(row * size[1] + column[inside].astype(np.intp), weight, size[0] * size[1])
    votes = cv2.blur(flat.reshape(size).astype(np.float32), BLUR)
    return np.asarray(votes, dtype=np.float32), first
