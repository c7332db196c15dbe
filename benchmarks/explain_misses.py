# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Why labelled lines are not found: what became of the candidates along them.

python benchmarks/explain_misses.py DATA [SUITE] [--set NAME=VALUE ...]
DATA: the labelled KITTI frames; SUITE: a folder of `lane_dp scenes`. Printed is, for each label that is not
found, every candidate for paint near it: how far beside it and over what share of it, its metres of paint,
why it is refused, and the measurements by which it loses most log-odds against the best paint there is.
Without a candidate no path leads there, or the road's direction or surface is wrong.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from command_line import add_settings, exit_code, parser_of
from study_runner import JudgedPair, kitti_pairs, labelled_pairs, lane_of

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.detector import LaneDetection
from lane_dp_ros.core.lanes.candidate import Candidate
from lane_dp_ros.core.lanes.evidence_model import EvidenceModel, evidence_model
from lane_dp_ros.core.parameter import replaced
from lane_dp_ros.core.types import Lane
from lane_dp_ros.tools.evaluation.annotations import Label, by_depth
from lane_dp_ros.tools.evaluation.assignment import END_SLACK
from lane_dp_ros.tools.evaluation.causes import NEAR, costly
from lane_dp_ros.tools.evaluation.scores import FrameScore
from lane_dp_ros.tools.progress import progress


def not_found(result: FrameScore) -> list[str]:
    """Return the ids of the labels that had to be found and were not."""
    found = {match.label for match in result.found}
    return [label for label in result.labels if label not in found]


def beside(pair: JudgedPair, label: Label, lane: Lane) -> tuple[float, float]:
    """Return the mean distance [m] of a lane from a label on the label's ground, and the share it covers.

    Infinite and 0 where it covers none of it.
    """
    assert pair.truth is not None
    line = by_depth(pair.truth.on_ground(pair.camera.project(lane.points)))
    x, z = label.samples.T
    if not len(line):
        return np.inf, 0.0
    covered = (z >= line[0, 1] - END_SLACK) & (z <= line[-1, 1] + END_SLACK)
    if not covered.any():
        return np.inf, 0.0
    aside = np.interp(z[covered], line[:, 1], line[:, 0]) - x[covered]
    return float(np.abs(aside).mean()), float(covered.mean())


def explanations(pair: JudgedPair, detection: LaneDetection, label: Label, model: EvidenceModel) -> list[str]:
    """Return what there is to say of each candidate near a label, the nearest first; `model` judged them."""
    painted = [each for each in detection.candidates if each.variant != "border"]
    found = [(*beside(pair, label, lane_of(each, detection)), each) for each in painted]
    near = sorted((each for each in found if each[0] <= NEAR), key=lambda each: each[0])
    if not near:
        nothing = "" if painted else detection.note
        return [nothing or f"no candidate within {NEAR:g} m"]
    return [
        f"{candidate.variant}, {aside:.2f} m beside {share:.0%} of it, {candidate.score:.1f} m of paint: "
        + (f"{candidate.refusal} ({costs(candidate, model)})" if candidate.refusal else "published")
        for aside, share, candidate in near
    ]


def costs(candidate: Candidate, model: EvidenceModel) -> str:
    """Return the measurements by which a candidate loses most log-odds against the best paint there is."""
    return ", ".join(f"{name} {-lost:.1f}" for name, lost in costly(candidate, model).items())


def misses(pairs: Sequence[JudgedPair], config: DetectorConfig) -> Iterator[str]:
    """Yield a line for each label that is not found, and one for each candidate near it."""
    model = evidence_model(config.lane_selection.evidence_model)
    for pair in progress(pairs, len(pairs), "pair"):
        if pair.truth is None:
            continue
        detection = pair.detected(config)
        missed = not_found(pair.score(detection))
        for label in pair.truth.labels:
            if label.id in missed:
                yield f"{pair.name} {label.id}:"
                yield from (f"  {text}" for text in explanations(pair, detection, label, model))


def run(arguments: argparse.Namespace) -> None:
    """Detect, judge and print."""
    config = replaced(DetectorConfig(), dict(arguments.set))
    pairs = kitti_pairs(arguments.data)
    if arguments.suite is not None:
        pairs += labelled_pairs(arguments.suite, arguments.suite / "truth.json")
    print(*misses(pairs, config), sep="\n")


def main() -> int:
    """Judge and print; 1 for a known error, in one line."""
    parser = parser_of(__doc__)
    parser.add_argument("suite", type=Path, nargs="?", metavar="SUITE")
    add_settings(parser)
    return exit_code(run, parser.parse_args())


if __name__ == "__main__":
    sys.exit(main())
