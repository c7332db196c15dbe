# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Slices of a bag in which other processes detect ahead, before it is known what comes before them.

A process begins its slice with nothing known, and what it finds is soon, after 0 to 5 s, what is found by who
came all the way: then road, axis and paint of the frame before are the same. Where they are not yet, its
findings do not hold and are not used, see `Finding.holds`: so no answer depends on the slices.
"""

from __future__ import annotations

import logging
from collections import deque
from collections.abc import Hashable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import cv2

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.pipeline import Finding
from lane_dp_ros.messages.bag import BagReader
from lane_dp_ros.messages.camera_infos import calibration
from lane_dp_ros.messages.stamp import NS_PER_S, stamp_from_ros
from lane_dp_ros.messages.stereo_bag import BagPair, StereoTopics, read_stereo_pairs, sync_of_bag
from lane_dp_ros.messages.stereo_pipeline import StereoPipeline
from lane_dp_ros.messages.topic_choice import TopicChoice
from lane_dp_ros.tools.parallel import Stream

WARM_UP_NS = NS_PER_S // 2  # before a slice: the stamps of left and right meet, and a picture is known
LEAD_NS = NS_PER_S  # of a drive: what is answered while a process starts, less what is detected anew
READ_TWICE = 0.1  # of the work on a pair, where another process has looked at it, is done by both
LONGEST_NS = 40 * NS_PER_S  # of a slice: what waits here to be used is bounded
SHORTEST_NS = 8 * NS_PER_S  # of a slice that is worth a process
FEWEST = 30  # pairs for each slice and what is before it, whatever the time in which they were recorded


class Slice(NamedTuple):
    """A time in a bag, by recording [ns]; its end is not part of it."""

    start_ns: int
    end_ns: int


@dataclass(frozen=True)
class Source:
    """The pairs of a bag, for every process to open."""

    path: Path
    choice: TopicChoice
    topics: StereoTopics
    sync_tolerance: float
    config: DetectorConfig


def slices_ahead(span: Slice, pairs: int, jobs: int, left_over: float) -> list[Slice]:
    """Return the slices of a bag that processes but this one should look at; between them it works itself.

    Then all `jobs` processes have about the same to do, where the share `left_over` of the work on a pair is
    still this one's where another one has looked at it. None where the bag is too short for more than one.
    """
    if jobs == 1:
        return []
    shares = max(0.0, 1 + READ_TWICE - left_over * jobs) + jobs - 1
    rounds = max(1, round((span.end_ns - span.start_ns) / (LONGEST_NS * shares + LEAD_NS)))
    rounds = min(rounds, pairs // FEWEST)
    if not rounds:
        return []
    period = (span.end_ns - span.start_ns) / rounds
    length = (period - LEAD_NS) / shares
    if length < SHORTEST_NS:
        return slices_ahead(span, pairs, jobs - 1, left_over)
    starts = [
        span.start_ns + round((i + 1) * period - (jobs - 1 - k) * length)
        for i in range(rounds)
        for k in range(jobs - 1)
    ]
    return [Slice(start, start + round(length)) for start in starts]


class LookAhead:
    """What `jobs` - 1 processes have found in slices of a bag, while this one comes after."""

    def __init__(self, source: Source, slices: Sequence[Slice], jobs: int) -> None:
        self._source, self._processes = source, jobs - 1
        self._due = deque(slices)
        self._begun: deque[_Begun] = deque()
        self._threads = cv2.getNumThreads()

    def __enter__(self) -> LookAhead:
        if self._due:
            cv2.setNumThreads(1)  # the other cores are theirs
        return self

    def __exit__(self, *_: object) -> None:
        cv2.setNumThreads(self._threads)
        while self._begun:
            self._begun.popleft().stream.close()

    def find(self, pair: BagPair) -> Finding | None:
        """Return what was found in a pair, once it has been; None where nobody looks at it."""
        while self._begun and pair.time_ns >= self._begun[0].part.end_ns:
            self._begun.popleft().stream.close()
        self._begin()
        if not self._begun or pair.time_ns < self._begun[0].part.start_ns:
            return None
        return self._begun[0].find(_key(pair))

    def _begin(self) -> None:
        """Keep the processes at work, but none further ahead than a slice that waits for each."""
        while (
            self._due
            and len(self._begun) < 2 * self._processes
            and sum(not each.stream.done for each in self._begun) < self._processes
        ):
            self._begun.append(_Begun(self._source, self._due.popleft()))


class _Begun:
    """A slice at which a process looks."""

    def __init__(self, source: Source, part: Slice) -> None:
        self.part = part
        self.stream = Stream(_look, (source, part))
        self._results = iter(self.stream)
        self._held: dict[Hashable, Finding | None] = {}

    def find(self, key: Hashable) -> Finding | None:
        """Wait for what was found in a pair; None where the process had no such pair."""
        while key not in self._held:
            result = next(self._results, None)
            if result is None:
                return None
            self._held[result[0]] = result[1]
        return self._held.pop(key)


def _look(task: tuple[Source, Slice]) -> Iterator[tuple[Hashable, Finding | None]]:
    logging.disable(logging.WARNING)  # the process that answers has warned
    (source, part), pipeline = task, StereoPipeline()
    with BagReader(source.path, source.choice) as reader:
        first_ns = part.start_ns - WARM_UP_NS
        sync = sync_of_bag(source.sync_tolerance)
        for pair in read_stereo_pairs(reader, source.topics, sync, first_ns, part.end_ns):
            found = pipeline.find(pair.pair, pair.infos, source.config)
            if pair.time_ns >= part.start_ns:
                yield _key(pair), None if found is None else found.without_arrays()


def _key(pair: BagPair) -> Hashable:
    """Return what two processes know a pair by: its images and what is used of its camera infos."""
    right = pair.pair.right
    right_ns = None if right is None else stamp_from_ros(right.header.stamp)
    return pair.pair.stamp_ns, right_ns, pair.time_ns, *(calibration(info) for info in pair.infos)
