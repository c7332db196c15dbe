# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The curves of the evidence model before they are fitted: knots, physical signs, and what each adds."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.lanes.evidence_model import Term

Floats = NDArray[Any]
Shape = Literal["rises", "falls", "peak", "valley"]

KNOTS, KNOTS_ASIDE = 5, 4  # of a curve, from the 5th to the 95th percentile; on each side of a turn
BEYOND = 2.0  # lengths of the last segment by which a curve goes on beyond its last knot, against the class
GAPS = (0.0, 0.2, 0.4, 0.75, 1.2, 1.8, 2.3, 2.7, 3.1, 3.5, 4.0, 4.6, 6.0, 9.0)  # m
OVERLAPS = (0.0, 0.2, 0.4, 0.7, 1.0)
MANY = 20  # values that are known; with fewer a curve is flat


@dataclass(frozen=True)
class Sign:
    """How a curve runs: it rises, falls, or has a peak or a valley at `turn`."""

    shape: Shape
    turn: float = 0.0


RISES, FALLS = Sign("rises"), Sign("falls")
SIGNS: Mapping[str, Mapping[str, Sign]] = {
    "paint": {
        "length": RISES,
        "score": RISES,
        "start": FALLS,
        "slope": FALLS,
        "paint_width": Sign("peak", 0.14),
        "wide_band_ratio": FALLS,
        "height": Sign("peak"),
        "kerb_step": FALLS,
        "texture": FALLS,
        "contrast": RISES,
        "saturation_contrast": RISES,
        "relative_contrast": RISES,
        "wander": FALLS,
        "brightness": RISES,
        "rise": Sign("peak"),
    },
    "edge": {
        "length": RISES,
        "start": FALLS,
        "slope": FALLS,
        "border": RISES,
        "painted": FALLS,
        "rise": Sign("valley"),
        "grey_step": Sign("valley"),
        "texture_step": RISES,
        "far_rise": Sign("valley"),
        "far_grey_step": Sign("valley"),
        "far_texture_step": RISES,
        "ground": Sign("peak"),
    },
}


@dataclass(frozen=True, eq=False)
class Curve:
    """A curve by its segments: between two knots (K + 1,) it changes by a coefficient (K,) of one sign."""

    knots: Floats
    signs: NDArray[np.int8]
    """+1: rises or is flat; -1: falls or is flat."""
    before: float = 0.0
    """Lengths of the first segment by which it goes on before the first knot."""
    behind: float = 0.0
    """The same behind the last one."""

    def segments(self, values: Floats) -> Floats:
        """Return what part of each segment lies before values (N,), (N, K); nothing of one that is NaN."""
        share = (np.nan_to_num(values)[:, None] - self.knots[:-1]) / np.diff(self.knots)
        low, high = np.zeros(len(self.signs)), np.ones(len(self.signs))
        low[0], high[-1] = -self.before, 1 + self.behind
        return np.where(np.isfinite(values)[:, None], np.clip(share, low, high), 0.0)

    def term(self, steps: Floats, unknown: float) -> Term:
        """Return the curve with coefficients `steps` (K,), 0 at its first knot."""
        lengths = np.diff(self.knots)
        at, value = list(self.knots), [0.0, *np.cumsum(steps)]
        if self.before:
            at.insert(0, self.knots[0] - self.before * lengths[0])
            value.insert(0, -self.before * steps[0])
        if self.behind:
            at.append(self.knots[-1] + self.behind * lengths[-1])
            value.append(value[-1] + self.behind * steps[-1])
        return Term(np.array(at), np.array(value), unknown)


def curve(sign: Sign, values: Floats) -> Curve:
    """Return a curve of that shape for values (N,), of which some may be NaN."""
    known = values[np.isfinite(values)]
    if len(known) < MANY:
        return Curve(np.array([0.0, 1.0]) + sign.turn, np.array([_up(sign)], np.int8))
    knots: Floats
    if sign.shape in ("peak", "valley"):
        sides = (sign.turn - known[known < sign.turn], known[known > sign.turn] - sign.turn)
        left, right = (_knots(side, KNOTS_ASIDE)[1:] for side in sides)
        knots = np.hstack([sign.turn - left[::-1], [sign.turn], sign.turn + right])
    else:
        knots = _knots(known, KNOTS)
    if len(knots) < 2:
        knots = knots[0] + np.arange(2)
    middle = (knots[1:] + knots[:-1]) / 2
    up: Floats = np.full(len(middle), _up(sign))
    if sign.shape in ("peak", "valley"):
        up = np.where(middle > sign.turn, -up, up)
    against = up[0] > 0, up[-1] < 0
    before, behind = (BEYOND if each else 0.0 for each in against)
    return Curve(knots, up.astype(np.int8), before, behind)


def _up(sign: Sign) -> int:
    return {"rises": 1, "peak": 1, "falls": -1, "valley": -1}[sign.shape]


def _knots(values: Floats, count: int) -> Floats:
    """Return up to `count` knots at equal shares of the values, apart by a fiftieth of their range."""
    if not len(values):
        return np.empty(0)
    knots: Floats = np.percentile(values, np.linspace(5, 95, count))
    apart = max(float(np.ptp(knots)) / 50, 1e-6)
    kept = [knots[0]]
    for knot in knots[1:]:
        if knot - kept[-1] > apart:
            kept.append(knot)
    return np.asarray(kept)
