# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The dense vanishing point of Ozgunalp et al. 2017, and the pitch and yaw that a vanishing point tells."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.dp.shortest_paths import shortest_paths
from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.geometry.road_axis import RoadAxis
from lane_dp_ros.core.geometry.road_surface import RoadSurface
from lane_dp_ros.core.types import RoadEdges, VanishingPoint

Floats = NDArray[np.float64]

CELL = 4  # px, rows and columns of the accumulator
MARGIN = 0.5  # of the image's width; how far beside the image a vanishing point is looked for
BLUR = (9, 5)  # cells across and along; edges point a few pixels beside their vanishing point
NEIGHBOURS, SMOOTHNESS = 2, 0.02  # small steps in u: the vanishing point moves slowly along the road
DEGREE = 4
MIN_EDGES = 20


def dense_vanishing_point(edges: RoadEdges, surface: RoadSurface, shape: tuple[int, ...]) -> VanishingPoint:
    """Return the vanishing point near the vehicle, with the quartic u_vp(v) of the road ahead.

    Every edge votes in the accumulator (v, u_vp), weighted by its gradient, for u_vp = u + (v - v_vp(v))
    g_v / g_u, v_vp(v) being the horizon that the road's profile has at its row. A shortest path from the
    bottom row up, then a quartic through it, is u_vp(v). `shape` is the image's (rows, columns). With too
    few edges it is straight ahead.
    """
    votes, first = _accumulate(edges, surface, shape)
    if len(edges.u) < MIN_EDGES:
        return vanishing_point_of(RoadAxis(), surface)
    peak = np.maximum(votes.max(axis=1, keepdims=True), 1e-6)
    column = shortest_paths(1 - votes / peak, k=NEIGHBOURS, smoothness=SMOOTHNESS).best()
    rows = np.arange(len(votes))
    v = first + (rows + 0.5) * CELL
    u = (column + 0.5) * CELL - MARGIN * shape[1]
    degree = min(DEGREE, len(v) - 1)
    polynomial = np.polynomial.Polynomial.fit(v, u, degree, w=np.sqrt(votes[rows, column] + 1e-3))
    near = float(np.clip(surface.near_row, v[0], v[-1]))  # where nothing votes the quartic runs wild
    return VanishingPoint(
        float(polynomial(near)), float(surface.horizon(near)), tuple(polynomial.convert().coef)
    )


def vanishing_point_of(axis: RoadAxis, surface: RoadSurface) -> VanishingPoint:
    """Return the vanishing point of the road's direction at the vehicle."""
    camera = surface.camera
    u = camera.cx + camera.fx * np.tan(axis.heading) / np.cos(surface.pitch)
    return VanishingPoint(float(u), float(camera.cy - camera.fy * np.tan(surface.pitch)))


def pitch_and_yaw(
    point: VanishingPoint, camera: StereoCamera, shape: tuple[int, ...], centred: bool = False
) -> tuple[float, float]:
    """Return pitch (down) and yaw (right) [rad] of the road against the camera.

    pitch = atan((cy - v_vp) / fy), yaw = atan((u_vp - cx) cos(pitch) / fx). With `centred` the paper's
    formula (section IV-2, eq. 7 and 8; Nieto et al. 2007): beta = atan(tan(alpha_v) (1 - 2 v_vp / V)),
    gamma = atan(tan(alpha_u) (2 u_vp / U - 1)), which takes the middle of the image of `shape` (V, U) for
    the principal point.
    """
    if centred:
        rows, columns = shape[:2]
        tan_v, tan_u = rows / (2 * camera.fy), columns / (2 * camera.fx)
        pitch, yaw = (
            np.arctan(tan_v * (1 - 2 * point.v / rows)),
            np.arctan(tan_u * (2 * point.u / columns - 1)),
        )
    else:
        pitch = np.arctan((camera.cy - point.v) / camera.fy)
        yaw = np.arctan((point.u - camera.cx) * np.cos(pitch) / camera.fx)
    return float(pitch), float(yaw)


def _accumulate(
    edges: RoadEdges, surface: RoadSurface, shape: tuple[int, ...]
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
