# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Where each pixel's ray meets the ground: a plane, or hills, a cross slope and kerbs."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.scenes.course import HAZE_DISTANCE
from lane_dp_ros.scenes.surface import Surface
from lane_dp_ros.scenes.view import View

Singles = NDArray[np.float32]

NEAREST = 3.0  # [m] along the camera's axis: nearer ground is below most pictures
SAMPLES = 640  # along each column's plane, at evenly spaced disparities: about half a row each
COLUMN_STEP = 4  # [px] between the columns that are sampled; those between follow smoothly


def lay_out(surface: Surface, view: View) -> None:
    """Write into a surface that holds the sky where its ground is; its colours are left as they are."""
    depth = ground_depth(view)
    rows = slice(int(np.isfinite(depth).any(axis=1).argmax()), None)
    seen = np.isfinite(depth[rows])
    depth = np.where(
        seen, depth[rows], np.float32(HAZE_DISTANCE)
    )  # of what is not ground, nothing will be kept
    position = view.origin.astype(np.float32) + view.rays[rows] * depth[..., None]
    s, n, heading = view.course.locate(position[..., 0], position[..., 2])
    s += np.float32(view.course.position)
    normal = _normals(view, s, n, heading)
    for layer, values in ((surface.position, position), (surface.normal, normal)):
        np.copyto(layer[rows], values, where=seen[..., None])
    for plane, numbers in ((surface.s, s), (surface.n, n), (surface.depth, depth)):
        np.copyto(plane[rows], numbers, where=seen)
    surface.ground[rows] = seen


def ground_depth(view: View) -> Singles:
    """Return the depth (H, W) [m] along the camera's axis of the ground that each pixel sees, or inf."""
    depth = _plane_depth(view) if view.road.is_flat else _heightfield_depth(view)
    depth[(depth <= 0) | (depth > HAZE_DISTANCE)] = np.inf
    return depth


def _plane_depth(view: View) -> Singles:
    fall = view.axes[1, 1] * view.slopes[1] + view.axes[2, 1]  # of a ray, for each metre along the axis
    with np.errstate(divide="ignore"):
        depth = -view.origin[1] / fall
    return np.repeat(depth.astype(np.float32)[:, None], view.size[0], axis=1)


def _heightfield_depth(view: View) -> Singles:
    """Cut the ground with the plane of each picture column, and keep what the near does not hide.

    Along the plane the picture row of the ground falls with distance; where it rises again, the ground is
    hidden behind a crest, so that the running minimum is what is seen.
    """
    depths = 1 / np.linspace(1 / _nearest(view), 1 / HAZE_DISTANCE, SAMPLES)
    rows = np.minimum.accumulate(_ground_rows(view, depths), axis=1)
    wanted = np.arange(view.shape[0], dtype=np.float32)
    inverse = np.empty((view.size[0], view.shape[0]), np.float32)
    for i, row in enumerate(rows):
        inverse[i] = np.interp(wanted, row[::-1], 1 / depths[::-1], left=0.0)
    with np.errstate(divide="ignore"):
        return np.ascontiguousarray(1 / inverse.T)


def _nearest(view: View) -> float:
    """Return a depth [m] that no ground in the picture is nearer than: two thirds of a plane's."""
    steepest = -float(view.rays[-1, :, 1].min())
    return min(NEAREST, 2 / 3 * view.road.camera_height / steepest) if steepest > 0 else NEAREST


def _ground_rows(view: View, depths: NDArray[np.float64]) -> Singles:
    """Return the picture row (W, samples) in which each column sees the ground at each depth."""
    u = np.arange(0, view.size[0] + COLUMN_STEP, COLUMN_STEP)
    bearing = ((u - view.camera.cx) / view.camera.fx)[:, None]
    right, down, forward = view.axes
    x, level, z = (view.origin[i] + depths * (bearing * right[i] + forward[i]) for i in range(3))
    drop = level / -down[1]
    flat = drop
    s, n, _ = view.course.locate(*((a + drop * down[i]).astype(np.float32) for a, i in ((x, 0), (z, 2))))
    # The place under a point of the column's plane moves a little with its height, which matters on slopes.
    for _ in range(2 if view.road.hill else 1):
        drop = (level - view.course.height(s + (drop - flat) * down[2], n)) / -down[1]
    rows = (view.camera.cy + view.camera.fy * drop / depths).astype(np.float32)
    width = (len(u) - 1) * COLUMN_STEP
    columns = np.arange(width, dtype=np.float32)[: view.size[0], None] / COLUMN_STEP
    grid = np.broadcast_to(np.arange(SAMPLES, dtype=np.float32), (view.size[0], SAMPLES))
    every = cv2.remap(rows, np.ascontiguousarray(grid), np.repeat(columns, SAMPLES, axis=1), cv2.INTER_LINEAR)
    return every.astype(np.float32, copy=False)


def _normals(view: View, s: Singles, n: Singles, heading: Singles) -> Singles:
    """Return the ground's normals (..., 3) in the world at (s, n) from the road's start; heading as there."""
    if view.road.is_flat:
        return np.broadcast_to(np.array([0, 1, 0], np.float32), (*s.shape, 3))
    climb_s, climb_n = view.road.slopes(s, n, view.course.position)
    sine, cosine = np.sin(heading), np.cos(heading)
    normal = np.stack(
        [-climb_s * sine - climb_n * cosine, np.ones_like(s), climb_n * sine - climb_s * cosine], axis=-1
    )
    return (normal / np.linalg.norm(normal, axis=-1, keepdims=True)).astype(np.float32)
