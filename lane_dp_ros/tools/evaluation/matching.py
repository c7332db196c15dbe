# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Judge detected lane lines against labels.

Detections and labels are compared on the label's own ground: a detection is projected into the left image,
and each pixel is taken from there to (x, z), metres right and ahead, so that a small error of the road plane
is not counted twice.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.types import Lane
from lane_dp_ros.tools.evaluation.annotations import Label, LabelledFrame, by_depth
from lane_dp_ros.tools.evaluation.lateral import lateral_errors
from lane_dp_ros.tools.evaluation.scores import FrameScore, JudgedLine, Match, Verdict
from lane_dp_ros.tools.evaluation.tusimple_culane import culane, tusimple, tusimple_rows

Floats = NDArray[np.float64]

END_SLACK = 0.25  # m by which a detection may fall short of a sample and still cover it
MIN_COVERAGE = 0.7  # share of a label's samples
MAX_MEAN_ERROR = 0.20  # m
MAX_ERROR_90 = 0.40  # m, 90th percentile
DUPLICATE_DISTANCE = 0.35  # m; mean distance to a label, below which an unmatched detection means that label
INCORRECT_DISTANCE = 1.5  # m; mean distance, below which an unmatched detection was meant for an ego label
JITTER_DEPTH = 10.0  # m


def judge(
    frame: LabelledFrame, lanes: Iterable[Lane], camera: StereoCamera, latency: float | None = None
) -> FrameScore:
    """Compare the detections of one frame with its labels.

    `lanes` are in the left optical frame of `camera`, which projects them; `latency` [s] is passed on.
    A label is matched by at most one detection and the other way round, the smallest mean error first.
    """
    lanes = tuple(lanes)
    pixels = [_in_image(lane, camera) for lane in lanes]
    lines = [by_depth(frame.on_ground(uv)) for uv in pixels]
    by_id = {label.id: label for label in frame.labels}
    matches = tuple(
        replace(match, in_space=lateral_errors(by_id[match.label], lanes[match.detection], camera))
        for match in _matches(frame.labels, lines)
    )
    detections = _detections(frame.labels, lanes, lines, matches)
    spare = [line for line, detection in zip(lines, detections, strict=True) if detection.verdict != "match"]
    egos = [label for label in frame.labels if label.id in frame.ego_ids and label.counts]
    failed = [label for label in egos if all(label.id != match.label for match in matches)]
    meant = {
        label.id for label in failed if any(_distance(label, line) <= INCORRECT_DISTANCE for line in spare)
    }
    return FrameScore(
        name=frame.name,
        sequence=frame.sequence,
        category=frame.category,
        stamp_ns=frame.stamp_ns,
        detections=detections,
        matches=matches,
        labels=tuple(label.id for label in frame.labels if label.counts),
        ego_labels=tuple(label.id for label in egos),
        incorrect=tuple(label.id for label in failed if label.id in meant),
        missed=tuple(label.id for label in failed if label.id not in meant),
        latency=latency,
        **_tusimple_culane(
            frame, [uv for uv, line in zip(pixels, lines, strict=True) if _is_asked(frame, line)]
        ),
    )


def judge_unpainted(
    name: str, lanes: Iterable[Lane], sequence: str, stamp_ns: int, latency: float | None = None
) -> FrameScore:
    """Return the result of a frame that is known to have no paint: every detection is false."""
    detections = tuple(JudgedLine(lane, "false") for lane in lanes)
    return FrameScore(name, sequence, "", stamp_ns, detections, latency=latency)


