# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Kind and colour of a line over time: those that most of its recent sightings had."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Generic, TypeVar

from lane_dp_ros.core.types import Lane, LaneKind, PaintColour

Value = TypeVar("Value")

KEPT = 0.9  # of each vote, with every later one: the last ten or so decide
MAJORITY = 1.5  # times as many votes another value must have: kinds that take turns do not flicker


@dataclass
class Vote(Generic[Value]):
    """What most of the recent votes were for; None before the first one."""

    winner: Value | None = None
    _votes: dict[Value, float] = field(default_factory=dict)

    def add(self, value: Value, weight: float) -> None:
        """Count a vote of `weight` in (0, 1]; the older ones count less from now on."""
        self._votes = {each: KEPT * votes for each, votes in self._votes.items()}
        self._votes[value] = self._votes.get(value, 0.0) + weight
        most = max(self._votes, key=self._votes.__getitem__)
        if self.winner is None or self._votes[most] > MAJORITY * self._votes[self.winner]:
            self.winner = most


@dataclass
class PaintVote:
    """The kind, the sides and the colour of one line, by a vote each; what is not known does not vote."""

    _kind: Vote[LaneKind] = field(default_factory=Vote)
    _colour: Vote[PaintColour] = field(default_factory=Vote)
    _sides: Vote[tuple[LaneKind, LaneKind]] = field(default_factory=Vote)

    def steadied(self, lane: Lane) -> Lane:
        """Count a sighting, whose confidence is its vote's weight; return it with what won so far."""
        if lane.kind:
            self._kind.add(lane.kind, lane.confidence)
        if lane.colour:
            self._colour.add(lane.colour, lane.confidence)
        if lane.sides:
            self._sides.add(lane.sides, lane.confidence)
        kind = self._kind.winner or ""
        sides = self._sides.winner if kind == "double" else None
        return replace(lane, kind=kind, colour=self._colour.winner or "", sides=sides)
