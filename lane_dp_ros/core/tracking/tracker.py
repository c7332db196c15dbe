# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Lanes over time: the same line keeps its id and kind, runs smoothly, and outlasts a short loss."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from lane_dp_ros.core.parameter import Parameters, parameter
from lane_dp_ros.core.tracking.frenet_line import FrenetLine
from lane_dp_ros.core.tracking.track import Detection, Track, TrackManager
from lane_dp_ros.core.types import Lane, with_roles

MEMORY_NS = 1_000_000_000  # a longer jump of time, or one backwards, and everything is forgotten
FARTHEST = 1000.0  # m
BORDER = 0.25  # m at the border of the view, in which a line and the road on both sides of it find no room


@dataclass(frozen=True)
class TrackingConfig(Parameters):
    """Lines over time."""

    enabled: bool = parameter(True, "Smooth lines, bridge short losses, steady the axis; else give ids only.")
    coast_time: float = parameter(
        0.5, "How long a lost line is published where it must be by now.", unit="s", limits=(0.0, 0.5)
    )
    hits_min: int = parameter(
        5,
        "Frames in which a line must be seen before it coasts; what only looks like one is seen in fewer.",
        limits=(1, 100),
        expert=True,
    )
    heading_deviation_max: float = parameter(
        0.15,
        "No line runs off the road's direction by more.",
        unit="rad",
        limits=(0.0, 1.0),
        expert=True,
    )
    new_beside: float = parameter(
        1.0,
        "A line that appears nearer to a lost one takes its place.",
        unit="m",
        limits=(0.0, 5.0),
        expert=True,
    )
    merge_distance: float = parameter(
        0.2,
        "Nearer, lines that were seen side by side have merged.",
        unit="m",
        limits=(0.0, 2.0),
        expert=True,
    )
    confidence_decay: float = parameter(
        1.0,
        "Share by which a lost line's confidence falls each second; some is left after the longest coasting.",
        unit="1/s",
        limits=(0.0, 1.9),
        expert=True,
    )


