# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Judge detected lane lines and road edges against labels: docs/evaluation.md."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.types import Lane
from lane_dp_ros.tools.evaluation.annotations import Label, LabelledFrame
from lane_dp_ros.tools.evaluation.assignment import ProjectedLine, assign, distance, nearest, project
from lane_dp_ros.tools.evaluation.scores import FrameScore, JudgedLine, Match, RoadEdgeScore, Verdict
from lane_dp_ros.tools.evaluation.tusimple_culane import culane, tusimple, tusimple_rows

DUPLICATE_DISTANCE = 0.35  # m; mean distance to a label, below which an unmatched detection means that label
INCORRECT_DISTANCE = 1.5  # m; mean distance, below which an unmatched detection was meant for an ego label


def judge(
    frame: LabelledFrame,
    lanes: Iterable[Lane],
    camera: StereoCamera,
    latency: float | None = None,
    road_edges: Iterable[Lane] | None = None,
) -> FrameScore:
    """Compare the detections of one frame with its labels.

    `lanes` and `road_edges` are in the left optical frame of `camera`, which projects them; `latency` [s] is
    passed on. A label is matched by at most one of the lanes and the other way round, the smallest mean error
    first. `road_edges` are matched likewise with the labels of kind "edge" alone; they are not judged where
    they are None, as those of a detector that tells of none.
    """
    lines = project(frame, lanes, camera)
    sought = tuple(label.id for label in frame.labels if label.counts)
    matches = assign(frame.labels, lines, camera, sought)
    detections = _judged(frame.labels, lines, matches)
    spare = [line for line, d in zip(lines, detections, strict=True) if d.verdict not in ("match", "beyond")]
    egos = [label for label in frame.labels if label.id in frame.ego_ids and label.counts]
    failed = [label for label in egos if all(label.id != match.label for match in matches)]
    meant = {
        label.id for label in failed if any(distance(label, line) <= INCORRECT_DISTANCE for line in spare)
    }
    return FrameScore(
        name=frame.name,
        sequence=frame.sequence,
        category=frame.category,
        stamp_ns=frame.stamp_ns,
        detections=detections,
        matches=matches,
        labels=sought,
        ego_labels=tuple(label.id for label in egos),
        incorrect=tuple(label.id for label in failed if label.id in meant),
        missed=tuple(label.id for label in failed if label.id not in meant),
        unpainted=not any(label.painted for label in frame.labels),
        road_edges=None if road_edges is None else _judge_edges(frame, road_edges, camera),
        latency=latency,
        truth=frame,
        camera=camera,
        **_tusimple_culane(frame, [line for line in lines if _is_asked(frame, line)]),
    )


def judge_unpainted(name: str, lanes: Iterable[Lane], sequence: str, stamp_ns: int) -> FrameScore:
    """Return the result of a frame that is known to have no paint: every detection is false."""
    detections = tuple(JudgedLine(lane, "false") for lane in lanes)
    return FrameScore(name, sequence, "", stamp_ns, detections, unpainted=True)


def _judge_edges(frame: LabelledFrame, road_edges: Iterable[Lane], camera: StereoCamera) -> RoadEdgeScore:
    edges = [label for label in frame.labels if not label.painted]
    sought = tuple(label.id for label in edges if label.sure and label.takes_part)
    lines = project(frame, road_edges, camera)
    matches = assign(edges, lines, camera, sought)
    return RoadEdgeScore(_judged(frame.labels, lines, matches), matches, sought)


def _judged(
    labels: Sequence[Label], lines: Sequence[ProjectedLine], matches: Sequence[Match]
) -> tuple[JudgedLine, ...]:
    by_id = {label.id: label for label in labels}
    matched = {match.detection: by_id[match.label] for match in matches}
    taken = list(matched.values())
    others = [label for label in labels if label not in taken]
    edges = [label for label in labels if not label.painted]
    judged = []
    for i, line in enumerate(lines):
        label = matched.get(i)
        verdict: Verdict = "match" if label is not None else _unmatched(taken, others, line)
        on_paint = label is not None and label.painted
        beside_edge = not on_paint and nearest(edges, line) <= DUPLICATE_DISTANCE
        judged.append(JudgedLine(line.lane, verdict, None if label is None else label.id, beside_edge))
    return tuple(judged)


def _unmatched(taken: Sequence[Label], others: Sequence[Label], line: ProjectedLine) -> Verdict:
    """Return the verdict on a line that matches no label, beside the labels that others match or none."""
    if line.far_aside:
        return "beyond"
    if nearest(taken, line) <= DUPLICATE_DISTANCE:
        return "duplicate"
    return "ignored" if nearest(others, line) <= DUPLICATE_DISTANCE else "false"


def _tusimple_culane(frame: LabelledFrame, lines: Sequence[ProjectedLine]) -> dict[str, Any]:
    """Return what TuSimple and CULane say of lines in the image; labels are the painted, sure ones."""
    labels, pixels = (
        [label.uv for label in frame.labels if _is_wanted(label)],
        [line.pixels for line in lines],
    )
    rows = tusimple_rows(frame.size[1], frame.camera.cy)
    return {"tusimple": tusimple(pixels, labels, rows), "culane": culane(pixels, labels, frame.size)}


def _is_asked(frame: LabelledFrame, line: ProjectedLine) -> bool:
    """Whether TuSimple's and CULane's measures get a line: they know no labels that need not be found."""
    wanted = [label for label in frame.labels if _is_wanted(label)]
    others = [label for label in frame.labels if not _is_wanted(label)]
    if nearest(wanted, line) <= DUPLICATE_DISTANCE:
        return True
    return not line.far_aside and nearest(others, line) > DUPLICATE_DISTANCE


def _is_wanted(label: Label) -> bool:
    return label.painted and label.sure
