# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""lane_dp evaluate: the lanes of a bag or of a folder of images judged by labels, or the road's surface."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from lane_dp_ros.core.presets import PRESETS
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.tools.cli.arguments import add_jobs, add_topics, limit, topic_choice
from lane_dp_ros.tools.evaluation.thresholds import THRESHOLDS, missed_thresholds

if TYPE_CHECKING:
    from lane_dp_ros.tools.evaluation.evaluate import DetectorChoice, Evaluation

NOT_COMPARED = (  # what judges anew, and so has no effect on a comparison
    "--truth", "--unpainted", "--surface", "--json", "--preset", "--config",
    *(threshold.option for threshold in THRESHOLDS),
)  # fmt: skip


def add_command(commands: argparse._SubParsersAction) -> None:
    """Add `evaluate` to the commands of lane_dp."""
    text = (
        "judge lanes by labels and print the paper's table: those in a bag, or detected in its images first"
    )
    epilog = (
        "A bag that carries lanes is judged as recorded. Exit code 1 when a --min... or --max... is missed. "
        "With --surface the depth of the measured road is judged by LiDAR, no lanes."
    )
    command = commands.add_parser("evaluate", help=text, description=text, epilog=epilog)
    add_arguments(command)
    files = "what got better and worse between two files of --json; --report takes images from BAG_OR_DIR"
    command.add_argument("--compare", type=Path, nargs=2, metavar=("A.json", "B.json"), help=files)
    command.add_argument("--preset", choices=PRESETS, help="to detect with, default: default")
    command.add_argument("--config", type=Path, metavar="FILE", help="ROS parameter file to detect with")
    add_jobs(command)
    add_topics(command)
    command.set_defaults(run=run)


def add_arguments(command: argparse.ArgumentParser) -> None:
    """Add what says which frames to judge, by what, and where the numbers go: the arguments of `evaluate`."""
    command.set_defaults(usage_error=command.error)
    command.add_argument(
        "input",
        type=Path,
        nargs="?",
        metavar="BAG_OR_DIR",
        help="bag, folder of images, or what lane_dp scenes wrote",
    )
    truth = command.add_mutually_exclusive_group()
    truth.add_argument("--truth", type=Path, metavar="FILE", help="the labels, see docs/truth_format.md")
    truth.add_argument("--unpainted", action="store_true", help="no frame of the bag has any paint")
    layout = "in place of BAG_OR_DIR: image pairs with LiDAR disparity, laid out as KITTI's stereo 2015"
    truth.add_argument("--surface", type=Path, metavar="DIR", help=layout)
    command.add_argument(
        "--json", type=Path, metavar="FILE", help="write all numbers, see docs/evaluation.md"
    )
    command.add_argument(
        "--report", type=Path, metavar="DIR", help="write a page with tables, curves and frames"
    )
    for threshold in THRESHOLDS:
        word = "smallest" if threshold.is_lower else "largest"
        command.add_argument(
            threshold.option, type=limit, metavar="X", help=f"{word} {threshold.name} to accept"
        )


def run(arguments: argparse.Namespace) -> None:
    """Judge what is recorded, or what the detector finds with the parameters that are asked for."""
    from lane_dp_ros.tools.evaluation.evaluate import DetectorChoice

    if arguments.compare is not None:
        _compare(arguments)
        return
    topics = topic_choice(arguments)
    evaluate(arguments, DetectorChoice(arguments.preset, arguments.config, arguments.jobs, topics))


def _compare(arguments: argparse.Namespace) -> None:
    """Print what changed between two evaluations, and write the page about it."""
    from lane_dp_ros.tools.evaluation.changes import compare
    from lane_dp_ros.tools.evaluation.changes_text import comparison_text
    from lane_dp_ros.tools.evaluation.json_file import read_json

    _check_compared(arguments)
    _check_outputs(arguments)
    before, after = map(read_json, arguments.compare)
    comparison = compare(before, after)
    print(f"A: {before.path}, B: {after.path}\n\n{comparison_text(comparison)}")
    for note in comparison.notes:
        print(f"note: {note}")
    if arguments.report is not None:
        from lane_dp_ros.tools.report import write_changes_report

        source = arguments.input or after.source
        names, topics = (before.path, after.path), topic_choice(arguments)
        page = write_changes_report(comparison, names, source, arguments.report, topics)
        print(f"report: {page}")


def _check_compared(arguments: argparse.Namespace) -> None:
    """End with wrong usage, or raise CommandError, for arguments that a comparison has no use for."""
    if spare := [option for option in NOT_COMPARED if _value(arguments, option) not in (None, False)]:
        arguments.usage_error(f"--compare takes BAG_OR_DIR and --report alone, not {', '.join(spare)}")
    if arguments.input is not None and arguments.report is None:
        arguments.usage_error("--compare takes BAG_OR_DIR for the images of --report alone")
    if arguments.input is not None and not arguments.input.exists():
        raise CommandError(f"{arguments.input}: no such bag or folder, expected the one with the images")


def _value(arguments: argparse.Namespace, option: str) -> Any:
    return getattr(arguments, option.lstrip("-").replace("-", "_"))


def evaluate(arguments: argparse.Namespace, choice: DetectorChoice) -> None:
    """Judge, print, write; raise CommandError when a threshold is missed."""
    from lane_dp_ros.tools.evaluation.evaluate import evaluate_path, evaluate_unpainted
    from lane_dp_ros.tools.evaluation.summary import summarise
    from lane_dp_ros.tools.evaluation.surface import evaluate_surface

    if (arguments.input is None) == (arguments.surface is None):
        arguments.usage_error("expected either BAG_OR_DIR or --surface DIR: the one thing to judge")
    _check_outputs(arguments)
    if arguments.surface is not None:
        evaluation = evaluate_surface(arguments.surface, choice)
    elif arguments.unpainted:
        evaluation = evaluate_unpainted(arguments.input, choice)
    else:
        evaluation = evaluate_path(arguments.input, arguments.truth, choice)
    _write(arguments, evaluation, choice)
    limits = {t.option: _value(arguments, t.option) for t in THRESHOLDS}
    if missed := missed_thresholds(summarise(evaluation.results), limits):
        raise CommandError(missed)


def _check_outputs(arguments: argparse.Namespace) -> None:
    """Raise CommandError for an output that must not be replaced, before anything is detected."""
    from lane_dp_ros.tools.evaluation.json_file import check_json_output
    from lane_dp_ros.tools.report import check_report_output

    if arguments.json is not None:
        check_json_output(arguments.json)
    if arguments.report is not None:
        check_report_output(arguments.report)


def _write(arguments: argparse.Namespace, evaluation: Evaluation, choice: DetectorChoice) -> None:
    from lane_dp_ros.tools.evaluation.json_file import write_json
    from lane_dp_ros.tools.evaluation.text import surface_tables, tables

    print((tables if arguments.surface is None else surface_tables)(evaluation.results))
    for note in evaluation.notes:
        print(f"note: {note}")
    if arguments.json is not None:
        write_json(evaluation.results, evaluation.notes, arguments.json, arguments.input or arguments.surface)
    if arguments.report is not None:
        print(f"report: {_write_report(arguments, evaluation, choice)}")


def _write_report(arguments: argparse.Namespace, evaluation: Evaluation, choice: DetectorChoice) -> Path:
    from lane_dp_ros.tools.report import write_report, write_surface_report

    if arguments.surface is not None:
        return write_surface_report(evaluation.results, arguments.surface, arguments.report)
    config = choice.configs[1] if choice.given else None
    return write_report(evaluation.results, arguments.input, arguments.report, config, choice.topics)
