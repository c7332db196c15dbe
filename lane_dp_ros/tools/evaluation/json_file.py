# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""An evaluation as a JSON file: docs/evaluation.md."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.tools.evaluation.depth import DEPTHS, DepthErrors, DepthSummary
from lane_dp_ros.tools.evaluation.lateral import Mean
from lane_dp_ros.tools.evaluation.reliability import CONFIDENCE_BINS, confidences, reliability
from lane_dp_ros.tools.evaluation.scores import FrameScore, Match
from lane_dp_ros.tools.evaluation.summary import Summary, by_category, by_sequence

FORMAT = "lane_dp evaluation 1"
SPACE_KEYS = ("near", "far", "at_10", "at_25")
# JSON key: the summary's attribute
SUMMARY_KEYS = {
    "frames": "frames",
    "total_lane_markings": "ego_labels",
    "incorrect": "incorrect",
    "missed": "missed",
    "precision": "paper_precision",
    "labels": "labels",
    "matched": "matched",
    "recall": "lane_recall",
    "detections": "detections",
    "false_lanes": "false_lanes",
    "duplicates": "duplicates",
    "detection_precision": "detection_precision",
    "false_per_frame": "false_lanes_per_frame",
    "error": "localisation_error",
    "error_near": "near_error",
    "error_far": "far_error",
    "id_switches": "id_switches",
    "id_chances": "id_chances",
    "jitter": "jitter",
    "label_jitter": "label_jitter",
    "jitter_windows": "jitter_windows",
    "latency": "latency",
    "latency_95": "latency_95",
}


def check_json_output(path: Path) -> None:
    """Raise CommandError for a file that is there and is no earlier evaluation: it would be lost."""
    if not path.exists():
        return
    try:
        earlier = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
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
        "total": _summary_json(total),
        "sequences": {name: _summary_json(summary) for name, summary in sequences.items()},
        "categories": {name: _summary_json(summary) for name, summary in categories.items()},
        "reliability": _reliability_json(results),
        "notes": list(notes),
        "frames": [_frame_json(result) for result in results],
    }


def _reliability_json(results: Sequence[FrameScore]) -> dict[str, Any]:
    bins = reliability(*confidences(results))
    rows = zip(CONFIDENCE_BINS, bins.confidence, bins.right, bins.counts, strict=False)
    return {
        "expected_calibration_error": _number(bins.error),
        "bins": [
            {"from": float(low), "mean": _number(float(mean)), "right": int(right), "lines": int(lines)}
            for low, mean, right, lines in rows
        ],
    }


def _summary_json(summary: Summary) -> dict[str, Any]:
    t, c = summary.tusimple, summary.culane
    return {
        **{key: _number(getattr(summary, attribute)) for key, attribute in SUMMARY_KEYS.items()},
        "tusimple": {name: _number(getattr(t, name)) for name in ("accuracy", "fp", "fn")},
        "culane": {"tp": c.tp, "fp": c.fp, "fn": c.fn, "f1": _number(c.f1)},
        "depth": _depth_json(summary.depth),
        "error_3d": {key: _mean_json(getattr(summary.in_space, key)) for key in SPACE_KEYS},
    }


def _depth_json(depth: DepthSummary) -> dict[str, Any]:
    curve = depth.curve()
    columns = (each.tolist() for each in (curve.depths, curve.bias, curve.low, curve.high, curve.counts))
    return {
        "frames": depth.frames,
        "no_surface": depth.no_surface,
        "bias": {f"{z:g}": _number(depth.bias(z)) for z in DEPTHS},
        "spread": {f"{z:g}": _number(depth.spread(z)) for z in DEPTHS},
        "curve": [
            {"depth": z, "bias": _number(bias), "low": _number(low), "high": _number(high), "frames": count}
            for z, bias, low, high, count in zip(*columns, strict=True)
        ],
    }


def _mean_json(mean: Mean) -> dict[str, Any]:
    return {"mean": _number(mean.value), "lines": mean.count}


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
        "detections": [
            {"id": d.lane.id, "role": d.lane.role, "confidence": d.lane.confidence, "verdict": d.verdict}
            for d in result.detections
        ],
    }


def _match_json(match: Match) -> dict[str, Any]:
    errors = {"error": match.error, "error_near": match.near, "error_far": match.far}
    in_space = {"error_3d_near": match.in_space.near, "error_3d_far": match.in_space.far}
    return {"label": match.label, "detection": match.detection, "counts": match.counts, **errors, **in_space}


def _depth_errors_json(depth: DepthErrors | None) -> list[float | None] | None:
    """Return the errors at each depth of the curve; null for a frame in which no surface is known."""
    return None if depth is None or not depth.measured else [_number(error) for error in depth.errors]


def _number(value: float) -> float | None:
    return value if math.isfinite(value) else None
