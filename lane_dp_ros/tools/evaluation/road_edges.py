# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The sum of judged road edges: unpainted borders of the carriageway."""

from __future__ import annotations

from dataclasses import dataclass, field

from lane_dp_ros.tools.evaluation.lateral import Mean
from lane_dp_ros.tools.evaluation.scores import RoadEdgeScore


@dataclass(frozen=True)
class RoadEdgeSummary:
    """Counts over any number of frames whose road edges were judged; summaries add up.

    `labels`: sure labels of kind "edge" that take part, of which `matched` were found; `error` [m] is their
    mean lateral error. `false_edges` match no such label and run along no label of any kind.
    """

    frames: int = 0
    labels: int = 0
    matched: int = 0
    detections: int = 0
    false_edges: int = 0
    error: Mean = field(default_factory=Mean)

    @classmethod
    def of(cls, score: RoadEdgeScore | None) -> RoadEdgeSummary:
        """Return the summary of one frame, of nothing where its road edges were not judged."""
        if score is None:
            return cls()
        error = Mean(sum(match.error for match in score.found), len(score.found))
        counts = len(score.labels), len(score.found), len(score.judged), score.false_lines
        return cls(1, *counts, error)

    def __add__(self, other: RoadEdgeSummary) -> RoadEdgeSummary:
        return RoadEdgeSummary(
            self.frames + other.frames,
            self.labels + other.labels,
            self.matched + other.matched,
            self.detections + other.detections,
            self.false_edges + other.false_edges,
            self.error + other.error,
        )

    @property
    def recall(self) -> float:
        """Share of the labels that were found, nan without any."""
        return self.matched / self.labels if self.labels else float("nan")

    @property
    def false_per_frame(self) -> float:
        """False road edges per frame, nan without any frame."""
        return self.false_edges / self.frames if self.frames else float("nan")
