# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The road's axis by the paint that was found askew of it: kerbs and shadows vote for an axis, too."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.dp.robust_fit import tukey_fit
from lane_dp_ros.core.geometry.road_axis import RoadAxis
from lane_dp_ros.core.lanes.candidate import Candidate, LaneLine
from lane_dp_ros.core.lanes.scoring import EvidenceScoring
from lane_dp_ros.core.parameter import Parameters, parameter

Floats = NDArray[np.float64]

TOLERANCE, ROUNDS = 0.15, 4  # lateral over forward; a line that deviates more leads somewhere else
RIDGE = np.diag([1e-6, 50.0])  # m of paint, times m^2: without need the curvature stays


@dataclass(frozen=True)
class AxisRefinementConfig(Parameters):
    """When the paint that was found turns the road's axis."""

    slope_min: float = parameter(
        0.08,
        "Lateral over forward; lines less oblique are found well enough.",
        limits=(0.0, 0.5),
        expert=True,
    )
    score_min: float = parameter(
        2.2,
        "Net metres of paint of a line that has a say.",
        unit="m",
        limits=(0.5, 20.0),
        expert=True,
    )


class AxisRefinement:
    """Turns the axis to the paint that was found.

    `slope_cost` is what the path search took off a line's metres of paint for its slope, `curvature_max`
    [1/m] that of the sharpest bend.
    """

    def __init__(
        self,
        config: AxisRefinementConfig,
        scoring: EvidenceScoring,
        slope_cost: float,
        curvature_max: float,
    ) -> None:
        self._config, self._scoring = config, scoring
        self._slope_cost, self._curvature_max = slope_cost, curvature_max

    def refine(self, candidates: Sequence[Candidate], axis: RoadAxis) -> RoadAxis | None:
        """Return the axis along which most of the candidates' paint runs, None where that is `axis`.

        A line counts as paint by all its evidence but the slope, and weighs its metres of paint without what
        was taken off for the slope. One of unknown height has no say: what stands on the road is drawn out
        into oblique lines in a view from above.
        """
        lines = self._paint(candidates)
        slopes = [np.gradient(line.n, line.s) for line in lines]
        weights = [_weight(line, slope, self._slope_cost) for line, slope in zip(lines, slopes, strict=True)]
        heard = [i for i, weight in enumerate(weights) if weight >= self._config.score_min]
        if not heard:
            return None
        middle = _weighted_median([float(slopes[i].mean()) for i in heard], [weights[i] for i in heard])
        if abs(middle) < self._config.slope_min:
            return None
        s, slope = (np.concatenate([of[i] for i in heard]) for of in ([line.s for line in lines], slopes))
        weight = np.concatenate([np.full(len(slopes[i]), weights[i] / len(slopes[i])) for i in heard])
        A = np.column_stack([np.ones_like(s), s])
        b = tukey_fit(A, slope, weight, RIDGE, np.full(ROUNDS, TOLERANCE), np.array([middle, 0.0]))
        curvature = float(np.clip(axis.curvature + b[1], -self._curvature_max, self._curvature_max))
        return RoadAxis(axis.heading + float(np.arctan(b[0])), curvature)

    def _paint(self, candidates: Sequence[Candidate]) -> list[LaneLine]:
        """Return the lines of known height that are paint by all but their course."""
        odds = self._scoring.but_for_course([candidate.evidence for candidate in candidates])
        return [
            candidate.line
            for candidate, each in zip(candidates, odds, strict=True)
            if each > 0 and np.isfinite(candidate.evidence.height)
        ]


def _weight(line: LaneLine, slope: Floats, slope_cost: float) -> float:
    return line.score + slope_cost * float(slope.mean()) ** 2 * line.length


def _weighted_median(values: Sequence[float], weights: Sequence[float]) -> float:
    order = np.argsort(values)
    cumulative = np.cumsum(np.asarray(weights)[order])
    return float(np.asarray(values)[order][np.searchsorted(cumulative, cumulative[-1] / 2)])
