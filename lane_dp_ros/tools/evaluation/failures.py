# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What went wrong in a frame, classed as the paper does, and which frames are the worst."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Sequence
from typing import Literal, NamedTuple

from lane_dp_ros.core.types import Lane
from lane_dp_ros.tools.evaluation.scores import FrameScore

Kind = Literal["missed", "incorrect", "not found", "false", "duplicate"]

# The paper's classes (section VI-C): why a line beside the vehicle is missed, or a wrong one found. A class
# is known by a word of the truth's category; the paper knows no lines that are missed in shadows.
NOT_SEEN = {
    "over-exposure": {"exposure", "overexposure", "glare", "sun", "wet", "reflection"},
    "occlusion": {"vehicles", "cars", "traffic", "grass", "occlusion", "occluded", "hidden"},
    "curvature": {"curve", "curves", "curved", "curvature", "bend"},
}
TAKEN_FOR_ONE = {
    "shadow": {"shadow", "shadows", "shade", "bridge", "trees"},
    "similar objects": {
        "kerb", "kerbs", "rail", "rails", "railing", "seams", "tar", "cracks", "joints", "concrete",
        "hatching", "arrows", "stop", "zebra", "verge", "grass", "island", "works", "similar", "parked",
        "strip", "ghost", "slush", "reflections", "sealing", "footpath", "gutter",
    },
}  # fmt: skip
OTHER, UNKNOWN = "other", "not known"

# How much worse each makes a frame: lines that the vehicle would follow weigh most.
WEIGHTS: dict[Kind, int] = {"missed": 3, "incorrect": 3, "false": 3, "not found": 1, "duplicate": 1}


class Failure(NamedTuple):
    """One failure: its kind, the label or the detection (its index) that it is about, the paper's class.

    "missed" and "incorrect" are labels beside the vehicle, the paper's two kinds; "not found" any other label
    that had to be found; "false" and "duplicate" are detections.
    """

    kind: Kind
    what: str | int
    reason: str


def failures(result: FrameScore) -> tuple[Failure, ...]:
    """Return all that is wrong in a frame."""
    found = {match.label for match in result.found}
    egos = set(result.ego_labels)
    others = [label for label in result.labels if label not in found and label not in egos]
    what: list[tuple[Kind, str | int]] = [
        *(("missed", label) for label in result.missed),
        *(("incorrect", label) for label in result.incorrect),
        *(("not found", label) for label in others),
        *(("false", i) for i, d in enumerate(result.detections) if d.verdict == "false"),
        *(("duplicate", i) for i, d in enumerate(result.detections) if d.verdict == "duplicate"),
    ]
    return tuple(Failure(kind, which, reason(kind, result.category)) for kind, which in what)


def reason(kind: Kind, category: str) -> str:
    """Return the paper's class of a failure in a frame of this category of the truth.

    A category that is none of the paper's stands behind "other".
    """
    if not category:
        return UNKNOWN
    classes = NOT_SEEN if kind in ("missed", "not found") else TAKEN_FOR_ONE
    words = set(re.findall("[a-z]+", category.lower()))
    return next((name for name, known in classes.items() if words & known), f"{OTHER}: {category}")


def is_papers(reason: str) -> bool:
    """Whether a class is one of the paper's."""
    return reason in (*NOT_SEEN, *TAKEN_FOR_ONE)


def worst_first(results: Iterable[FrameScore]) -> list[FrameScore]:
    """Return the frames, those with the gravest failures first, among equals that with the largest error.

    The frames of a sequence look alike: the worst of each comes before the second worst of any, as far as
    they fail.
    """
    order = sorted(results, key=badness, reverse=True)
    before: Counter[str] = Counter()
    turns = {}
    for result in order:
        sequence = result.name if result.stamp_ns is None else result.sequence
        turns[result.name] = before[sequence]
        before[sequence] += 1
    return sorted(order, key=lambda result: turns[result.name] if failures(result) else len(order))


def counts_by_reason(results: Sequence[FrameScore]) -> dict[str, Counter[Kind]]:
    """Return how many failures of each kind each class has, the paper's classes first."""
    found = [failure for result in results for failure in failures(result)]
    names = sorted({failure.reason for failure in found}, key=lambda name: (_rank(name), name))
    return {name: Counter(failure.kind for failure in found if failure.reason == name) for name in names}


def _rank(reason: str) -> int:
    """Return the place of a class: the paper's in its order, others, the unknown."""
    classes = (*NOT_SEEN, *TAKEN_FOR_ONE)
    return classes.index(reason) if reason in classes else len(classes) + (reason == UNKNOWN)


def badness(result: FrameScore) -> tuple[int, float]:
    """Return how bad a frame is: the weight of its failures, and among equals the largest error [m]."""
    weight = sum(WEIGHTS[failure.kind] for failure in failures(result))
    return weight, max((match.error for match in result.found), default=0.0)


def aside(lane: Lane) -> str:
    """Return in words where a line runs, beside the vehicle."""
    return f"{abs(lane.lateral_offset):.1f} m {'left' if lane.lateral_offset < 0 else 'right'}"
