# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What fails, as tables: the worst frames, the paper's classes, the stages at which labels were lost."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from functools import partial
from typing import get_args

from lane_dp_ros.tools.evaluation.causes import Cause, Stage
from lane_dp_ros.tools.evaluation.failures import (
    UNKNOWN,
    WEIGHTS,
    Failure,
    Kind,
    aside,
    badness,
    counts_by_reason,
    failures,
)
from lane_dp_ros.tools.evaluation.scores import FrameScore
from lane_dp_ros.tools.report.html_table import Cell, Marked, html_table

COLUMNS: dict[Kind, str] = {
    "missed": "missed", "incorrect": "incorrect", "not found": "other labels\nnot found",
    "false": "false\nlanes", "duplicate": "duplicates",
}  # fmt: skip
NONE_OF_THEM = "<p>None.</p>"
NONE = "<p>None: every line was found, and none that is not there.</p>"

Causes = Mapping[str, Cause]  # of one frame, by the label's id


def worst_frames(worst: Sequence[FrameScore], causes: Sequence[Causes]) -> str:
    """Return the failing ones of the worst frames, each leading to its card, with its gravest failure."""
    rows: dict[str, list[Cell]] = {}
    links: dict[str, str] = {}
    for place, (result, known) in enumerate(zip(worst, causes, strict=True), 1):
        if failures(result):
            cause = _gravest(result, known)
            failing = Marked(_counts(result), "word", badness(result)[0])
            rows[result.name] = [failing, Marked(cause, "prose"), Marked(result.category or "-", "word")]
            links[result.name] = f"#frame-{place}"
    if not rows:
        return NONE
    return html_table("frame", ["failures", "the gravest", "category"], rows, links)


def _counts(result: FrameScore) -> str:
    counts = Counter(failure.kind for failure in failures(result))
    return ", ".join(f"{counts[kind]} {kind}" for kind in COLUMNS if counts[kind])


def _gravest(result: FrameScore, causes: Causes) -> str:
    """Return in words the gravest failure of which there is more to say than that it is one."""
    gravest_first = sorted(failures(result), key=partial(_rank, result))
    return next((words for failure in gravest_first if (words := _told(failure, result, causes))), "-")


def _rank(result: FrameScore, failure: Failure) -> tuple[float, float]:
    """Return the place of a failure: the gravest first, of wrong lines the surest."""
    what = failure.what
    return -WEIGHTS[failure.kind], -result.detections[what].lane.confidence if isinstance(what, int) else 0.0


def _told(failure: Failure, result: FrameScore, causes: Causes) -> str:
    if isinstance(failure.what, str):
        return f"{failure.what}: {causes[failure.what].words}" if failure.what in causes else ""
    lane = result.detections[failure.what].lane
    return f"{failure.kind} line {aside(lane)}, published with confidence {lane.confidence:.2f}"


def reasons(results: Sequence[FrameScore]) -> str:
    """Return the failures counted by the paper's classes."""
    counts = counts_by_reason(results)
    rows = {name: [_count(counts[name][kind]) for kind in COLUMNS] for name in counts}
    unknown = "<p>Where the truth names no category, the class is not known.</p>" if UNKNOWN in rows else ""
    return f"{html_table('class', list(COLUMNS.values()), rows) or NONE_OF_THEM}{unknown}"


def stages(worst: Sequence[FrameScore], causes: Sequence[Causes]) -> str:
    """Return how many labels of the worst frames were lost at each stage."""
    kinds: tuple[Kind, ...] = ("missed", "incorrect", "not found")
    lost = Counter(
        (known[failure.what].stage, failure.kind)
        for result, known in zip(worst, causes, strict=True)
        for failure in failures(result)
        if isinstance(failure.what, str) and failure.what in known
    )
    names = [stage for stage in get_args(Stage) if any(lost[stage, kind] for kind in kinds)]
    rows = {stage: [_count(lost[stage, kind]) for kind in kinds] for stage in names}
    return html_table("stage", [COLUMNS[kind] for kind in kinds], rows) or NONE_OF_THEM


def _count(count: int) -> str:
    return str(count) if count else "·"
