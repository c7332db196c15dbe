# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Materials and cut-outs of the rendered road: seamless noise, grass, asphalt, trees, posts."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import cv2
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float32]
Bytes = NDArray[np.uint8]

ROWS, COLUMNS = 4096, 1024  # of a material's tile
LEVELS = 9  # of averaging, up to 2^8 rows
GREY_PER_SIGMA = 40.0  # a tile is stored as bytes: 128 + 40 times the noise


@dataclass(frozen=True)
class Material:
    """A seamless tile of noise on the ground, filtered for the sizes that a pixel can have there.

    `levels[k]` (ROWS, COLUMNS) is averaged over 2^k texels along the road, and across it as far as the pixel
    reaches that sees this length of flat road: far away it is some twenty times longer than wide.
    """

    levels: tuple[Bytes, ...]
    row_length: float  # [m] along the road
    column_width: float  # [m] across

    def sample(self, s: Floats, n: Floats, length: Floats) -> Floats:
        """Return the noise (H, W), about 1 in size where near, at places s along and n across the road [m].

        `length` (H,) [m]: how much of the road one pixel of each row covers; it falls from row to row.
        """
        x = _wrapped(n * np.float32(1 / self.column_width), COLUMNS)
        y = _wrapped(s * np.float32(1 / self.row_length), ROWS)
        level = np.clip(np.log2(length / self.row_length), 0, len(self.levels) - 1)
        noise = np.zeros_like(s)
        for k, image in enumerate(self.levels):
            weight = np.maximum(0, 1 - np.abs(level - k)).astype(np.float32)
            rows = np.flatnonzero(weight)
            if len(rows):
                part = slice(rows[0], rows[-1] + 1)
                grey = cv2.remap(image, x[part], y[part], cv2.INTER_LINEAR, borderMode=cv2.BORDER_WRAP)
                noise[part] += weight[part, None] * (grey.astype(np.float32) - 128)
        return noise / GREY_PER_SIGMA


@cache
def asphalt() -> Material:
    """Return a material of fine grain with tar patches, joints and cracks; 82 m long, 10 m wide."""
    rng = np.random.default_rng(1)
    tile = octave_noise(rng, (ROWS, COLUMNS), 0.55, 8)
    for _ in range(14):
        x, y = rng.integers(COLUMNS), rng.integers(ROWS)
        width, length = rng.integers(40, 200), rng.integers(40, 400)
        patch = tile[y : y + length, x : x + width]
        patch *= rng.uniform(0.6, 0.9)
        patch += rng.uniform(-0.9, 0.3)
    for _ in range(30):
        _draw_crack(tile, rng)
    return material(tile, row_length=0.02, column_width=0.01)


@cache
def grass() -> Material:
    """Return a material of tufts and bare spots."""
    rng = np.random.default_rng(2)
    return material(octave_noise(rng, (ROWS, COLUMNS), 0.8, 7), row_length=0.04, column_width=0.02)


@cache
def leaves() -> Floats:
    """Return a seamless tile (512, 512) of noise for foliage, of standard deviation 1."""
    return octave_noise(np.random.default_rng(3), (512, 512), 0.9, 6)


def foliage(x: Floats, y: Floats) -> Floats:
    """Return the seamless noise of `leaves` at texels x, y (H, W)."""
    tile = leaves()
    rows, columns = tile.shape
    x, y = _wrapped(x, columns), _wrapped(y, rows)
    noise = cv2.remap(tile, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_WRAP)
    return noise.astype(np.float32, copy=False)


def _wrapped(x: Floats, size: int) -> Floats:
    """Return x modulo size, in a tenth of np.mod's time."""
    return (x - np.floor(x * np.float32(1 / size)) * np.float32(size)).astype(np.float32, copy=False)


def foliage_at(x: Floats, y: Floats) -> Floats:
    """Return the seamless noise of `leaves` at texels x, y (N,)."""
    size = -len(x) % 256
    square = (np.pad(a, (0, size)).reshape(-1, 256) for a in (x, y))  # OpenCV takes no row that is too long
    return foliage(*square).ravel()[: len(x)] if len(x) else x


