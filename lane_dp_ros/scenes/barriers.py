# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What runs along the border of a rendered road, all its length: guard rails, grass, lamp posts."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from itertools import pairwise

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.scenes.faces import Face, Picture
from lane_dp_ros.scenes.textures import leaves

Floats = NDArray[np.float64]

# A W-beam: how far it stands out to the road and how high, from below, [m].
BEAM = ((0.0, 0.44), (0.05, 0.50), (0.05, 0.54), (0.0, 0.60), (0.05, 0.66), (0.05, 0.70), (0.0, 0.76))
PIECE = 4.0  # [m] of a rail that is drawn straight; twice and four times as much farther on
POST_SPACING, POSTS_SEEN = 4.0, 60.0  # [m] of a rail; ahead, up to which they are drawn
GRASS_SEEN = 30.0  # [m] ahead, up to which single tufts are drawn
TUFT_CELL = 0.4  # [m] of border with one tuft of grass


@dataclass(frozen=True)
class GuardRail:
    """A steel guard rail `n` [m] right of the road's axis, on posts, with its front to the axis."""

    n: float

    def things(self, s: float, reach: float) -> Iterator[tuple[Face, ...]]:
        """Yield it piece by piece, from s to s + reach along the road."""
        inward = -np.sign(self.n)
        for start, end in _pieces(s, reach):
            beam = [
                _along((start, end), (self.n + inward * d0, up0), (self.n + inward * d1, up1), _steel())
                for (d0, up0), (d1, up1) in pairwise(BEAM)
            ]
            posts = [
                Face(upright(float(post), self.n - inward * 0.08, 0.11, (0.0, 0.70)), _steel(), both=True)
                for post in np.arange(start, min(end, s + POSTS_SEEN), POST_SPACING)
            ]
            yield (*posts, *beam)

    def outlines(self, s: float, reach: float) -> Iterator[Floats]:
        """Yield convex outlines (N, 3) that throw its shadow."""
        for start, end in _pieces(s, reach):
            yield np.array([(p, self.n, up) for p in (start, end) for up in (0.44, 0.76)])


@dataclass(frozen=True)
class Grass:
    """Tufts of grass along `n` [m], up to `height` [m] high, that lean towards the road's axis.

    `density`, 0 to 1, is how many of the places for a tuft are taken; `seed` says which.
    """

    n: float
    height: float = 0.35
    density: float = 0.8
    seed: int = 0

    def things(self, s: float, reach: float) -> Iterator[tuple[Face, ...]]:
        """Yield the tufts of the next 30 m, some at a time."""
        cells = range(int(s / TUFT_CELL), int((s + min(reach, GRASS_SEEN)) / TUFT_CELL))
        for first in cells[::8]:
            yield tuple(face for i in range(first, first + 8) for face in self._tuft(i))

    def outlines(self, s: float, reach: float) -> Iterator[Floats]:  # noqa: ARG002
        """Yield nothing: the shadow of a tuft is lost in it."""
        yield from ()

    def _tuft(self, cell: int) -> tuple[Face, ...]:
        """Return the tuft that grows in a cell, or nothing; it grows in patches."""
        rng = np.random.default_rng([self.seed, 7, cell])
        taken, along, across, size, lean = rng.uniform(size=5)
        patch = 0.5 + 0.5 * np.sin(cell * 0.11 + self.seed) * np.sin(cell * 0.037 + 1)
        if taken > self.density * (0.35 + 0.65 * patch):
            return ()
        s, n = (cell + along) * TUFT_CELL, self.n + 0.22 * (across - 0.5)
        height = self.height * (0.45 + 0.55 * size)
        corners = upright(s, n, 1.6 * height, (-0.02, height))
        corners[:2, 1] -= np.sign(self.n) * height * (0.2 + 0.6 * lean)
        return (Face(corners, _tufts()[cell % len(_tufts())], both=True, leafy=True),)


