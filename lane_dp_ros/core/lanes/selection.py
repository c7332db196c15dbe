# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Which candidates are lanes by how they lie to one another, strongest first."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from lane_dp_ros.core.lanes.candidate import Candidate, LaneLine
from lane_dp_ros.core.parameter import Parameters, check_order, parameter


@dataclass(frozen=True)
class LaneSelectionConfig(Parameters):
    """What makes a line a lane."""

    evidence: bool = parameter(True, "Judge lines by their evidence; else every line of the model is a lane.")
    paint_width_max: float = parameter(0.36, "Broader bands are no lane lines.", unit="m", limits=(0.1, 1.0))
    height_max: float = parameter(
        0.05, "Greatest height above the ground beside it; more is a kerb.", unit="m", limits=(0.0, 1.0)
    )
    slope_max: float = parameter(
        0.14, "Steepest lateral over forward on a straight road.", limits=(0.01, 1.0)
    )
    texture_max: float = parameter(
        0.2, "Texture over brightness of the ground beside the line; more is grass.", limits=(0.01, 1.0)
    )
    contrast_min: float = parameter(
        0.1,
        "Weber contrast of the paint against the road on both sides; in glare less will do.",
        limits=(-1.0, 1.0),
    )
    start_max: float = parameter(22.0, "Farthest beginning of a line.", unit="m", limits=(5.0, 100.0))
    score_min: float = parameter(
        1.9, "Net metres of paint of a line beside another one.", unit="m", limits=(0.5, 20.0)
    )
    score_alone: float = parameter(
        3.0, "Net metres of paint of a line by itself.", unit="m", limits=(0.5, 30.0)
    )
    lane_width_min: float = parameter(2.5, "Narrowest lane.", unit="m", limits=(1.0, 4.0))
    lane_width_max: float = parameter(4.3, "Widest lane.", unit="m", limits=(2.0, 8.0))
    wide_band_ratio_max: float = parameter(
        1.0,
        "Contrast of a 0.45 m band over that of a 0.15 m one; more is a verge or a light patch.",
        limits=(0.1, 3.0),
        expert=True,
    )
    off_paint_fraction_max: float = parameter(
        0.1,
        "Share of the paint that a line passes beside; more is drawn through several things.",
        limits=(0.0, 1.0),
        expert=True,
    )
    saturation_contrast_min: float = parameter(
        0.1,
        "Rise of the paint as a share of that up to white; in glare paint can have no more contrast.",
        limits=(0.0, 1.0),
        expert=True,
    )
    slope_per_bend: float = parameter(
        7.0,
        "How much steeper lines may be on a bend, whose curvature is known roughly only.",
        unit="m",
        limits=(0.0, 50.0),
        expert=True,
    )
    kerb_contrast_max: float = parameter(
        0.4,
        "Only stripes with less contrast are taken for kerbs.",
        limits=(0.0, 2.0),
        expert=True,
    )
    kerb_saturation_contrast_max: float = parameter(
        0.35,
        "Only stripes with less saturation contrast are taken for kerbs.",
        limits=(0.0, 1.0),
        expert=True,
    )
    kerb_step_min: float = parameter(
        0.12,
        "A kerb has the ground behind it so much higher or lower, or lies so deep beside the road.",
        unit="m",
        limits=(0.02, 0.5),
        expert=True,
    )
    unbroken_min: float = parameter(
        4.5,
        "A longer piece of paint is no dash; width, height and brightness of kerbs are asked of such.",
        unit="m",
        limits=(0.5, 20.0),
        expert=True,
    )
    rail_width_max: float = parameter(
        0.11,
        "Narrower unbroken pale stripes are rails.",
        unit="m",
        limits=(0.02, 0.3),
        expert=True,
    )
    kerb_width_min: float = parameter(
        0.3,
        "Broader unbroken pale stripes are kerbs.",
        unit="m",
        limits=(0.1, 1.0),
        expert=True,
    )
    kerb_height_min: float = parameter(
        0.03,
        "Higher unbroken pale stripes are kerbs.",
        unit="m",
        limits=(0.0, 0.3),
        expert=True,
    )
    kerb_brightness_max: float = parameter(
        -0.1,
        "Unbroken pale stripes darker than that, against the lane beside them, are kerbs.",
        limits=(-1.0, 1.0),
        expert=True,
    )
    same_line: float = parameter(
        0.15,
        "Lines so near to each other over half of the shorter one are one line found twice.",
        unit="m",
        limits=(0.02, 1.0),
        expert=True,
    )
    double_line: float = parameter(
        0.75,
        "Nearer lines are a double line.",
        unit="m",
        limits=(0.1, 2.0),
        expert=True,
    )
    strong_score: float = parameter(
        6.0,
        "Net metres of paint that lift a line above being an arrow or hatching.",
        unit="m",
        limits=(0.5, 30.0),
        expert=True,
    )
    strong_segment: float = parameter(
        8.0,
        "The same, of its longest piece.",
        unit="m",
        limits=(0.5, 30.0),
        expert=True,
    )
    strong_dashes: int = parameter(
        3,
        "The same, in dashes.",
        limits=(1, 20),
        expert=True,
    )
    score_unknown_height: float = parameter(
        9.0,
        "Net metres of paint of a line by itself whose height is not known.",
        unit="m",
        limits=(0.5, 30.0),
        expert=True,
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        check_order(self, "lane_selection", "lane_width_min", "lane_width_max")


@dataclass(frozen=True)
class Selection:
    """The candidates that are lanes, strongest first, and those refused, each with the reason."""

    lanes: tuple[Candidate, ...]
    refused: tuple[Candidate, ...]


def select_lanes(
    candidates: Sequence[Candidate], config: LaneSelectionConfig, kept: Sequence[Candidate] = ()
) -> Selection:
    """Return which of the candidates are lanes, besides those that are `kept` from a selection before.

    A line in the middle of a lane - nearer than a lane's width to a stronger one - is an arrow or
    hatching unless its own evidence is strong. A weak line counts only one lane's width from another one.
    """
    chosen, refused = list(kept), []
    for candidate in sorted(candidates, key=lambda candidate: -candidate.score):
        reason = _displaced(candidate, chosen, bool(kept), config)
        if reason:
            refused.append(candidate.refused(reason))
        else:
            chosen.append(candidate)
    lanes = []
    for i, candidate in enumerate(chosen):
        if i < len(kept) or _stands_alone(candidate, config) or _has_partner(candidate, chosen, config):
            lanes.append(candidate)
        else:
            refused.append(
                candidate.refused(f"{candidate.score:.1f} m of paint, no line a lane's width aside")
            )
    return Selection(tuple(lanes), tuple(refused))


def _displaced(
    candidate: Candidate, chosen: Sequence[Candidate], any_kept: bool, config: LaneSelectionConfig
) -> str:
    """Return why a candidate gives way to stronger ones, empty where it does not."""
    if candidate.score < config.score_min:
        return f"{candidate.score:.1f} m of paint, expected {config.score_min:g}"
    gaps = [lateral_gap(candidate.line, other.line) for other in chosen]
    inside = [gap for gap in gaps if config.double_line < gap < config.lane_width_min]
    if inside and not _is_strong(candidate, config):
        return f"weak, inside a lane: {min(inside):.1f} m beside a stronger line"
    if any(_is_same(candidate.line, other.line, config.same_line) for other in chosen):
        return "a stronger line found twice"
    if any_kept and min(gaps) <= config.double_line:
        return f"{min(gaps):.1f} m beside a lane found before"
    return ""


def _is_strong(candidate: Candidate, config: LaneSelectionConfig) -> bool:
    """Return whether a candidate is more than an arrow or the ends of hatching stripes."""
    evidence = candidate.evidence
    in_pieces = evidence.longest_segment >= config.strong_segment or evidence.dashes >= config.strong_dashes
    return candidate.score >= config.strong_score and in_pieces


def _stands_alone(candidate: Candidate, config: LaneSelectionConfig) -> bool:
    """Return whether a candidate has enough paint for a line by itself; what stands is a streak, too."""
    known = np.isfinite(candidate.evidence.height)
    enough = config.score_alone if known else max(config.score_alone, config.score_unknown_height)
    return candidate.score >= enough


def _has_partner(candidate: Candidate, chosen: Sequence[Candidate], config: LaneSelectionConfig) -> bool:
    """Return whether a candidate lies one lane's width from another one."""
    gaps = (lateral_gap(candidate.line, other.line) for other in chosen if other is not candidate)
    return any(config.lane_width_min <= gap <= config.lane_width_max for gap in gaps)


def _is_same(a: LaneLine, b: LaneLine, apart: float) -> bool:
    """Return whether two lines are one found twice, or pieces of one; those that merge or split soon part."""
    first, last = max(a.s[0], b.s[0]), min(a.s[-1], b.s[-1])
    if last <= first:
        return lateral_gap(a, b) <= apart
    s = np.linspace(first, last, 20)
    together = np.abs(np.interp(s, a.s, a.n) - np.interp(s, b.s, b.n)) <= apart
    return bool(together.all() or together.mean() * (last - first) > min(a.length, b.length) / 2)


def lateral_gap(a: LaneLine, b: LaneLine) -> float:
    """Return the mean lateral distance [m] of two lines side by side, else of their nearest ends."""
    # Where they are not side by side this runs from end to end, and both keep the value of their end.
    s = np.linspace(max(a.s[0], b.s[0]), min(a.s[-1], b.s[-1]), 5)
    return float(np.abs(np.interp(s, a.s, a.n) - np.interp(s, b.s, b.n)).mean())
