# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What a rendered road is like: its course, its height, its lines and what else lies on it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.scenes.wall_shapes import Verge, wall_height

Floats = NDArray[np.float64]
Reals = NDArray[np.floating[Any]]

MAX_CURVATURE = 0.035  # [1/m]
KERB_FACE = 0.08  # [m] across the road over which a kerb rises


Colour = Literal["white", "yellow", "tar", "steel", "concrete", "patch"] | tuple[float, float, float]
PAINT_GRAIN = 0.055  # share by which the asphalt's grain shows through paint


@dataclass(frozen=True)
class Line:
    """One painted line, or `none`. A dashed one has `dash` [m] of paint, then `gap` [m] without.

    It runs `width` [m] wide from `begin` to `end` [m] along the road; over `bend_over` [m] from `bend_at`
    on it moves `bend` [m] to the right; it wavers by `wobble` [m], `phase` [m] along the road before another
    that does. Its borders are `ragged` by this much [m]. `wear` is the share that is gone. A colour without a
    name is BGR in grey levels; `grain` is the share by which the asphalt's grain shows.
    """

    painted: Literal["solid", "dashed", "none"] = "solid"
    width: float = 0.15
    dash: float = 4.0
    gap: float = 8.0
    colour: Colour = "white"
    wear: float = 0.03
    begin: float = -np.inf
    end: float = np.inf
    bend: float = 0.0
    bend_at: float = 0.0
    bend_over: float = 40.0
    wobble: float = 0.0
    phase: float = 0.0
    ragged: float = 0.0
    grain: float = PAINT_GRAIN

    def aside(self, s: Reals) -> Reals:
        """Return how far right [m] of its place across the road the line runs at s along the road."""
        if not (self.bend or self.wobble):
            return np.zeros_like(s)
        part = np.clip((s - self.bend_at) / self.bend_over, 0, 1)
        along = s + self.phase
        waver = np.sin(0.31 * along) + 0.7 * np.sin(0.83 * along + 1) + 0.4 * np.sin(2.9 * along)
        return self.bend * part * part * (3 - 2 * part) + self.wobble * waver

    def is_painted(self, s: Reals) -> NDArray[np.bool_]:
        """Return whether there is paint at s along the road."""
        inside = (s >= self.begin) & (s <= self.end)
        on_dash = np.mod(s, self.dash + self.gap) <= self.dash
        return inside & (on_dash | (self.painted == "solid"))


@dataclass(frozen=True)
class Mark:
    """Paint that is no lane line, a seam across the road, a patch: an outline, filled or striped.

    `left` and `right` [m] are its borders across the road at `along` [m], straight between them.
    Stripes `stripe` [m] wide, `gap` [m] apart, run across the road, turned by `slant` [rad] (pi / 2: along
    it); `chevron` mirrors them at the outline's middle. It comes again every `repeat` [m], 0: it does not.
    """

    along: tuple[float, ...]
    left: tuple[float, ...]
    right: tuple[float, ...]
    colour: Colour = "white"
    wear: float = 0.05
    stripe: float = 0.0
    gap: float = 0.5
    slant: float = 0.0
    chevron: bool = False
    repeat: float = 0.0
    grain: float = PAINT_GRAIN


SOLID, DASHED, UNPAINTED = Line(), Line("dashed"), Line("none")


