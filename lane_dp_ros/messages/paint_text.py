# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Kind and colour of a line's paint as a marker's text says them, such as "dashed yellow", and back."""

from __future__ import annotations

from itertools import product
from typing import NamedTuple, get_args

from lane_dp_ros.core.types import LaneKind, PaintColour

BOTH_SOLID: tuple[LaneKind, LaneKind] = ("solid", "solid")  # as most double lines are: not worth a word


class Paint(NamedTuple):
    """What `Lane.kind`, `Lane.colour` and `Lane.sides` say of a line."""

    kind: LaneKind = ""
    colour: PaintColour = ""
    sides: tuple[LaneKind, LaneKind] | None = None


def paint_to_text(paint: Paint) -> str:
    """Return e.g. "solid white", "dashed" or "double white, solid left, dashed right".

    What is not known is left out. The sides of a double line are said unless both are solid.
    """
    said = " ".join(filter(None, [paint.kind, paint.colour]))
    if paint.kind != "double" or paint.sides in (None, BOTH_SOLID):
        return said
    left, right = (side or "unknown" for side in paint.sides or ())
    return f"{said}, {left} left, {right} right"


def paint_from_text(text: str) -> Paint:
    """Return what a text of `paint_to_text` says; nothing is known by any other text."""
    return PAINT_BY_TEXT.get(text, Paint())


def _every_paint() -> list[Paint]:
    kinds, colours = get_args(LaneKind), get_args(PaintColour)
    singles = [Paint(kind, colour) for kind, colour in product(kinds, colours) if kind != "double"]
    doubles = [Paint("double", colour, sides) for colour in colours for sides in product(kinds, repeat=2)]
    return singles + doubles


PAINT_BY_TEXT = {paint_to_text(paint): paint for paint in _every_paint()}
