# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""lane_dp scenes: roads rendered whose lane lines are known exactly."""

from __future__ import annotations

import argparse
from pathlib import Path

from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.scenes.drive_options import BAG, FRAMES, RATE, SUITES, TRUTH
from lane_dp_ros.tools.cli.arguments import add_jobs, count, positive, seed


def add_command(commands: argparse._SubParsersAction) -> None:
    """Add `scenes` to the commands of lane_dp."""
    text = "render roads whose lane lines are known exactly: a bag and its truth, or a sheet of pictures"
    command = commands.add_parser("scenes", help=text, description=text)
    command.add_argument(
        "categories", nargs="*", metavar="CATEGORY", help="kinds of scenes; default for --sheet: all"
    )
    command.add_argument("--suite", choices=SUITES, help="a fixed set: standard is every category")
    what = command.add_mutually_exclusive_group(required=True)
    what.add_argument("--list", action="store_true", help="print the categories")
    what.add_argument("--sheet", type=Path, metavar="FILE.png", help="write thumbnails, for a look at them")
    what.add_argument("-o", "--output", type=Path, metavar="DIR", help=f"write DIR/{BAG} and DIR/{TRUTH}")
    command.add_argument("--frames", type=count, default=FRAMES, metavar="N", help=f"default: {FRAMES}")
    command.add_argument(
        "--rate", type=positive, default=RATE, metavar="R", help=f"of them, Hz; default: {RATE:g}"
    )
    command.add_argument("--seed", type=seed, default=0, metavar="N", help="of everything; default: 0")
    command.add_argument("--force", action="store_true", help="replace what an earlier run has written")
    add_jobs(command)
    command.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Render, or list the categories."""
    from lane_dp_ros.scenes.categories import CATEGORIES
    from lane_dp_ros.scenes.suite import drives, write_drives, write_sheet

    if arguments.list:
        print(*CATEGORIES, sep="\n")
        return
    if arguments.suite and arguments.categories:
        raise CommandError(f"--suite {arguments.suite} brings its own categories: name either it or some")
    if arguments.output and not (arguments.suite or arguments.categories):
        raise CommandError("nothing to render: name categories (--list prints them) or --suite standard")
    categories = arguments.categories or tuple(CATEGORIES)
    chosen = drives(categories, arguments.frames, arguments.rate, arguments.seed)
    if arguments.sheet:
        write_sheet(arguments.sheet, chosen, arguments.force, arguments.jobs)
        print(f"{arguments.sheet}: {len(chosen)} categories")
        return
    truth = write_drives(arguments.output, chosen, arguments.force, arguments.jobs)
    painted = [label.painted for frame in truth for label in frame.labels]
    lines, edges = sum(painted), len(painted) - sum(painted)
    pairs = f"{len(truth)} pairs of {len(chosen)} categories"
    print(f"{arguments.output}: {pairs}, {lines} lane lines, {edges} road edges")
