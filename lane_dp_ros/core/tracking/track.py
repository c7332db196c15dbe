# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The lines seen in the last second, each where it is now, whether it is seen or not."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from lane_dp_ros.core.tracking.association import agreement, match_in_order, strayed
from lane_dp_ros.core.tracking.frenet_line import FrenetLine, common_axis, first_axis, surface_change
from lane_dp_ros.core.tracking.motion_filter import Aside, MotionFilter
from lane_dp_ros.core.tracking.paint_vote import PaintVote
from lane_dp_ros.core.types import Lane

COMPARED = 3.0  # m; lines that lie farther apart on the whole are not the same
SAME_LINE = 0.5  # m; from one frame to the next a line leaves its prediction by less
BARELY = 0.0075  # 1/m; what two offsets tell counts like a share of 3 m at 20 m, see `agreement`


@dataclass(frozen=True, eq=False)
class Detection:
    """A lane of this frame, and its course."""

    lane: Lane
    course: FrenetLine


@dataclass
class Track:
    """A line or a road edge: as it was last published, but `course` and `offset` [m] as of this frame."""

    lane: Lane
    course: FrenetLine
    offset: float
    born_ns: int
    last_seen_ns: int
    hits: int = 1
    paint: PaintVote = field(default_factory=PaintVote)


class TrackManager:
    """Known lines by id. All of them move with the vehicle as the filter has it, frame by frame."""

    def __init__(self, lanes: Sequence[Lane] = ()) -> None:
        """Begin with the frame of these lanes, which are not known yet."""
        self.tracks: dict[int, Track] = {}
        self.axis = first_axis([lane.points for lane in lanes])
        self._filter = MotionFilter()

    def predict(self, seconds: float) -> None:
        """Move everything on in time, and straighten it by the axis of that time."""
        self._filter.predict(seconds, self.axis.curvature)
        self._move()
        axis = common_axis([line.course for line in self.tracks.values()])
        for line in self.tracks.values():
            line.course = FrenetLine.of(line.course.points(self.axis), axis)
        self.axis = axis

    def remove(self, seen_before_ns: int) -> None:
        """Forget the lines that were last seen before that time."""
        for identity in [i for i, line in self.tracks.items() if line.last_seen_ns < seen_before_ns]:
            del self.tracks[identity]
            self._filter.remove(identity)

    def match(self, sightings: Sequence[Detection]) -> dict[int, int]:
        """Return index of sighting -> id for the known lines among them."""
        known = sorted((line.course.place(self.axis), i) for i, line in self.tracks.items())
        new = sorted((seen.course.place(self.axis), i) for i, seen in enumerate(sightings))
        gains = np.zeros((len(known), len(new)))
        for row, column in np.ndindex(gains.shape):
            if abs(known[row][0] - new[column][0]) <= COMPARED:
                gains[row, column] = self._likeness(known[row][1], sightings[new[column][1]])
        return {new[column][1]: known[row][1] for row, column in match_in_order(gains)}

    def update(self, found: Mapping[int, Detection], may_stray: Collection[int] = ()) -> set[int]:
        """Take in the lines that are seen; the others move along.

        So do those of `may_stray` that were found, for a part, on the paint of another; they are returned.
        """
        suspects = self._strayed(found) & set(may_stray)
        placed = self._take_in({i: seen for i, seen in found.items() if i not in suspects})
        # By now it is known how the vehicle moved, with which lines may have moved to where others were.
        strayed = self._strayed(found) & suspects
        placed |= self._take_in({i: found[i] for i in suspects - strayed})
        taken_in = found.keys() - strayed
        for identity in taken_in - placed:
            self._filter.initialise(identity)
        surface = surface_change(
            (self.tracks[i].course, found[i].course) for i in taken_in & self.tracks.keys()
        )
        for identity in self.tracks.keys() - taken_in:
            self.tracks[identity].course = self.tracks[identity].course.lowered(surface)
        return strayed

    def smoothed(self, identity: int, course: FrenetLine) -> FrenetLine:
        """Return the course of a known line as it was found in this frame, moved to where it was expected."""
        expected = self.tracks[identity].course.slid(self._filter.slide(), self.axis)
        return course.onto(expected)

    def _strayed(self, found: Mapping[int, Detection]) -> set[int]:
        courses = {i: self.tracks[i].course for i in found if i in self.tracks}
        return {
            i
            for i, course in courses.items()
            if strayed(found[i].course, course, [other for j, other in courses.items() if j != i])
        }

    def _take_in(self, found: Mapping[int, Detection]) -> set[int]:
        """Move all lines as those found tell; return which of these could be compared with what was known."""
        known = {i: (self.tracks[i].course, seen.course) for i, seen in found.items() if i in self.tracks}
        parts = {i: (course, seen.within(course)) for i, (course, seen) in known.items()}
        asides = {
            i: Aside(
                part.s, part.y - np.interp(part.s, course.s, course.y), part.sigma(), part.lever(self.axis)
            )
            for i, (course, part) in parts.items()
            if part is not None
        }
        # What is expected first: it tells the vehicle's motion, so that one that strayed does not.
        for identity in sorted(asides, key=lambda i: self._filter.surprise(i, asides[i])):
            self._filter.update(identity, asides[identity])
        self._move()
        return set(asides)

    def _likeness(self, identity: int, seen: Detection) -> float:
        line = self.tracks[identity]
        beside = SAME_LINE - abs(line.offset - seen.lane.lateral_offset)
        return max(BARELY * beside, agreement(line.course, seen.course, SAME_LINE))

    def _move(self) -> None:
        for identity, move in self._filter.take_moves().items():
            line = self.tracks[identity]
            line.course = line.course.moved(move)
            line.offset += float(move[0])
