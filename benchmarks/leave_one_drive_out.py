# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""How good the detector is on a drive that did not take part in choosing its thresholds.

python benchmarks/leave_one_drive_out.py DATA [--suite DIR] [--jobs N]
DATA: the labelled KITTI frames. For each drive, the thresholds of thresholds.py are chosen on all other
drives - as they are, in a mirror and at other exposures, see varied_pairs.py - and the drive is judged with
them, as it is. --suite: choose on one frame of each category of these scenes, too.

A threshold's grid is what is physically plausible. The search begins in the middle of every grid, not at the
defaults, and goes through the thresholds in turn; each step away from the middle has to pay.
"""

from __future__ import annotations

import argparse
import math
import statistics
import sys
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from command_line import exit_code, parser_of
from study_runner import UNPAINTED, JudgedPair, Judges, kitti_pairs, labelled_pairs
from thresholds import THRESHOLDS, shipped
from varied_pairs import varied

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.parameter import replaced
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.tools.evaluation.summary import Summary, summarise
from lane_dp_ros.tools.evaluation.text import COLUMNS_OF_FRAMES, table
from lane_dp_ros.tools.parallel import available_cpus

ROUNDS = 2  # through all of them, at most
STEP_COST = 0.0005  # of the objective; the drives are few, what gains less is chance
THINNED = 3  # of the drive without paint, whose pairs follow one another, each third is varied
VARIED = ", varied"  # name of a drive's pairs in a mirror or at other exposures; never judged
# First and last number of the frames of stereo 2015 on one road, by their numbers and by what is seen.
STEREO_DRIVES = (
    ("7-16 (junctions)", 7, 16),
    ("22-31 (dual carriageway)", 22, 31),
    ("57", 57, 57),
    ("72-81 (multi-lane)", 72, 81),
    ("89", 89, 89),
    ("112", 112, 112),
    ("119-126 (gutters)", 119, 126),
    ("144-148 (city)", 144, 148),
)
SUITE = "suite"  # the drive of the scenes; never judged

Values = tuple[float, ...]  # in the order of THRESHOLDS
Scores = Mapping[str, Summary]  # by drive


def drive_of(pair: JudgedPair) -> str:
    """Return the drive that a labelled pair is of: a sequence, or the road that it shares with others.

    A frame among those of one road is of that road, whatever its label calls it: none may serve for choosing
    the thresholds that its neighbours are judged with.
    """
    if pair.sequence != "kitti_stereo_2015":
        return pair.sequence
    number = int(pair.name.rpartition("/")[2].partition("_")[0])
    for name, first, last in STEREO_DRIVES:
        if first <= number <= last:
            return f"stereo 2015, {name}"
    if pair.truth is None or not pair.truth.drive:
        raise CommandError(f"{pair.name} is of no known drive: its label names none, nor does STEREO_DRIVES")
    return f"stereo 2015, {pair.truth.drive}"


@dataclass
class Search:
    """Verdicts by thresholds, each worked out once, and the search for the best ones."""

    judges: Judges
    drives: Mapping[str, str]  # name of the pair: drive
    scores: dict[Values, Scores] = field(default_factory=dict)

    def scored(self, values: Values) -> Scores:
        """Return the summary of each drive with these thresholds."""
        if values not in self.scores:
            self.scores[values] = self._judged(values)
            if sys.stderr.isatty():
                print(f"\r{len(self.scores)} sets of thresholds", end="", file=sys.stderr, flush=True)
        return self.scores[values]

    def _judged(self, values: Values) -> Scores:
        results = self.judges.results(replaced(DetectorConfig(), named(values)))
        names = dict.fromkeys(self.drives.values())
        return {name: summarise(r for r in results if self.drives[r.name] == name) for name in names}

    def best(self, drives: Iterable[str]) -> Values:
        """Return the thresholds that suit these drives best: one at a time, through all, until none moves."""
        chosen = list(drives)
        values, still = middle(), 0
        for i in [*range(len(values))] * ROUNDS:
            before, values = values, self._best_along(i, values, chosen)
            still = still + 1 if values == before else 0
            if still == len(values):
                break
        return values

    def _best_along(self, i: int, values: Values, drives: Sequence[str]) -> Values:
        """Return the thresholds with the best of the values of number i."""
        grid = list(THRESHOLDS.values())[i]

        def quality(at: int) -> float:
            """Return the objective with the value at that place of the grid, less the cost of going there."""
            scores = self.scored((*values[:i], grid[at], *values[i + 1 :]))
            return objective([scores[drive] for drive in drives]) - STEP_COST * abs(at - len(grid) // 2)

        best = max(range(len(grid)), key=quality)
        return (*values[:i], grid[best], *values[i + 1 :])


def middle() -> Values:
    """Return the middle of every grid."""
    return tuple(statistics.median_low(grid) for grid in THRESHOLDS.values())


def named(values: Values) -> dict[str, float]:
    """Return the values by the names of their thresholds."""
    return dict(zip(THRESHOLDS, values, strict=True))


def objective(summaries: Iterable[Summary]) -> float:
    """Return the harmonic mean of the paper's precision, recall and detection precision.

    It is lowered by the share of a lane that each frame without painted lines yields.
    """
    summaries = list(summaries)
    total = sum(summaries, Summary())
    bare = sum((s for s in summaries if not s.labels), Summary())
    numbers = [total.paper_precision, total.lane_recall, total.detection_precision]
    penalty = bare.false_lanes / bare.frames if bare.frames else 0.0
    return statistics.harmonic_mean([0.0 if math.isnan(n) else n for n in numbers]) * max(0.0, 1 - penalty)


def run(arguments: argparse.Namespace) -> None:
    """Search once for each drive, and print."""
    replaced(DetectorConfig(), named(middle()))  # before all the work: a threshold that is gone is said
    pairs = kitti_pairs(arguments.data)
    drives = {pair.name: drive_of(pair) for pair in pairs}
    names = list(dict.fromkeys(drives.values()))
    variants = varied(to_vary(pairs))
    pairs += variants
    drives |= {pair.name: drive_of(pair) + VARIED for pair in variants}
    if arguments.suite:
        scenes = labelled_pairs(arguments.suite, arguments.suite / "truth.json")
        scenes = [pair for pair in scenes if pair.name.endswith("/02")]
        pairs += scenes
        drives |= {pair.name: SUITE for pair in scenes}
    with Judges(pairs, arguments.jobs, alone=True) as judges:
        search = Search(judges, drives)
        chosen = {name: search.best(all_but(name, drives.values())) for name in names}
        left_out = {name: search.scored(values)[name] for name, values in chosen.items()}
        defaults = search.scored(tuple(shipped(name) for name in THRESHOLDS))
    print(f"{len(search.scores)} sets of thresholds were judged\n")
    report(left_out, {name: defaults[name] for name in names}, chosen)


def to_vary(pairs: Sequence[JudgedPair]) -> list[JudgedPair]:
    """Return the pairs that are judged in a mirror and at other exposures, too."""
    return [pair for i, pair in enumerate(pairs) if pair.sequence != UNPAINTED or i % THINNED == 0]


def all_but(drive: str, drives: Iterable[str]) -> list[str]:
    """Return the drives without that one and its varied pairs."""
    return [name for name in dict.fromkeys(drives) if name not in (drive, drive + VARIED)]


def report(left_out: Scores, defaults: Scores, chosen: Mapping[str, Values]) -> None:
    """Print the verdicts with the drive left out, those by the defaults, and what was chosen how often."""
    for title, scores in (("left out", left_out), ("defaults", defaults)):
        total = {"total": sum(scores.values(), Summary())}
        print(table(title, {**scores, **total}, COLUMNS_OF_FRAMES), end="\n\n")
    error = sum(left_out.values(), Summary()).localisation_error
    print(f"localisation error with the drive left out: {error:.3f} m")
    print(f"lines on the frames of {UNPAINTED}: {left_out[UNPAINTED].false_lanes}\n")
    print("How often each value was chosen (grid: times), and the default:")
    for i, (name, grid) in enumerate(THRESHOLDS.items()):
        times = Counter(values[i] for values in chosen.values())
        counts = "  ".join(f"{value:g}: {times[value]}" for value in grid)
        print(f"{name:44s} {counts}  (default {shipped(name):g})")


def main() -> int:
    """Search and print; 1 for a known error, in one line."""
    parser = parser_of(__doc__)
    parser.add_argument("--suite", type=Path, metavar="DIR", help="a folder of lane_dp scenes")
    parser.add_argument("--jobs", type=int, default=available_cpus(), metavar="N")
    return exit_code(run, parser.parse_args())


if __name__ == "__main__":
    sys.exit(main())
