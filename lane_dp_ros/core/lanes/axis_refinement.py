# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The road's axis by the paint that was found askew of it: kerbs and shadows vote for an axis, too."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.config import LaneSelectionConfig, VanishingPointConfig
from lane_dp_ros.core.dp.robust_fit import tukey_fit
from lane_dp_ros.core.geometry.road_axis import RoadAxis
from lane_dp_ros.core.lanes.path_search import SLOPE_COST
from lane_dp_ros.core.lanes.selection import is_paint
from lane_dp_ros.core.types import LaneEvidence, LaneLine

Floats = NDArray[np.float64]

ASKEW = 0.08  # lateral over forward; lines less oblique are found well enough
WEIGHT_MIN = 2.2  # m of paint; a weaker line has no say
TOLERANCE, ROUNDS = 0.15, 4  # lateral over forward; a line that deviates more leads somewhere else
RIDGE = np.diag([1e-6, 50.0])  # m of paint, times m^2: without need the curvature stays


def turned_axis(
    candidates: Sequence[tuple[LaneLine, LaneEvidence]],
    axis: RoadAxis,
    selection: LaneSelectionConfig,
    limits: VanishingPointConfig,
) -> RoadAxis | None:
    """Return the axis along which most of the candidates' paint runs, None where that is `axis`.

    A line counts as paint by all its evidence but the slope, and weighs its metres of paint without what
    the path search took off for the slope. One of unknown height has no say: what stands on the road is
    drawn out into oblique lines in a view from above.
    """
    lines = [line for line, evidence in candidates if _is_paint(line, evidence, selection)]
    slopes = [np.gradient(line.n, line.s) for line in lines]
    weights = [_weight(*each) for each in zip(lines, slopes, strict=True)]
    heard = [i for i, weight in enumerate(weights) if weight >= WEIGHT_MIN]
    if not heard:
        return None
    middle = _weighted_median([float(slopes[i].mean()) for i in heard], [weights[i] for i in heard])
    if abs(middle) < ASKEW:
        return None
    s, slope = (np.concatenate([of[i] for i in heard]) for of in ([line.s for line in lines], slopes))
    weight = np.concatenate([np.full(len(slopes[i]), weights[i] / len(slopes[i])) for i in heard])
    A = np.column_stack([np.ones_like(s), s])
    b = tukey_fit(A, slope, weight, RIDGE, np.full(ROUNDS, TOLERANCE), np.array([middle, 0.0]))
    curvature = np.clip(axis.curvature + b[1], -limits.curvature_max, limits.curvature_max)
    return RoadAxis(axis.heading + float(np.arctan(b[0])), float(curvature))


def _is_paint(line: LaneLine, evidence: LaneEvidence, selection: LaneSelectionConfig) -> bool:
    known = bool(np.isfinite(evidence.height))
    return known and is_paint(line, replace(evidence, slope=0.0), selection, bend=0.0)


def _weight(line: LaneLine, slope: Floats) -> float:
    return line.score + SLOPE_COST * float(slope.mean()) ** 2 * line.length


def _weighted_median(values: Sequence[float], weights: Sequence[float]) -> float:
    order = np.argsort(values)
    cumulative = np.cumsum(np.asarray(weights)[order])
    return float(np.asarray(values)[order][np.searchsorted(cumulative, cumulative[-1] / 2)])
