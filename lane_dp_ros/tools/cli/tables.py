# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""lane_dp tables: the paper's tables, ours and the baseline's beside the published numbers."""

from __future__ import annotations

import argparse
from pathlib import Path

from lane_dp_ros.core.presets import PRESETS
from lane_dp_ros.tools.cli.arguments import add_jobs, add_topics, topic_choice

EXPLANATION = """\
The truth of a drive or bag NAME is NAME.truth.json beside it, as lane_dp review exports it, that of a folder
truth.json or labels/lanes.json in it. A folder that holds the paper's drives stands for all of them. What the
detectors find is judged as by lane_dp evaluate."""


def add_command(commands: argparse._SubParsersAction) -> None:
    """Add `tables` to the commands of lane_dp."""
    text = "print the paper's tables: ours, the paper preset and the baseline beside the published numbers"
    command = commands.add_parser("tables", help=text, description=text, epilog=EXPLANATION)
    kinds = "KITTI raw drive or a folder of them, bag, folder of lane_dp scenes or of labelled images"
    command.add_argument("data", type=Path, nargs="+", metavar="DATA", help=kinds)
    detector = "Python file with lanes(left, right, camera), in place of the baseline"
    command.add_argument("--detector", type=Path, metavar="FILE", help=detector)
    add_jobs(command)
    add_topics(command)
    command.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Judge and print."""
    from lane_dp_ros.tools.evaluation.comparison import comparison
    from lane_dp_ros.tools.evaluation.detectors import baseline_detector, file_detector, preset_detector

    other = file_detector(arguments.detector) if arguments.detector else baseline_detector()
    detectors = [*map(preset_detector, PRESETS), other]
    print(comparison(arguments.data, detectors, arguments.jobs, topic_choice(arguments)))
