# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Which single threshold keeps a labelled line from being found.

python benchmarks/explain_misses.py DATA [SUITE] [--jobs N]
DATA: the labelled KITTI frames; SUITE: a folder of `lane_dp scenes`. Where labels are not found, each
threshold of thresholds.py is set to the lowest and the highest value there, one at a time. Printed is for
each of these labels with which of them it would be found. With none, several tests speak against it, or the
road's direction or surface is wrong.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from command_line import exit_code, parser_of
from study_runner import JudgedPair, Judges, kitti_pairs, labelled_pairs
from thresholds import THRESHOLDS, changed

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.tools.evaluation.scores import FrameScore
from lane_dp_ros.tools.parallel import available_cpus
from lane_dp_ros.tools.progress import progress

Change = tuple[DetectorConfig, Mapping[str, Any]]


def extremes() -> Iterator[tuple[str, Change]]:
    """Yield each threshold at either limit, by what it says, with the configuration and the constants."""
    for name, grid in THRESHOLDS.items():
        for value in (min(grid), max(grid)):
            with suppress(ValueError):  # contradicts another one, such as a width more than the greatest
                yield f"{name} {value:g}", changed({name: value})


def not_found(result: FrameScore) -> list[str]:
    """Return the ids of the labels that had to be found and were not."""
    found = {match.label for match in result.found}
    return [label for label in result.labels if label not in found]


def run(arguments: argparse.Namespace) -> None:
    """Judge by the defaults, then those that fail with every change, and print."""
    pairs: Sequence[JudgedPair] = kitti_pairs(arguments.data)
    if arguments.suite is not None:
        pairs = [*pairs, *labelled_pairs(arguments.suite, arguments.suite / "truth.json")]
    with Judges(pairs, arguments.jobs, alone=True) as judges:
        before = {result.name: result for result in judges.results(DetectorConfig())}
    failing = [pair for pair in pairs if not_found(before[pair.name])]
    changes = list(extremes())
    after: dict[str, dict[str, FrameScore]] = {pair.name: {} for pair in failing}
    with Judges(failing, arguments.jobs, alone=True) as judges:
        for name, change in progress(iter(changes), len(changes), "change"):
            for result in judges.results(*change):
                after[result.name][name] = result
    for pair in failing:
        for label in not_found(before[pair.name]):
            mended = [name for name, result in after[pair.name].items() if label not in not_found(result)]
            print(f"{pair.name} {label}: {', '.join(mended) or 'no single threshold'}")


def main() -> int:
    """Judge and print; 1 for a known error, in one line."""
    parser = parser_of(__doc__)
    parser.add_argument("suite", type=Path, nargs="?", metavar="SUITE")
    parser.add_argument("--jobs", type=int, default=available_cpus(), metavar="N")
    return exit_code(run, parser.parse_args())


if __name__ == "__main__":
    sys.exit(main())
