# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""How often a published line is right, by what speaks for it, and the confidence that this makes.

python benchmarks/calibrate_confidence.py DATA [SUITE] [--evidence score,run] [--set NAME=VALUE ...]
DATA: the labelled KITTI frames; SUITE: a folder of `lane_dp scenes`. Prints for each number of a line's
evidence how many of the lines are right in each fifth of them, for each reason of a refusal how many of the
refused candidates are right, then a logistic regression of "is right" on the logarithms of the numbers that
--evidence names, and how reliable it is on sequences left out of it.
Thresholds set lower (--set lane_selection.score_min=1) let more wrong lines through to learn from.
"""

from __future__ import annotations

import argparse
import re
import sys
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from command_line import add_settings, exit_code, parser_of
from numpy.typing import NDArray
from study_runner import JudgedPair, kitti_pairs, labelled_pairs, lane_of

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.lanes.candidate import Candidate
from lane_dp_ros.core.parameter import replaced
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.tools.evaluation.reliability import Reliability, reliability
from lane_dp_ros.tools.evaluation.scores import JudgedLine
from lane_dp_ros.tools.progress import progress

Floats = NDArray[np.float64]

PARTS = 5  # of the lines, by each number
SMALLEST = 1e-3  # below it the logarithm of a number is that of this
RIDGE = 1e-2  # holds the weights where lines are few
ROUNDS = 30  # of Newton's method


@dataclass(frozen=True)
class JudgedCandidate:
    """A candidate: its sequence, the numbers of its evidence, its confidence, whether it is right.

    `refusal` says why it is not published, empty where it is; a refused one is judged as if it were the only
    line of the frame.
    """

    sequence: str
    evidence: Mapping[str, float]
    confidence: float
    right: bool
    refusal: str = ""


def judged_candidates(pair: JudgedPair, config: DetectorConfig) -> Iterator[JudgedCandidate]:
    """Yield every candidate of a pair, by itself, those that are published first, none beyond the labels."""
    detection = pair.detected(config)
    published = [each for each in detection.candidates if not each.refusal]
    published.sort(key=lambda candidate: float(candidate.line.n[0]))  # as the lanes are
    for candidate, judged in zip(published, pair.judged(detection.lanes).detections, strict=True):
        if judged.verdict != "beyond":
            yield _judged(pair, candidate, judged)
    for candidate in detection.candidates:
        if candidate.refusal:
            (judged,) = pair.judged((lane_of(candidate, detection),)).detections
            if judged.verdict != "beyond":
                yield _judged(pair, candidate, judged)


def _judged(pair: JudgedPair, candidate: Candidate, judged: JudgedLine) -> JudgedCandidate:
    evidence = {name: float(value) for name, value in asdict(candidate.evidence).items()}
    numbers = {**evidence, "score": candidate.score, "length": candidate.line.length}
    confidence = judged.lane.confidence
    return JudgedCandidate(pair.sequence, numbers, confidence, not judged.wrong, candidate.refusal)


def fit_logistic(numbers: Floats, right: Floats) -> Floats:
    """Return w (1 + K,) so that 1 / (1 + exp(-w0 - w . log x)) is the share of right lines at x (N, K)."""
    return logistic_weights(_design(numbers), right)


def logistic_weights(A: Floats, right: Floats, counts: Floats | float = 1.0) -> Floats:
    """Return w (K,) so that 1 / (1 + exp(-A w)) is the share of right rows of A (N, K), by Newton's method.

    `counts` (N,) is how often each row counts.
    """
    w = np.zeros(A.shape[1])
    for _ in range(ROUNDS):
        p = _sigmoid(A @ w)
        hessian = (A * (counts * p * (1 - p))[:, None]).T @ A + RIDGE * np.eye(len(w))
        w += np.linalg.solve(hessian, A.T @ (counts * (right - p)) - RIDGE * w)
    return w


def predicted(numbers: Floats, weights: Floats) -> Floats:
    """Return the confidence (N,) that the weights give lines with these numbers (N, K)."""
    return _sigmoid(_design(numbers) @ weights)


def _design(numbers: Floats) -> Floats:
    return np.column_stack([np.ones(len(numbers)), np.log(np.maximum(numbers, SMALLEST))])


def _sigmoid(x: Floats) -> Floats:
    return np.asarray(1 / (1 + np.exp(-np.clip(x, -30, 30))))


def left_out(lines: Sequence[JudgedCandidate], names: Sequence[str]) -> Reliability:
    """Return the reliability of the regression on each sequence by the weights of all others."""
    numbers, right = _arrays(lines, names)
    sequences = np.array([line.sequence for line in lines])
    confidence = np.empty(len(lines))
    for sequence in np.unique(sequences):
        judged = sequences == sequence
        weights = fit_logistic(numbers[~judged], right[~judged])
        confidence[judged] = predicted(numbers[judged], weights)
    return reliability(confidence, right)


def _arrays(lines: Sequence[JudgedCandidate], names: Sequence[str]) -> tuple[Floats, Floats]:
    try:
        numbers = np.array([[line.evidence[name] for name in names] for line in lines])
    except KeyError as error:
        raise CommandError(
            f"--evidence {error}: no such number, expected some of {', '.join(lines[0].evidence)}"
        ) from None
    return numbers, np.array([line.right for line in lines], dtype=np.float64)


def print_parts(lines: Sequence[JudgedCandidate]) -> None:
    """Print, for each number of the evidence, how many lines are right in each fifth of them."""
    right = np.array([line.right for line in lines])
    print(f"{len(lines)} lines, {right.sum()} right. Right of all in each fifth, by (from):")
    for name in lines[0].evidence:
        values = np.array([line.evidence[name] for line in lines])
        parts = np.array_split(np.argsort(values, kind="stable"), PARTS)
        texts = [f"{values[p[0]]:7.2f}: {right[p].sum():3d} of {len(p):3d}" for p in parts if len(p)]
        print(f"{name:22s} {'   '.join(texts)}")


def print_refusals(candidates: Sequence[JudgedCandidate]) -> None:
    """Print how many of the refused candidates lie on a label, by the reason, its numbers left away."""
    refused: dict[str, list[bool]] = defaultdict(list)
    for each in candidates:
        if each.refusal:
            refused[re.sub(r"-?\d+(\.\d+)?", "#", each.refusal)].append(each.right)
    print(f"\n{sum(map(len, refused.values()))} candidates refused. No wrong lines, of all, by the reason:")
    for reason, right in sorted(refused.items(), key=lambda item: -len(item[1])):
        print(f"{sum(right):4d} of {len(right):4d}  {reason}")


def print_reliability(title: str, bins: Reliability) -> None:
    """Print the bins of a confidence."""
    used = np.flatnonzero(bins.counts)
    texts = [f"{bins.confidence[i]:.2f}: {bins.right[i]} of {bins.counts[i]}" for i in used]
    print(f"{title}: {', '.join(texts)}; expected calibration error {bins.error:.3f}")


def run(arguments: argparse.Namespace) -> None:
    """Detect, count, fit, print."""
    config = replaced(DetectorConfig(), dict(arguments.set))
    pairs = kitti_pairs(arguments.data)
    if arguments.suite is not None:
        pairs += labelled_pairs(arguments.suite, arguments.suite / "truth.json")
    candidates = [
        each for pair in progress(pairs, len(pairs), "pair") for each in judged_candidates(pair, config)
    ]
    lines = [each for each in candidates if not each.refusal]
    if not lines:
        raise CommandError("no line was published: nothing to learn from")
    print_parts(lines)
    print_refusals(candidates)
    names = arguments.evidence.split(",")
    numbers, right = _arrays(lines, names)
    weights = fit_logistic(numbers, right)
    terms = "".join(f" {w:+.3f} log({name})" for name, w in zip(names, weights[1:], strict=True))
    print(f"\nconfidence = 1 / (1 + exp(-z)), z = {weights[0]:.3f}{terms}")
    print_reliability("now", reliability([line.confidence for line in lines], right))
    print_reliability("so", reliability(predicted(numbers, weights), right))
    print_reliability("so, each sequence left out of the fit", left_out(lines, names))


def main() -> int:
    """Count, fit and print; 1 for a known error, in one line."""
    parser = parser_of(__doc__)
    parser.add_argument("suite", type=Path, nargs="?", metavar="SUITE")
    parser.add_argument("--evidence", default="score", metavar="NAMES", help="default: score")
    add_settings(parser)
    return exit_code(run, parser.parse_args())


if __name__ == "__main__":
    sys.exit(main())