class LaneTracker:
    """Follows lanes, or road edges, from frame to frame.

    It answers from the first frame on, which it leaves as it is. Lines that are seen again are smoothed, and
    have the kind and the colour that most of their recent sightings had; one that was seen often and is lost
    is published where it must be by now, for `coast_time`, if nothing contradicts, and so is one that was
    found on the paint of another; a line that comes back within a second keeps its id. Unless `enabled`,
    lines get ids only.

    `half_width` [m] is that of the view in which lines are found: one that leaves it sideways is not lost.
    """

    def __init__(self, config: TrackingConfig | None = None) -> None:
        self.config = config or TrackingConfig()
        self.half_width = np.inf
        self._tracks = TrackManager()
        self._stamp_ns: int | None = None
        self._next_id = 0

    def reset(self) -> None:
        """Forget all lines, but not which ids were given."""
        self._tracks, self._stamp_ns = TrackManager(), None

    def update(self, lanes: Sequence[Lane], stamp_ns: int) -> tuple[Lane, ...]:
        """Return what is to be published for the frame of `stamp_ns`, in the left optical frame.

        First the lanes given, in their order, then those lost and coasted; all with their ids. A lane without
        points, or with numbers that are none or beyond every road, is dropped.
        """
        lanes = [lane for lane in lanes if _is_usable(lane)]
        self._predict(lanes, stamp_ns)
        found = self._identified(lanes, stamp_ns)
        fresh = [i for i, line in self._tracks.tracks.items() if self._is_fresh(line, stamp_ns)]
        strayed = self._tracks.update(found, may_stray=fresh)
        published = tuple(
            self._coasted(identity, stamp_ns)
            if identity in strayed
            else self._remember(identity, seen, stamp_ns)
            for identity, seen in found.items()
        )
        others = [self._tracks.tracks[identity] for identity in found]
        lost = [i for i, line in self._lost(found, stamp_ns).items() if _stands(line, others, self.config)]
        coasted = tuple(self._coasted(identity, stamp_ns) for identity in lost)
        return with_roles(published + coasted)

    def _predict(self, lanes: Sequence[Lane], stamp_ns: int) -> None:
        """Move what is known on to this frame's time; begin anew when nothing is known or time jumps."""
        elapsed = 0 if self._stamp_ns is None else stamp_ns - self._stamp_ns
        self._stamp_ns = stamp_ns
        self._tracks.remove(stamp_ns - MEMORY_NS)
        if self._tracks.tracks and 0 <= elapsed <= MEMORY_NS:
            self._tracks.predict(elapsed / 1e9)
        else:
            self._tracks = TrackManager(lanes)

    def _identified(self, lanes: Sequence[Lane], stamp_ns: int) -> dict[int, Detection]:
        """Return the lanes by id, without new ones that contradict lines that are lost."""
        axis = self._tracks.axis
        sightings = [Detection(lane, FrenetLine.of(lane.points, axis)) for lane in lanes]
        ids = self._tracks.match(sightings)
        lost = self._lost(set(ids.values()), stamp_ns)
        found = {}
        for i, seen in enumerate(sightings):
            if i in ids:
                found[ids[i]] = seen
            elif not lost or seen.course.strays(axis) <= self.config.heading_deviation_max:
                found[self._next_id] = seen
                self._next_id += 1
        return found

    def _lost(self, seen: Collection[int], stamp_ns: int) -> dict[int, Track]:
        """Return the lines that coast: established, not seen now, but a moment ago, and still in view."""
        return {
            identity: line
            for identity, line in self._tracks.tracks.items()
            if identity not in seen
            and line.hits >= self.config.hits_min
            and self._is_fresh(line, stamp_ns)
            and self._is_in_view(line)
        }

    def _is_in_view(self, line: Track) -> bool:
        aside = np.abs(line.course.offsets(self._tracks.axis))
        return bool(np.median(aside) < self.half_width - BORDER)

    def _is_fresh(self, line: Track, stamp_ns: int) -> bool:
        """Whether a line was seen so short a time ago that it may be coasted."""
        limit_ns = self.config.coast_time * 1e9 if self.config.enabled else -1
        return stamp_ns - line.last_seen_ns <= limit_ns

    def _remember(self, identity: int, seen: Detection, stamp_ns: int) -> Lane:
        """Return what is published of a line that is seen, and keep it in mind."""
        line = self._tracks.tracks.get(identity)
        lane = replace(seen.lane, id=identity)
        if line is None:
            line = Track(lane, seen.course, lane.lateral_offset, stamp_ns, stamp_ns)
            line.lane = line.paint.steadied(lane)
            self._tracks.tracks[identity] = line
            return line.lane
        course = seen.course
        if self.config.enabled:
            course = self._tracks.smoothed(identity, course)
            lane = replace(line.paint.steadied(lane), points=course.points(self._tracks.axis))
        line.lane, line.course, line.offset = lane, course, lane.lateral_offset
        line.last_seen_ns, line.hits = stamp_ns, line.hits + 1
        return lane

    def _coasted(self, identity: int, stamp_ns: int) -> Lane:
        """Return a line that is not seen where it must be by now, with less confidence."""
        line = self._tracks.tracks[identity]
        age = (stamp_ns - line.last_seen_ns) / 1e9
        confidence = line.lane.confidence * (1 - self.config.confidence_decay * age)
        points = line.course.points(self._tracks.axis)
        return replace(line.lane, points=points, confidence=confidence, lateral_offset=line.offset)


def _is_usable(lane: Lane) -> bool:
    numbers = np.append(lane.points, lane.lateral_offset)
    return len(numbers) > 1 and bool(np.all(np.abs(numbers) < FARTHEST))


def _stands(line: Track, found: Iterable[Track], config: TrackingConfig) -> bool:
    """Whether nothing that is seen contradicts a lost line: nothing new beside it, nothing across it."""
    for other in found:
        aside = line.course.aside(other.course)
        near = config.merge_distance if other.born_ns <= line.last_seen_ns else config.new_beside
        if len(aside) and (np.min(np.abs(aside)) < near or np.ptp(np.sign(aside)) > 0):
            return False
    return True
