# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The tables of the report as HTML."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from lane_dp_ros.tools.evaluation.depth import DEPTHS
from lane_dp_ros.tools.evaluation.paint_kinds import PaintSummary, confusion_rows, is_told
from lane_dp_ros.tools.evaluation.scores import FrameScore
from lane_dp_ros.tools.evaluation.summary import Summary, by_category, by_sequence
from lane_dp_ros.tools.evaluation.text import COLUMNS, Column, cell, compared_in_space, without_paint
from lane_dp_ros.tools.evaluation.value_columns import (
    DEPTH_COLUMNS,
    EDGE_COLUMNS,
    SPACE_COLUMNS,
    ValueColumn,
    value_cells,
)
from lane_dp_ros.tools.report.html_table import html_table

PAPER_COLUMNS = COLUMNS[:4]
FIRST_ERROR = [column.attribute for column in COLUMNS].index("near_error")
TODAY_COLUMNS = (
    Column("", "frames", "frames", "d"),
    *COLUMNS[len(PAPER_COLUMNS) : FIRST_ERROR],
    Column("error m", "6-25 m", "localisation_error"),
    *COLUMNS[FIRST_ERROR:],
)
TILES = (
    (Column("", "paper's precision", "paper_precision"), "of the lines beside the vehicle"),
    (Column("", "recall", "lane_recall"), "of all painted lines"),
    (Column("", "detection precision", "detection_precision"), "of the published lines"),
    (
        Column("", "strict precision", "strict_detection_precision"),
        "with lines on unpainted edges among the false ones",
    ),
    (Column("", "false lanes per frame", "false_lanes_per_frame", ".2f"), "on no line at all"),
    (Column("", "error [m]", "localisation_error"), "aside, where lines are found"),
)
TUSIMPLE = ("accuracy", "fp", "fn")


def tiles(total: Summary) -> str:
    """Return the numbers that say most."""
    return "".join(
        f'<div class="tile"><b>{cell(total, column)}</b><span>{column.bottom}</span>'
        f"<small>{text}</small></div>"
        for column, text in TILES
    )


def tables(results: Sequence[FrameScore]) -> str:
    """Return the paper's table, today's numbers, TuSimple's and CULane's, by sequence and by category.

    Depth, road edges and kinds of paint have tables of their own where there is anything to tell.
    """
    sequences, categories = by_sequence(results), by_category(results)
    total = sequences["total"]
    parts = [_paper_and_today("sequence", sequences)]
    if len(categories) > 1 and categories != sequences:
        parts.append(_paper_and_today("category", categories))
    if total.unpainted_frames:
        parts.append(f"<p>{without_paint(total).capitalize()}.</p>")
    if compared_in_space(total):
        words = (
            "In metres, not through the image: the measured surface's depth straight ahead, and the lines."
        )
        parts.append(_section("Depth and 3-D", words, _value_table(sequences, SPACE_COLUMNS)))
    if total.road_edges.frames:
        words = "Unpainted borders of the carriageway, matched with the labels of that kind as lines are."
        parts.append(_section("Road edges", words, _value_table(sequences, EDGE_COLUMNS)))
    if is_told(total.paint.kinds):
        parts.append(_paint(total.paint))
    if total.tusimple.frames:
        parts.append(_tusimple_culane(sequences))
    return "".join(parts)


def _section(title: str, words: str, table: str) -> str:
    """Return a table with its title, or nothing where there is no table."""
    return f"<section><h3>{title}</h3><p>{words}</p>{table}</section>" if table else ""


def _paint(paint: PaintSummary) -> str:
    words = "Of the lines that were found: what is there by row, what was told of it by column."
    confusions = {"kind": paint.kinds, "colour": paint.colours}
    found = [
        html_table(title, *confusion_rows(confusion)) for title, confusion in confusions.items() if confusion
    ]
    return _section("Kind and colour of the paint", words, "".join(found))


def _paper_and_today(title: str, summaries: Mapping[str, Summary]) -> str:
    paper, today = (
        html_table(title, [f"{c.top}\n{c.bottom}" for c in columns], {
            name: [cell(summary, column) for column in columns] for name, summary in summaries.items()
        })
        for columns in (PAPER_COLUMNS, TODAY_COLUMNS)
    )  # fmt: skip
    sections = (
        _section(f"The paper's table, by {title}", "The two lines beside the vehicle alone.", paper),
        _section(f"Today's numbers, by {title}", "All painted lines.", today),
    )
    return f'<div class="pair">{"".join(sections)}</div>'


def _tusimple_culane(summaries: Mapping[str, Summary]) -> str:
    heads = ["TuSimple\naccuracy", "FP", "FN", "CULane\nF1", "TP", "FP", "FN"]
    rows = {
        name: [
            *(number(getattr(s.tusimple, measure)) for measure in TUSIMPLE),
            number(s.culane.f1), f"{s.culane.tp}", f"{s.culane.fp}", f"{s.culane.fn}",
        ]
        for name, s in summaries.items()
    }  # fmt: skip
    words = "In the image: TuSimple (20 px, 85 %) and CULane (lines 30 px wide, IoU 0.5), as published."
    return _section("The literature's measures", words, html_table("sequence", heads, rows))


def _value_table(summaries: Mapping[str, Summary], columns: Sequence[ValueColumn]) -> str:
    rows = {name: value_cells(summary, columns) for name, summary in summaries.items()}
    return html_table("sequence", [f"{c.top}\n{c.bottom}" for c in columns], rows)


def depth_table(results: Sequence[FrameScore]) -> str:
    """Return the depth's bias and spread by sequence."""
    return _value_table(by_sequence(results), DEPTH_COLUMNS)


def frames_by_depth_error(results: Sequence[FrameScore]) -> str:
    """Return the depth's errors of each frame, those without a surface first, then the largest error."""
    errors = {r.name: [r.depth.at(z) for z in DEPTHS] for r in results if r.depth is not None}
    largest = {name: max((abs(e) for e in row if math.isfinite(e)), default=math.inf)
               for name, row in errors.items()}  # fmt: skip
    rows = {
        name: ["-" if math.isnan(error) else f"{100 * error:+.2f}" for error in errors[name]]
        for name in sorted(errors, key=lambda name: (-largest[name], name))
    }
    return html_table("frame", [f"depth %\n{z:g} m" for z in DEPTHS], rows)


def number(value: float) -> str:
    """Return a number of the tables; "-" where it is nan."""
    return "-" if math.isnan(value) else f"{value:.3f}"
