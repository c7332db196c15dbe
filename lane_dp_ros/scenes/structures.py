# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What is built on or over a rendered road: traffic islands with their sign, bridges."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.scenes.barriers import pillar, stones, upright
from lane_dp_ros.scenes.faces import Face, Picture
from lane_dp_ros.scenes.textures import leaves

Floats = NDArray[np.float64]
DECK_STRIP = 2.0  # [m] of a bridge's underside in one face: a strip that comes too near is not drawn
DECK_EDGE, RAILING = 1.1, 1.0  # [m] high


@dataclass(frozen=True)
class Box:
    """A box over the road from `low` to `high`, each (s, n, above) [m]."""

    low: tuple[float, float, float]
    high: tuple[float, float, float]

    def outline(self) -> Floats:
        """Return its corners (8, 3)."""
        return np.array([(s, n, up) for s in self._ends(0) for n in self._ends(1) for up in self._ends(2)])

    def faces(self, side: Picture, above: Picture) -> tuple[Face, ...]:
        """Return the front and both sides with one picture, the top with another."""
        (s0, n0, z0), (s1, n1, z1) = self.low, self.high
        front = upright(s0, (n0 + n1) / 2, n1 - n0, (z0, z1))
        left = [(s1, n0, z1), (s0, n0, z1), (s0, n0, z0), (s1, n0, z0)]
        right = [(s0, n1, z1), (s1, n1, z1), (s1, n1, z0), (s0, n1, z0)]
        top = [(s1, n0, z1), (s1, n1, z1), (s0, n1, z1), (s0, n0, z1)]
        upright_faces = [Face(np.array(corners, np.float64), side) for corners in (front, left, right)]
        return (*upright_faces, Face(np.array(top, np.float64), above))

    def _ends(self, axis: int) -> tuple[float, float]:
        return self.low[axis], self.high[axis]


@dataclass(frozen=True)
class Island:
    """A traffic island from `s` over `length` [m], its middle at `n`, with a sign to pass it by."""

    s: float
    n: float
    length: float = 10.0
    width: float = 1.6
    height: float = 0.13

    def things(self, s: float, reach: float) -> Iterator[tuple[Face, ...]]:
        """Yield its stones, two metres at a time, and the sign, if they lie from s to s + reach."""
        for box in self._boxes():
            if s < box.high[0] and box.low[0] < s + reach:
                yield box.faces(stones(), _concrete())
        if s < self.s + 1 < s + reach:
            yield (Face(upright(self.s + 1, self.n, 0.6, (self.height, 1.3)), _pass_by(), both=True),)

    def outlines(self, s: float, reach: float) -> Iterator[Floats]:
        """Yield convex outlines (N, 3) that throw its shadow."""
        if s < self.s + self.length and self.s < s + reach:
            yield from (box.outline() for box in self._boxes())
            yield pillar(self.s + 1, self.n, 0.3, (self.height, 1.3))

    def _boxes(self) -> Iterator[Box]:
        for start in np.arange(self.s, self.s + self.length, 2.0).tolist():
            end = min(start + 2.0, self.s + self.length)
            half = self.width / 2
            yield Box((start, self.n - half, 0.0), (end, self.n + half, self.height))


@dataclass(frozen=True)
class Bridge:
    """A bridge across the road, from `s` over `length` [m], `clearance` [m] above it, on two walls."""

    s: float
    length: float = 9.0
    clearance: float = 4.8
    span: float = 22.0

    def things(self, s: float, reach: float) -> Iterator[tuple[Face, ...]]:
        """Yield deck and walls, if they lie from s to s + reach along the road."""
        if not s - self.length < self.s < s + reach:
            return
        strips = np.arange(self.s, self.s + self.length, DECK_STRIP).tolist()
        yield tuple(self._underside(start) for start in strips)
        for side in (-1, 1):
            yield (*(self._wall(start, side) for start in strips), self._wall_front(side))
        edge = self.clearance + DECK_EDGE
        front = upright(self.s, 0, 6 * self.span, (self.clearance, edge))
        rail = upright(self.s, 0, 6 * self.span, (edge, edge + RAILING))
        yield (Face(front, _concrete()), Face(rail, _railing(), both=True))

    def outlines(self, s: float, reach: float) -> Iterator[Floats]:
        """Yield convex outlines (N, 3) that throw its shadow."""
        if s - 4 * self.length < self.s < s + reach:
            low, high = self.clearance, self.clearance + DECK_EDGE + 0.5 * RAILING
            yield Box((self.s, -2 * self.span, low), (self.s + self.length, 2 * self.span, high)).outline()

    def roofs(self) -> tuple[Floats, ...]:
        """Return the outline (4, 3) of the ground that it keeps the sky from."""
        s0, s1, n = self.s, self.s + self.length, 2 * self.span
        return (np.array([(s0, -n, 0), (s1, -n, 0), (s1, n, 0), (s0, n, 0)], np.float64),)

    def _underside(self, start: float) -> Face:
        n, up = 3 * self.span, self.clearance
        corners = [(start, -n, up), (start, n, up), (start + DECK_STRIP, n, up), (start + DECK_STRIP, -n, up)]
        return Face(np.array(corners), _concrete(), both=True)

    def _wall(self, start: float, side: int) -> Face:
        """Return a strip of the wall that faces the road."""
        n, up = side * self.span / 2, self.clearance
        near, far = (start + DECK_STRIP, start) if side < 0 else (start, start + DECK_STRIP)
        corners = [(far, n, up), (near, n, up), (near, n, 0), (far, n, 0)]
        return Face(np.array(corners, np.float64), _concrete())

    def _wall_front(self, side: int) -> Face:
        low, high = sorted((side * self.span / 2, side * 2 * self.span))
        return Face(upright(self.s, (low + high) / 2, high - low, (0.0, self.clearance)), _concrete())


@cache
def _concrete() -> Picture:
    """Return concrete with the marks of its boards and of water."""
    image = np.array((132, 138, 140), np.float32) * (1 + 0.07 * leaves()[:256, :, None])
    image[:, ::64] *= 0.85
    return Picture.of(np.dstack([image, np.ones(image.shape[:2], np.float32)]))


@cache
def _railing() -> Picture:
    image = np.zeros((32, 2048, 4), np.float32)
    image[:3] = image[:, ::12] = image[15:17] = (70, 72, 70, 1)
    return Picture.of(image)


@cache
def _pass_by() -> Picture:
    """Return the round blue sign with its white arrow, on a pole."""
    image = np.zeros((256, 128, 4), np.float32)
    image[120:, 58:70] = (110, 112, 112, 1)
    cv2.circle(image, (64, 64), 62, (214, 216, 216, 1), -1)
    cv2.circle(image, (64, 64), 58, (150, 84, 30, 1), -1)
    cv2.arrowedLine(image, (36, 36), (92, 92), (220, 222, 222, 1), 13, tipLength=0.45)
    return Picture.of(image)
