# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Which lines are lanes: each by its own evidence first, then by how they lie to one another."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from lane_dp_ros.core.config import LaneSelectionConfig
from lane_dp_ros.core.types import LaneEvidence, LaneLine

WIDE_BAND_RATIO_MAX = (
    1.0  # contrast of a 0.45 m band over that of a 0.15 m one; more is a verge or a light patch
)
OFF_PAINT_FRACTION_MAX = (
    0.1  # share of the paint; a line that passes beside more is drawn through several things
)
SATURATION_CONTRAST_MIN = (
    0.1  # share of what is left up to white; in glare paint can be no brighter than that
)
SLOPE_PER_BEND = 7.0  # m; how much steeper lines may be on a bend, whose curvature is known roughly only

# What a kerb, a gutter, a rail or a verge has and paint lacks: little contrast, and one of the others.
KERB_CONTRAST, KERB_SATURATION_CONTRAST = 0.40, 0.35  # paint has more of one of them
KERB_STEP = 0.12  # m; the ground behind it is so much higher or lower, or it lies so deep beside the road
UNBROKEN = 4.5  # m; a dash is shorter. The following say nothing of dashes, which glare makes dim and broad.
RAIL_WIDTH, KERB_WIDTH = 0.11, 0.3  # m; paint is neither narrower nor broader
KERB_HEIGHT = 0.03  # m
KERB_BRIGHTNESS = -0.1  # over that of the lane beside it, less 1

SAME = 0.15  # m; lines so near to each other over half of the shorter one are one line found twice
BESIDE = 0.75  # m; nearer lines are a double line
STRONG = 6.0  # m of paint, in a long piece or in dashes, that lift a line above being an arrow or hatching
LONG_PIECE, DASHES = 8.0, 3  # m, number
UNKNOWN_HEIGHT = 6.0  # m of paint of a line by itself whose height is not known: what stands is a streak, too


def is_paint(line: LaneLine, evidence: LaneEvidence, config: LaneSelectionConfig, bend: float) -> bool:
    """Return whether a line has the evidence of paint, by itself. `bend` [1/m] is the road's curvature."""
    return (
        evidence.paint_width <= config.paint_width_max
        and evidence.wide_band_ratio <= WIDE_BAND_RATIO_MAX
        and (
            evidence.contrast >= config.contrast_min
            or evidence.saturation_contrast >= SATURATION_CONTRAST_MIN
        )
        and not evidence.height > config.height_max  # nor is NaN, an unknown height
        and not _is_kerb(evidence)
        and evidence.slope <= config.slope_max + SLOPE_PER_BEND * abs(bend)
        and evidence.off_paint_fraction <= OFF_PAINT_FRACTION_MAX
        and evidence.roughness <= config.texture_max
        and line.s[0] <= config.start_max
    )


def is_pale(evidence: LaneEvidence) -> bool:
    """Return whether a stripe is as pale as kerbs are."""
    return evidence.contrast < KERB_CONTRAST and evidence.saturation_contrast < KERB_SATURATION_CONTRAST


def _is_kerb(evidence: LaneEvidence) -> bool:
    """Return whether a pale stripe has a sign of a kerb, a gutter, a rail or a verge."""
    unbroken = evidence.run >= UNBROKEN
    return is_pale(evidence) and (
        evidence.step > KERB_STEP
        or evidence.height < -KERB_STEP
        or (unbroken and not RAIL_WIDTH <= evidence.paint_width <= KERB_WIDTH)
        or (unbroken and evidence.height > KERB_HEIGHT)
        or (unbroken and evidence.brightness < KERB_BRIGHTNESS)
    )


def select_lanes(
    lines: Sequence[LaneLine],
    evidence: Sequence[LaneEvidence],
    config: LaneSelectionConfig,
    kept: Sequence[int] = (),
) -> list[int]:
    """Return the indices of the lines that are lanes, `kept` ones included, strongest first.

    A line in the middle of a lane - nearer than a lane's width to a stronger one - is an arrow or
    hatching unless its own evidence is strong. A weak line counts only one lane's width from another one.
    """
    chosen = list(kept)
    for i in sorted(set(range(len(lines))) - set(kept), key=lambda i: -lines[i].score):
        gaps = [lateral_gap(lines[i], lines[k]) for k in chosen]
        inside_lane = any(BESIDE < gap < config.lane_width_min for gap in gaps)
        if lines[i].score < config.score_min or (inside_lane and not _is_strong(lines[i], evidence[i])):
            continue
        if any(_same(lines[i], lines[k]) for k in chosen) or (kept and min(gaps) <= BESIDE):
            continue
        chosen.append(i)
    return [i for i in chosen if i in kept or _stands(i, chosen, lines, evidence[i], config)]


def _same(a: LaneLine, b: LaneLine) -> bool:
    """Return whether two lines are one found twice, or pieces of one; those that merge or split soon part."""
    first, last = max(a.s[0], b.s[0]), min(a.s[-1], b.s[-1])
    if last <= first:
        return lateral_gap(a, b) <= SAME
    s = np.linspace(first, last, 20)
    together = np.abs(np.interp(s, a.s, a.n) - np.interp(s, b.s, b.n)) <= SAME
    return bool(together.all() or together.mean() * (last - first) > min(a.length, b.length) / 2)


def _is_strong(line: LaneLine, evidence: LaneEvidence) -> bool:
    """Return whether a line is more than an arrow or the ends of hatching stripes."""
    return line.score >= STRONG and (evidence.run >= LONG_PIECE or evidence.dashes >= DASHES)


def _stands(
    i: int,
    chosen: Sequence[int],
    lines: Sequence[LaneLine],
    evidence: LaneEvidence,
    config: LaneSelectionConfig,
) -> bool:
    """Return whether line i has enough paint for itself, or lies one lane's width from another."""
    known = np.isfinite(evidence.height)
    if lines[i].score >= (config.score_alone if known else max(config.score_alone, UNKNOWN_HEIGHT)):
        return True
    gaps = (lateral_gap(lines[i], lines[k]) for k in chosen if k != i)
    return any(config.lane_width_min <= gap <= config.lane_width_max for gap in gaps)


def lateral_gap(a: LaneLine, b: LaneLine) -> float:
    """Return the mean lateral distance [m] of two lines side by side, else of their nearest ends."""
    # Where they are not side by side this runs from end to end, and both keep the value of their end.
    s = np.linspace(max(a.s[0], b.s[0]), min(a.s[-1], b.s[-1]), 5)
    return float(np.abs(np.interp(s, a.s, a.n) - np.interp(s, b.s, b.n)).mean())
