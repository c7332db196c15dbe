# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""How lines lie to one another: their gaps, and what each two of them can be together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.dp.ordered_choice import NEVER
from lane_dp_ros.core.lanes.candidate import LaneLine
from lane_dp_ros.core.lanes.evidence_model import CLASSES, PAIRS, EvidenceModel

Floats = NDArray[Any]
Masks = NDArray[np.bool_]

STEP = 1.0  # m along the road at which lines are compared
SAME_PLACE = 0.2  # m; two lines so near show the same paint
SAME_PAINT = 0.5  # share of the shorter line; two that have more in one place are not both lines
ONE_LINE = 0.35  # m; lines that are so near on average tell of one
PAINT, EDGE = range(len(CLASSES))


@dataclass(frozen=True, eq=False)
class Neighbours:
    """Lines (N,) from left to right, two by two (N, N).

    `gap` [m] is the mean lateral distance where both run, else that of the ends that face one another;
    `overlap` the share of the shorter one that lies in the place of the other. `left` (N,): lines that begin
    left of the vehicle.
    """

    gap: Floats
    overlap: Floats
    left: Masks

    @classmethod
    def of(cls, lines: Sequence[LaneLine]) -> Neighbours:
        """Return how lines, given from left to right, lie to one another."""
        if not lines:
            return cls(np.empty((0, 0)), np.empty((0, 0)), np.empty(0, bool))
        s = np.arange(min(line.s[0] for line in lines), max(line.s[-1] for line in lines) + STEP, STEP)
        n = np.array([np.interp(s, line.s, line.n) for line in lines])
        runs = np.array([(s >= line.s[0] - STEP / 2) & (s <= line.s[-1] + STEP / 2) for line in lines])
        both = runs[:, None] & runs[None]
        apart = np.abs(n[:, None] - n[None])
        shared = both.sum(axis=2)
        gap = np.where(both, apart, 0).sum(axis=2) / np.maximum(shared, 1)
        for i, j in zip(*np.nonzero(shared == 0), strict=True):
            gap[i, j] = _between_ends(lines[i], lines[j])
        length = runs.sum(axis=1)
        same = (both & (apart <= SAME_PLACE)).sum(axis=2)
        overlap = same / np.maximum(np.minimum(length[:, None], length[None]), 1)
        return cls(gap, overlap, np.array([line.n[0] < 0 for line in lines]))

    @property
    def one_line(self) -> Masks:
        """Return which two show one line, (N, N), each with itself."""
        return np.asarray((self.gap <= ONE_LINE) | np.eye(len(self.gap), dtype=bool))

    @property
    def one_paint(self) -> Masks:
        """Return which two show the same paint, (N, N): they are not both lane lines."""
        return np.asarray(self.overlap > SAME_PAINT)

    def log_odds(self, model: EvidenceModel) -> Floats:
        """Return what each two lines are worth together, (N, N, classes, classes), the left one first."""
        total = np.zeros((*self.gap.shape, len(CLASSES), len(CLASSES)))
        for name, where in relations(self.left).items():
            total += where * model.pairs[name](self.measure(name))[..., None, None]
        total[self.one_paint, PAINT, PAINT] = NEVER
        return total

    def measure(self, name: str) -> Floats:
        """Return what a term of pairs is a curve of, (N, N)."""
        return self.overlap if name == "paint_on_paint" else self.gap


def relations(left: Masks) -> dict[str, Masks]:
    """Return to which two lines of which classes each of `PAIRS` applies, (N, N, classes, classes)."""
    both = np.zeros((len(left), len(left), len(CLASSES), len(CLASSES)), bool)
    where: dict[str, Masks] = {name: both.copy() for name in PAIRS}
    on_left, on_right = left[:, None] & left[None], ~left[:, None] & ~left[None]
    across = ~on_left & ~on_right
    where["paint_beside_paint"][..., PAINT, PAINT] = True
    where["paint_on_paint"][..., PAINT, PAINT] = True
    where["paint_before_edge"][..., EDGE, PAINT] = on_left
    where["paint_before_edge"][..., PAINT, EDGE] = on_right
    where["paint_behind_edge"][..., PAINT, EDGE] = on_left
    where["paint_behind_edge"][..., EDGE, PAINT] = on_right
    where["edge_behind_edge"][..., EDGE, EDGE] = ~across
    where["paint_across_edge"][..., PAINT, EDGE] = across
    where["paint_across_edge"][..., EDGE, PAINT] = across
    where["edge_across_edge"][..., EDGE, EDGE] = across
    return where


def _between_ends(a: LaneLine, b: LaneLine) -> float:
    """Return the lateral distance [m] of the ends that face one another, of lines one behind the other."""
    near, far = (a, b) if a.s[-1] < b.s[0] else (b, a)
    return float(abs(near.n[-1] - far.n[0]))
