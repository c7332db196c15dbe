# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""An evaluation as text: the paper's table with today's numbers beside it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from lane_dp_ros.tools.evaluation.paint_kinds import Confusion, confusion_rows, is_told
from lane_dp_ros.tools.evaluation.reliability import (
    CONFIDENCE_BINS,
    confidences,
    reliability,
    road_edge_scores,
)
from lane_dp_ros.tools.evaluation.scores import FrameScore, LineScores
from lane_dp_ros.tools.evaluation.summary import Summary, by_category, by_sequence
from lane_dp_ros.tools.evaluation.value_columns import (
    DEPTH_COLUMNS,
    EDGE_COLUMNS,
    SPACE_COLUMNS,
    ValueColumn,
    value_cells,
)


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
    Column("", "strict", "strict_detection_precision"),
    Column("false", "per frame", "false_lanes_per_frame", ".2f"),
    Column("", "strict", "strict_false_lanes_per_frame", ".2f"),
    Column("error m", "6-12 m", "near_error"),
    Column("error m", "12-25 m", "far_error"),
    Column("id", "switches", "id_switches", "d"),
    Column("jitter", "m", "jitter"),
    Column("latency", "ms", "latency", ".1f", 1e3),
)
# Those that need no frames in a row, nor a clock.
COLUMNS_OF_FRAMES = COLUMNS[: [column.attribute for column in COLUMNS].index("id_switches")]


def tables(results: Sequence[FrameScore]) -> str:
    """Return the table by sequence, by category where that is another, and TuSimple's and CULane's.

    Between stand, where there is anything to tell: a table by sequence of what was compared in the world, one
    of the road edges, and one of the kinds of paint.
    """
    sequences, categories = by_sequence(results), by_category(results)
    total = sequences["total"]
    parts = [table("sequence", sequences)]
    if any(result.category for result in results) and categories != sequences:
        parts.append(table("category", categories))
    if compared_in_space(total):
        parts.append(value_table(sequences, SPACE_COLUMNS))
    if total.road_edges.frames:
        parts.append(value_table(sequences, EDGE_COLUMNS))
    if is_told(total.paint.kinds):
        parts.append(paint_table("kind", total.paint.kinds))
    if total.paint.colours:
        parts.append(paint_table("colour", total.paint.colours))
    return "\n\n".join([*parts, "\n".join(_last_lines(results, total))])


def _last_lines(results: Sequence[FrameScore], total: Summary) -> list[str]:
    edges = road_edge_scores(results)
    return [
        *([without_paint(total)] if total.unpainted_frames else []),
        _calibration(results, "lines"),
        *([_calibration(edges, "road edges")] if edges else []),
        _tusimple_culane(total),
    ]


def table(title: str, summaries: Mapping[str, Summary], columns: Sequence[Column] = COLUMNS) -> str:
    """Return a table, a summary to a line; "-" stands where there was nothing to count."""
    rows = [[name, *(cell(summary, column) for column in columns)] for name, summary in summaries.items()]
    return laid_out(title, columns, rows)


def compared_in_space(total: Summary) -> bool:
    """Whether any surface was looked for, or any line compared with the truth in the world."""
    return bool(total.depth.frames or total.in_space.near.count or total.in_space.far.count)


def surface_tables(results: Sequence[FrameScore]) -> str:
    """Return the depth's bias and spread by sequence, of frames whose surface alone was judged."""
    sequences = by_sequence(results)
    return f"{value_table(sequences, DEPTH_COLUMNS)}\n\n{len(results)} frames"


def value_table(summaries: Mapping[str, Summary], columns: Sequence[ValueColumn]) -> str:
    """Return a table of the numbers of some columns by sequence, a summary to a line."""
    rows = [[name, *value_cells(summary, columns)] for name, summary in summaries.items()]
    return laid_out("sequence", columns, rows)


def paint_table(title: str, confusion: Confusion) -> str:
    """Return how often each kind or colour was told of the found lines of each, and the share right."""
    heads, rows = confusion_rows(confusion)
    columns = [Column("" if i else "told as", head, "") for i, head in enumerate(heads)]
    return laid_out(title, columns, [[name, *cells] for name, cells in rows.items()])


def without_paint(total: Summary) -> str:
    """Return in words how many lines were published in frames without a painted label."""
    return (
        f"false lanes in {total.unpainted_frames} frames without paint: {total.unpainted_false_lanes}, "
        f"strictly {total.unpainted_false_lanes_strict}"
    )


def laid_out(
    title: str, columns: Sequence[Column] | Sequence[ValueColumn], rows: Sequence[Sequence[str]]
) -> str:
    """Return rows below the two lines of their heads, in columns."""
    heads = [["", *(c.top for c in columns)], [title, *(c.bottom for c in columns)]]
    widths = [max(map(len, cells)) for cells in zip(*heads, *rows, strict=True)]
    lines = [[cells[0].ljust(widths[0]), *map(str.rjust, cells[1:], widths[1:])] for cells in [*heads, *rows]]
    return "\n".join("  ".join(line).rstrip() for line in lines)


def cell(summary: Summary, column: Column) -> str:
    """Return a number of a summary; "-" stands where there was nothing to count."""
    value = getattr(summary, column.attribute)
    nothing = math.isnan(value) or (column.attribute == "id_switches" and not summary.id_chances)
    return "-" if nothing else format(value * column.scale if column.scale != 1 else value, column.spec)


def _calibration(results: Sequence[LineScores], what: str) -> str:
    """Return the share of right lines by confidence, as long as something was published."""
    bins = reliability(*confidences(results))
    if math.isnan(bins.error):
        return f"no {what} were published"
    shares = (
        f"{CONFIDENCE_BINS[i]:.1f}: {bins.right[i]} of {bins.counts[i]}" for i in np.flatnonzero(bins.counts)
    )
    error = f"expected calibration error {bins.error:.3f}"
    return f"{what} right by confidence, from {', '.join(shares)}; {error}"


def _tusimple_culane(total: Summary) -> str:
    t, c = total.tusimple, total.culane
    if not t.frames:
        return f"{total.frames} frames"
    return (
        f"{total.frames} frames; in the image, TuSimple's measure (20 px): accuracy {t.accuracy:.3f}, "
        f"FP {t.fp:.3f}, FN {t.fn:.3f}; CULane's (30 px wide, IoU 0.5): F1 {c.f1:.3f}"
    )
