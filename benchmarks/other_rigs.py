# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What the detector finds with other cameras, no parameter touched: other sizes, principal points apart.

python benchmarks/other_rigs.py DATA
DATA: the labelled KITTI frames. Each is judged as it is, at half and at twice its size, and with the right
picture moved by up to 400 px, as a rig without zero-disparity rectification has it. What is moved out of the
right picture is lost: so far the right camera sees less of the road.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from functools import partial

from command_line import exit_code, parser_of
from study_runner import JudgedPair, Judges, labelled_pairs
from varied_pairs import apart, resized

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.tools.evaluation.summary import Summary, summarise
from lane_dp_ros.tools.evaluation.text import Column, table
from lane_dp_ros.tools.parallel import available_cpus
from lane_dp_ros.tools.progress import progress

RIGS: dict[str, Callable[[JudgedPair], JudgedPair]] = {
    "as they are": lambda pair: pair,
    **{f"{scale:g} times the size": partial(resized, scale=scale) for scale in (0.5, 2.0)},
    **{f"{offset:+d} px apart": partial(apart, offset=offset) for offset in (-400, -150, -30, 30, 150, 400)},
}
COLUMNS = (
    Column("ego", "lines", "ego_labels", "d"),
    Column("paper's", "precision", "paper_precision"),
    Column("lane", "recall", "lane_recall"),
    Column("detection", "precision", "detection_precision"),
    Column("false", "lanes", "false_lanes", "d"),
)


def judged(pairs: list[JudgedPair]) -> Summary:
    """Return the verdict on pairs, each by itself, with the default parameters."""
    with Judges(pairs, min(available_cpus(), len(pairs)), alone=True) as judges:
        return summarise(judges.results(DetectorConfig()))


def run(arguments: argparse.Namespace) -> None:
    """Judge the labelled pairs with each rig, and print."""
    pairs = labelled_pairs(arguments.data, arguments.data / "labels" / "lanes.json")
    rigs = progress(RIGS.items(), len(RIGS), "rig")
    found = {name: judged([rig(pair) for pair in pairs]) for name, rig in rigs}
    print(table("labelled frames", found, COLUMNS))


if __name__ == "__main__":
    sys.exit(exit_code(run, parser_of(__doc__).parse_args()))
