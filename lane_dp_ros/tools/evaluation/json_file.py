# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""An evaluation as a JSON file: docs/evaluation.md."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.tools.evaluation.depth import DepthErrors
from lane_dp_ros.tools.evaluation.reliability import (
    CONFIDENCE_BINS,
    confidences,
    reliability,
    road_edge_scores,
)
from lane_dp_ros.tools.evaluation.scores import FrameScore, JudgedLine, LineScores, Match, RoadEdgeScore
from lane_dp_ros.tools.evaluation.summary import by_category, by_sequence
from lane_dp_ros.tools.evaluation.summary_json import number, summary_json

FORMAT = "lane_dp evaluation 1"


def check_json_output(path: Path) -> None:
    """Raise CommandError for a file that is there and is no earlier evaluation: it would be lost."""
    if not path.exists():
        return
    try:
        earlier = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        earlier = None
    if not (isinstance(earlier, dict) and earlier.get("format") == FORMAT):
        raise CommandError(f"{path} exists already and is no evaluation: choose another name for --json")


def write_json(results: Sequence[FrameScore], notes: Sequence[str], path: Path) -> None:
    """Write an evaluation as JSON; the file appears complete or not at all."""
    text = json.dumps(as_json(results, notes), indent=1, allow_nan=False) + "\n"
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        part.write_text(text, encoding="utf-8")
        part.replace(path)
    except OSError as error:
        raise CommandError(f"cannot write {path}: {error.strerror}") from None
    finally:
        part.unlink(missing_ok=True)


def as_json(results: Sequence[FrameScore], notes: Sequence[str]) -> dict[str, Any]:
    """Return an evaluation as what JSON can hold; null stands where there was nothing to count."""
    sequences, categories = by_sequence(results), by_category(results)
    total = sequences.pop("total")
    categories.pop("total")
    return {
        "format": FORMAT,
        "total": summary_json(total),
        "sequences": {name: summary_json(summary) for name, summary in sequences.items()},
        "categories": {name: summary_json(summary) for name, summary in categories.items()},
        "reliability": _reliability_json(results),
        "road_edge_reliability": _reliability_json(road_edge_scores(results)),
        "notes": list(notes),
        "frames": [_frame_json(result) for result in results],
    }


def _reliability_json(results: Sequence[LineScores]) -> dict[str, Any]:
    bins = reliability(*confidences(results))
    rows = zip(CONFIDENCE_BINS, bins.confidence, bins.right, bins.counts, strict=False)
    return {
        "expected_calibration_error": number(bins.error),
        "bins": [
            {"from": float(low), "mean": number(float(mean)), "right": int(right), "lines": int(lines)}
            for low, mean, right, lines in rows
        ],
    }


def _frame_json(result: FrameScore) -> dict[str, Any]:
    return {
        "name": result.name,
        "sequence": result.sequence,
        "category": result.category,
        "stamp_ns": result.stamp_ns,
        "ego_labels": list(result.ego_labels),
        "incorrect": list(result.incorrect),
        "missed": list(result.missed),
        "latency": result.latency,
        "depth_errors": _depth_errors_json(result.depth),
        "matches": [_match_json(match) for match in result.matches],
        "detections": [_detection_json(detection) for detection in result.detections],
        "road_edges": None if result.road_edges is None else _edges_of_frame_json(result.road_edges),
    }


def _detection_json(detection: JudgedLine) -> dict[str, Any]:
    lane = detection.lane
    told = {"id": lane.id, "role": lane.role, "kind": lane.kind, "colour": lane.colour}
    verdicts = {"verdict": detection.verdict, "strict_verdict": detection.strict_verdict}
    return {**told, "confidence": lane.confidence, **verdicts}


def _edges_of_frame_json(edges: RoadEdgeScore) -> dict[str, Any]:
    return {
        "labels": list(edges.labels),
        "matches": [_match_json(match) for match in edges.matches],
        "detections": [
            {"id": d.lane.id, "confidence": d.lane.confidence, "verdict": d.verdict} for d in edges.detections
        ],
    }


def _match_json(match: Match) -> dict[str, Any]:
    errors = {"error": match.error, "error_near": match.near, "error_far": match.far}
    in_space = {"error_3d_near": match.in_space.near, "error_3d_far": match.in_space.far}
    return {"label": match.label, "detection": match.detection, "counts": match.counts, **errors, **in_space}


def _depth_errors_json(depth: DepthErrors | None) -> list[float | None] | None:
    """Return the errors at each depth of the curve; null for a frame in which no surface is known."""
    return None if depth is None or not depth.measured else [number(error) for error in depth.errors]
