# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Whether two versions of the detector find the same lanes: to be run before a commit that touches the core.

python benchmarks/same_answers.py OLD NEW [DATA] [--cache DIR]
OLD, NEW: git revisions, or folders that hold the project. DATA: the labelled KITTI frames, else the folder
that LANE_DP_DATA names, else ../shared/data. Compared are the labelled frames, each by itself, the odometry
drives 01, 02 and 06 in order, and the standard suite of scenes, with both presets. Listed is every line that
appears, vanishes, moves by more than 2 cm at any depth that both reach, begins or ends more than 1 m farther
or nearer, changes its role, or changes its confidence by more than 0.05; then the scores of both. Exit code 1
when anything differs.
The cache keeps the bags, and the answers of commits; it may be deleted at any time.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from command_line import data_folder, exit_code
from input_bags import LABELLED, SUITE, UNPAINTED, InputBag, input_bags
from lane_changes import KINDS, Change, changes
from versions import version

from lane_dp_ros.core.types import Lane
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.tools.evaluation.answers import FrameAnswer
from lane_dp_ros.tools.evaluation.matching import judge, judge_unpainted
from lane_dp_ros.tools.evaluation.scores import FrameScore
from lane_dp_ros.tools.evaluation.summary import Summary, summarise
from lane_dp_ros.tools.evaluation.text import Column, table
from lane_dp_ros.tools.progress import progress

PRESETS = ("default", "paper")
SIDES = ("old", "new")
CACHE = Path.home() / ".cache" / "lane_dp_ros"
COLUMNS = (
    Column("", "frames", "frames", "d"),
    Column("ego", "lines", "ego_labels", "d"),
    Column("paper's", "precision", "paper_precision"),
    Column("lane", "recall", "lane_recall"),
    Column("detection", "precision", "detection_precision"),
    Column("false", "lanes", "false_lanes", "d"),
)
NOTHING_FOUND = FrameAnswer(())

Answers = Mapping[int, FrameAnswer]  # by stamp [ns]


@dataclass(frozen=True)
class Comparison:
    """The answers of both versions to one bag, with one preset."""

    preset: str
    bag: InputBag
    old: Answers
    new: Answers

    @cached_property
    def changes(self) -> list[Change]:
        """Return what differs, frame by frame."""
        return [
            change
            for stamp in sorted(self.bag.names)
            for change in changes(self.bag.names[stamp], *self.lanes(stamp))
        ]

    def lanes(self, stamp: int) -> list[tuple[Lane, ...] | None]:
        """Return the lanes of both versions in a frame, None where one of them gave no answer."""
        found = [answers.get(stamp) for answers in (self.old, self.new)]
        return [None if answer is None else answer.lanes for answer in found]

    def lines(self) -> list[int]:
        """Return how many lines each version found in all frames."""
        return [sum(len(answer.lanes) for answer in answers.values()) for answers in (self.old, self.new)]

    def judged(self, side: str) -> list[FrameScore]:
        """Return the verdicts on the lanes of one version."""
        answers = self.old if side == "old" else self.new
        if self.bag.frames:
            found = [(frame, answers.get(frame.stamp_ns or 0, NOTHING_FOUND)) for frame in self.bag.frames]
            return [judge(frame, answer.lanes, answer.camera or frame.camera) for frame, answer in found]
        return [
            judge_unpainted(name, answers.get(stamp, NOTHING_FOUND).lanes, self.bag.part, stamp)
            for stamp, name in self.bag.names.items()
        ]


def compared(old: str, new: str, data: Path, cache: Path) -> list[Comparison]:
    """Return the answers of both versions to every bag with every preset."""
    with version(old, cache) as before, version(new, cache) as after:
        bags = input_bags(data, cache)
        work = [(preset, bag) for preset in PRESETS for bag in bags]
        return [
            Comparison(preset, bag, *(side.lanes_in(bag.path, preset) for side in (before, after)))
            for preset, bag in progress(work, len(work), "bag")
        ]


def totals(comparisons: Sequence[Comparison]) -> Iterator[str]:
    """Yield a line for each preset and set of frames: how much was compared, and what differs."""
    groups = dict.fromkeys((each.preset, each.bag.part) for each in comparisons)
    for preset, part in groups:
        group = [each for each in comparisons if (each.preset, each.bag.part) == (preset, part)]
        frames = sum(len(each.bag.names) for each in group)
        old, new = (sum(lines) for lines in zip(*(each.lines() for each in group), strict=True))
        counts = Counter(change.kind for each in group for change in each.changes)
        kinds = ", ".join(f"{kind} {counts[kind]}" for kind in KINDS)
        yield f"{preset:8s} {part:8s} {frames:4d} frames, {old:4d} and {new:4d} lines: {kinds}"


def scores(comparisons: Sequence[Comparison], preset: str, older: frozenset[str]) -> str:
    """Return the table of both versions' scores with a preset; `older` names labelled frames."""
    summaries: dict[str, Summary] = {}
    for side in SIDES:
        of_part = {
            part: [result for each in comparisons if (each.preset, each.bag.part) == (preset, part)
                   for result in each.judged(side)]
            for part in (LABELLED, UNPAINTED, SUITE)
        }  # fmt: skip
        groups = {
            "older labelled frames": [result for result in of_part[LABELLED] if result.name in older],
            "all labelled frames": of_part[LABELLED],
            f"{UNPAINTED}, without paint": of_part[UNPAINTED],
            "standard suite": of_part[SUITE],
        }
        summaries |= {f"{side}, {name}": summarise(results) for name, results in groups.items()}
    return table(f"preset {preset}", summaries, COLUMNS)


def older_frames(truth: Path) -> frozenset[str]:
    """Return the names of the labelled frames that do not say which road they belong to: the first ones."""
    frames = json.loads(truth.read_text(encoding="utf-8"))
    return frozenset(name for name, fields in frames.items() if "drive" not in fields)


def run(arguments: argparse.Namespace) -> None:
    """Compare and print. Raises CommandError when anything differs."""
    data, cache = arguments.data.resolve(), arguments.cache.resolve()
    comparisons = compared(arguments.old, arguments.new, data, cache)
    found = [(each, change) for each in comparisons for change in each.changes]
    for each, change in found:
        print(f"{each.preset}, {each.bag.part}, {change}")
    print(*totals(comparisons), sep="\n")
    older = older_frames(data / "labels" / "lanes.json")
    for preset in PRESETS:
        print(f"\n{scores(comparisons, preset, older)}")
    if found:
        raise CommandError(f"differences between {arguments.old} and {arguments.new}: {len(found)}")


def main() -> int:
    """Compare and print; 1 for differences or a known error, in one line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("old", metavar="OLD", help="git revision or folder")
    parser.add_argument("new", metavar="NEW", help="git revision or folder")
    parser.add_argument("data", type=Path, nargs="?", default=data_folder(), metavar="DATA")
    parser.add_argument("--cache", type=Path, default=CACHE, metavar="DIR", help=f"default: {CACHE}")
    return exit_code(run, parser.parse_args())


if __name__ == "__main__":
    sys.exit(main())
