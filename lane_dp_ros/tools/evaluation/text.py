# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""An evaluation as text: the paper's table with today's numbers beside it, JSON, and thresholds."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.tools.evaluation.reliability import CONFIDENCE_BINS, confidences, reliability
from lane_dp_ros.tools.evaluation.scores import FrameScore, Match, Summary
from lane_dp_ros.tools.evaluation.summary import by_category, by_sequence

FORMAT = "lane_dp evaluation 1"  # of the JSON file; docs/evaluation.md


class Column(NamedTuple):
    """A column of the table: its head in two lines, the summary's attribute, how to print it."""

    top: str
    bottom: str
    attribute: str
    spec: str = ".3f"
    scale: float = 1.0


COLUMNS = (
    Column("total lane", "markings", "ego_labels", "d"),
    Column("", "incorrect", "incorrect", "d"),
    Column("", "missed", "missed", "d"),
    Column("", "precision", "paper_precision"),
    Column("", "recall", "lane_recall"),
    Column("detection", "precision", "detection_precision"),
    Column("false", "per frame", "false_lanes_per_frame", ".2f"),
    Column("error m", "6-12 m", "near_error"),
    Column("error m", "12-25 m", "far_error"),
    Column("id", "switches", "id_switches", "d"),
    Column("jitter", "m", "jitter"),
    Column("latency", "ms", "latency", ".1f", 1e3),
)
# Those that need no frames in a row, nor a clock.
COLUMNS_OF_FRAMES = COLUMNS[: [column.attribute for column in COLUMNS].index("id_switches")]

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


class Threshold(NamedTuple):
    """A limit that a user may set: option, the summary's attribute, its name, whether it is a lower limit."""

    option: str
    attribute: str
    name: str
    is_lower: bool


THRESHOLDS = (
    Threshold("--min-precision", "paper_precision", "precision", True),
    Threshold("--min-recall", "lane_recall", "recall", True),
    Threshold("--min-detection-precision", "detection_precision", "detection precision", True),
    Threshold("--max-error", "localisation_error", "error", False),
    Threshold("--max-false-per-frame", "false_lanes_per_frame", "false lanes per frame", False),
)


def tables(results: Sequence[FrameScore]) -> str:
    """Return the table by sequence, by category where that is another, and the literature's measures."""
    sequences, categories = by_sequence(results), by_category(results)
    parts = [table("sequence", sequences)]
    if any(result.category for result in results) and categories != sequences:
        parts.append(table("category", categories))
    return "\n\n".join([*parts, "\n".join([_calibration(results), _literature(sequences["total"])])])


def table(title: str, summaries: Mapping[str, Summary], columns: Sequence[Column] = COLUMNS) -> str:
    """Return a table, a summary to a line; "-" stands where there was nothing to count."""
    rows = [[name, *(cell(summary, column) for column in columns)] for name, summary in summaries.items()]
    heads = [["", *(c.top for c in columns)], [title, *(c.bottom for c in columns)]]
    widths = [max(map(len, cells)) for cells in zip(*heads, *rows, strict=True)]
    lines = [[cells[0].ljust(widths[0]), *map(str.rjust, cells[1:], widths[1:])] for cells in [*heads, *rows]]
    return "\n".join("  ".join(line).rstrip() for line in lines)


def cell(summary: Summary, column: Column) -> str:
    """Return a number of a summary; "-" stands where there was nothing to count."""
    value = getattr(summary, column.attribute)
    nothing = math.isnan(value) or (column.attribute == "id_switches" and not summary.id_chances)
    return "-" if nothing else format(value * column.scale if column.scale != 1 else value, column.spec)


def _calibration(results: Sequence[FrameScore]) -> str:
    """Return the share of right lines by confidence, as long as something was published."""
    bins = reliability(*confidences(results))
    if math.isnan(bins.error):
        return "nothing was published"
    shares = (
        f"{CONFIDENCE_BINS[i]:.1f}: {bins.right[i]} of {bins.counts[i]}" for i in np.flatnonzero(bins.counts)
    )
    return f"right by confidence, from {', '.join(shares)}; expected calibration error {bins.error:.3f}"


def _literature(total: Summary) -> str:
    t, c = total.tusimple, total.culane
    if not t.frames:
        return f"{total.frames} frames"
    return (
        f"{total.frames} frames; in the image, TuSimple's measure (20 px): accuracy {t.accuracy:.3f}, "
        f"FP {t.fp:.3f}, FN {t.fn:.3f}; CULane's (30 px wide, IoU 0.5): F1 {c.f1:.3f}"
    )


def missed_thresholds(total: Summary, limits: Mapping[str, float | None]) -> str:
    """Return one line that says which of the limits, {option: value}, are missed and by how much; or ""."""
    given = [(threshold, limits[threshold.option]) for threshold in THRESHOLDS]
    texts = [_missed(total, threshold, limit) for threshold, limit in given if limit is not None]
    return "; ".join(text for text in texts if text)


def _missed(total: Summary, threshold: Threshold, limit: float) -> str:
    value = getattr(total, threshold.attribute)
    if math.isnan(value):
        return f"{threshold.name} is not known, there is nothing to count, {threshold.option} is {limit:g}"
    short = limit - value if threshold.is_lower else value - limit
    if short <= 0:
        return ""
    side = "below" if threshold.is_lower else "above"
    return f"{threshold.name} {value:.4f} is {side} {threshold.option} {limit:g} by {short:.2g}"


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
        "matches": [_match_json(match) for match in result.matches],
        "detections": [
            {"id": d.lane.id, "role": d.lane.role, "confidence": d.lane.confidence, "verdict": d.verdict}
            for d in result.detections
        ],
    }


def _match_json(match: Match) -> dict[str, Any]:
    errors = {"error": match.error, "error_near": match.near, "error_far": match.far}
    return {"label": match.label, "detection": match.detection, "counts": match.counts, **errors}


def _number(value: float) -> float | None:
    return None if math.isnan(value) else value