def _detections(
    labels: Sequence[Label], lanes: Sequence[Lane], lines: Sequence[Floats], matches: Sequence[Match]
) -> tuple[JudgedLine, ...]:
    matched = {match.detection: match.label for match in matches}
    taken = [label for label in labels if label.id in matched.values()]
    others = [label for label in labels if label.id not in matched.values()]
    verdicts: list[Verdict] = [
        "match" if i in matched
        else "duplicate" if _nearest(taken, line) <= DUPLICATE_DISTANCE
        else "ignored" if _nearest(others, line) <= DUPLICATE_DISTANCE
        else "false"
        for i, line in enumerate(lines)
    ]  # fmt: skip
    return tuple(JudgedLine(lane, verdicts[i], matched.get(i)) for i, lane in enumerate(lanes))


def _matches(labels: Sequence[Label], lines: Sequence[Floats]) -> tuple[Match, ...]:
    """Return the matches, one to one, the smallest mean error first."""
    candidates = [
        match for label in labels for i, line in enumerate(lines) if (match := _match(label, i, line))
    ]
    matches: list[Match] = []
    for match in sorted(candidates, key=lambda match: match.error):
        if all(match.label != other.label and match.detection != other.detection for other in matches):
            matches.append(match)
    return tuple(matches)


def _match(label: Label, detection: int, line: Floats) -> Match | None:
    """Return the match of a line (N, 2) with a label, None where it is none."""
    if not label.takes_part:
        return None
    depths, errors = _lateral_errors(label, line)
    if len(errors) < MIN_COVERAGE * len(label.samples):
        return None
    if np.mean(errors) > MAX_MEAN_ERROR or np.percentile(errors, 90) > MAX_ERROR_90:
        return None
    positions = _position(line), _position(label.xz)
    return Match(label.id, detection, label.counts, depths, errors, *positions)


def _position(line: Floats) -> float | None:
    """Return x [m] of a line (N, 2) at 10 m of depth, None where it does not reach."""
    reaches = line[0, 1] <= JITTER_DEPTH <= line[-1, 1]
    return float(np.interp(JITTER_DEPTH, line[:, 1], line[:, 0])) if reaches else None


def _nearest(labels: Sequence[Label], line: Floats) -> float:
    return min((_distance(label, line) for label in labels), default=np.inf)


def _distance(label: Label, line: Floats) -> float:
    """Return the mean lateral distance [m] over the samples that the line covers, inf if it covers none."""
    _, errors = _lateral_errors(label, line)
    return float(np.mean(errors)) if len(errors) else np.inf


def _lateral_errors(label: Label, line: Floats) -> tuple[Floats, Floats]:
    """Return z and |x of the line - x of the label| [m] at the label's samples that the line covers."""
    if len(line) == 0:
        return np.empty(0), np.empty(0)
    x, z = label.samples.T
    covered = (z >= line[0, 1] - END_SLACK) & (z <= line[-1, 1] + END_SLACK)
    return z[covered], np.abs(np.interp(z[covered], line[:, 1], line[:, 0]) - x[covered])


def _in_image(lane: Lane, camera: StereoCamera) -> Floats:
    """Return the pixels (N, 2) of a lane; points behind the camera drop out."""
    points = np.asarray(lane.points, dtype=np.float64).reshape(-1, 3)
    return camera.project(points[points[:, 2] + camera.left_translation[2] > 0])


def _tusimple_culane(frame: LabelledFrame, pixels: Sequence[Floats]) -> dict[str, Any]:
    """Return what TuSimple and CULane say of lines (N, 2) in the image; labels are the painted, sure ones."""
    labels = [label.uv for label in frame.labels if label.painted and label.sure]
    rows = tusimple_rows(frame.size[1], frame.camera.cy)
    return {"tusimple": tusimple(pixels, labels, rows), "culane": culane(pixels, labels, frame.size)}


def _is_asked(frame: LabelledFrame, line: Floats) -> bool:
    """Whether TuSimple's and CULane's measures get a line: they know no labels that need not be found."""
    wanted = [label for label in frame.labels if label.painted and label.sure]
    others = [label for label in frame.labels if not (label.painted and label.sure)]
    return _nearest(wanted, line) <= DUPLICATE_DISTANCE or _nearest(others, line) > DUPLICATE_DISTANCE
