# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The figures of a fit: how its model fares on what it saw, and others on what they did not see."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields

from lane_dp_ros.tools.evaluation.reliability import confidences, reliability, road_edge_scores
from lane_dp_ros.tools.evaluation.scores import FrameScore
from lane_dp_ros.tools.evaluation.summary import summarise

DIGITS = 3
HEADS = (
    ("", "frames"),
    ("", "precision"),
    ("", "recall"),
    ("detection", "precision"),
    ("", "strict"),
    ("without paint", "frames"),
    ("", "false"),
    ("road edges", "recall"),
    ("", "false"),
    ("calibration", "error"),
    ("", "of edges"),
)


@dataclass(frozen=True)
class Figures:
    """The numbers of a set of judged frames, see docs/evaluation.md; None where there is nothing to count.

    `unpainted_false_lanes` were found in the `unpainted_frames`. The calibration errors are the expected ones
    of lane lines and of road edges.
    """

    frames: int
    precision: float | None
    recall: float | None
    detection_precision: float | None
    detection_precision_strict: float | None
    unpainted_frames: int
    unpainted_false_lanes: int
    edge_recall: float | None
    false_edges: int
    calibration_error: float | None
    edge_calibration_error: float | None

    @classmethod
    def of(cls, results: Sequence[FrameScore]) -> Figures:
        """Return the figures of judged frames."""
        total = summarise(results)
        edges = road_edge_scores(results)
        return cls(
            total.frames,
            _rounded(total.paper_precision),
            _rounded(total.lane_recall),
            _rounded(total.detection_precision),
            _rounded(total.strict_detection_precision),
            total.unpainted_frames,
            total.unpainted_false_lanes,
            _rounded(total.road_edges.recall),
            total.road_edges.false_edges,
            _rounded(reliability(*confidences(results)).error),
            _rounded(reliability(*confidences(edges)).error),
        )


def as_json(figures: Mapping[str, Figures]) -> dict[str, dict[str, float | None]]:
    """Return the figures as what a file holds."""
    return {name: asdict(each) for name, each in figures.items()}


def table(title: str, figures: Mapping[str, Figures]) -> str:
    """Return a table of figures, a line for each set of frames; "-" where there is nothing to count."""
    rows = [[name, *(_cell(getattr(each, f.name)) for f in fields(each))] for name, each in figures.items()]
    rows = [["", *(top for top, _ in HEADS)], [title, *(bottom for _, bottom in HEADS)], *rows]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = [[row[0].ljust(widths[0]), *map(str.rjust, row[1:], widths[1:])] for row in rows]
    return "\n".join("  ".join(line).rstrip() for line in lines)


def _rounded(value: float) -> float | None:
    return round(value, DIGITS) if math.isfinite(value) else None


def _cell(value: float | None) -> str:
    if value is None:
        return "-"
    return str(value) if isinstance(value, int) else f"{value:.{DIGITS}f}"
