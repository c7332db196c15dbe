# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The lane lines of a rendered scene as a careful person would label them, but exact."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.scenes.road import Line
from lane_dp_ros.scenes.surface import Surface
from lane_dp_ros.scenes.view import View
from lane_dp_ros.scenes.visibility import visible_paint
from lane_dp_ros.tools.evaluation.annotations import Kind, Label

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]

AHEAD = 45.0  # [m] over which lines are given at most
STEP = 0.5  # [m] between their points
FITTED_DEPTHS = (5.0, 35.0)  # [m] over which the ground is fitted
PAINT_SEEN = 0.3  # share of the paint of a whole line that must be left for it to be seen
BRIDGED = 12.0  # [m] without paint to be seen that one bridges: between a motorway's dashes there are so many
SHORT = 3.0  # [m] of a line that nobody is sure of
EGO_BEGINS = 15.0  # [m] ahead by which a line beside the vehicle must have begun
EGO_AT = 8.0  # [m] ahead where the lines beside the vehicle are told


@dataclass(frozen=True)
class _Seen:
    """The part of a line that is seen: s [m] ahead, n [m] at EGO_AT or where it begins, its label."""

    begins: float
    beside: float
    label: Label


def lane_labels(
    view: View, surface: Surface, image: NDArray[np.uint8]
) -> tuple[tuple[Label, ...], list[str | None]]:
    """Return the labels of the lines that the left camera sees, and the ids left and right of the vehicle.

    `image` (H, W, 3) BGR is the left picture, `surface` what it shows. Lines end where their paint does, at
    the picture's border, and where they are hidden or no longer stand out from the road. A line of which less
    than half can be seen is not sure; one that cannot be seen at all is given as far as it lies in sight.
    """
    ground = fitted_ground(view, surface)
    every = (_seen(view, surface, image, i, ground) for i in range(len(view.road.placed_lines)))
    seen = [line for line in every if line]
    beside = [line for line in seen if line.begins < EGO_BEGINS]
    left = max((line for line in beside if line.beside < 0), key=lambda line: line.beside, default=None)
    right = min((line for line in beside if line.beside >= 0), key=lambda line: line.beside, default=None)
    return tuple(line.label for line in seen), [line.label.id if line else None for line in (left, right)]


def fitted_ground(view: View, surface: Surface) -> Floats:
    """Return g (4,) of the road's true disparity g0 + g1 n + g2 n^2 + g3 m, as the truth format has it."""
    left, right = view.road.borders
    low, high = FITTED_DEPTHS
    part = np.s_[::4, ::8]
    road = surface.ground & (surface.n > left) & (surface.n < right)
    v, u = np.nonzero(road[part] & (surface.depth[part] > low) & (surface.depth[part] < high))
    camera = view.camera
    n, m = (v * 4 - camera.cy) / 100, (u * 8 - camera.cx) / 100
    disparity = camera.fx * camera.baseline / surface.depth[part][v, u].astype(np.float64)
    columns = np.column_stack([np.ones_like(n), n, n**2, m])
    return np.round(np.linalg.lstsq(columns, disparity, rcond=None)[0], 7)


def on_ground(uv: Floats, ground: Floats, camera: StereoCamera) -> Floats:
    """Return (x, z) (M, 2) [m] of pixels (N, 2) on a fitted ground, as far as z rises."""
    n, m = (uv[:, 1] - camera.cy) / 100, (uv[:, 0] - camera.cx) / 100
    disparity = np.column_stack([np.ones_like(n), n, n**2, m]) @ ground
    below = disparity > 1e-6
    z = camera.fx * camera.baseline / disparity[below]
    xz = np.column_stack([(uv[below, 0] - camera.cx) * z / camera.fx, z])
    return xz[z >= np.maximum.accumulate(z)] if len(z) else xz


def _seen(
    view: View, surface: Surface, image: NDArray[np.uint8], number: int, ground: Floats
) -> _Seen | None:
    n, line = view.road.placed_lines[number]
    s = np.asarray(np.arange(-1.0, AHEAD, STEP), dtype=np.float64)
    along = s + view.course.position
    aside = n + line.aside(along)
    points = view.optical(view.course.points(s, aside))
    uv = view.camera.project(points)
    painted = line.is_painted(along)
    in_sight = painted & _is_in_sight(view, surface, points, uv, line)
    visible = visible_paint(image, view, (n, line), s, in_sight)
    gap = line.gap if line.painted == "dashed" else 0.0
    part = _bridged_part(s, visible, gap)
    sure = bool(len(part) and visible[part].sum() > painted[part].sum() / 2 and np.ptp(s[part]) >= SHORT)
    part = part if sure else _bridged_part(s, in_sight, gap)
    xz = on_ground(uv[part], ground, view.camera)
    if len(xz) < 2:
        return None
    kind: Kind = "dashed" if line.painted == "dashed" else "solid"
    begins = float(s[part][0])
    beside = float(np.interp(max(EGO_AT, begins), s, aside)) - view.pose.lateral
    return _Seen(begins, beside, Label(f"line{number}", kind, sure, uv[part], xz, _exact(points[part])))


def _exact(points: Floats) -> Floats:
    """Return every second of points (N, 3), N > 1, and the last, as far as their depth rises."""
    chosen = points[np.unique([*range(0, len(points), 2), len(points) - 1])]
    deepest = np.maximum.accumulate(chosen[:, 2])
    return chosen[np.append(True, chosen[1:, 2] > deepest[:-1])]


def _is_in_sight(view: View, surface: Surface, points: Floats, uv: Floats, line: Line) -> Mask:
    """Return which points (N, 3) of a line lie in the picture, before nothing, with paint on them."""
    z = points[:, 2]
    inside = (z > 1) & np.all((uv >= 0) & (uv <= np.array(view.size) - 1), axis=1)
    u, v = np.rint(np.where(inside[:, None], uv, 0)).astype(int).T
    row = z**2 / (view.camera.fy * view.road.camera_height)  # [m] of flat ground in a picture row
    in_front = surface.depth[v, u] > z - 0.3 - 2 * row
    paint = cv2.dilate(surface.paint, np.ones((5, 3), np.uint8))
    whole = np.minimum(1, view.camera.fx * line.width / np.maximum(z, 1))
    return inside & in_front & (paint[v, u] > PAINT_SEEN * whole)


def _bridged_part(s: Floats, visible: Mask, gap: float) -> NDArray[np.intp]:
    """Return the places from the first to the last that are visible, the nearest piece that is not short.

    Pieces are apart by more than one bridges; without a long one the longest, without any no places.
    """
    seen = np.flatnonzero(visible)
    if len(seen) < 2:
        return seen[:0]
    far_apart = np.diff(s[seen]) > max(BRIDGED, gap) + 2 * STEP
    pieces = np.split(seen, np.flatnonzero(far_apart) + 1)
    long = [piece for piece in pieces if np.ptp(s[piece]) >= SHORT]
    chosen = long[0] if long else max(pieces, key=len)
    return np.arange(chosen[0], chosen[-1] + 1)
