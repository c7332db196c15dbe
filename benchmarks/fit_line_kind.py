# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The log-odds by which a line is dashed, not solid, and how often they are right on roads left out.

python benchmarks/fit_line_kind.py DATA [SUITE ...]
DATA: the labelled KITTI frames; SUITE: folders of `lane_dp scenes`. Every line that matches a sure label, as
a lane or as a refused candidate, takes part in the fit; lanes alone are counted. A road is a drive, or a
category of the scenes whatever its seed. The pairs of a scene show the same paint and count as one. Prints
DASHED_LOG_ODDS of core/lanes/line_kind.py.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from command_line import exit_code, parser_of
from drives import drive_of
from numpy.typing import NDArray
from study_runner import JudgedPair, labelled_pairs, lane_of

from lane_dp_ros.core.birdseye.paint_profile import PaintProfile
from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.lanes.line_kind import longest_run, missing_paint, paint_along
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.tools.progress import progress

Floats = NDArray[np.float64]

RIDGE = 1e-2  # holds the weights where lines are few
ROUNDS = 30  # of Newton's method


@dataclass(frozen=True)
class RoadPair:
    """A pair, the name of its data set, its road, and how much it counts."""

    pair: JudgedPair
    data: str
    road: str
    count: float = 1.0


@dataclass(frozen=True)
class KnownLine:
    """A line whose kind is known: its pair, missing paint, longest run [m], and whether it is a lane."""

    of: RoadPair
    dashed: bool
    missing: float
    run: float
    is_lane: bool


def road_pairs(data: Path, suites: Sequence[Path]) -> Iterator[RoadPair]:
    """Yield the labelled pairs of KITTI and of suites of scenes."""
    for pair in labelled_pairs(data, data / "labels" / "lanes.json"):
        yield RoadPair(pair, data.name, drive_of(pair))
    for suite in suites:
        pairs = labelled_pairs(suite, suite / "truth.json")
        of_scene = Counter(pair.sequence for pair in pairs)
        for pair in pairs:
            yield RoadPair(pair, suite.name, pair.sequence, 1 / of_scene[pair.sequence])


def known_lines(of: RoadPair) -> Iterator[KnownLine]:
    """Yield the candidates of a pair that match a sure label of paint, each by itself."""
    pair, detection = of.pair, of.pair.detected(DetectorConfig())
    if pair.truth is None or detection.birds_eye is None or detection.paint_map is None:
        return
    labels = {label.id: label for label in pair.truth.labels}
    paint = PaintProfile(detection.birds_eye, detection.paint_map)
    per_row = detection.birds_eye.resolution[0]
    for candidate in detection.candidates:
        matches = pair.judged((lane_of(candidate, detection),)).matches
        along = paint_along([candidate.line], paint)[0]
        if along is None or not matches or not labels[matches[0].label].counts:
            continue
        dashed = labels[matches[0].label].kind == "dashed"
        run = longest_run(along.cover, along.s, per_row)
        yield KnownLine(of, dashed, missing_paint(along.cover), run, not candidate.refusal)


def fitted(lines: Sequence[KnownLine]) -> Floats:
    """Return the weights (3,) of 1, missing paint, and log of the longest run."""
    dashed = np.array([line.dashed for line in lines], dtype=np.float64)
    return logistic_weights(_design(lines), dashed, np.array([line.of.count for line in lines]))


def logistic_weights(A: Floats, right: Floats, counts: Floats | float = 1.0) -> Floats:
    """Return w (K,) so that 1 / (1 + exp(-A w)) is the share of right rows of A (N, K), by Newton's method.

    `counts` (N,) is how often each row counts.
    """
    w = np.zeros(A.shape[1])
    for _ in range(ROUNDS):
        p = 1 / (1 + np.exp(-np.clip(A @ w, -30, 30)))
        hessian = (A * (counts * p * (1 - p))[:, None]).T @ A + RIDGE * np.eye(len(w))
        w += np.linalg.solve(hessian, A.T @ (counts * (right - p)) - RIDGE * w)
    return w


def left_out(lines: Sequence[KnownLine]) -> dict[KnownLine, bool]:
    """Return whether the kind of each line is right by a fit to all other roads."""
    right: dict[KnownLine, bool] = {}
    for road in {line.of.road for line in lines}:
        judged = [line for line in lines if line.of.road == road]
        log_odds = _design(judged) @ fitted([line for line in lines if line.of.road != road])
        right |= {line: (z > 0) == line.dashed for line, z in zip(judged, log_odds, strict=True)}
    return right


def _design(lines: Sequence[KnownLine]) -> Floats:
    return np.array([(1.0, line.missing, np.log(line.run)) for line in lines])


def run(arguments: argparse.Namespace) -> None:
    """Detect, fit, print."""
    pairs = list(road_pairs(arguments.data, arguments.suites))
    lines = [line for pair in progress(pairs, len(pairs), "pair") for line in known_lines(pair)]
    if len({line.dashed for line in lines}) < 2:
        raise CommandError(f"{arguments.data} yields no lines of both kinds, nothing to learn from")
    print(f"DASHED_LOG_ODDS = ({', '.join(f'{w:.2f}' for w in fitted(lines))})")
    right = left_out(lines)
    for data in dict.fromkeys(line.of.data for line in lines):
        for kind, dashed in (("solid", False), ("dashed", True)):
            chosen = [e for e in lines if e.is_lane and e.of.data == data and e.dashed == dashed]
            print(f"{data}: {sum(right[e] for e in chosen)} of {len(chosen)} {kind} lanes right, left out")


def main() -> int:
    """Fit and print; 1 for a known error, in one line."""
    parser = parser_of(__doc__)
    parser.add_argument("suites", type=Path, nargs="*", metavar="SUITE")
    return exit_code(run, parser.parse_args())


if __name__ == "__main__":
    sys.exit(main())