@dataclass(frozen=True)
class Posts:
    """Posts, thin and high, every `spacing` metres along `n`; `height` and `width` [m], BGR `colour`."""

    n: float
    spacing: float = 30.0
    height: float = 8.0
    width: float = 0.16
    colour: tuple[float, float, float] = (112.0, 116.0, 116.0)

    def things(self, s: float, reach: float) -> Iterator[tuple[Face, ...]]:
        """Yield each post from s to s + reach along the road."""
        for place in self._places(s, reach):
            corners = upright(place, self.n, self.width, (0.0, self.height))
            yield (Face(corners, Picture.plain(self.colour), both=True),)

    def outlines(self, s: float, reach: float) -> Iterator[Floats]:
        """Yield convex outlines (N, 3) that throw their shadows."""
        for place in self._places(s, reach):
            yield pillar(place, self.n, self.width, (0.0, self.height))

    def _places(self, s: float, reach: float) -> Floats:
        return self.spacing * np.arange(np.ceil(s / self.spacing), (s + reach) / self.spacing)


def upright(s: float, n: float, width: float, above: tuple[float, float]) -> Floats:
    """Return the corners (4, 3) of an upright face across the road, seen from before it."""
    left, right, (low, high) = n - width / 2, n + width / 2, above
    return np.array([(s, left, high), (s, right, high), (s, right, low), (s, left, low)], np.float64)


def pillar(s: float, n: float, width: float, above: tuple[float, float]) -> Floats:
    """Return the corners (8, 3) of a square pillar."""
    return np.vstack([upright(s + side * width / 2, n, width, above) for side in (-1, 1)])


def _pieces(s: float, reach: float) -> Iterator[tuple[float, float]]:
    """Yield where straight pieces begin and end, bound to the road: longer far away."""
    start = np.floor(s / PIECE) * PIECE
    while start < s + reach:
        length = PIECE * (1 if start < s + 12 else 2 if start < s + 40 else 4)
        end = (np.floor(start / length) + 1) * length
        yield start, end
        start = end


def _along(
    piece: tuple[float, float], low: tuple[float, float], high: tuple[float, float], picture: Picture
) -> Face:
    """Return a strip along the road between two lines (n, above), seen from the road's axis."""
    left, right = piece[::-1] if low[0] > 0 else piece
    corners = [(left, *high), (right, *high), (right, *low), (left, *low)]
    return Face(np.array(corners, np.float64), picture)


@cache
def _steel() -> Picture:
    """Return zinc-coated steel, streaked with dirt."""
    streaks = cv2.resize(leaves()[:16, :64], (256, 32), interpolation=cv2.INTER_CUBIC)
    return _opaque(np.array((150, 148, 144), np.float32) * (1 + 0.07 * streaks[..., None]))


@cache
def stones() -> Picture:
    """Return four metres of kerb stones, with their joints and stains."""
    image = np.array((150, 156, 158), np.float32) * (1 + 0.08 * leaves()[:32, :, None])
    for joint in range(0, 512, 128):
        image[:, joint : joint + 3] *= 0.55
    return _opaque(image)


def _opaque(image: NDArray[np.float32]) -> Picture:
    return Picture.of(np.dstack([np.clip(image, 0, 255), np.ones(image.shape[:2], np.float32)]))


@cache
def _tufts() -> tuple[Picture, ...]:
    return tuple(_blades(np.random.default_rng([6, i])) for i in range(6))


def _blades(rng: np.random.Generator) -> Picture:
    """Draw blades of grass that fan out of one spot, some of them dry."""
    image = np.zeros((128, 192, 4), np.float32)
    for _ in range(110):
        foot = np.array([96 + rng.normal(0, 30), 127])
        tip = foot + np.array([rng.normal(0, 28), -rng.uniform(35, 120)])
        bow = (foot + tip) / 2 + np.array([rng.normal(0, 6), -12])
        dry = rng.uniform()
        colour = (1 - dry) * np.array([52, 108, 92]) + dry * np.array([124, 182, 184])
        path = np.rint([foot, bow, tip]).astype(np.int32)
        cv2.polylines(image, [path], False, (*(colour * rng.uniform(0.6, 1.1)), 1), int(rng.integers(1, 3)))
    return Picture.of(image)
