# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The ground of a rendered scene: asphalt with its paint, and the grass beside it.

Every pixel's ray is cut with the ground, and the place it hits is expressed along and across the road,
(s, n). What is seen there depends on (s, n) alone, so that both cameras, and every frame, see one world.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.scenes import textures
from lane_dp_ros.scenes.course import HAZE_DISTANCE
from lane_dp_ros.scenes.heightfield import lay_out
from lane_dp_ros.scenes.paint import draw_covers, draw_paint, striped
from lane_dp_ros.scenes.road import Road
from lane_dp_ros.scenes.surface import Footprint, Surface
from lane_dp_ros.scenes.view import View
from lane_dp_ros.scenes.walls import draw_walls

Singles = NDArray[np.float32]

ASPHALT_TINT = np.array([1.0, 0.99, 0.97], np.float32)  # BGR, as all colours here
GRASS_DARK = np.array([40, 76, 64], np.float32)
GRASS_LIGHT = np.array([88, 142, 138], np.float32)
STRAW = np.array([104, 160, 186], np.float32)
SNOW = np.array([224, 220, 216], np.float32)
KERB_STONE = np.array([150, 156, 158], np.float32)
SLABS = np.array([118, 124, 128], np.float32)
KERB_WIDTH, PAVEMENT_WIDTH, TOWN_PAVEMENT_WIDTH = 0.16, 2.2, 3.4  # [m]
STONE_LENGTH, SLAB_LENGTH, JOINT = 1.0, 0.5, 0.012  # [m]


def draw_ground(surface: Surface, view: View) -> None:
    """Draw the ground, and what closes it to both sides, into a surface that holds the sky."""
    lay_out(surface, view)
    draw_walls(surface, view)
    if not surface.ground.any():
        return
    rows = slice(int(surface.ground.any(axis=1).argmax()), None)
    ground = _footprint(surface, view, rows)
    world = np.random.default_rng([view.seed, 0])
    shift = world.uniform(0, 1000)  # two seeds are two roads
    place = ground.s + np.float32(shift)
    grain = textures.asphalt().sample(place, ground.n, ground.row_length)
    tufts = textures.grass().sample(place, ground.n, ground.row_length)
    albedo = np.square(_asphalt(view.road, ground, grain, place) / 255)
    paint = draw_paint(albedo, view.road, ground, grain)
    on_road = _asphalt_share(view.road, ground, tufts)
    beside = _beside(view.road, ground, tufts, dryness=float(world.uniform(-0.35, 0.45)))
    albedo += (1 - on_road[..., None]) * (np.square(beside / 255) - albedo)
    paint *= on_road * draw_covers(albedo, view.road, ground, grain)
    seen = surface.ground[rows]
    np.copyto(surface.albedo[rows], albedo, where=seen[..., None])
    np.copyto(surface.emission[rows], np.float32(0), where=seen[..., None])
    np.copyto(surface.paint[rows], paint, where=seen)


def _footprint(surface: Surface, view: View, rows: slice) -> Footprint:
    rays, s, n = view.rays[rows], surface.s[rows], surface.n[rows]
    depth = np.minimum(surface.depth[rows], np.float32(HAZE_DISTANCE))
    steep = np.maximum(-np.einsum("hwi,hwi->hw", rays, surface.normal[rows]), 1e-4)
    width = depth / np.float32(view.camera.fx)
    length = depth * np.einsum("hwi,hwi->hw", rays, rays) / (np.float32(view.camera.fy) * steep)
    sine, cosine = view.course.direction(s - np.float32(view.course.position))
    level = np.hypot(rays[..., 0], rays[..., 2])
    along = np.abs(rays[..., 0] * sine + rays[..., 2] * cosine) / level
    across = np.abs(rays[..., 0] * cosine - rays[..., 2] * sine) / level
    return Footprint(
        s, n, length * along + width * across, length * across + width * along, np.median(length, axis=1)
    )


def _asphalt(road: Road, ground: Footprint, grain: Singles, place: Singles) -> Singles:
    """Return the colour (rows, W, 3) of the road: grain, stains, wheel tracks."""
    stains = textures.foliage(place * 3, ground.n * 6)  # texels of 0.33 m by 0.17 m
    grey = road.asphalt * (1 + 0.17 * grain + 0.035 * stains) * _wheel_tracks(road, ground.n)
    return (grey[..., None] * ASPHALT_TINT).astype(np.float32, copy=False)


def _wheel_tracks(road: Road, n: Singles) -> Singles:
    """Return the factor by which wheels have darkened the asphalt: two tracks a lane."""
    middles = (road.offsets[1:] + road.offsets[:-1]) / 2
    tracks = (middles[:, None] + [-0.8, 0.8]).ravel()
    table_n = np.linspace(-20, 20, 801)
    wear = np.exp(-0.5 * ((table_n[:, None] - tracks) / 0.28) ** 2).sum(axis=1)
    index = np.clip(np.rint((n + 20) * 20), 0, 800).astype(np.int32)
    return (1 - 0.09 * wear).astype(np.float32)[index]


def _asphalt_share(road: Road, ground: Footprint, tufts: Singles) -> Singles:
    """Return the share of each pixel that is asphalt; without a kerb its border is ragged with tufts."""
    left, right = road.borders
    inside = np.minimum(ground.n - left, right - ground.n)
    if not road.kerb:
        waves = textures.foliage(ground.s * 14, np.sign(ground.n) * 50) if road.overgrowth > 0.1 else 0
        inside -= np.float32(road.overgrowth) * (tufts + waves)
    return np.clip(0.5 + inside / np.maximum(ground.reach_n, 0.02), 0, 1).astype(np.float32)


def _beside(road: Road, ground: Footprint, tufts: Singles, dryness: float) -> Singles:
    """Return the colour (rows, W, 3) beside the asphalt: kerb, pavement, grass."""
    colour = _grass(tufts, ground, dryness)
    if road.snow:
        lying = np.clip(road.snow + 0.25 * tufts, 0, 1)[..., None]
        colour += lying * (SNOW * (1 + 0.03 * tufts[..., None]) - colour)
    if not road.kerb:
        return colour
    left, right = road.borders
    beyond = np.maximum(left - ground.n, ground.n - right)
    sharp = np.maximum(ground.reach_n, 0.02)
    for stone, width, length in (
        (SLABS, PAVEMENT_WIDTH if road.verge == "fields" else TOWN_PAVEMENT_WIDTH, SLAB_LENGTH),
        (KERB_STONE, KERB_WIDTH, STONE_LENGTH),
    ):
        cover = np.clip(0.5 + (width - beyond) / sharp, 0, 1)[..., None]
        joints = 1 - 0.35 * striped(ground.s, ground.reach_s, JOINT, length - JOINT)
        if width > length:
            joints *= 1 - 0.35 * striped(ground.n, ground.reach_n, JOINT, length - JOINT)
        colour += cover * (stone * (joints * (1 + 0.06 * tufts))[..., None] - colour)
    return colour


def _grass(tufts: Singles, ground: Footprint, dryness: float) -> Singles:
    """Return the colour (rows, W, 3) of the verge: tufts, and wide patches that are drier."""
    dry = textures.foliage(ground.s * 8, ground.n * 8)  # texels of 0.125 m
    blend = np.clip(0.45 + dryness / 2 + 0.20 * tufts + 0.16 * dry, 0, 1.3)[..., None]
    light = GRASS_LIGHT + np.float32(max(dryness, 0)) * (STRAW - GRASS_LIGHT)
    return GRASS_DARK + (light - GRASS_DARK) * blend
