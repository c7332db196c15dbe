# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The cards of the worst frames: pictures, and in words which label was missed and which line was false."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from html import escape

from lane_dp_ros.tools.evaluation.annotations import Label, LabelledFrame
from lane_dp_ros.tools.evaluation.causes import Cause
from lane_dp_ros.tools.evaluation.failures import Kind, failures, is_papers
from lane_dp_ros.tools.evaluation.scores import FrameScore, JudgedLine
from lane_dp_ros.tools.report.frame_images import FrameImages
from lane_dp_ros.tools.report.pictures import LANE_STATES, judged_with, label_state, pictures

BADGES: dict[Kind, str] = {
    "missed": "missed",
    "incorrect": "incorrect",
    "not found": "not found",
    "false": "false",
    "duplicate": "duplicate",
}


def card(place: int, result: FrameScore, images: FrameImages, causes: Mapping[str, Cause]) -> str:
    """Return the card of a frame as HTML.

    `place` is its number among the worst; `causes` say why labels were lost, by their ids.
    """
    note = f'<p class="note">{escape(images.note)}</p>' if images.note else ""
    return (
        f'<article class="frame" id="frame-{place}"><header><h3>{place}. {escape(result.name)}</h3>'
        f"{_badges(result)}</header>{note}"
        f'<div class="pictures">{pictures(result, images)}'
        f'<div class="words">{_labels(result, causes)}{_lanes(result)}{_road_edges(result)}'
        "</div></div></article>"
    )


def _badges(result: FrameScore) -> str:
    counts = Counter(failure.kind for failure in failures(result))
    badges = "".join(
        f'<span class="badge {kind.replace(" ", "-")}">{counts[kind]} {text}</span>'
        for kind, text in BADGES.items()
        if counts[kind]
    )
    category = f'<span class="category">{escape(result.category)}</span>' if result.category else ""
    return (badges or '<span class="badge right">no failure</span>') + category


def _labels(result: FrameScore, causes: Mapping[str, Cause]) -> str:
    frame = result.truth
    if frame is None:
        return _list("Labels", "<li>none: this road is known to have no paint</li>")
    rows = "".join(_label(label, result, frame, causes) for label in frame.labels)
    return _list("Labels", rows)


def _label(label: Label, result: FrameScore, frame: LabelledFrame, causes: Mapping[str, Cause]) -> str:
    side = {frame.ego_left: ", ego left", frame.ego_right: ", ego right"}.get(label.id, "")
    state = label_state(label, result)
    sure = "" if label.sure else ", not sure"
    words = {
        "found": "found" + _error(label, result),
        "missed": "missed",
        "incorrect": "incorrect: a line was published beside it",
        "not-found": "not found",
        "not-judged": "need not be found",
    }[state]
    if state in ("missed", "incorrect", "not-found"):
        words += _reason(label.id, result) + (f"; {causes[label.id].words}" if label.id in causes else "")
    what = f"{label.kind}{side}{sure}: {words}"
    return f'<li class="{state}"><b>{escape(label.id)}</b> {escape(what)}</li>'


def _error(label: Label, result: FrameScore) -> str:
    """Return in words how far a found label's line is off, empty for a label that was not found."""
    for match in judged_with(label, result).matches:
        if match.label == label.id:
            return f"{'' if match.counts else ', need not be'}, {100 * match.error:.1f} cm off"
    return ""


def _reason(what: str | int, result: FrameScore) -> str:
    reason = next((failure.reason for failure in failures(result) if failure.what == what), "")
    return f" ({reason})" if is_papers(reason) else ""


def _lanes(result: FrameScore) -> str:
    rows = "".join(_lane(i, detection, result) for i, detection in enumerate(result.detections))
    return _list("Published lines", rows)


def _road_edges(result: FrameScore) -> str:
    """Return in words what became of the road edges, empty where they were not judged."""
    if result.road_edges is None:
        return ""
    rows = "".join(_road_edge(detection) for detection in result.road_edges.detections)
    return _list("Road edges", rows)


def _road_edge(detection: JudgedLine) -> str:
    words = _verdict(detection) + ", {:.0f} to {:.0f} m".format(*detection.lane.extent)
    state = LANE_STATES[detection.verdict]
    return f'<li class="{state}"><b>{detection.lane.confidence:.2f}</b> {escape(words)}</li>'


def _list(title: str, rows: str) -> str:
    return f"<div><h4>{title}</h4><ul>{rows or '<li>none</li>'}</ul></div>"


def _lane(index: int, detection: JudgedLine, result: FrameScore) -> str:
    lane, state = detection.lane, LANE_STATES[detection.verdict]
    name = lane.role.replace("_", " ") + (f" {lane.id}" if lane.id >= 0 else "")
    words = _verdict(detection)
    if detection.strictly_wrong and not detection.wrong:
        words += "; strictly false, it runs along an unpainted edge"
    if detection.wrong:
        words += _reason(index, result)
    extent = "{:.0f} to {:.0f} m".format(*lane.extent)
    return f'<li class="{state}"><b>{lane.confidence:.2f}</b> {escape(name)}, {extent}: {escape(words)}</li>'


def _verdict(detection: JudgedLine) -> str:
    """Return the verdict on a published line in words."""
    return {
        "match": f"right, it is {detection.label}",
        "false": "false",
        "duplicate": "duplicate of a better one",
        "ignored": "beside a label that it does not match, not counted",
        "beyond": "farther aside than anything is labelled, not judged",
    }[detection.verdict]
