# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""A candidate for a lane line: its path, its line, its evidence, its paint, and why it was refused."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.types import LaneKind, PaintColour

Floats = NDArray[Any]
Variant = Literal["path", "near half", "parallel", "border"]


@dataclass(frozen=True, eq=False)
class LanePath:
    """A path through the graph that may be a lane: cells (rows[i], columns[i]), from near to far, one a row.

    `columns` may have fractions; `score` is the evidence along it [m]: net metres of paint.
    """

    rows: NDArray[np.intp]
    columns: Floats
    score: float


@dataclass(frozen=True, eq=False)
class LaneLine:
    """A smooth line n(s) through a path, in road coordinates [m], from near to far, one point a row."""

    rows: NDArray[np.intp]
    s: Floats
    n: Floats
    bend: float
    """Its curvature [1/m] against the road's axis."""
    score: float
    """Net metres of paint along it."""

    @property
    def length(self) -> float:
        """Length along the road [m]."""
        return float(self.s[-1] - self.s[0])


@dataclass(frozen=True)
class LaneEvidence:
    """What speaks for and against a line being paint, or a border of the carriageway, in physical units.

    NaN where it is not known: what needs a second image without one, what needs paint at a border.
    """

    length: float
    """Length [m] along the road."""
    start: float
    """Where it begins [m] ahead."""
    slope: float
    """Steepest lateral over forward, against the road's axis."""
    score: float = np.nan
    """Net metres of paint."""
    paint_width: float = np.nan
    """Width [m] of the bright band at half its contrast."""
    wide_band_ratio: float = np.nan
    """Contrast of a 0.45 m band over that of a 0.15 m one: small for a line, near 1 for a verge."""
    height: float = np.nan
    """Height [m] of the paint above the ground on the vehicle's side of it.

    Where that ground is not known, above the one on the other side, else above the road's surface. It is
    measured only of lines whose paint it decides.
    """
    kerb_step: float = np.nan
    """How much higher or lower [m] the ground on the other side is: a kerb's."""
    off_paint_fraction: float = np.nan
    """Share of the paint that it passes beside: that of one line lies on one smooth curve."""
    texture: float = np.nan
    """Texture beside the line, over brightness: asphalt is smooth, grass is not."""
    contrast: float = np.nan
    """Weber contrast of the paint against the road on both sides of it."""
    saturation_contrast: float = np.nan
    """The same rise as a share of that up to white: in glare even fresh paint has little contrast."""
    relative_contrast: float = np.nan
    """Either contrast over that of the most striking line in view, at most 1: paint is like other paint."""
    wander: float = np.nan
    """Root mean square [m] of how far aside of the smooth line its paint lies, means of 2 m of it."""
    brightness: float = np.nan
    """Brightness of the paint over that of the road towards the vehicle, less 1."""
    painted: float = np.nan
    """Share of its length that shows paint."""
    border: float = np.nan
    """Share of its length that looks like a border of the carriageway, see `EdgeMap.feature`."""
    rise: float = np.nan
    """How much higher [m] the ground just behind it is, by the dense disparity."""
    grey_step: float = np.nan
    """How much brighter the ground just behind it is, over brightness."""
    texture_step: float = np.nan
    """By what factor, as a logarithm, the ground just behind it is rougher."""
    far_rise: float = np.nan
    """How much higher [m] the ground farther behind it is than that farther before it."""
    far_grey_step: float = np.nan
    """How much brighter the ground farther behind it is, over brightness."""
    far_texture_step: float = np.nan
    """By what factor, as a logarithm, the ground farther behind it is rougher."""
    ground: float = np.nan
    """Height [m] of the ground before it above the road's surface: that of a road is 0."""


@dataclass(frozen=True)
class Marking:
    """Kind and colour of a line's paint, and the kinds of both lines of a double one, as `Lane` has them."""

    kind: LaneKind = ""
    colour: PaintColour = ""
    sides: tuple[LaneKind, LaneKind] | None = None


@dataclass(frozen=True, eq=False)
class Candidate:
    """A line that may be a lane line or a border of the carriageway, with its evidence.

    `variant` says what proposed it: a path through the paint, the nearer half of another candidate, a
    parallel to a lane line, or a path along a border, which is no paint. `log_odds` are those of paint and of
    border against neither, by its own evidence; `probability` those of either in the light of all others.
    `refusal` says why it is no lane line, empty where it is; `is_edge`: it is a border. `marking` is told of
    those that are lane lines.
    """

    line: LaneLine
    evidence: LaneEvidence
    variant: Variant = "path"
    log_odds: tuple[float, float] = (0.0, -np.inf)
    probability: tuple[float, float] = (1.0, 0.0)
    refusal: str = ""
    is_edge: bool = False
    marking: Marking = Marking()

    @property
    def score(self) -> float:
        """Net metres of paint along its line."""
        return self.line.score
