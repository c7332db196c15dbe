# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Where on the ground the sun shines: gaps between leaves, shadows of vehicles, rails, posts and bridges.

Everything is bound to the road, so that both cameras, and all frames, see the same shadows.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import cache
from itertools import pairwise

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.scenes.objects import NEAREST, SceneObject, at
from lane_dp_ros.scenes.structures import Bridge
from lane_dp_ros.scenes.surface import Surface
from lane_dp_ros.scenes.textures import Material, foliage, material, octave_noise
from lane_dp_ros.scenes.vehicles import Vehicle
from lane_dp_ros.scenes.view import View

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]

SHADOWS_AHEAD = 90.0  # [m] up to which single things throw shadows that are drawn
EDGE_STEP = 1.0  # [m] between points of a shadow's outline, which follows the road
GAPS_STORED = 4.0  # a share of light, 0 to 1, is stored as noise from -2 to 2
LEAF_SLANT = 0.4  # [m] along the road for each metre across it, by which the low sun draws out leaf shadows
DEPTH_SLACK = 1.0  # [m] by which the ground under a shadow may be nearer than its outline's nearest point
SHIFT = 4  # binary digits of a pixel in the outlines that OpenCV fills


def past_things(
    surface: Surface, view: View, objects: Sequence[SceneObject], towards_sun: Callable[[float], Floats]
) -> Singles:
    """Return the share (H, W) of sunlight that things on the road let through to the ground.

    `towards_sun` gives the direction (3,) to the sun, right, up, ahead, for a heading [rad].
    """
    start, reach = view.course.position - 20.0, SHADOWS_AHEAD + 20.0
    outlines = [outline for item in at(objects, view.time) for outline in item.outlines(start, reach)]
    headings = view.road.heading(np.array([outline[:, 0].mean() for outline in outlines]))
    suns = (towards_sun(float(heading)) for heading in headings)
    shadows = _mask(
        surface, view, (_thrown(outline, sun) for outline, sun in zip(outlines, suns, strict=True))
    )
    return np.where(surface.ground, 1 - shadows, np.float32(1))


def open_sky(surface: Surface, view: View, objects: Sequence[SceneObject]) -> Singles:
    """Return the share (H, W) of skylight that comes to the ground under vehicles and bridges."""
    covers = [item for item in at(objects, view.time) if isinstance(item, Vehicle | Bridge)]
    roofs = [roof for item in covers for roof in item.roofs()]
    if not roofs:
        return np.ones(view.shape, np.float32)
    dark = cv2.GaussianBlur(_mask(surface, view, (_widened(roof[:, :2]) for roof in roofs)), (0, 0), 2.0)
    return np.where(surface.ground, 1 - np.float32(0.75) * dark, np.float32(1))


def through_leaves(surface: Surface, view: View, across: tuple[float, float]) -> Singles:
    """Return the share (H, W) of sunlight that leaves let through to the road between `across` [m].

    The shade's borders are ragged, and here and there a tree is missing. What stands on the road is lit as
    if there were no trees.
    """
    share = np.ones(view.shape, np.float32)
    rows = np.flatnonzero(surface.ground.any(axis=1))
    if len(rows):
        part = slice(rows[0], rows[-1] + 1)
        leaves = _leaf_light(surface, view, part, across)
        share[part] = np.where(surface.ground[part], leaves, np.float32(1))
    return share


def _leaf_light(surface: Surface, view: View, rows: slice, across: tuple[float, float]) -> Singles:
    s, n = surface.s[rows], surface.n[rows]
    depth = np.where(surface.ground[rows], surface.depth[rows], np.inf).min(axis=1)
    length = np.clip(depth, 1, 300) ** 2 / (view.camera.fy * view.road.camera_height)
    shift = np.float32(37.3 * view.seed % 164)  # two seeds are two woods
    gaps = gaps_between_leaves().sample(s + n * np.float32(LEAF_SLANT) + shift, n, length)
    rough = foliage(s * 4, n * 4)
    border = np.minimum(n - np.float32(across[0]), np.float32(across[1]) - n) + np.float32(0.35) * rough
    missing = np.clip((1.5 - foliage(s * 0.35 + shift, n * 0.15)) * 3 + 0.4 * rough, 0, 1)
    shade = np.clip(border * 4, 0, 1) * missing
    return np.asarray(1 - shade * (1 - np.clip(gaps / GAPS_STORED + 0.5, 0, 1)), np.float32)


