# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What the left picture alone says: without heights, kerbs, guard rails and cars look like paint."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from lane_dp_ros.core.lane import Lane
from lane_dp_ros.core.types import LaneEvidence, LaneLine

# What paint hardly ever lacks, and what takes its place often does.
PAINT_WIDTH = (0.1, 0.28)  # m; broader are kerb stones, narrower the edges of things
BREADTH_MIN = 0.1  # a band of 0.45 m is brighter than both sides; a kerb's edge has one side as bright
BRIGHTNESS_MIN = 0.15  # over the road on the vehicle's side, less 1; a kerb's edge is hardly brighter
ROUGHNESS_MAX = 0.1  # beside the line is asphalt; more is grass, noise or a crowd
START_MAX = 12.0  # m; what begins farther off stands on the road
SCORE_MIN = 6.0  # net metres of paint
BESIDE = (0.75, 2.4)  # m; so far outside another line runs a kerb or a rail, no lane ends there

DOUBTED = 0.5  # confidence; half of what lacks one of these is paint

SAME_LINE = 0.3  # m; from one frame to the next a line moves aside by less
SHARED, SAMPLES = 3.0, 10  # m of depth that two lines must share to be compared there


def without_heights(
    lanes: Sequence[Lane], lines: Sequence[LaneLine], evidence: Sequence[LaneEvidence]
) -> tuple[Lane, ...]:
    """Return the lanes of lines, those with at most `DOUBTED` confidence that may well be something else.

    `lanes` are sorted from left to right, `lines` and their `evidence` are not.
    """
    ordered = sorted(zip(lines, evidence, strict=True), key=lambda pair: float(pair[0].n[0]))
    starts = [float(line.n[0]) for line, _ in ordered]
    return tuple(
        lane if _looks_like_paint(*pair, starts) else replace(lane, confidence=min(lane.confidence, DOUBTED))
        for lane, pair in zip(lanes, ordered, strict=True)
    )


def trusted(lanes: Sequence[Lane], known: Sequence[Lane]) -> tuple[Lane, ...]:
    """Return the lanes that are not doubted, or go on with a known one of the frame before."""
    return tuple(lane for lane in lanes if lane.confidence > DOUBTED or any(_same(lane, k) for k in known))


def _same(a: Lane, b: Lane) -> bool:
    near, far = max(a.extent[0], b.extent[0]), min(a.extent[1], b.extent[1])
    if far - near < SHARED:
        return False
    z = np.linspace(near, far, SAMPLES)
    x_a, x_b = (np.interp(z, lane.points[:, 2], lane.points[:, 0]) for lane in (a, b))
    return bool(np.abs(x_a - x_b).mean() < SAME_LINE)


def _looks_like_paint(line: LaneLine, evidence: LaneEvidence, starts: Sequence[float]) -> bool:
    aside = float(line.n[0])
    inner = [abs(aside - n) for n in starts if n * aside > 0 and abs(n) < abs(aside)]
    return (
        PAINT_WIDTH[0] <= evidence.paint_width <= PAINT_WIDTH[1]
        and evidence.wide_band_ratio >= BREADTH_MIN
        and evidence.brightness >= BRIGHTNESS_MIN
        and evidence.roughness <= ROUGHNESS_MAX
        and line.s[0] <= START_MAX
        and line.score >= SCORE_MIN
        and not any(BESIDE[0] < gap < BESIDE[1] for gap in inner)
    )
