# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Which candidates are lane lines and which are road edges, all decided together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.dp.ordered_choice import NEVER, NONE, best_choice, marginals
from lane_dp_ros.core.lanes.candidate import Candidate
from lane_dp_ros.core.lanes.evidence_model import SHIPPED, EvidenceModel, evidence_model
from lane_dp_ros.core.lanes.neighbours import EDGE, PAINT, Neighbours
from lane_dp_ros.core.parameter import Parameters, parameter

Floats = NDArray[Any]

HOPELESS = -5.0  # log-odds; no neighbours make a line of less


@dataclass(frozen=True)
class LaneSelectionConfig(Parameters):
    """What makes a line a lane."""

    evidence: bool = parameter(True, "Judge lines by their evidence; else every line of the model is a lane.")
    evidence_model: str = parameter(
        SHIPPED, "File of lane_dp fit-evidence with the log-odds of the evidence, or: shipped."
    )
    confidence_min: float = parameter(
        0.3, "Probability that it takes to be a lane line or a road edge.", limits=(0.05, 0.99)
    )
    paint_width_max: float = parameter(
        0.4,
        "Broader bands are no lane lines, whatever else speaks for them.",
        unit="m",
        limits=(0.1, 1.0),
        expert=True,
    )
    wide_band_ratio_max: float = parameter(
        1.0,
        "Contrast of a 0.45 m band over that of a 0.15 m one; more is a verge or a light patch.",
        limits=(0.1, 3.0),
        expert=True,
    )
    height_max: float = parameter(
        0.1,
        "What is higher above the ground beside it is no paint.",
        unit="m",
        limits=(0.0, 1.0),
        expert=True,
    )
    unknown_height_slope_max: float = parameter(
        0.14,
        "Steepest lateral over forward of a line whose height is not known.",
        limits=(0.01, 1.0),
        expert=True,
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        evidence_model(self.evidence_model)


def select(
    candidates: Sequence[Candidate], model: EvidenceModel, config: LaneSelectionConfig
) -> list[Candidate]:
    """Return the candidates, each with its probabilities, and whether it is a lane line, an edge, or neither.

    Neighbours count: a line in the middle of a lane speaks against both its borders, one a lane's width from
    another for it, see `ordered_choice`. Several candidates may be one line: it is as probable as all of them
    together.
    """
    hopeful = [i for i, each in enumerate(candidates) if max(each.log_odds) > HOPELESS]
    hopeful.sort(key=lambda i: float(candidates[i].line.n[0]))
    neighbours = Neighbours.of([candidates[i].line for i in hopeful])
    worth = np.maximum([candidates[i].log_odds for i in hopeful], NEVER).reshape(-1, 2)
    together = neighbours.log_odds(model)
    classes = best_choice(worth, together)
    own = marginals(worth[None], together[None]).of_things[0]
    probable = np.minimum((neighbours.one_line @ own), 1.0)
    classes = [
        kind if kind == NONE or probable[i, kind] >= config.confidence_min else NONE
        for i, kind in enumerate(classes)
    ]
    lanes = np.array([kind == PAINT for kind in classes], bool)
    twins = (neighbours.one_line & lanes).any(axis=1)
    judged = {
        i: _judged(candidates[i], *of) for i, *of in zip(hopeful, classes, probable, twins, strict=True)
    }
    return [
        judged[i] if i in judged else replace(each, probability=(0.0, 0.0), refusal=_reason(each, 0.0))
        for i, each in enumerate(candidates)
    ]


def _judged(candidate: Candidate, kind: int, probability: Floats, twin: bool) -> Candidate:
    """Return a candidate of a class; a `twin` lies where a lane line does."""
    paint, edge = (float(each) for each in probability)
    if kind == PAINT:
        refusal = ""
    elif kind == EDGE:
        refusal = "a road edge"
    else:
        refusal = "a line found twice" if twin and not candidate.refusal else _reason(candidate, paint)
    return replace(candidate, probability=(paint, edge), refusal=refusal, is_edge=kind == EDGE)


def _reason(candidate: Candidate, probability: float) -> str:
    """Return why a candidate is no lane line."""
    if candidate.refusal:
        return candidate.refusal
    own = candidate.log_odds[PAINT]
    if own > 0:
        return f"log-odds {own:+.1f}, but {probability:.2f} beside the other lines"
    return f"log-odds {own:+.1f}"
