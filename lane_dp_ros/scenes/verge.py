# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Trees, bushes, poles and delineator posts on the verges of a rendered road."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.scenes import textures
from lane_dp_ros.scenes.course import Course
from lane_dp_ros.scenes.surface import Surface
from lane_dp_ros.scenes.view import View

Singles = NDArray[np.float32]

PLANT_CELL = 5.0  # [m] of verge with at most one tree, bush or pole
POST_CELL = 25.0  # [m] between delineator posts
POST, POLE = (0.5, 1.05), (2.2, 8.0)  # [m] from the asphalt, and high
NEAREST = 4.0  # [m] ahead: what is nearer is out of the picture
FACING = np.array([0, 0.5, -0.87], np.float32)  # the way leaves look, mostly up and towards the camera


@dataclass(frozen=True)
class Thing:
    """A cut-out that stands at `foot` (3,) [m] in the world, `width` by `height` [m], facing the camera."""

    foot: NDArray[np.float64]
    width: float
    height: float
    cut_out: textures.CutOut


def draw_verges(surface: Surface, view: View) -> None:
    """Draw what stands on both verges into a surface that holds sky and ground."""
    for thing in sorted(things_ahead(view.course, view.seed), key=lambda thing: -float(thing.foot[2])):
        _stand_up(surface, view, thing)


def things_ahead(course: Course, seed: int) -> list[Thing]:
    """Return the things on both verges that the vehicle has before it."""
    things = []
    plant = {"fields": _plant, "forest": _forest_plant, "town": _street_furniture}[course.road.verge]
    for side in (-1, 1):
        if course.road.verge != "town":
            posts = (i * POST_CELL for i in _cells(course, POST_CELL))
            things += [_thing(course, s, side, POST, textures.post()) for s in posts]
        for i in _cells(course, PLANT_CELL):
            rng = np.random.default_rng([seed, 2 + (side > 0), i])
            things += plant(course, i * PLANT_CELL, side, rng)
    return [thing for thing in things if thing.foot[2] > NEAREST]


def _cells(course: Course, length: float) -> range:
    """Return the numbers of the stretches of this length that lie ahead, counted from the road's start."""
    return range(int(np.ceil(course.position / length)), int((course.position + course.s[-1]) / length))


def _plant(course: Course, s: float, side: int, rng: np.random.Generator) -> list[Thing]:
    """Return a tree, a bush or a pole somewhere in a cell of the verge, or nothing."""
    kind, along, beside, large = rng.uniform(size=4)
    if kind < 0.45:
        size, cut_outs = (5 + 14 * beside, 5 + 6 * large), textures.trees()
    elif kind < 0.75:
        size, cut_outs = (3 + 9 * beside, 1 + 1.6 * large), textures.bushes()
    elif kind < 0.80:
        size, cut_outs = POLE, (textures.pole(),)
    else:
        return []
    cut_out = cut_outs[rng.integers(len(cut_outs))]
    return [_thing(course, s + along * PLANT_CELL, side, size, cut_out)]


def _forest_plant(course: Course, s: float, side: int, rng: np.random.Generator) -> list[Thing]:
    """Return a tree or a bush before the forest's edge, or nothing."""
    kind, along, beside, large = rng.uniform(size=4)
    if kind > 0.75:
        return []
    cut_outs = textures.trees() if kind < 0.4 else textures.bushes()
    size = (4.5 + 3 * beside, 6 + 6 * large) if kind < 0.4 else (3 + 4 * beside, 1 + 1.8 * large)
    return [_thing(course, s + along * PLANT_CELL, side, size, cut_outs[rng.integers(len(cut_outs))])]


def _street_furniture(course: Course, s: float, side: int, rng: np.random.Generator) -> list[Thing]:
    """Return a street tree or a lamp's pole on the pavement, or nothing."""
    kind, large = rng.uniform(size=2)
    if kind > 0.3:
        return []
    if kind < 0.18:
        return [_thing(course, s, side, (1.2, 4.5 + 2.5 * large), textures.trees()[rng.integers(6)])]
    return [_thing(course, s, side, (0.5, 6.5), textures.pole())]


def _thing(course: Course, s: float, side: int, size: tuple[float, float], cut_out: textures.CutOut) -> Thing:
    """Stand a thing at s (from the road's start): `size` is its distance from the asphalt and its height."""
    distance, height = size
    border = course.road.borders[side > 0]
    foot = course.points(s - course.position, border + side * distance)[0]
    rows, columns = cut_out.pyramid[0].shape[:2]
    return Thing(foot, height * columns / rows, height, cut_out)


def _stand_up(surface: Surface, view: View, thing: Thing) -> None:
    """Draw a thing over what is farther away, through the homography of its upright plane."""
    across, up = thing.width / 2 * view.axes[0], np.array([0, thing.height, 0])
    corners = view.pixels(thing.foot + np.array([up - across, up + across, across, -across]))
    low = np.maximum(np.floor(corners.min(axis=0)).astype(int) - 1, 0)
    high = np.minimum(np.ceil(corners.max(axis=0)).astype(int) + 2, view.size)
    if np.any(high <= low):
        return
    picture = thing.cut_out.at_width(float(np.ptp(corners[:, 0])))
    rows, columns = picture.shape[:2]
    source = np.array([[0, 0], [columns, 0], [columns, rows], [0, rows]]) - 0.5  # a texel's centre is whole
    H = cv2.getPerspectiveTransform(source.astype(np.float32), (corners - low).astype(np.float32))
    size = tuple(int(n) for n in high - low)
    drawn = cv2.warpPerspective(picture, H, size, flags=cv2.INTER_LINEAR).astype(np.float32) / np.float32(255)
    _cover(surface, view, (slice(low[1], high[1]), slice(low[0], high[0])), drawn, thing)


def _cover(surface: Surface, view: View, part: tuple[slice, slice], drawn: Singles, thing: Thing) -> None:
    """Lay a drawn thing, BGR times opacity and opacity (rows, columns, 4), over part of a surface."""
    depth = float(view.optical(thing.foot)[2])
    opacity = drawn[..., 3:] * (surface.depth[part] > depth)[..., None]
    lit: Singles = np.square(drawn[..., :3] / np.maximum(drawn[..., 3:], 1e-3))
    for layer, value in ((surface.albedo, lit), (surface.emission, np.float32(0))):
        layer[part] += opacity * (value - layer[part])
    solid = opacity[..., 0] > 0.5
    surface.depth[part][solid] = depth
    surface.position[part][solid] = view.origin + view.rays[part][solid] * depth
    surface.normal[part][solid] = FACING
    surface.ground[part][solid] = False
    surface.paint[part] *= 1 - opacity[..., 0]
