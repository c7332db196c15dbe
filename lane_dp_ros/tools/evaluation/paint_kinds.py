# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Are kind and colour of the paint told right? A table of what is there against what was told."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import NamedTuple

from lane_dp_ros.core.types import Lane
from lane_dp_ros.tools.evaluation.annotations import Label

ORDER = ("solid", "dashed", "double", "edge", "white", "yellow", "")  # of rows and columns
NOT_TOLD = "not told"
NAN = float("nan")

Confusion = Counter[tuple[str, str]]  # (what is there, what was told, "" for nothing): number of lines


class PaintComparison(NamedTuple):
    """Kind and colour of a label, and what its detection tells of them; empty where it is not known."""

    true_kind: str
    kind: str
    true_colour: str
    colour: str


def compare_paint(label: Label, lane: Lane) -> PaintComparison:
    """Return what a label and the lane that matches it tell of the paint.

    A label that does not tell whether it is double, as those made by hand, may be one of two lines: there a
    double line counts as the label's kind where one of its sides is of that kind.
    """
    kind: str = lane.kind
    if label.double is None and lane.kind == "double" and lane.sides is not None and label.kind in lane.sides:
        kind = label.kind
    true_kind = "double" if label.double else label.kind
    return PaintComparison(true_kind, kind, label.colour, lane.colour)


@dataclass(frozen=True)
class PaintSummary:
    """How often each kind and colour was told of each that is there; summaries add up."""

    kinds: Confusion = field(default_factory=Counter)
    colours: Confusion = field(default_factory=Counter)

    @classmethod
    def of(cls, comparisons: Iterable[PaintComparison]) -> PaintSummary:
        """Return the summary of matched lines; colours are compared where both are known."""
        comparisons = tuple(comparisons)
        return cls(
            Counter((c.true_kind, c.kind) for c in comparisons),
            Counter((c.true_colour, c.colour) for c in comparisons if c.true_colour and c.colour),
        )

    def __add__(self, other: PaintSummary) -> PaintSummary:
        return PaintSummary(self.kinds + other.kinds, self.colours + other.colours)

    @property
    def kind_right(self) -> float:
        """Share of the lines with a kind told whose kind is right, nan without any."""
        return share_right(self.kinds)

    @property
    def colour_right(self) -> float:
        """Share of the lines with both colours known whose colour is right, nan without any."""
        return share_right(self.colours)


def is_told(confusion: Confusion) -> bool:
    """Whether anything was told of any line."""
    return any(told for _, told in confusion)


def share_right(confusion: Confusion) -> float:
    """Return the share that is right of what was told, nan where nothing was."""
    told = {pair: n for pair, n in confusion.items() if pair[1]}
    return sum(n for (true, said), n in told.items() if true == said) / sum(told.values()) if told else NAN


def confusion_rows(confusion: Confusion) -> tuple[list[str], dict[str, list[str]]]:
    """Return a table of a confusion: the heads, what was told, and by what is there the numbers of lines.

    The last column is the share right, the last row "total". What was not told is neither right nor wrong.
    """
    heads = [name for name in ORDER if any(name in pair for pair in confusion)]
    groups = {name: _of(confusion, name) for name in heads}
    rows = {name: _row(group, heads) for name, group in {**groups, "total": confusion}.items() if group}
    return [*(head or NOT_TOLD for head in heads), "right"], rows


def _of(confusion: Confusion, name: str) -> Confusion:
    return Counter({pair: n for pair, n in confusion.items() if pair[0] == name})


def _row(confusion: Confusion, heads: list[str]) -> list[str]:
    right = share_right(confusion)
    counts = [sum(n for (_, told), n in confusion.items() if told == head) for head in heads]
    return [*map(str, counts), "-" if math.isnan(right) else f"{right:.3f}"]
