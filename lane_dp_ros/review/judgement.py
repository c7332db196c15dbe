# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What a person says about the two closest lanes of a frame, and the paper's table of it."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from typing import Any, cast

from lane_dp_ros.tools.evaluation.truth_file import KINDS, Kind

SIDES = ("left", "right")
VERDICTS = ("correct", "incorrect", "missed", "none")  # none: no marking there, not counted
ROLES = ("ego_left", "ego_right", "other")
MAX_LINES, MAX_POINTS = 50, 1000  # of one frame and of one line: more is no road

Pixel = tuple[float, float]


@dataclass(frozen=True)
class Line:
    """A line as corrected by hand: points (u, v) [px] of the left image, on the centre of the paint."""

    id: str
    role: str
    kind: Kind
    sure: bool
    uv: tuple[Pixel, ...]


@dataclass(frozen=True)
class Judgement:
    """What was said of one frame; None where nothing was said yet. `lines` replace the detected ones."""

    left: str | None = None
    right: str | None = None
    lines: tuple[Line, ...] | None = None

    @property
    def complete(self) -> bool:
        """Whether both sides are judged."""
        return self.left is not None and self.right is not None


@dataclass(frozen=True)
class Table:
    """The paper's table of a drive: the closest two lane markings of every judged frame."""

    total: int = 0
    incorrect: int = 0
    missed: int = 0

    @property
    def precision(self) -> float | None:
        """(total - incorrect - missed) / total; None where there is nothing to count."""
        return (self.total - self.incorrect - self.missed) / self.total if self.total else None

    def text(self, name: str) -> str:
        """Return the table as lines of text, headed as in the paper."""
        precision = "-" if self.precision is None else f"{100 * self.precision:.1f} %"
        width = max(len(name), len("sequence"))
        return (
            f"{'sequence':<{width}} | total lane markings | incorrect | missed | precision\n"
            f"{name:<{width}} | {self.total:>19} | {self.incorrect:>9} | {self.missed:>6} | {precision:>9}"
        )


def table_of(judgements: Iterable[Judgement]) -> Table:
    """Count the verdicts of both sides of every judgement."""
    said = [verdict for each in judgements for verdict in (each.left, each.right)]
    counted = [verdict for verdict in said if verdict not in (None, "none")]
    return Table(len(counted), counted.count("incorrect"), counted.count("missed"))


def judgement_to_json(judgement: Judgement) -> dict[str, Any]:
    """Return it as JSON's types, without what was not said; `judgement_from_json` reads it back."""
    fields: dict[str, Any] = {"left": judgement.left, "right": judgement.right, "lines": judgement.lines}
    if judgement.lines is not None:
        fields["lines"] = lines_to_json(judgement.lines)
    return {name: value for name, value in fields.items() if value is not None}


def lines_to_json(lines: tuple[Line, ...]) -> list[dict[str, Any]]:
    """Return lines as JSON's types."""
    return [{**asdict(line), "uv": [list(point) for point in line.uv]} for line in lines]


def judgement_from_json(fields: Any) -> Judgement:
    """Return the judgement that JSON fields describe. Raises ValueError naming what is wrong."""
    if not isinstance(fields, dict) or not fields.keys() <= {"left", "right", "lines"}:
        raise ValueError(f"{_short(fields)} is no judgement: expected left, right, lines")
    lines = fields.get("lines")
    said = {side: None if fields.get(side) is None else verdict_from_json(fields[side]) for side in SIDES}
    return Judgement(said["left"], said["right"], None if lines is None else lines_from_json(lines))


def verdict_from_json(value: Any) -> str:
    """Return a verdict. Raises ValueError for any other value."""
    return _choice(value, VERDICTS, "verdict")


def lines_from_json(values: Any) -> tuple[Line, ...]:
    """Return the lines of a frame.

    Raises ValueError for what is no line, NaN points, ids that repeat, and two lines of one ego role.
    """
    if not isinstance(values, list) or len(values) > MAX_LINES:
        raise ValueError(f"lines are {_short(values)}, expected a list of at most {MAX_LINES}")
    lines = tuple(_line(value) for value in values)
    ids, egos = [line.id for line in lines], [line.role for line in lines if line.role != "other"]
    for values_of, name in ((ids, "id"), (egos, "role")):
        if len(set(values_of)) < len(values_of):
            raise ValueError(f"two lines have one {name}: {', '.join(values_of)}")
    return lines


def _line(value: Any) -> Line:
    if not isinstance(value, dict) or value.keys() != {"id", "role", "kind", "sure", "uv"}:
        raise ValueError(f"{_short(value)} is no line: expected id, role, kind, sure, uv")
    if not isinstance(value["id"], str) or not 0 < len(value["id"]) <= 40:
        raise ValueError(f"a line's id is {_short(value['id'])}, expected a text of 1 to 40 characters")
    if not isinstance(value["sure"], bool):
        raise ValueError(f"sure is {_short(value['sure'])}, expected true or false")
    role, kind = _choice(value["role"], ROLES, "role"), _choice(value["kind"], KINDS, "kind")
    return Line(value["id"], role, cast("Kind", kind), value["sure"], _points(value["uv"]))


def _points(values: Any) -> tuple[Pixel, ...]:
    if not isinstance(values, list) or not 2 <= len(values) <= MAX_POINTS:
        raise ValueError(f"uv is {_short(values)}, expected 2 to {MAX_POINTS} points")
    return tuple(_point(value) for value in values)


def _point(value: Any) -> Pixel:
    if not isinstance(value, list) or len(value) != 2 or not all(_is_number(number) for number in value):
        raise ValueError(f"a point is {_short(value)}, expected two finite numbers [u, v]")
    return float(value[0]), float(value[1])


def _is_number(value: Any) -> bool:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return False
    return abs(value) <= sys.float_info.max  # an integer may be more than any float


def _choice(value: Any, choices: tuple[str, ...], name: str) -> str:
    if not isinstance(value, str) or value not in choices:
        raise ValueError(f"{name} is {_short(value)}, expected one of {', '.join(choices)}")
    return value


def _short(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."
