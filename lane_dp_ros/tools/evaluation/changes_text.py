# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""A comparison of two evaluations as text."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from lane_dp_ros.tools.evaluation.changes import Comparison, FrameChange
from lane_dp_ros.tools.evaluation.measures import GROUP_MEASURES, MEASURES, Difference
from lane_dp_ros.tools.evaluation.summary import Summary, by_category, by_sequence, summarise
from lane_dp_ros.tools.evaluation.text import Column, laid_out

LISTED = 20  # frames of each sort; the report has them all
SIGNS = {"better": " +", "worse": " !", "": "  "}


def total_differences(comparison: Comparison) -> list[Difference]:
    """Return the differences of the total, of all measures with anything to tell."""
    before, after = summarise(comparison.before), summarise(comparison.after)
    found = [Difference.of(measure, before, after) for measure in MEASURES]
    return [difference for difference in found if difference.texts != ("-", "-")]


def group_differences(comparison: Comparison) -> dict[str, dict[str, list[Difference]]]:
    """Return by "sequence" and "category", and there by name, the differences of the chief measures.

    A grouping into one group is left out, and categories that bear the names of the sequences, as those of
    rendered scenes do.
    """
    sequences, categories = (
        _of_groups(group(comparison.before), group(comparison.after)) for group in (by_sequence, by_category)
    )
    found = {"sequence": sequences, "category": {} if categories.keys() == sequences.keys() else categories}
    return {title: rows for title, rows in found.items() if len(rows) > 2}  # several, and the total


def _of_groups(before: Mapping[str, Summary], after: Mapping[str, Summary]) -> dict[str, list[Difference]]:
    return {
        name: [Difference.of(measure, before[name], after[name]) for measure in GROUP_MEASURES]
        for name in after
        if name in before
    }


def comparison_text(comparison: Comparison) -> str:
    """Return the differences of the total, of each sequence and category, and the frames that changed."""
    parts = [
        _total_table(total_differences(comparison)),
        *(_group_table(title, rows) for title, rows in group_differences(comparison).items()),
        frames_told(comparison) + ".",
        _listed("worse", comparison.worse),
        _listed("better in one thing, worse in another", comparison.mixed),
        _listed("better", comparison.better),
    ]
    return "\n\n".join(part for part in parts if part)


def frames_told(comparison: Comparison) -> str:
    """Return in words how many frames changed."""
    better, worse, mixed = (len(each) for each in (comparison.better, comparison.worse, comparison.mixed))
    alike = len(comparison.after) - len(comparison.changes)
    both = f", {mixed} better in one thing and worse in another" if mixed else ""
    return f"{len(comparison.after)} frames: {better} better, {worse} worse{both}, {alike} unchanged"


def _total_table(differences: Sequence[Difference]) -> str:
    columns = [Column("", head, "") for head in ("A", "B", "change", "")]
    rows = [[d.measure.name, *d.texts, change_text(d), d.verdict] for d in differences]
    return laid_out("total", columns, rows)


def change_text(difference: Difference) -> str:
    """Return the signed change, empty where there is none."""
    if not difference.verdict:
        return ""
    return format(difference.change, f"+{difference.measure.spec}")


def _group_table(title: str, rows: Mapping[str, Sequence[Difference]]) -> str:
    columns = [Column("A -> B", measure.name, "") for measure in GROUP_MEASURES]
    cells = [[name, *map(difference_text, differences)] for name, differences in rows.items()]
    return f"{laid_out(title, columns, cells)}\n+ better, ! worse"


def difference_text(difference: Difference) -> str:
    """Return both numbers and a sign of what is better, or the one number that both are."""
    before, after = difference.texts
    if before == after:
        return after + SIGNS[""]
    return f"{before} -> {after}{SIGNS[difference.verdict]}"


def _listed(title: str, changes: Sequence[FrameChange]) -> str:
    words = {change.after.name: (*change.worse, *change.better) for change in changes[:LISTED]}
    lines = [f"  {name}: {'; '.join(each)}" for name, each in words.items()]
    more = [f"  and {len(changes) - LISTED} more: see --report"] if len(changes) > LISTED else []
    return "\n".join([f"{title}:", *lines, *more]) if changes else ""
