# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What judging gives: a FrameScore for each frame, and the Summary of any set of frames."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.types import Lane
from lane_dp_ros.tools.evaluation.tusimple_culane import CULane, TuSimple

Floats = NDArray[np.float64]
Verdict = Literal["match", "false", "duplicate", "ignored"]

NEAR, FAR = (6.0, 12.0), (12.0, 25.0)  # m of depth; 12 m itself is near


@dataclass(frozen=True)
class JudgedLine:
    """A detected line and its verdict.

    "match" of a label; "false"; "duplicate", beside a label that a better one matches; "ignored", beside any
    other label (unsure, unpainted, or not matched by anything).

    `label` is the id of the label that it matches, None for all but matches.
    """

    lane: Lane
    verdict: Verdict
    label: str | None = None

    @property
    def wrong(self) -> bool:
        """Whether it counts against the detection precision."""
        return self.verdict in ("false", "duplicate")


@dataclass(frozen=True, eq=False)
class Match:
    """A label and the detection that was found for it.

    `depths` (N,) [m] are the label's samples that the detection covers, `errors` (N,) [m] the lateral
    distances there, always >= 0. `position` and `label_position` [m] are where the detection and the label
    run at 10 m of depth, None where either of them does not reach. `counts`: the label had to be found.
    """

    label: str
    detection: int
    counts: bool
    depths: Floats
    errors: Floats
    position: float | None = None
    label_position: float | None = None

    @property
    def error(self) -> float:
        """Mean lateral error [m]."""
        return float(np.mean(self.errors))

    @property
    def near(self) -> float | None:
        """Mean lateral error [m] from 6 to 12 m of depth, None where no sample lies there."""
        return self._error_between(*NEAR)

    @property
    def far(self) -> float | None:
        """Mean lateral error [m] beyond 12 m of depth, None where no sample lies there."""
        return self._error_between(np.nextafter(FAR[0], np.inf), FAR[1])

    def _error_between(self, low: float, high: float) -> float | None:
        inside = (self.depths >= low) & (self.depths <= high)
        return float(np.mean(self.errors[inside])) if inside.any() else None


@dataclass(frozen=True, eq=False)
class FrameScore:
    """How one frame was judged.

    `labels`: ids of the lines that had to be found; `ego_labels`: those of them beside the vehicle, of which
    `incorrect` and `missed` were not. `matches` are all, also those of labels that need not be found.
    `latency` [s] is None where it is not known; `tusimple` and `culane` are None for a frame without truth.
    """

    name: str
    sequence: str
    category: str
    stamp_ns: int | None
    detections: tuple[JudgedLine, ...]
    matches: tuple[Match, ...] = ()
    labels: tuple[str, ...] = ()
    ego_labels: tuple[str, ...] = ()
    incorrect: tuple[str, ...] = ()
    missed: tuple[str, ...] = ()
    latency: float | None = None
    tusimple: TuSimple | None = None
    culane: CULane | None = None

    @property
    def false_lanes(self) -> int:
        """Number of detections that lie on nothing."""
        return sum(d.verdict == "false" for d in self.detections)

    @property
    def duplicates(self) -> int:
        """Number of detections beside one that is nearer to the same label."""
        return sum(d.verdict == "duplicate" for d in self.detections)

    @property
    def found(self) -> tuple[Match, ...]:
        """The matches of labels that had to be found."""
        return tuple(match for match in self.matches if match.counts)

    @property
    def confidences(self) -> tuple[tuple[float, bool], ...]:
        """For each detection, its confidence and whether it was right (neither false nor a duplicate)."""
        return tuple((d.lane.confidence, not d.wrong) for d in self.detections)


@dataclass(frozen=True)
class Summary:
    """Counts and sums over any number of frames; summaries add up.

    `id_chances` is how often an id could have switched. Ratios and means are nan where there is nothing to
    count.
    """

    frames: int = 0
    ego_labels: int = 0
    incorrect: int = 0
    missed: int = 0
    labels: int = 0
    matched: int = 0
    detections: int = 0
    false_lanes: int = 0
    duplicates: int = 0
    error_sum: float = 0.0
    near_sum: float = 0.0
    near_matches: int = 0
    far_sum: float = 0.0
    far_matches: int = 0
    id_switches: int = 0
    id_chances: int = 0
    jitter_sum: float = 0.0
    label_jitter_sum: float = 0.0
    jitter_windows: int = 0
    latencies: tuple[float, ...] = ()
    tusimple: TuSimple = field(default_factory=TuSimple)
    culane: CULane = field(default_factory=CULane)

    def __add__(self, other: Summary) -> Summary:
        names = [each.name for each in fields(self)]
        return Summary(*(getattr(self, name) + getattr(other, name) for name in names))

    @property
    def paper_precision(self) -> float:
        """(N - incorrect - missed) / N over the painted, sure ego lines: the paper's Tables II and III."""
        return _ratio(self.ego_labels - self.incorrect - self.missed, self.ego_labels)

    @property
    def lane_recall(self) -> float:
        """Share of the painted, sure labels that were found."""
        return _ratio(self.matched, self.labels)

    @property
    def detection_precision(self) -> float:
        """Share of the detections that are neither false lanes nor duplicates."""
        return _ratio(self.detections - self.false_lanes - self.duplicates, self.detections)

    @property
    def false_lanes_per_frame(self) -> float:
        """False lanes per frame."""
        return _ratio(self.false_lanes, self.frames)

    @property
    def localisation_error(self) -> float:
        """Mean lateral error [m] of the matches."""
        return _ratio(self.error_sum, self.matched)

    @property
    def near_error(self) -> float:
        """Mean lateral error [m] of the matches from 6 to 12 m of depth."""
        return _ratio(self.near_sum, self.near_matches)

    @property
    def far_error(self) -> float:
        """Mean lateral error [m] of the matches from 12 to 25 m of depth."""
        return _ratio(self.far_sum, self.far_matches)

    @property
    def jitter(self) -> float:
        """Mean standard deviation [m] of the lateral position at 10 m about a straight line over 5 frames."""
        return _ratio(self.jitter_sum, self.jitter_windows)

    @property
    def label_jitter(self) -> float:
        """The same of the labels themselves: what a perfect detector's jitter would be."""
        return _ratio(self.label_jitter_sum, self.jitter_windows)

    @property
    def latency(self) -> float:
        """Mean latency [s] of the frames whose latency is known."""
        return _ratio(sum(self.latencies), len(self.latencies))

    @property
    def latency_95(self) -> float:
        """95th percentile [s] of the latencies that are known."""
        return float(np.percentile(self.latencies, 95)) if self.latencies else float("nan")


def _ratio(part: float, whole: float) -> float:
    return part / whole if whole else float("nan")
