# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What each parameter of the default pipeline does to the numbers when it is too low or too high.

python benchmarks/tuning.py DATA [SUITE] [--only TEXT] [--jobs N]
DATA: the labelled KITTI frames, with all of odometry 06, which has no paint. SUITE: a folder that
`lane_dp scenes --suite standard` wrote. Each parameter is set to a lower and to a higher value, all others
stay. Prints a table in Markdown; docs/tuning.md has one.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Sequence
from pathlib import Path

from command_line import exit_code, parser_of
from study_runner import UNPAINTED, Judges, kitti_pairs, labelled_pairs

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.parameter import Value, parameters, replaced
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.tools.evaluation.scores import FrameScore
from lane_dp_ros.tools.evaluation.summary import Summary, summarise
from lane_dp_ros.tools.evaluation.text import Column, cell
from lane_dp_ros.tools.parallel import available_cpus
from lane_dp_ros.tools.progress import progress

TRIED: dict[str, tuple[Value, ...]] = {
    "disparity.correlation_window_size": (3, 9),
    "disparity.P1": (200, 800),
    "disparity.P2": (800, 3200),
    "disparity.uniqueness_ratio": (5, 20),
    "disparity.speckle_size": (12, 50),
    "road_profile.camera_height": (1.2, 2.5),
    "road_profile.camera_pitch": (-0.1, 0.1),
    "vanishing_point.heading_max": (0.25, 0.8),
    "vanishing_point.curvature_max": (0.025, 0.1),
    "birds_eye.near": (2.0, 8.0),
    "birds_eye.length": (15.0, 60.0),
    "birds_eye.width": (8.0, 24.0),
    "birds_eye.forward_resolution": (0.125, 0.5),
    "birds_eye.lateral_resolution": (0.025, 0.1),
    "birds_eye.height_tolerance": (0.06, 0.24),
    "paint_map.contrast_min": (0.18, 0.7),
    "paint_map.contrast_max": (1.4, 5.6),
    "path_search.max_paths": (6, 24),
    "path_search.suppression": (0.15, 0.6),
    "path_search.min_score": (0.75, 3.0),
    "path_search.blank_cost": (0.075, 0.3),
    "lane_selection.confidence_min": (0.15, 0.6),
    "tracking.enabled": (False,),
    "tracking.coast_time": (0.0,),
    "seed": (1, 2),
}
"""Lower and higher values of every parameter of the default pipeline; the paper preset has some more."""

QUALITY = (
    Column("", "precision", "paper_precision"),
    Column("", "recall", "lane_recall"),
    Column("", "det. precision", "detection_precision"),
)
FALSE = Column("", "false lanes", "false_lanes", "d")
GROUPS = {"labelled frames": QUALITY, "06": (FALSE,), "suite": (*QUALITY, FALSE)}
Summaries = dict[str, Summary]


def summaries(results: Sequence[FrameScore]) -> Summaries:
    """Return the summary of each group that was judged: scenes have a category, KITTI's frames have none."""
    groups: dict[str, list[FrameScore]] = {name: [] for name in GROUPS}
    for result in results:
        of_kitti = "06" if result.sequence == UNPAINTED else "labelled frames"
        groups["suite" if result.category else of_kitti].append(result)
    return {name: summarise(found) for name, found in groups.items() if found}


def change(before: Summary, after: Summary, column: Column) -> str:
    """Return by how much a number changed: shares in points of a hundred, counts as they are."""
    now, then = (getattr(each, column.attribute) for each in (after, before))
    if math.isnan(now) or math.isnan(then):
        return cell(after, column)
    text = f"{now - then:+d}" if column.spec == "d" else f"{100 * (now - then):+.1f}"
    return "0" if not float(text) else text


def row(name: str, before: Summaries, after: Sequence[Summaries]) -> str:
    """Return the line of a parameter: its values, and what each of them changes."""
    spec = parameters(DetectorConfig())[name]
    changes = [
        " / ".join(change(before[group], each[group], column) for each in after)
        for group in before
        for column in GROUPS[group]
    ]
    tried = " / ".join(_text(value) for value in TRIED[name])
    return f"| `{name}` | {_text(spec.default)} | {spec.unit} | {tried} | {' | '.join(changes)} |"


def heads(before: Summaries) -> str:
    """Return the first three lines of the table: titles, and what the defaults give."""
    titles = [f"{group}: {column.bottom}" for group in before for column in GROUPS[group]]
    defaults = [cell(before[group], column) for group in before for column in GROUPS[group]]
    return "\n".join(
        [
            f"| parameter | default | unit | tried | {' | '.join(titles)} |",
            f"|---|---|---|---{'|---' * len(titles)}|",
            f"| none changed | | | | {' | '.join(defaults)} |",
        ]
    )


def _text(value: Value) -> str:
    if isinstance(value, str):
        return value
    return str(value).lower() if isinstance(value, bool) else f"{value:g}"


def configs(names: Sequence[str]) -> dict[str, list[DetectorConfig]]:
    """Return what is tried. Raises ValueError for a parameter or a value that there is none of."""
    return {name: [replaced(DetectorConfig(), {name: value}) for value in TRIED[name]] for name in names}


def run(arguments: argparse.Namespace) -> None:
    """Judge every value, and print a line for each parameter."""
    tried = configs([name for name in TRIED if arguments.only in name])
    if not tried:
        raise CommandError(f"no parameter has {arguments.only!r} in its name: see docs/tuning.md")
    pairs = kitti_pairs(arguments.data)
    if arguments.suite is not None:
        pairs += labelled_pairs(arguments.suite, arguments.suite / "truth.json")
    with Judges(pairs, arguments.jobs) as judges:
        before = summaries(judges.results(DetectorConfig()))
        rows = [heads(before)]
        for name, changed in progress(iter(tried.items()), len(tried), "parameter"):
            rows.append(row(name, before, [summaries(judges.results(config)) for config in changed]))
    print(*rows, sep="\n")


def main() -> int:
    """Judge and print; 1 for a known error, in one line."""
    parser = parser_of(__doc__)
    parser.add_argument("suite", type=Path, nargs="?", metavar="SUITE")
    parser.add_argument("--only", default="", metavar="TEXT", help="parameters with this in their name")
    parser.add_argument("--jobs", type=int, default=available_cpus(), metavar="N")
    return exit_code(run, parser.parse_args())


if __name__ == "__main__":
    sys.exit(main())