@dataclass(frozen=True)
class Road:
    """A road, and how the camera stands on it.

    `curvature` [1/m], positive to the right, swings by +-`swing` [1/m] over `swing_length` [m]. It lies
    `hill` [m] higher in the middle of every `hill_length` [m] than at their ends, and falls to the right by
    `roll` [rad]. `lane_widths` [m] and the `lines` between and beside them go from left to right, one line
    more than lanes; `more_lines` are further ones, each with how far right of the axis it runs [m].
    The road's axis is the middle of lane number `driven`. `strips` run like lines, but are none (tar seams,
    rails), and `marks` are on the road besides; `covers` run like lines, too, and lie over all of it and over
    what is beside the road (slush, a footpath's border). `shoulder` [m] is the asphalt beyond the outer
    lines, of the grey level `asphalt`; then comes a kerb, `kerb` [m] high, with a pavement, or, at 0 m,
    grass, which reaches `overgrowth` [m] over the border here and there, under `snow` for this share.
    `verge` is what stands there. `camera_height` [m], `pitch` [rad] positive where the camera looks down.

    Raises ValueError when lines and lanes do not go together or the road bends too sharply.
    """

    curvature: float = 0.0
    swing: float = 0.006
    swing_length: float = 240.0
    hill: float = 0.0
    hill_length: float = 200.0
    roll: float = 0.0
    lane_widths: tuple[float, ...] = (3.5, 3.5)
    lines: tuple[Line, ...] = (SOLID, DASHED, SOLID)
    more_lines: tuple[tuple[float, Line], ...] = ()
    strips: tuple[tuple[float, Line], ...] = ()
    marks: tuple[Mark, ...] = ()
    covers: tuple[tuple[float, Line], ...] = ()
    driven: int = 1
    shoulder: float = 0.6
    kerb: float = 0.0
    overgrowth: float = 0.04
    snow: float = 0.0
    asphalt: float = 112.0
    verge: Verge = "fields"
    camera_height: float = 1.65
    pitch: float = 0.012

    def __post_init__(self) -> None:
        if len(self.lines) != len(self.lane_widths) + 1 or not 0 <= self.driven < len(self.lane_widths):
            raise ValueError(
                f"{len(self.lines)} lines, {len(self.lane_widths)} lanes, driven lane {self.driven}: "
                "expected one line more than lanes, and the driven lane among them"
            )
        sharpest = abs(self.curvature) + abs(self.swing)
        if not sharpest <= MAX_CURVATURE:
            raise ValueError(f"curvature up to {sharpest:g} 1/m, expected at most {MAX_CURVATURE:g} 1/m")

    @property
    def offsets(self) -> Floats:
        """How far right of the middle of the driven lane each border between lanes is, (lines,) [m]."""
        borders = np.concatenate([[0.0], np.cumsum(self.lane_widths)])
        return borders - borders[self.driven : self.driven + 2].mean()

    @property
    def borders(self) -> tuple[float, float]:
        """Where the asphalt ends, left and right of the axis [m]."""
        return float(self.offsets[0] - self.shoulder), float(self.offsets[-1] + self.shoulder)

    @property
    def placed_lines(self) -> tuple[tuple[float, Line], ...]:
        """Every line that is painted somewhere, with how far right of the axis it runs [m]."""
        lines = (*zip(self.offsets.tolist(), self.lines, strict=True), *self.more_lines)
        return tuple((n, line) for n, line in lines if line.painted != "none")

    @property
    def is_flat(self) -> bool:
        """Whether all the ground is one plane on which the vehicle stands."""
        return not (self.hill or self.roll or self.kerb or self.verge != "fields")

    def heading(self, s: Floats) -> Floats:
        """Return the road's direction [rad] at s, clockwise from that at s = 0: its curvature summed up."""
        turn = 2 * np.pi / self.swing_length
        return self.curvature * s + self.swing / turn * (1 - np.cos(turn * s))

    def height(self, s: Reals, n: Reals, position: float) -> Reals:
        """Return the height [m] above the plane that touches the road's axis at `position` along it."""
        if self.is_flat:
            return np.zeros(np.broadcast(s, n).shape)
        left, right = self.borders
        beyond = np.maximum(left - n, n - right)
        beside = self.kerb * np.clip(beyond / KERB_FACE, 0, 1)
        beside = beside + wall_height(self.verge, s, beyond, np.sign(n))
        return self.level(s, n, position) + beside

    def level(self, s: Reals, n: Reals, position: float) -> Reals:
        """Return `height` without kerbs and walls."""
        turn = 2 * np.pi / self.hill_length
        rise = self.hill / 2 * (np.cos(turn * position) - np.cos(turn * s))
        return rise - self._climb(position) * (s - position) - np.tan(self.roll) * np.clip(n, -30, 30)

    def slopes(self, s: Reals, n: Reals, position: float) -> tuple[Reals, Reals]:
        """Return how the ground of `height` climbs along and across the road; walls are left out."""
        left, right = self.borders
        beyond = np.maximum(left - n, n - right)
        face = self.kerb / KERB_FACE * np.sign(n) * ((beyond > 0) & (beyond < KERB_FACE))
        return self._climb(s) - self._climb(position), face - np.tan(self.roll)

    def _climb(self, s: Reals | float) -> Any:
        turn = 2 * np.pi / self.hill_length
        return self.hill / 2 * turn * np.sin(turn * s)
