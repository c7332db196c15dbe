# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What closes the view to both sides of a rendered road: the edge of a forest, the fronts of houses.

They are part of the ground's heightfield, so that they hide one another and what is behind as hills do.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.scenes.paint import striped
from lane_dp_ros.scenes.surface import Surface
from lane_dp_ros.scenes.textures import foliage_at
from lane_dp_ros.scenes.view import View
from lane_dp_ros.scenes.wall_shapes import BLOCK, STOREY, houses

Singles = NDArray[np.float32]

LOWEST = 0.1  # [m] over the ground, from where on it is a wall
BAY, BAYS = 3.4, 4  # [m] between windows along the road, and how many of them a house has
WINDOW = (1.5, 1.3)  # [m] high, wide
FRAME, PLINTH = 0.12, 0.7  # [m] wide, high
PLASTER = np.array(
    [(186, 206, 214), (150, 158, 160), (96, 112, 150), (140, 178, 196), (205, 208, 206), (110, 130, 140)],
    np.float32,
)  # grey levels BGR, as all colours here
ROOF = np.array([62, 66, 104], np.float32)
WHITE = np.array([188, 190, 190], np.float32)
GLASS = np.array([62, 56, 50], np.float32)
LEAVES_LEAN = 0.75  # of the normals of leaves, upwards
LEAVES_DARK, LEAVES_LIGHT = np.array([22, 34, 30], np.float32), np.array([66, 118, 104], np.float32)


def draw_walls(surface: Surface, view: View) -> None:
    """Colour the walls in a surface whose heightfield is laid out, and take them off its ground."""
    road = view.road
    if road.verge == "fields":
        return
    left, right = road.borders
    beside = np.nonzero(surface.ground & ((surface.n < left) | (surface.n > right)))
    level = road.level(surface.s[beside], surface.n[beside], view.course.position) + road.kerb
    above = (surface.position[..., 1][beside] - level).astype(np.float32)
    stands = above > LOWEST
    where, up = (beside[0][stands], beside[1][stands]), above[stands]
    painted = _forest(surface, where, up) if road.verge == "forest" else _fronts(surface, view, where, up)
    surface.albedo[where] = np.square(painted / 255)
    surface.emission[where] = 0
    surface.normal[where] = _towards_road(surface, view, where)
    surface.ground[where] = False


def _towards_road(surface: Surface, view: View, where: tuple[NDArray[np.intp], ...]) -> Singles:
    sine, cosine = view.course.direction(surface.s[where] - np.float32(view.course.position))
    side = -np.sign(surface.n[where])
    lean = np.float32(LEAVES_LEAN if view.road.verge == "forest" else 0)
    flat = np.sqrt(1 - lean * lean)
    return np.stack([flat * side * cosine, np.full_like(side, lean), -flat * side * sine], axis=-1).astype(
        np.float32
    )


def _forest(surface: Surface, where: tuple[NDArray[np.intp], ...], up: Singles) -> Singles:
    """Return the colour (N, 3) of the forest's edge: crowns over a dark foot."""
    s = surface.s[where] - np.abs(surface.n[where])  # a wall may run along the road or across
    light = 0.5 + 0.4 * foliage_at(s * 1.3, -up * 4) + 0.28 * foliage_at(s * 6, -up * 17)
    light *= np.clip(0.3 + 0.12 * up, 0, 1)
    colour = LEAVES_DARK + (LEAVES_LIGHT - LEAVES_DARK) * np.clip(light, 0, 1.3)[:, None]
    return colour.astype(np.float32)


def _fronts(surface: Surface, view: View, where: tuple[NDArray[np.intp], ...], up: Singles) -> Singles:
    """Return the colour (N, 3) of the fronts of houses: plaster, windows, roofs; hedges between them."""
    s, n, depth = surface.s[where], surface.n[where], surface.depth[where]
    _, height, tint = houses(s, np.sign(n))
    across = up > height + 0.5  # the wall of the next house, seen over this place's hedge or roof
    tint = np.where(across, houses(s + BLOCK / 2, np.sign(n))[2], tint)
    reach_up = depth / np.float32(view.camera.fy)
    reach_s = depth * depth / (np.float32(view.camera.fx) * np.maximum(np.abs(n), 3))
    reach = reach_s.astype(np.float32), reach_up.astype(np.float32)
    glass = _windows(s, up, reach, 0.0)
    frame = _windows(s, up, reach, FRAME)
    roof = np.clip((up - height + 2.6) / np.maximum(reach_up, 0.05), 0, 1)
    dirt = 1 + 0.04 * foliage_at((s - np.abs(n)) * 3, up * 3)
    colour = PLASTER[tint] * (dirt * np.clip(0.86 + 0.03 * up, 0, 1.05))[:, None]
    colour *= np.where(up < PLINTH, np.float32(0.72), 1)[:, None]
    for cover, paint in ((frame, WHITE), (glass, GLASS)):
        colour += (cover * (roof < 1) * ~across)[:, None] * (paint - colour)
    colour += (roof * ~across)[:, None] * (ROOF * dirt[:, None] - colour)
    hedge = ((height < 3) & ~across)[:, None]
    return np.where(hedge, _forest(surface, where, up + 3), colour).astype(np.float32)


def _windows(s: Singles, up: Singles, reach: tuple[Singles, Singles], wider: float) -> Singles:
    """Return the share (N,) of windows, each side of them `wider` [m]."""
    high, wide = (np.float32(size + 2 * wider) for size in WINDOW)
    sill, jamb = np.float32(0.9 - wider), np.float32(1.0 - wider)
    share = striped(up - sill, reach[1], float(high), float(STOREY - high))
    place = (s - np.floor(s / np.float32(BLOCK)) * np.float32(BLOCK)).astype(np.float32)
    inside = place < BAYS * BAY
    return share * inside * striped(place - jamb, reach[0], float(wide), float(BAY - wide))
