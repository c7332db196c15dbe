# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Things that stand or drive on a rendered road: drawn into what a camera sees, and what they hide of it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lane_dp_ros.scenes.barriers import Grass, GuardRail, Posts
from lane_dp_ros.scenes.faces import Face, hides, see
from lane_dp_ros.scenes.layers import draw
from lane_dp_ros.scenes.structures import Bridge, Island
from lane_dp_ros.scenes.surface import Surface
from lane_dp_ros.scenes.vehicles import Vehicle
from lane_dp_ros.scenes.view import View

SceneObject = Vehicle | GuardRail | Grass | Posts | Island | Bridge

REACH = 150.0  # [m] ahead up to which things are drawn
NEAREST = 1.5  # [m] ahead of the camera: what ends before is out of the picture


def composite(surface: Surface, view: View, objects: tuple[SceneObject, ...]) -> None:
    """Draw objects into a surface, wherever they are nearer than what it holds.

    Where an object is drawn, `ground` becomes false and `paint` zero. They stand where they are
    at `view.time`.
    """
    for thing in things_in_sight(view, objects):
        draw(surface, view, thing)


def things_in_sight(view: View, objects: Sequence[SceneObject]) -> list[tuple[Face, ...]]:
    """Return the faces of each thing before the camera, the farthest thing first."""
    start = view.course.position + NEAREST
    reach = min(REACH, float(view.course.s[-1]) - NEAREST)
    things = [thing for item in at(objects, view.time) for thing in item.things(start, reach) if thing]
    return sorted(things, key=lambda thing: -min(float(face.corners[:, 0].min()) for face in thing))


def at(objects: Sequence[SceneObject], seconds: float) -> tuple[SceneObject, ...]:
    """Return the objects where they are after this time: vehicles have moved."""
    return tuple(item.at(seconds) if isinstance(item, Vehicle) else item for item in objects)


def hidden(view: View, objects: Sequence[SceneObject], points: ArrayLike) -> NDArray[np.bool_]:
    """Return which world points (N, 3), right, up, ahead [m], are hidden from a camera by objects, (N,)."""
    optical = view.optical(points)
    depth = np.maximum(optical[:, 2], 1e-3)
    pixels = np.column_stack([optical[:, :2] / depth[:, None], np.ones(len(depth))])
    pixels = pixels[:, :2] * (view.camera.fx, view.camera.fy) + (view.camera.cx, view.camera.cy)
    behind = np.zeros(len(depth), bool)
    for thing in things_in_sight(view, objects):
        for seen in see(view, thing):
            behind |= hides(seen, pixels, depth)
    return behind
