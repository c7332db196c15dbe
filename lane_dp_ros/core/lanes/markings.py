# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The kind and colour of the lines that are lanes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

from lane_dp_ros.core.birdseye.paint_profile import PaintProfile
from lane_dp_ros.core.lanes.candidate import Candidate, Marking
from lane_dp_ros.core.lanes.double_line import side_by_side, twin_beside
from lane_dp_ros.core.lanes.line_kind import PaintAlong, own_kind, paint_along
from lane_dp_ros.core.lanes.paint_colour import paint_colour
from lane_dp_ros.core.types import Image, LaneKind

Sides = tuple[LaneKind, LaneKind]


def with_markings(
    candidates: Sequence[Candidate], paint: PaintProfile, picture: Image
) -> tuple[Candidate, ...]:
    """Return the candidates that are lanes with kind and colour, in their order.

    `picture` is the left one as it came, (H, W) grey or (H, W, 3) BGR. Lines of one colour that run side by
    side are double; so is one in whose cross section the other one shows.
    Of a line of which hardly a row is seen nothing is known.
    """
    along = paint_along([candidate.line for candidate in candidates], paint)
    single = [
        candidate if each is None else replace(candidate, marking=_single(each, paint, picture))
        for candidate, each in zip(candidates, along, strict=True)
    ]
    sides = _sides_of_twins(single, along, paint.view.resolution[0]) | _sides_of_pairs(single)
    return tuple(
        replace(each, marking=Marking("double", each.marking.colour, sides[i])) if i in sides else each
        for i, each in enumerate(single)
    )


def _single(along: PaintAlong, paint: PaintProfile, picture: Image) -> Marking:
    """Return the marking of a line by itself."""
    kind = own_kind(along.cover, along.s, paint.view.resolution[0])
    return Marking(kind, paint_colour(along, paint.view, picture))


def _sides_of_twins(
    lines: Sequence[Candidate], along: Sequence[PaintAlong | None], per_row: float
) -> dict[int, Sides]:
    """Return the sides of those lines, by their number, beside which the cross section shows another one."""
    sides: dict[int, Sides] = {}
    for i, each in enumerate(along):
        twin = None if each is None else twin_beside(each, per_row)
        if twin is not None:
            own, (side, kind) = lines[i].marking.kind, twin
            sides[i] = (kind, own) if side < 0 else (own, kind)
    return sides


def _sides_of_pairs(lines: Sequence[Candidate]) -> dict[int, Sides]:
    """Return the sides of the lines, by their number, of which two of one colour run side by side."""
    sides: dict[int, Sides] = {}
    order = sorted(range(len(lines)), key=lambda i: float(lines[i].line.n[0]))
    for i, j in pairwise(order):
        left, right = lines[i], lines[j]
        one_colour = left.marking.colour == right.marking.colour
        if one_colour and side_by_side(left.line, right.line):
            sides[i] = sides[j] = left.marking.kind, right.marking.kind
    return sides
