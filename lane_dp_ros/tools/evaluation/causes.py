# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Why a label was not found: at which stage the detector lost it, told from what it looked at."""

from __future__ import annotations

from typing import Literal, NamedTuple

from lane_dp_ros.core.detector import LaneDetection
from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.lanes.candidate import Candidate
from lane_dp_ros.core.lanes.evidence_model import EvidenceModel
from lane_dp_ros.core.lanes.lifting import to_lanes
from lane_dp_ros.tools.evaluation.annotations import Label, LabelledFrame
from lane_dp_ros.tools.evaluation.assignment import coverage, distance, project
from lane_dp_ros.tools.evaluation.matching import judge

Stage = Literal[
    "no road surface", "no candidate", "candidate refused", "published beside it", "found in the pair alone"
]

COSTLY = 3  # measurements that are told
NEAR = 0.5  # m beside a label, in the mean; a candidate farther off is of something else
MIN_COVERAGE = 0.5  # share of the label's samples; a shorter candidate is hardly this line


class Cause(NamedTuple):
    """The stage at which a label was lost, and what happened there in words."""

    stage: Stage
    words: str


def causes(
    frame: LabelledFrame, camera: StereoCamera, detection: LaneDetection, model: EvidenceModel
) -> dict[str, Cause]:
    """Return why each painted label that takes part was lost, by its id, were it not found.

    `detection` is what the detector sees in this pair alone, in the left optical frame of `camera`; `model`
    judged its candidates.
    """
    if detection.birds_eye is None:
        lost = Cause("no road surface", detection.note)
        return {label.id: lost for label in frame.labels if label.painted and label.takes_part}
    alone = judge(frame, detection.lanes, camera)
    found = {match.label for match in alone.matches}
    near = _Nearby(frame, camera, detection, model)
    return {
        label.id: Cause("found in the pair alone", "these parameters find it in this pair by itself")
        if label.id in found
        else near.cause(label)
        for label in frame.labels
        if label.painted and label.takes_part
    }


def costly(candidate: Candidate, model: EvidenceModel) -> dict[str, float]:
    """Return the measurements by which a candidate loses most log-odds against the best paint there is."""
    lost = {
        name: model.terms["paint"][name].highest - part
        for name, part in model.parts("paint", candidate.evidence).items()
    }
    return {name: lost[name] for name in sorted(lost, key=lambda name: -lost[name])[:COSTLY]}


class _Nearby:
    """The candidates for paint of a detection, each with its line on the labels' ground."""

    def __init__(
        self, frame: LabelledFrame, camera: StereoCamera, detection: LaneDetection, model: EvidenceModel
    ) -> None:
        view = detection.birds_eye
        assert view is not None
        self._model = model
        self._candidates = [each for each in detection.candidates if each.variant != "border"]
        lanes = [to_lanes([each], view)[0] for each in self._candidates]
        self._lines = project(frame, lanes, camera)
        self._paths = len(detection.paths)

    def cause(self, label: Label) -> Cause:
        """Return why a label has no line among those published."""
        near = [
            (aside, coverage(label, line), candidate)
            for candidate, line in zip(self._candidates, self._lines, strict=True)
            if (aside := distance(label, line)) <= NEAR and coverage(label, line) >= MIN_COVERAGE
        ]
        if not near:
            return Cause(
                "no candidate", f"no candidate within {NEAR:g} m of it (paths in the view: {self._paths})"
            )
        published = [each for each in near if not each[2].refusal]
        if published:
            aside, share, _ = min(published, key=lambda each: each[0])
            return Cause(
                "published beside it", f"a line was published {aside:.2f} m aside, along {share:.0%} of it"
            )
        aside, share, best = max(near, key=lambda each: (each[2].probability[0], each[2].log_odds[0]))
        against = ", ".join(name.replace("_", " ") for name in costly(best, self._model))
        where = f"a candidate {aside:.2f} m aside, along {share:.0%} of it,"
        return Cause("candidate refused", f"{where} was refused: {best.refusal}; most against it: {against}")
