# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What the road mirrors: the sun and lamps on asphalt, and on a wet road all that stands behind it.

It depends on where the camera is, so that both cameras see it a little differently, as they do.
"""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.scenes.layers import draw
from lane_dp_ros.scenes.objects import SceneObject, things_in_sight
from lane_dp_ros.scenes.surface import Surface
from lane_dp_ros.scenes.textures import foliage
from lane_dp_ros.scenes.view import View

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]

F0 = 0.04  # share that asphalt and water mirror when looked at from straight above
STEEPEST = 0.03  # the sine of the least angle at which the road is seen or lit
MIRRORED = 70.0  # [m] from the mirroring place to the woods and trees that it shows
WET_BLUR = 1.6  # [px] sigma across of what a wet road mirrors
NEAREST_LAMP = 0.4  # [m^2] no road is nearer to a lamp
COARSE = 3  # glints, which are smooth, are worked out for every third row and column only
PAINT_GLOSS, GRASS_GLOSS = 0.45, 0.1  # of the asphalt's


def sun_glint(surface: Surface, view: View, rows: slice, towards: Singles, roughness: float) -> Singles:
    """Return the share of sunlight that rows (h, W) of the road mirror to the camera.

    `towards` (3,) is the direction to the sun, `roughness` the mean slope of the road's facets.
    """
    share = _lobe(_coarse(view.rays[rows]), towards, roughness)
    return _fine(share, view, rows) * _polish(surface, view, rows)


def lamp_glint(surface: Surface, view: View, rows: slice, lamp: Singles, roughness: float) -> Singles:
    """Return the share of the light, 1 m before a lamp at (3,) [m], that rows (h, W) mirror to the camera."""
    way = lamp - _coarse(surface.position[rows])
    squared = np.maximum(np.sum(way * way, axis=-1), NEAREST_LAMP)
    share = _lobe(_coarse(view.rays[rows]), way / np.sqrt(squared)[..., None], roughness) / squared
    return _fine(share, view, rows) * _polish(surface, view, rows)


def _lobe(rays: Singles, towards: Singles, roughness: float) -> Singles:
    """Return the share of light from a direction that asphalt mirrors back along rays (Beckmann)."""
    back = -rays / np.linalg.norm(rays, axis=-1, keepdims=True)
    seen_up, lit_up = np.maximum(back[..., 1], STEEPEST), np.maximum(towards[..., 1], STEEPEST)
    between = np.sum(back * towards, axis=-1)
    squared = (seen_up + lit_up) ** 2 / np.maximum(2 + 2 * between, 1e-4)  # cosine^2 of the facet's slope
    squared = np.clip(squared, 1e-3, 1)
    spread = np.float32(roughness**2)
    lobe = np.exp((1 - 1 / squared) / spread) / (np.float32(np.pi) * spread * squared**2)
    return np.asarray(_fresnel(np.sqrt(np.clip((1 + between) / 2, 0, 1))) * lobe / (4 * seen_up), np.float32)


def _coarse(plane: Singles) -> Singles:
    return plane[::COARSE, ::COARSE]


def _fine(coarse: Singles, view: View, rows: slice) -> Singles:
    """Return what was worked out for some pixels, for all of them (h, W)."""
    size = (view.shape[1], rows.stop - rows.start)
    return np.asarray(cv2.resize(coarse, size, interpolation=cv2.INTER_LINEAR), np.float32)


def mirror(
    surface: Surface,
    view: View,
    light: Singles,
    objects: Sequence[SceneObject],
    wetness: float,
    streak: float,
) -> None:
    """Lay over the light (H, W, 3) what a wet road mirrors; `wetness` 0 to 1: damp to flooded.

    A wet road is no mirror: its grain draws out what it shows downwards, over a sigma of `streak` [px].
    """
    rows = ground_rows(surface)
    if rows.stop <= rows.start:
        return
    up = -view.rays[rows][..., 1] / np.linalg.norm(view.rays[rows], axis=-1)
    share = _fresnel(np.maximum(up, STEEPEST)) * _puddles(surface, rows, wetness)
    share = np.where(_on_asphalt(surface, view, rows), share, 0)[..., None]
    image = _with_mirrored_things(view, rows, objects, _distant(surface, view, rows, light))
    light[rows] += share * (cv2.GaussianBlur(image, (0, 0), WET_BLUR, sigmaY=streak) - light[rows])


def ground_rows(surface: Surface) -> slice:
    """Return the rows from the first to the last that sees any ground."""
    rows = np.flatnonzero(surface.ground.any(axis=1))
    return slice(int(rows[0]), int(rows[-1]) + 1) if len(rows) else slice(0, 0)


def _fresnel(cosine: Singles) -> Singles:
    """Return the share that is mirrored at this angle of incidence (Schlick)."""
    return np.asarray(F0 + (1 - F0) * (1 - cosine) ** 5, np.float32)


def _polish(surface: Surface, view: View, rows: slice) -> Singles:
    """Return how glossy each place is: the asphalt's stones more than what lies between, paint less."""
    grey = surface.albedo[rows][..., 1]
    stones = np.clip(grey / 0.19, 0.4, 1.8)
    paint = np.clip(surface.paint[rows], 0, 1)
    return np.asarray(
        np.where(_on_asphalt(surface, view, rows), stones * (1 - paint) + PAINT_GLOSS * paint, GRASS_GLOSS),
        np.float32,
    )


def _on_asphalt(surface: Surface, view: View, rows: slice) -> NDArray[np.bool_]:
    left, right = view.road.borders
    return np.asarray(surface.ground[rows] & (surface.n[rows] > left) & (surface.n[rows] < right))


def _puddles(surface: Surface, rows: slice, wetness: float) -> Singles:
    """Return how much water stands on the road (h, W), 0 to 1: it lies in patches, longer than wide."""
    patches = foliage(surface.s[rows] * 2.2, surface.n[rows] * 5.0)
    return np.asarray(np.clip(1.5 * wetness - 0.35 + 0.35 * patches, 0, 1), np.float32)


def _distant(surface: Surface, view: View, rows: slice, light: Singles) -> Singles:
    """Return what each of the rows mirrors of sky, woods and trees (h, W, 3), found in the picture itself."""
    ray = view.rays[rows]
    place = np.where(surface.ground[rows][..., None], surface.position[rows], 0)
    mirrored = place + ray * np.array([1, -1, 1], np.float32) * np.float32(MIRRORED)
    optical = (mirrored - view.origin.astype(np.float32)) @ view.axes.T.astype(np.float32)
    depth = np.maximum(optical[..., 2], 1)
    u = optical[..., 0] / depth * np.float32(view.camera.fx) + np.float32(view.camera.cx)
    v = optical[..., 1] / depth * np.float32(view.camera.fy) + np.float32(view.camera.cy)
    return np.asarray(cv2.remap(light, u, v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE), np.float32)


def _with_mirrored_things(view: View, rows: slice, objects: Sequence[SceneObject], image: Singles) -> Singles:
    """Return the mirrored picture of the rows with vehicles and all else that stands on the road."""
    below = Surface.empty(view.shape)
    for thing in things_in_sight(view, objects):
        draw(below, view, [face.mirrored() for face in thing])
    there = np.isfinite(below.depth[rows])[..., None]
    return np.where(there, 0.45 * below.albedo[rows] + below.lamps[rows], image).astype(np.float32)
