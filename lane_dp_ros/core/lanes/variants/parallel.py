# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""A second look for the vehicle's own lane: faint lines parallel to the strongest one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.birdseye.paint_profile import PaintProfile, paint_gain
from lane_dp_ros.core.dp.robust_fit import tukey_fit
from lane_dp_ros.core.lanes.candidate import LaneLine
from lane_dp_ros.core.lanes.line_fit import MIN_ROWS
from lane_dp_ros.core.parameter import Parameters, check_order, parameter

Floats = NDArray[np.float64]

SMOOTHING = 2.0  # m along the line, over which contrast is averaged: faint paint adds up, texture does not
CONTRAST_CAP = 2.5  # one bright spot counts no more than this
TEN_METRES = 10.0  # the unit of s in the fit, to condition it
RIDGE = np.diag([1e-6, 2.0])  # rows of paint; a parallel is moved freely and turned a little
TOLERANCE, ROUNDS = 0.2, 5  # m; paint farther from the line is not its own


@dataclass(frozen=True)
class ParallelConfig(Parameters):
    """The second look for faint borders of the own lane."""

    contrast_min: float = parameter(
        0.4,
        "Contrast of no paint, averaged along the line, in units of the road's texture.",
        limits=(0.0, 10.0),
        expert=True,
    )
    contrast_max: float = parameter(
        1.4,
        "Contrast of certain paint, likewise.",
        limits=(0.1, 20.0),
        expert=True,
    )
    blank_cost: float = parameter(
        0.15,
        "Metres of paint that a metre of blank road costs.",
        limits=(0.01, 1.0),
        expert=True,
    )
    score_min: float = parameter(
        1.8,
        "Net metres of paint.",
        unit="m",
        limits=(0.5, 20.0),
        expert=True,
    )
    lane_width_min: float = parameter(2.5, "Narrowest lane.", unit="m", limits=(1.0, 4.0), expert=True)
    lane_width_max: float = parameter(4.3, "Widest lane.", unit="m", limits=(2.0, 8.0), expert=True)
    ego_max: float = parameter(
        3.0,
        "How far aside the own lane's border can be.",
        unit="m",
        limits=(1.0, 6.0),
        expert=True,
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        check_order(self, "parallel", "contrast_min", "contrast_max")
        check_order(self, "parallel", "lane_width_min", "lane_width_max")


def parallel_lines(lines: Sequence[LaneLine], paint: PaintProfile, config: ParallelConfig) -> list[LaneLine]:
    """Return faint lines that run parallel to the strongest of `lines` where the own lane lacks a border.

    Each lies one lane's width from a given line, on a side of the vehicle that has none; strongest first.
    Empty where both sides have one or there is no line to be parallel to.
    """
    if not lines:
        return []
    view = paint.view
    strongest = max(lines, key=lambda line: line.score)
    shape = np.interp(view.s, strongest.s, strongest.n) - strongest.n[0]
    offsets = [float(np.median(line.n - np.interp(line.s, view.s[::-1], shape[::-1]))) for line in lines]
    missing = [side for side in (-1, 1) if not any(0 < side * n < config.lane_width_max for n in offsets)]
    if not missing:
        return []
    gain = _gain(paint, shape, config)
    score, first, last = best_stretches(gain[::-1])
    found = []
    for column in np.argsort(-score):
        n = view.n[column]
        if score[column] < config.score_min:
            break
        gaps = [abs(n - other) for other in offsets]
        rows = len(view.s) - 1 - np.arange(first[column], last[column] + 1)
        if len(rows) < MIN_ROWS:
            continue
        if any(0 < side * n < config.ego_max for side in missing) and (
            config.lane_width_min <= min(gaps) <= config.lane_width_max
        ):
            found.append(_fitted(paint, rows, n + shape[rows], float(score[column])))
            offsets.append(float(n))
            missing = [side for side in missing if side * n < 0]
    return found


def best_stretches(
    gain: NDArray[np.float32],
) -> tuple[NDArray[np.float32], NDArray[np.intp], NDArray[np.intp]]:
    """Return the largest sum of consecutive rows of each column of `gain`, and its first and last row.

    `gain` (rows, columns). Kadane's algorithm on all columns at once; the sum is 0 where no row gains.
    """
    columns = gain.shape[1]
    current, best = np.zeros(columns, np.float32), np.zeros(columns, np.float32)
    start, first, last = (np.zeros(columns, np.intp) for _ in range(3))
    for row, values in enumerate(gain):
        start[current <= 0] = row
        current = np.maximum(current, 0) + values
        better = current > best
        best[better], first[better], last[better] = current[better], start[better], row
    return best, first, last


def _gain(paint: PaintProfile, shape: Floats, config: ParallelConfig) -> NDArray[np.float32]:
    """Return the gain [m] of each row of the line n(s) = n[column] + shape(s), (rows, columns)."""
    view, paint_map = paint.view, paint.paint_map
    per_row, per_column = view.resolution
    columns = np.arange(len(view.n), dtype=np.float32)
    map_u = (columns[None] + (shape / per_column)[:, None]).astype(np.float32)
    map_v = np.repeat(np.arange(len(view.s), dtype=np.float32)[:, None], len(columns), axis=1)
    contrast = np.where(paint_map.seen, np.clip(paint_map.contrast, -1, CONTRAST_CAP), 0).astype(np.float32)
    moved = cv2.remap(
        contrast, map_u, map_v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT, borderValue=-1
    )
    smooth = cv2.blur(cv2.dilate(moved, np.ones((1, 3), np.uint8)), (1, round(SMOOTHING / per_row)))
    painted = np.clip((smooth - config.contrast_min) / (config.contrast_max - config.contrast_min), 0, 1)
    return np.asarray(paint_gain(painted, config.blank_cost) * per_row, dtype=np.float32)


def _fitted(paint: PaintProfile, rows: NDArray[np.intp], parallel: Floats, score: float) -> LaneLine:
    """Return the line n = `parallel` (N,) [m], moved and turned a little onto the centres of its paint."""
    n, weight = paint.centres(rows, paint.view.columns(parallel))
    s = paint.view.s[rows]
    A = np.vander((s - s.mean()) / TEN_METRES, 2, increasing=True)
    b = tukey_fit(A, n - parallel, weight + 1e-6, RIDGE, np.full(ROUNDS, TOLERANCE))
    return LaneLine(rows, s, A @ b + parallel, 0.0, score)
