# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The lines, strips and marks of a rendered road: how much of each pixel they cover, in which colour."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.scenes.road import Colour, Line, Mark, Road
from lane_dp_ros.scenes.surface import Footprint
from lane_dp_ros.scenes.textures import foliage_at

Singles = NDArray[np.float32]

COLOURS = {  # linear, BGR
    name: np.square(np.array(grey, np.float32) / 255)
    for name, grey in {
        "white": (218, 218, 217),
        "yellow": (70, 172, 214),
        "tar": (52, 51, 50),
        "steel": (164, 162, 158),
        "concrete": (140, 144, 146),
        "patch": (80, 79, 78),
    }.items()
}


RAGGED_TEXEL = 0.2  # [m] along the road of the noise by which borders are ragged


def draw_paint(albedo: Singles, road: Road, ground: Footprint, grain: Singles) -> Singles:
    """Draw all that lies flat on a road over its asphalt (rows, W, 3).

    Returns the share (rows, W) of each pixel that paint of lane lines covers.
    """
    for n, strip in road.strips:
        _draw_line(albedo, n, strip, ground, grain)
    for mark in road.marks:
        _draw_mark(albedo, mark, ground, grain)
    total = np.zeros_like(ground.s)
    for n, line in road.placed_lines:
        where, cover = _draw_line(albedo, n, line, ground, grain)
        total[where] = np.maximum(total[where], cover)
    return total


def draw_covers(albedo: Singles, road: Road, ground: Footprint, grain: Singles) -> Singles:
    """Draw what lies over a road, its paint and its verge (rows, W, 3).

    Returns the share (rows, W) of each pixel that is left bare.
    """
    bare = np.ones_like(ground.s)
    for n, line in road.covers:
        where, cover = _draw_line(albedo, n, line, ground, grain)
        bare[where] *= 1 - cover
    return bare


def share(summed: Callable[[Singles], Singles], place: Singles, reach: Singles) -> Singles:
    """Return the mean, over `reach` about `place`, of a cover whose running sum is `summed`."""
    half = reach / np.float32(2)
    return ((summed(place + half) - summed(place - half)) / reach).astype(np.float32)


def striped(place: Singles, reach: Singles, stripe: float, gap: float) -> Singles:
    """Return the share of stripes that come every `stripe` + `gap` [m]."""

    def painted(s: Singles) -> Singles:
        """Return how many metres of [0, s] are painted."""
        whole = np.floor(s / (stripe + gap))
        return whole * stripe + np.minimum(s - whole * (stripe + gap), stripe)

    return share(painted, place, reach)


def _draw_line(
    albedo: Singles, n: float, line: Line, ground: Footprint, grain: Singles
) -> tuple[tuple[NDArray[np.intp], ...], Singles]:
    beside = ground.n - np.float32(n)
    if line.bend or line.wobble:
        beside = beside - line.aside(ground.s).astype(np.float32)
    where = np.nonzero(np.abs(beside) < (line.width + ground.reach_n) / 2 + 3 * line.ragged)
    part = ground.at(where)
    half = _half_width(line, part, np.sign(beside[where]) + np.float32(n))
    cover = share(lambda n: np.clip(n, -half, half), beside[where], part.reach_n)
    cover *= share(lambda s: np.clip(s, line.begin, line.end), part.s, part.reach_s)
    if line.painted == "dashed":
        cover *= striped(part.s, part.reach_s, line.dash, line.gap)
    return where, _lay(albedo, where, cover, line, (part, grain[where]))


def _half_width(line: Line, part: Footprint, side: Singles) -> Singles | float:
    """Return how far [m] a line reaches from its middle at each pixel; `side` tells its borders apart."""
    if not line.ragged:
        return line.width / 2
    noise = foliage_at(part.s / np.float32(RAGGED_TEXEL), side * 97) / (1 + np.square(part.reach_s / 0.4))
    return np.maximum(line.width / 2 + line.ragged * noise, 0).astype(np.float32)


def _draw_mark(albedo: Singles, mark: Mark, ground: Footprint, grain: Singles) -> None:
    s = np.mod(ground.s - mark.along[0], mark.repeat) + mark.along[0] if mark.repeat else ground.s
    near = (s > mark.along[0] - ground.reach_s) & (s < mark.along[-1] + ground.reach_s)
    near &= (ground.n > min(mark.left) - ground.reach_n) & (ground.n < max(mark.right) + ground.reach_n)
    where = np.nonzero(near)
    part = ground.at(where)
    s = s[where]
    left, right = (np.interp(s, mark.along, side).astype(np.float32) for side in (mark.left, mark.right))
    cover = share(lambda n: np.clip(n, left, np.maximum(left, right)), part.n, part.reach_n)
    cover *= share(lambda s: np.clip(s, mark.along[0], mark.along[-1]), s, part.reach_s)
    if mark.stripe:
        aside = np.abs(part.n - (left + right) / 2) if mark.chevron else part.n
        sine, cosine = np.float32(np.sin(mark.slant)), np.float32(np.cos(mark.slant))
        reach = part.reach_s * abs(cosine) + part.reach_n * abs(sine)
        cover *= striped((s - mark.along[0]) * cosine + aside * sine, reach, mark.stripe, mark.gap)
    _lay(albedo, where, cover, mark, (part, grain[where]))


def _lay(
    albedo: Singles,
    where: tuple[NDArray[np.intp], ...],
    cover: Singles,
    paint: Line | Mark,
    under: tuple[Footprint, Singles],
) -> Singles:
    """Lay paint over the asphalt at some pixels, as far as it is not worn off; return its share of each."""
    part, grain = under
    cover = cover * _left_of_wear(paint.wear, part, grain)
    colour = _linear(paint.colour) * (1 + paint.grain * grain)[:, None]
    albedo[where] += cover[:, None] * (colour - albedo[where])
    return cover


def _linear(colour: Colour) -> Singles:
    """Return a colour (3,) BGR, linear."""
    return COLOURS[colour] if isinstance(colour, str) else np.square(np.array(colour, np.float32) / 255)


def _left_of_wear(wear: float, part: Footprint, grain: Singles) -> Singles:
    """Return the share of the paint that traffic has left: fine pores at first, then whole flakes."""
    if wear < 0.1:
        return np.clip(1 - wear + 0.05 * grain, 0, 1)
    flakes = foliage_at(part.s * 25, part.n * 25) / (1 + np.square(part.reach_s / 0.3))  # texels of 4 cm
    keep = 0.5 + (0.9 - 2.2 * wear + 0.75 * flakes + 0.2 * grain)
    return np.clip(keep, 0.02, 0.95).astype(np.float32)
