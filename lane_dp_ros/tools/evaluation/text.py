# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""An evaluation as text: the paper's table with today's numbers beside it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from lane_dp_ros.tools.evaluation.reliability import CONFIDENCE_BINS, confidences, reliability
from lane_dp_ros.tools.evaluation.scores import FrameScore
from lane_dp_ros.tools.evaluation.summary import Summary, by_category, by_sequence


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


def tables(results: Sequence[FrameScore]) -> str:
    """Return the table by sequence, by category where that is another, and TuSimple's and CULane's."""
    sequences, categories = by_sequence(results), by_category(results)
    parts = [table("sequence", sequences)]
    if any(result.category for result in results) and categories != sequences:
        parts.append(table("category", categories))
    return "\n\n".join([*parts, "\n".join([_calibration(results), _tusimple_culane(sequences["total"])])])


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


def _tusimple_culane(total: Summary) -> str:
    t, c = total.tusimple, total.culane
    if not t.frames:
        return f"{total.frames} frames"
    return (
        f"{total.frames} frames; in the image, TuSimple's measure (20 px): accuracy {t.accuracy:.3f}, "
        f"FP {t.fp:.3f}, FN {t.fn:.3f}; CULane's (30 px wide, IoU 0.5): F1 {c.f1:.3f}"
    )
