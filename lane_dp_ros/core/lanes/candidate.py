# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""A candidate for a lane line: its path, its line, its evidence, its paint, and why it was refused."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.types import LaneKind, PaintColour

Floats = NDArray[Any]
Variant = Literal["path", "near half", "parallel"]


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
    """What speaks for and against a line being paint, each in physical units."""

    paint_width: float
    """Width [m] of the bright band at half its contrast."""
    wide_band_ratio: float
    """Contrast of a 0.45 m band over that of a 0.15 m one: small for a line, near 1 for a verge."""
    height: float
    """Height [m] of the paint above the ground on the vehicle's side of it, NaN where it is not known.

    Where that ground is not known, above the one on the other side, else above the road's surface. It is
    measured only of lines that all else lets be paint.
    """
    kerb_step: float
    """How much higher or lower [m] the ground on the other side is: a kerb's; 0 where it is not known."""
    slope: float
    """Steepest lateral over forward, against the road's axis."""
    off_paint_fraction: float
    """Share of the paint that it passes beside: that of one line lies on one smooth curve."""
    texture: float
    """Texture beside the line, over brightness: asphalt is smooth, grass is not."""
    contrast: float
    """Weber contrast of the paint against the road on both sides of it."""
    saturation_contrast: float
    """The same rise as a share of that up to white: in glare even fresh paint has little contrast."""
    brightness: float
    """Brightness of the paint over that of the road towards the vehicle, less 1."""
    longest_segment: float
    """Longest piece of paint [m], short gaps bridged."""
    dashes: int
    """Number of pieces of paint that are long enough to be dashes."""


@dataclass(frozen=True)
class Marking:
    """Kind and colour of a line's paint, and the kinds of both lines of a double one, as `Lane` has them."""

    kind: LaneKind = ""
    colour: PaintColour = ""
    sides: tuple[LaneKind, LaneKind] | None = None


@dataclass(frozen=True, eq=False)
class Candidate:
    """A line that may be a lane line, with its evidence; `refusal` says why it is none, empty where it is.

    `variant` says what proposed it: a path of the search, the nearer half of another candidate, or a parallel
    to a lane line. `marking` is told of those that are lane lines.
    """

    line: LaneLine
    evidence: LaneEvidence
    variant: Variant = "path"
    refusal: str = ""
    marking: Marking = Marking()

    @property
    def score(self) -> float:
        """Net metres of paint along its line."""
        return self.line.score

    def refused(self, reason: str) -> Candidate:
        """Return it with the reason for which it is no lane line, empty for none."""
        return replace(self, refusal=reason)
