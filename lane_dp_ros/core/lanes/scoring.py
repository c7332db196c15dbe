# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The log-odds of candidates by their own evidence, and the few things that no paint can be."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.lanes.candidate import Candidate, LaneEvidence
from lane_dp_ros.core.lanes.evidence_model import CLASSES, evidence_model
from lane_dp_ros.core.lanes.selection import LaneSelectionConfig, select

Floats = NDArray[Any]

HEIGHT = ("height", "kerb_step")
COURSE = ("slope", "off_paint_fraction")
HEIGHT_DECIDES = -4.0  # log-odds; of what has less, at the best height, no neighbours make a line


class EvidenceScoring:
    """Scores candidates by the evidence model that a configuration names."""

    def __init__(self, config: LaneSelectionConfig) -> None:
        self.config, self.model = config, evidence_model(config.evidence_model)

    def scored(self, candidates: Sequence[Candidate]) -> list[Candidate]:
        """Return candidates with their log-odds, and the reason where one can be no paint."""
        evidence = [each.evidence for each in candidates]
        paint, edge = (self.model.log_odds(kind, evidence).tolist() for kind in CLASSES)
        return [
            replace(each, log_odds=(-np.inf if reason else paint[i], edge[i]), refusal=reason)
            for i, each in enumerate(candidates)
            for reason in [self._impossible(each)]
        ]

    def selected(self, candidates: Sequence[Candidate]) -> list[Candidate]:
        """Return the candidates, each told what it is in the light of all others, see `select`."""
        return select(candidates, self.model, self.config)

    def needs_height(self, evidence: Sequence[LaneEvidence]) -> NDArray[np.bool_]:
        """Return of which lines (N,) the height may decide whether they are paint."""
        terms = [self.model.terms["paint"][name] for name in HEIGHT if name in self.model.terms["paint"]]
        at_best = sum(term.highest - term.unknown for term in terms)
        return np.asarray(self.model.log_odds("paint", evidence, HEIGHT) + at_best > HEIGHT_DECIDES)

    def but_for_course(self, evidence: Sequence[LaneEvidence]) -> Floats:
        """Return the log-odds (N,) of paint by all but where lines lead: steeply, or past their paint."""
        return self.model.log_odds("paint", evidence, COURSE)

    def _impossible(self, candidate: Candidate) -> str:
        """Return why a candidate can be no paint, whatever else speaks for it; empty where it can."""
        evidence, config = candidate.evidence, self.config
        if candidate.variant == "border":
            return "a border without paint"
        # What stands on the road is drawn out obliquely in the view from above.
        steep = evidence.slope if np.isnan(evidence.height) else 0.0
        caps = (
            (evidence.paint_width, config.paint_width_max, "{:.2f} m broad"),
            (evidence.wide_band_ratio, config.wide_band_ratio_max, "as bright beside as on it"),
            (abs(evidence.height), config.height_max, "{:.2f} m above or below the road"),
            (steep, config.unknown_height_slope_max, "slope {:.2f}, of unknown height"),
        )
        return next((text.format(value) for value, most, text in caps if value > most), "")
