# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""A summary as what JSON can hold: docs/evaluation.md."""

from __future__ import annotations

import math
from typing import Any

from lane_dp_ros.tools.evaluation.depth import DEPTHS, DepthSummary
from lane_dp_ros.tools.evaluation.lateral import Mean
from lane_dp_ros.tools.evaluation.paint_kinds import NOT_TOLD, Confusion, PaintSummary
from lane_dp_ros.tools.evaluation.road_edges import RoadEdgeSummary
from lane_dp_ros.tools.evaluation.summary import Summary

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
    "detection_precision_strict": "strict_detection_precision",
    "false_per_frame": "false_lanes_per_frame",
    "false_lanes_strict": "false_lanes_strict",
    "false_per_frame_strict": "strict_false_lanes_per_frame",
    "unpainted_frames": "unpainted_frames",
    "unpainted_false_lanes": "unpainted_false_lanes",
    "unpainted_false_lanes_strict": "unpainted_false_lanes_strict",
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


def summary_json(summary: Summary) -> dict[str, Any]:
    """Return the numbers of a summary; null stands where there was nothing to count."""
    t, c = summary.tusimple, summary.culane
    return {
        **{key: number(getattr(summary, attribute)) for key, attribute in SUMMARY_KEYS.items()},
        "tusimple": {name: number(getattr(t, name)) for name in ("accuracy", "fp", "fn")},
        "culane": {"tp": c.tp, "fp": c.fp, "fn": c.fn, "f1": number(c.f1)},
        "depth": _depth_json(summary.depth),
        "error_3d": {key: _mean_json(getattr(summary.in_space, key)) for key in SPACE_KEYS},
        "road_edges": _road_edges_json(summary.road_edges),
        "paint": _paint_json(summary.paint),
    }


def _road_edges_json(edges: RoadEdgeSummary) -> dict[str, Any]:
    return {
        **{name: getattr(edges, name) for name in ("frames", "labels", "matched", "detections")},
        "recall": number(edges.recall),
        "false": edges.false_edges,
        "false_per_frame": number(edges.false_per_frame),
        "error": number(edges.error.value),
    }


def _paint_json(paint: PaintSummary) -> dict[str, Any]:
    return {
        "kind_right": number(paint.kind_right),
        "colour_right": number(paint.colour_right),
        "kinds": _confusion_json(paint.kinds),
        "colours": _confusion_json(paint.colours),
    }


def _confusion_json(confusion: Confusion) -> dict[str, dict[str, int]]:
    """Return, by what is there, how many lines were told to be what."""
    rows: dict[str, dict[str, int]] = {}
    for (true, told), lines in sorted(confusion.items()):
        rows.setdefault(true, {})[told or NOT_TOLD] = lines
    return rows


def _depth_json(depth: DepthSummary) -> dict[str, Any]:
    curve = depth.curve()
    columns = (each.tolist() for each in (curve.depths, curve.bias, curve.low, curve.high, curve.counts))
    return {
        "frames": depth.frames,
        "no_surface": depth.no_surface,
        "bias": {f"{z:g}": number(depth.bias(z)) for z in DEPTHS},
        "spread": {f"{z:g}": number(depth.spread(z)) for z in DEPTHS},
        "curve": [
            {"depth": z, "bias": number(bias), "low": number(low), "high": number(high), "frames": count}
            for z, bias, low, high, count in zip(*columns, strict=True)
        ],
    }


def _mean_json(mean: Mean) -> dict[str, Any]:
    return {"mean": number(mean.value), "lines": mean.count}


def number(value: float) -> float | None:
    """Return a number, None for what JSON knows no number for: null."""
    return value if math.isfinite(value) else None
