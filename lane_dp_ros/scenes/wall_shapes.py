# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""How high the edge of a forest and the fronts of houses stand beside a rendered road."""

from __future__ import annotations

from functools import cache
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.scenes.textures import octave_noise

Singles = NDArray[np.float32]
Reals = NDArray[np.floating[Any]]
Verge = Literal["fields", "forest", "town"]

RISE = 0.25  # [m] across the road over which a wall rises
TOPS_STEP = 0.25  # [m] between the heights of the forest's edge
FOREST_FROM = 8.0  # [m] beyond the asphalt
BLOCK, STOREY = 16.0, 3.1  # [m] of road for a house, of height for a storey
HEDGE = 1.7  # [m] high
TINTS = 6  # colours of plaster


def wall_height(verge: Verge, s: Reals, beyond: Reals, side: Reals) -> Reals:
    """Return the height [m] of walls at s along the road, `beyond` [m] the asphalt on a side (-1, 1)."""
    if verge == "fields":
        return np.zeros_like(beyond)
    if verge == "forest":
        tops = _tops()
        along = s / TOPS_STEP + 1000 * (side > 0)
        i = np.floor(along).astype(np.int32) % (len(tops) - 1)
        top = tops[i] + (along - np.floor(along)) * (tops[i + 1] - tops[i])
        bays = 1.2 + 0.9 * np.sin(0.11 * s + side) + 0.7 * np.sin(0.43 * s) + 0.3 * np.sin(1.7 * s)
        return top * np.clip((beyond - FOREST_FROM - bays) / RISE, 0, 1)
    setback, height, _ = houses(s, side)
    return height * np.clip((beyond - setback) / RISE, 0, 1)


@cache
def _tops() -> Singles:
    """Return the height [m] of the forest's edge, every TOPS_STEP over 1 km: ragged, here and there low."""
    noise = octave_noise(np.random.default_rng(11), (64, 4096), 1.35, 7)[0]
    return np.clip(9.5 + 2.3 * noise, 2.0, 16.0).astype(np.float32)


def houses(s: Reals, side: Reals) -> tuple[Reals, Reals, NDArray[np.intp]]:
    """Return setback [m], height [m] and colour of the house at s on a side; some places have a hedge."""
    setback, height, tint = _street()
    i = (np.floor(s / BLOCK).astype(np.int32) + 77 * (side > 0)) % len(height)
    return setback[i], height[i], tint[i]


@cache
def _street() -> tuple[Singles, Singles, NDArray[np.intp]]:
    rng = np.random.default_rng(12)
    count = 256
    storeys = rng.integers(2, 5, count)
    height = np.where(rng.uniform(size=count) < 0.22, HEDGE, storeys * STOREY + 2.6)
    setback = 2.6 + rng.choice([0.0, 0.4, 3.0], count)
    return setback.astype(np.float32), height.astype(np.float32), rng.integers(TINTS, size=count)
