# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""An evaluation as text: the paper's table with today's numbers beside it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from lane_dp_ros.tools.evaluation.depth import DEPTHS
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


class SpaceColumn(NamedTuple):
    """A column of the table of what is compared in the world: its head in two lines, its number, its spec."""

    top: str
    bottom: str
    of: Callable[[Summary], float]
    spec: str = ".3f"


def _bias(depth: float, summary: Summary) -> float:
    return 100 * summary.depth.bias(depth)


def _spread(depth: float, summary: Summary) -> float:
    return 100 * summary.depth.spread(depth)


def _depth_columns(depth: float) -> Iterator[SpaceColumn]:
    """Yield the bias and the spread of the surface's depth in per cent, at a depth [m]."""
    yield SpaceColumn("depth %", f"{depth:g} m", partial(_bias, depth), "+.2f")
    yield SpaceColumn("90 %", "within", partial(_spread, depth), ".2f")


DEPTH_COLUMNS = (
    *(column for depth in DEPTHS for column in _depth_columns(depth)),
    SpaceColumn("no", "surface", lambda s: s.depth.no_surface if s.depth.frames else math.nan, ".0f"),
)
SPACE_COLUMNS = (
    *DEPTH_COLUMNS,
    SpaceColumn("3-D m", "6-12 m", lambda s: s.in_space.near.value),
    SpaceColumn("3-D m", "12-25 m", lambda s: s.in_space.far.value),
    SpaceColumn("3-D m", "at 10 m", lambda s: s.in_space.at_10.value),
    SpaceColumn("3-D m", "at 25 m", lambda s: s.in_space.at_25.value),
)


def tables(results: Sequence[FrameScore]) -> str:
    """Return the table by sequence, by category where that is another, and TuSimple's and CULane's.

    Where anything was compared in the world, a table of that by sequence stands between.
    """
    sequences, categories = by_sequence(results), by_category(results)
    parts = [table("sequence", sequences)]
    if any(result.category for result in results) and categories != sequences:
        parts.append(table("category", categories))
    if compared_in_space(sequences["total"]):
        parts.append(space_table(sequences))
    return "\n\n".join([*parts, "\n".join([_calibration(results), _tusimple_culane(sequences["total"])])])


def table(title: str, summaries: Mapping[str, Summary], columns: Sequence[Column] = COLUMNS) -> str:
    """Return a table, a summary to a line; "-" stands where there was nothing to count."""
    rows = [[name, *(cell(summary, column) for column in columns)] for name, summary in summaries.items()]
    return _laid_out(title, columns, rows)


def compared_in_space(total: Summary) -> bool:
    """Whether any surface was looked for, or any line compared with the truth in the world."""
    return bool(total.depth.frames or total.in_space.near.count or total.in_space.far.count)


def surface_tables(results: Sequence[FrameScore]) -> str:
    """Return the depth's bias and spread by sequence, of frames whose surface alone was judged."""
    sequences = by_sequence(results)
    return f"{space_table(sequences, DEPTH_COLUMNS)}\n\n{len(results)} frames"


def space_table(
    summaries: Mapping[str, Summary], columns: Sequence[SpaceColumn] = SPACE_COLUMNS, title: str = "sequence"
) -> str:
    """Return the depth's bias and spread and the lateral errors in the world, a summary to a line."""
    rows = [[name, *space_cells(summary, columns)] for name, summary in summaries.items()]
    return _laid_out(title, columns, rows)


def space_cells(summary: Summary, columns: Sequence[SpaceColumn] = SPACE_COLUMNS) -> list[str]:
    """Return the numbers of a line of that table."""
    values = [column.of(summary) for column in columns]
    return [
        "-" if math.isnan(value) else format(value, column.spec)
        for value, column in zip(values, columns, strict=True)
    ]


def _laid_out(
    title: str, columns: Sequence[Column] | Sequence[SpaceColumn], rows: Sequence[Sequence[str]]
) -> str:
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
