# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""From a line that runs along a rendered road to its label: the part that is seen, its places, its ground."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.scenes.surface import Surface
from lane_dp_ros.scenes.view import View

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]

AHEAD = 45.0  # [m] over which lines are given at most
STEP = 0.5  # [m] between their points
FITTED_DEPTHS = (5.0, 35.0)  # [m] over which the ground is fitted
BRIDGED = 12.0  # [m] without paint to be seen that one bridges: between a motorway's dashes there are so many
SHORT = 3.0  # [m] of a line that nobody is sure of


@dataclass(frozen=True)
class Places:
    """The places of a line before the camera, every 0.5 m: `s`, `aside` (N,) [m] along and across the road.

    `points` (N, 3) [m] in the left optical frame, `uv` (N, 2) [px].
    """

    s: Floats
    aside: Floats
    points: Floats
    uv: Floats

    @classmethod
    def of(cls, view: View, s: Floats, aside: Floats) -> Places:
        """Return the places at s ahead of the vehicle, `aside` right of the road's axis."""
        points = view.optical(view.course.points(s, aside))
        return cls(s, aside, points, view.camera.project(points))

    def pixels(self, view: View) -> tuple[Mask, NDArray[np.intp], NDArray[np.intp]]:
        """Return which places lie in the picture (N,), and their rows and columns; 0 for those outside."""
        inside = (self.points[:, 2] > 1) & np.all(
            (self.uv >= 0) & (self.uv <= np.array(view.size) - 1), axis=1
        )
        u, v = np.rint(np.where(inside[:, None], self.uv, 0)).astype(int).T
        return inside, v, u

    def unhidden(self, view: View, surface: Surface) -> Mask:
        """Return which places (N,) lie in the picture with nothing nearer before them."""
        inside, v, u = self.pixels(view)
        z = self.points[:, 2]
        row = z**2 / (view.camera.fy * view.road.camera_height)  # [m] of flat ground in a picture row
        return inside & (surface.depth[v, u] > z - 0.3 - 2 * row)


def steps_ahead() -> Floats:
    """Return the places s (N,) [m] ahead of the vehicle at which lines are looked at."""
    return np.asarray(np.arange(-1.0, AHEAD, STEP), dtype=np.float64)


def seen_part(
    s: Floats, there: Mask, in_sight: Mask, visible: Mask, gap: float = 0.0
) -> tuple[NDArray[np.intp], bool]:
    """Return which places of a line are labelled, and whether one is sure of them.

    `there` (N,) is where the line is, `in_sight` where nothing hides it, `visible` where it stands out; `gap`
    [m] is that between its dashes. One is sure of a line of which more than half can be seen over at least
    3 m. It is labelled as far as it is visible; one that is not sure, as far as it lies in sight.
    """
    part = _bridged_part(s, visible, gap)
    sure = bool(len(part) and visible[part].sum() > there[part].sum() / 2 and np.ptp(s[part]) >= SHORT)
    return (part if sure else _bridged_part(s, in_sight, gap)), sure


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


def exact(points: Floats) -> Floats:
    """Return every second of points (N, 3), N > 1, and the last, as far as their depth rises."""
    chosen = points[np.unique([*range(0, len(points), 2), len(points) - 1])]
    deepest = np.maximum.accumulate(chosen[:, 2])
    return chosen[np.append(True, chosen[1:, 2] > deepest[:-1])]


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