@cache
def gaps_between_leaves() -> Material:
    """Return the pattern of light under trees, 164 m long, 20 m wide: leaf gaps, branches, open patches."""
    rng = np.random.default_rng(8)
    crisp = octave_noise(rng, (4096, 1024), 1.08, 8)
    noise: Singles = np.asarray(cv2.GaussianBlur(crisp, (0, 0), 4.0, sigmaY=2.0), np.float32)
    _draw_boughs(noise, rng)
    gaps: Singles = np.clip((noise - 0.35) * 2.5, 0, 1).astype(np.float32)
    return material((gaps - 0.5) * GAPS_STORED, row_length=0.04, column_width=0.02)


def _draw_boughs(noise: Singles, rng: np.random.Generator) -> None:
    """Draw the shadows of trunks and boughs, mostly across the road."""
    for _ in range(70):
        foot = rng.uniform((0, 0), (1024, 4096))
        steps = rng.normal((70, 0), (30, 16), (9, 2)) * rng.choice([-1, 1])
        path = np.cumsum(np.vstack([foot, steps]), axis=0)
        cv2.polylines(noise, [path.astype(np.int32)], False, -2.0, int(rng.integers(2, 9)))


def _thrown(outline: Floats, sun: Floats) -> Floats:
    """Return the outline (N, 2) on the ground, (s, n), of the shadow of a convex outline (N, 3) above it."""
    right, up, ahead = sun
    fallen = outline[:, :2] - outline[:, 2:] * (ahead, right) / max(up, 0.05)
    return np.asarray(cv2.convexHull(fallen.astype(np.float32)), np.float64).reshape(-1, 2)


def _widened(outline: Floats) -> Floats:
    middle = outline.mean(axis=0)
    return middle + (outline - middle) * 1.05


def _mask(surface: Surface, view: View, outlines: Iterable[Floats]) -> Singles:
    """Return the share (H, W) of each pixel that lies within outlines (N, 2) on the ground, (s, n)."""
    mask = np.zeros(view.shape, np.uint8)
    for outline in outlines:
        points = _before(view, outline)
        if len(points) > 2:
            _fill(mask, surface, points[:, 2], np.clip(view.camera.project(points), -20_000, 20_000))
    return np.asarray(mask / np.float32(255), np.float32)


def _fill(mask: NDArray[np.uint8], surface: Surface, depth: Floats, pixels: Floats) -> None:
    """Fill an outline whose points have these depths; not where a crest of the road lies before it."""
    low = np.clip(np.floor(pixels.min(axis=0)).astype(int) - 1, 0, mask.shape[::-1])
    high = np.clip(np.ceil(pixels.max(axis=0)).astype(int) + 2, 0, mask.shape[::-1])
    if np.any(high <= low):
        return
    part = (slice(low[1], high[1]), slice(low[0], high[0]))
    inside = np.zeros(mask[part].shape, np.uint8)
    outline = np.rint((pixels - low) * 2**SHIFT).astype(np.int32)
    cv2.fillPoly(inside, [outline], 255, cv2.LINE_AA, SHIFT)
    inside[surface.depth[part] < depth.min() - DEPTH_SLACK] = 0
    np.maximum(mask[part], inside, out=mask[part])


def _before(view: View, outline: Floats) -> Floats:
    """Return what of an outline on the ground is before the camera (N, 3), in its optical frame."""
    s, n = _dense(outline).T
    near, far = NEAREST + 1.0, min(SHADOWS_AHEAD * 1.5, float(view.course.s[-1]))
    ahead = np.clip(s - view.course.position, near, far)
    points = view.optical(view.course.points(ahead, n))
    return points[points[:, 2] > 0.5] if np.ptp(ahead) > 0 else points[:0]


def _dense(outline: Floats) -> Floats:
    """Return an outline with points on its edges, for it follows the road."""
    closed = np.vstack([outline, outline[:1]])
    pieces = []
    for start, end in pairwise(closed):
        count = int(np.clip(np.linalg.norm(end - start) / EDGE_STEP, 1, 40))
        pieces.append(start + (end - start) * np.arange(count)[:, None] / count)
    return np.vstack(pieces)
