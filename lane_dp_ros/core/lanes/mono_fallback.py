# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What the left picture alone says: without heights, kerbs, guard rails and cars look like paint."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from lane_dp_ros.core.birdseye.birds_eye import BirdsEyeView
from lane_dp_ros.core.lanes.candidate import Candidate
from lane_dp_ros.core.lanes.lifting import left_to_right, to_lanes
from lane_dp_ros.core.parameter import Parameters, parameter
from lane_dp_ros.core.types import Lane, with_roles

SAME_LINE = 0.3  # m; from one frame to the next a line moves aside by less
SHARED, SAMPLES = 3.0, 10  # m of depth that two lines must share to be compared there


@dataclass(frozen=True)
class MonoFallbackConfig(Parameters):
    """What paint hardly ever lacks, and what takes its place often does, where no heights are known."""

    paint_width_min: float = parameter(
        0.1,
        "Narrower are the edges of things.",
        unit="m",
        limits=(0.02, 0.5),
        expert=True,
    )
    paint_width_max: float = parameter(
        0.28,
        "Broader are kerb stones.",
        unit="m",
        limits=(0.1, 1.0),
        expert=True,
    )
    wide_band_ratio_min: float = parameter(
        0.1,
        "A 0.45 m band is brighter than both sides; a kerb's edge has one side as bright.",
        limits=(-1.0, 1.0),
        expert=True,
    )
    brightness_min: float = parameter(
        0.15,
        "Over the road on the vehicle's side, less 1; a kerb's edge is hardly brighter.",
        limits=(-1.0, 1.0),
        expert=True,
    )
    texture_max: float = parameter(
        0.1,
        "Beside the line is asphalt; more is grass, noise or a crowd.",
        limits=(0.01, 1.0),
        expert=True,
    )
    start_max: float = parameter(
        12.0,
        "What begins farther off stands on the road.",
        unit="m",
        limits=(5.0, 100.0),
        expert=True,
    )
    score_min: float = parameter(
        6.0,
        "Net metres of paint.",
        unit="m",
        limits=(0.5, 30.0),
        expert=True,
    )
    gap_min: float = parameter(
        0.75,
        "So far outside another line runs a kerb or a rail, no lane ends there.",
        unit="m",
        limits=(0.1, 3.0),
        expert=True,
    )
    gap_max: float = parameter(
        2.4,
        "Up to so far.",
        unit="m",
        limits=(0.5, 5.0),
        expert=True,
    )
    doubted_confidence: float = parameter(
        0.5,
        "Of what lacks one of these; half of it is paint.",
        limits=(0.05, 1.0),
        expert=True,
    )


def mono_lanes(
    candidates: Sequence[Candidate],
    view: BirdsEyeView,
    known: Sequence[Lane] | None,
    config: MonoFallbackConfig,
) -> tuple[tuple[Lane, ...], tuple[Candidate, ...]]:
    """Return the lanes of candidates whose heights are not known, and the candidates that are none after all.

    What may well be something else has little confidence, and is a lane only where it continues a `known` one
    of the frame before (None: nothing is followed over time, all are lanes). Both go from left to right.
    """
    ordered = left_to_right(candidates)
    lanes = without_heights(to_lanes(ordered, view), ordered, config)
    kept = [known is None or is_kept(lane, known, config) for lane in lanes]
    doubted = [candidate for candidate, keep in zip(ordered, kept, strict=True) if not keep]
    reason = "may be a kerb or a rail: its height is not known, nor was there a lane before"
    lanes = tuple(lane for lane, keep in zip(lanes, kept, strict=True) if keep)
    return with_roles(lanes), tuple(candidate.refused(reason) for candidate in doubted)


def without_heights(
    lanes: Sequence[Lane], candidates: Sequence[Candidate], config: MonoFallbackConfig
) -> tuple[Lane, ...]:
    """Return the lanes of candidates, from left to right, with little confidence in what may be no paint."""
    starts = [float(candidate.line.n[0]) for candidate in candidates]
    doubted = config.doubted_confidence
    return tuple(
        lane
        if _looks_like_paint(candidate, starts, config)
        else replace(lane, confidence=min(lane.confidence, doubted))
        for lane, candidate in zip(lanes, candidates, strict=True)
    )


def is_kept(lane: Lane, known: Sequence[Lane], config: MonoFallbackConfig) -> bool:
    """Return whether a lane is not doubted, or continues one that was `known` in the frame before."""
    return lane.confidence > config.doubted_confidence or any(_is_same(lane, each) for each in known)


def _is_same(a: Lane, b: Lane) -> bool:
    near, far = max(a.extent[0], b.extent[0]), min(a.extent[1], b.extent[1])
    if far - near < SHARED:
        return False
    z = np.linspace(near, far, SAMPLES)
    x_a, x_b = (np.interp(z, lane.points[:, 2], lane.points[:, 0]) for lane in (a, b))
    return bool(np.abs(x_a - x_b).mean() < SAME_LINE)


def _looks_like_paint(candidate: Candidate, starts: Sequence[float], config: MonoFallbackConfig) -> bool:
    line, evidence = candidate.line, candidate.evidence
    aside = float(line.n[0])
    inner = [abs(aside - n) for n in starts if n * aside > 0 and abs(n) < abs(aside)]
    return (
        config.paint_width_min <= evidence.paint_width <= config.paint_width_max
        and evidence.wide_band_ratio >= config.wide_band_ratio_min
        and evidence.brightness >= config.brightness_min
        and evidence.texture <= config.texture_max
        and line.s[0] <= config.start_max
        and line.score >= config.score_min
        and not any(config.gap_min < gap < config.gap_max for gap in inner)
    )