def octave_noise(rng: np.random.Generator, shape: tuple[int, int], falloff: float, octaves: int) -> Floats:
    """Return seamless value noise with mean 0 and standard deviation 1.

    Octave k has cells of 2^k texels (both sides of `shape` must be multiples of the largest) and falloff^k
    times the strength of the finest.
    """
    noise = np.zeros(shape, np.float32)
    for k in range(octaves):
        cell = 2**k
        values = rng.standard_normal((shape[0] // cell, shape[1] // cell), dtype=np.float32)
        wrapped = cv2.copyMakeBorder(values, 2, 2, 2, 2, cv2.BORDER_WRAP)
        smooth = cv2.resize(wrapped, None, fx=cell, fy=cell, interpolation=cv2.INTER_CUBIC)
        border = 2 * cell
        noise += np.asarray(falloff**k * smooth[border:-border, border:-border], np.float32)
    noise -= noise.mean()
    return noise / noise.std()


def _draw_crack(tile: Floats, rng: np.random.Generator) -> None:
    """Draw a sealed crack: a random walk, mostly along or mostly across the road."""
    steps = rng.normal(0, 12, (rng.integers(5, 25), 2))
    steps[:, rng.integers(2)] += rng.uniform(15, 45)
    path = rng.uniform((0, 0), (COLUMNS, ROWS)) + np.cumsum(steps, axis=0)
    cv2.polylines(tile, [path.astype(np.int32)], False, -1.6, int(rng.integers(1, 5)), cv2.LINE_8)


def material(tile: Floats, row_length: float, column_width: float) -> Material:
    """Filter a tile for pixels of every size; on flat road width = sqrt(length * height / focal length)."""
    height_per_focal = 1.65 / 721.5
    levels, averaged = [], tile
    for k in range(LEVELS):
        averaged = _averaged_rows(averaged, k)
        width = np.sqrt(row_length * 2**k * height_per_focal) / column_width
        wrapped = cv2.copyMakeBorder(averaged, 0, 0, 64, 64, cv2.BORDER_WRAP)
        smooth = cv2.GaussianBlur(wrapped, (63, 1), max(width / np.sqrt(12), 0.3))[:, 64:-64]
        levels.append(np.clip(np.rint(128 + GREY_PER_SIGMA * smooth), 0, 255).astype(np.uint8))
    return Material(tuple(levels), row_length, column_width)


def _averaged_rows(tile: Floats, level: int) -> Floats:
    """Return the tile averaged over 2^level rows, from that averaged over half as many."""
    if level == 0:
        return tile
    half = 2**level // 4
    above, below = np.roll(tile, half, axis=0), np.roll(tile, -max(half, 1), axis=0)
    return np.asarray((above + below) / 2, np.float32)


@dataclass(frozen=True)
class CutOut:
    """A picture to stand upright in the scene: BGRA bytes, colour times opacity, at falling sizes."""

    pyramid: tuple[Bytes, ...]

    def at_width(self, pixels: float) -> Bytes:
        """Return the smallest picture that is at least as wide as it will be drawn (the first if none is)."""
        wide = [image for image in self.pyramid if image.shape[1] >= pixels]
        return wide[-1] if wide else self.pyramid[0]


@cache
def trees() -> tuple[CutOut, ...]:
    """Return different trees, 3 wide to 4 high."""
    return tuple(_tree(np.random.default_rng([4, i]), trunk=True) for i in range(6))


@cache
def bushes() -> tuple[CutOut, ...]:
    """Return different bushes, 3 wide to 2 high, that reach down to the ground."""
    return tuple(_tree(np.random.default_rng([5, i]), trunk=False) for i in range(4))


@cache
def post() -> CutOut:
    """Return a delineator post: white with a slanted black band and a reflector."""
    image = np.zeros((256, 32, 4), np.float32)
    image[4:, 6:26] = (225, 228, 226, 1)
    cv2.fillPoly(image, [np.array([[6, 44], [26, 34], [26, 94], [6, 104]])], (28, 26, 26, 1))
    image[56:84, 12:20] = (200, 205, 210, 1)
    return _cut_out(image)


@cache
def pole() -> CutOut:
    """Return a grey pole."""
    image = np.zeros((512, 16, 4), np.float32)
    shade = np.linspace(0.75, 1.1, 8)[None, :, None]
    image[:, 4:12, :3] = 118 * shade
    image[:, 4:12, 3] = 1
    return _cut_out(image)


def _tree(rng: np.random.Generator, trunk: bool) -> CutOut:
    """Paint a crown of many round tufts, lit from above, ragged at the border."""
    height, width = (512, 384) if trunk else (256, 384)
    image = np.zeros((height, width, 4), np.float32)
    if trunk:
        image[330:, width // 2 - 13 : width // 2 + 13] = (48, 58, 70, 1)
    noise = np.roll(leaves(), tuple(rng.integers(0, 512, 2)), (0, 1))[:height, :width]
    tint = rng.uniform(0.8, 1.15) * np.array([42, 82, 66]) + rng.normal(0, 5, 3)
    top, bottom, widest = (60, 350, 0.85) if trunk else (60, 235, 0.6)
    for y in np.sort(rng.uniform(top, bottom, 45)):
        reach = 138 * np.sin(np.pi * np.clip(y / bottom, 0.1, widest))
        _paint_tuft(image, noise, (width / 2 + rng.uniform(-reach, reach), y, rng.uniform(27, 50)), tint)
    return _cut_out(image)


def _paint_tuft(
    image: Floats, noise: Floats, circle: tuple[float, float, float], tint: NDArray[np.float64]
) -> None:
    """Paint a ragged round tuft (u, v, radius) [px] of leaves, brighter towards its top and the tree's."""
    u, v, radius = circle
    rows, columns = (slice(max(0, int(c - 2 * radius)), int(c + 2 * radius)) for c in (v, u))
    part, rough = image[rows, columns], noise[rows, columns]
    y, x = np.mgrid[rows, columns][:, : part.shape[0], : part.shape[1]]
    tuft = np.hypot(x - u, y - v) / radius + 0.28 * rough < 1
    light = 1.05 - 0.5 * v / image.shape[0] + 0.35 * (v - y) / radius + 0.22 * rough
    part[tuft, :3] = np.maximum(0.25, light[tuft, None]) * tint
    part[tuft, 3] = 1


def _cut_out(image: Floats) -> CutOut:
    """Make the pyramid of a picture (H, W, 4): BGR 0 to 255, opacity 0 to 1."""
    image = np.clip(image, 0, 255)
    image[..., :3] *= image[..., 3:]
    image[..., 3] *= 255
    sizes = [2**k for k in range(8) if min(image.shape[:2]) >> k >= 2]
    pictures = (
        cv2.resize(image, (image.shape[1] // k, image.shape[0] // k), interpolation=cv2.INTER_AREA)
        for k in sizes
    )
    return CutOut(tuple(np.rint(picture).astype(np.uint8) for picture in pictures))
