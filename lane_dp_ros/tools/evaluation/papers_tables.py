# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The paper's tables: the published numbers, and what was measured beside them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

from lane_dp_ros.tools.evaluation.summary import Summary


class Published(NamedTuple):
    """A line of the paper's tables."""

    markings: int
    incorrect: int
    missed: int

    @property
    def cells(self) -> list[str]:
        """What the table shows."""
        precision = (self.markings - self.incorrect - self.missed) / self.markings
        return [*map(str, self), f"{100 * precision:.1f}"]


OURS = {  # Jiao, Fan, Ma, Liu 2019, the table of the proposed algorithm
    "2011_09_26_drive_0015": Published(594, 4, 1),
    "2011_09_26_drive_0027": Published(376, 12, 2),
    "2011_09_26_drive_0028": Published(860, 1, 0),
    "2011_09_26_drive_0070": Published(760, 29, 0),
    "2011_09_30_drive_0016": Published(556, 21, 7),
}
THEIRS = {  # the same, the table of Wang, Dahnoun, Achim 2012: two drives are not in it
    "2011_09_26_drive_0015": Published(594, 44, 0),
    "2011_09_26_drive_0027": Published(376, 44, 0),
    "2011_09_26_drive_0028": Published(860, 12, 0),
}
PUBLISHED = (OURS, THEIRS)
HEAD = {"total": 5, "inc.": 4, "mis.": 4, "%": 5}  # of each table, and the width of its columns
LEGEND = "total lane markings, incorrect, missed, precision in % of the two lines beside the vehicle"
FIVE, ALL = "total of the five", "total"


def papers_tables(names: Sequence[str], summaries: Sequence[Mapping[str, Summary]]) -> str:
    """Return the paper's tables side by side: of each detector by its name, then the published ones.

    The paper's drives come first, with their total when all five were judged: a part would not be like for
    like. All other sequences follow, and the total of everything. "-" stands where nothing was counted.
    """
    others = [name for name in summaries[0] if name not in OURS and name != ALL]
    rows = [
        [name, *(cell for s in summaries for cell in _measured(s, name)), *_published(name)]
        for name in [*OURS, FIVE, *others, *([ALL] if others else [])]
    ]
    titles = [*names, "published, the paper", "published, Wang 2012"]
    return f"{LEGEND}\n{_grouped(titles, rows)}"


def _measured(summaries: Mapping[str, Summary], name: str) -> list[str]:
    if name == FIVE and summaries.keys() >= OURS.keys():
        summary = sum((summaries[drive] for drive in OURS), Summary())
    else:
        summary = summaries.get(name, Summary())
    if not summary.ego_labels:
        return ["-"] * len(HEAD)
    return Published(summary.ego_labels, summary.incorrect, summary.missed).cells


def _published(name: str) -> list[str]:
    tables = (
        {**each, FIVE: Published(*map(sum, zip(*each.values(), strict=True)))} for each in (OURS, THEIRS)
    )
    return [cell for each in tables for cell in (each[name].cells if name in each else ["-"] * len(HEAD))]


def _grouped(titles: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return a table whose columns stand in groups of `HEAD`, each under its title."""
    first, group = max(len(row[0]) for row in rows), len(_group(HEAD))
    heads = [f"{title[:group]:^{group}}" for title in titles], [_group(HEAD)] * len(titles)
    lines = [[" " * first, *heads[0]], ["sequence".ljust(first), *heads[1]]]
    for name, *cells in rows:
        groups = [_group(cells[i : i + len(HEAD)]) for i in range(0, len(cells), len(HEAD))]
        lines.append([name.ljust(first), *groups])
    return "\n".join(" | ".join(line).rstrip() for line in lines)


def _group(cells: Iterable[str]) -> str:
    return " ".join(cell.rjust(width) for cell, width in zip(cells, HEAD.values(), strict=True))
