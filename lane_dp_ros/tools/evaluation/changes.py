# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What got better and what worse between two evaluations, frame by frame."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from lane_dp_ros.core.types import Lane
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.tools.evaluation.annotations import by_depth
from lane_dp_ros.tools.evaluation.failures import WEIGHTS, Failure, aside, failures
from lane_dp_ros.tools.evaluation.frame_json import score_to_json
from lane_dp_ros.tools.evaluation.json_file import EvaluationFile
from lane_dp_ros.tools.evaluation.matching import DUPLICATE_DISTANCE
from lane_dp_ros.tools.evaluation.scores import FrameScore, JudgedLine

NOTICED = 0.05  # m; a smaller change of a line's error is within what labels are off themselves


@dataclass(frozen=True)
class Change:
    """One thing that changed in a frame: how much better it made it (negative: worse), and in words."""

    gain: float
    words: str


@dataclass(frozen=True, eq=False)
class FrameChange:
    """A frame in which something changed, as it was judged before and after."""

    before: FrameScore
    after: FrameScore
    changes: tuple[Change, ...]

    @property
    def gain(self) -> float:
        """How much better the frame became, in weights of failures; a change of an error weighs little."""
        return sum(change.gain for change in self.changes)

    @property
    def better(self) -> tuple[str, ...]:
        """What became better, in words."""
        return tuple(change.words for change in self.changes if change.gain > 0)

    @property
    def worse(self) -> tuple[str, ...]:
        """What became worse, in words."""
        return tuple(change.words for change in self.changes if change.gain < 0)


@dataclass(frozen=True, eq=False)
class Comparison:
    """Two evaluations of the same frames: those that both have, and what changed, the worst first."""

    before: tuple[FrameScore, ...]
    after: tuple[FrameScore, ...]
    changes: tuple[FrameChange, ...]
    notes: tuple[str, ...]

    @property
    def better(self) -> tuple[FrameChange, ...]:
        """The frames that became better on the whole, the best first."""
        return tuple(change for change in reversed(self.changes) if change.gain > 0)

    @property
    def worse(self) -> tuple[FrameChange, ...]:
        """The frames that became worse on the whole, the worst first."""
        return tuple(change for change in self.changes if change.gain < 0)

    @property
    def mixed(self) -> tuple[FrameChange, ...]:
        """The frames in which as much became better as became worse."""
        return tuple(change for change in self.changes if change.gain == 0)


def compare(before: EvaluationFile, after: EvaluationFile) -> Comparison:
    """Compare two evaluations on the frames that both have, by name, or by stamp where there is no truth.

    Raises CommandError when they have no frame in common.
    """
    old, new = ({_key(result): result for result in each.results} for each in (before, after))
    common = [key for key in new if key in old]
    if not common:
        raise CommandError(f"{before.path} and {after.path} have no frame in common")
    pairs = [(old[key], new[key]) for key in common]
    changes = [FrameChange(*pair, tuple(_changes(*pair))) for pair in pairs]
    return Comparison(
        tuple(pair[0] for pair in pairs),
        tuple(pair[1] for pair in pairs),
        tuple(sorted((each for each in changes if each.changes), key=lambda each: each.gain)),
        tuple(_notes(before, after, pairs)),
    )


def _key(result: FrameScore) -> str | int:
    return result.name if result.truth is not None or result.stamp_ns is None else result.stamp_ns


def _notes(
    before: EvaluationFile, after: EvaluationFile, pairs: Sequence[tuple[FrameScore, FrameScore]]
) -> Iterator[str]:
    for one in (before, after):
        if spare := len(one.results) - len(pairs):
            yield f"{spare} frames are in {one.path} alone, left out"
    relabelled = sum(_truth(old) != _truth(new) for old, new in pairs)
    if relabelled:
        yield f"{relabelled} frames were judged by different labels: their numbers are not of like with like"


def _truth(result: FrameScore) -> object:
    return score_to_json(result)["truth"]


def _changes(before: FrameScore, after: FrameScore) -> Iterator[Change]:
    """Yield what changed in a frame: labels, wrong lines, errors, the road's surface."""
    yield from _label_changes(before, after)
    yield from _line_changes(before, after)
    yield from _error_changes(before, after)
    yield from _surface_changes(before, after)


def _label_changes(before: FrameScore, after: FrameScore) -> Iterator[Change]:
    old, new = _lost(before), _lost(after)
    for label in after.labels:
        if label in before.labels and (label in old) != (label in new):
            lost = old.get(label) or new[label]
            words = f"found, was {lost.kind}" if label in old else f"{lost.kind}, was found"
            yield Change(WEIGHTS[lost.kind] * (1 if label in old else -1), f"{label} {words}")


def _lost(result: FrameScore) -> dict[str, Failure]:
    """Return the failures that are about labels."""
    return {failure.what: failure for failure in failures(result) if isinstance(failure.what, str)}


def _line_changes(before: FrameScore, after: FrameScore) -> Iterator[Change]:
    """Yield wrong lines that are gone and new ones; those that run where one did before are neither."""
    old = [detection for detection in before.detections if detection.wrong]
    for detection in (detection for detection in after.detections if detection.wrong):
        same = min(old, key=lambda each: apart(each.lane, detection.lane), default=None)
        if same is not None and apart(same.lane, detection.lane) <= DUPLICATE_DISTANCE:
            old.remove(same)
        else:
            confidence = f"confidence {detection.lane.confidence:.2f}"
            yield Change(-_weight(detection), f"new {_told(detection)} ({confidence})")
    for detection in old:
        yield Change(_weight(detection), f"{_told(detection)} gone")


def _weight(detection: JudgedLine) -> int:
    return WEIGHTS["false" if detection.verdict == "false" else "duplicate"]


def _told(detection: JudgedLine) -> str:
    return f"{detection.verdict} line {aside(detection.lane)}"


def apart(one: Lane, other: Lane) -> float:
    """Return the mean lateral distance [m] of two lines over the depths that both have, inf without any."""
    a, b = (by_depth(lane.points) for lane in (one, other))
    low, high = max(a[0, 2], b[0, 2]), min(a[-1, 2], b[-1, 2])
    if high < low:
        return float("inf")
    z = np.linspace(low, high, 20)
    return float(np.mean(np.abs(np.interp(z, a[:, 2], a[:, 0]) - np.interp(z, b[:, 2], b[:, 0]))))


def _error_changes(before: FrameScore, after: FrameScore) -> Iterator[Change]:
    old = {match.label: match.error for match in before.found}
    for match in after.found:
        if abs(gain := old.get(match.label, match.error) - match.error) >= NOTICED:
            yield Change(gain, f"{match.label} {match.error:.2f} m off, was {old[match.label]:.2f} m")


def _surface_changes(before: FrameScore, after: FrameScore) -> Iterator[Change]:
    if before.depth is not None and after.depth is not None and before.depth.measured != after.depth.measured:
        words = ("road surface measured, was none", "no road surface, was measured")
        yield Change(1.0, words[0]) if after.depth.measured else Change(-1.0, words[1])
