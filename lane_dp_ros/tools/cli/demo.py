# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""lane_dp demo: a rendered road, through a running node, to lanes and pictures."""

from __future__ import annotations

import argparse
import os
import shutil
import sys
from pathlib import Path

from lane_dp_ros.tools.cli.arguments import positive
from lane_dp_ros.tools.cli.ros_module import ros_module


def add_command(commands: argparse._SubParsersAction) -> None:
    """Add `demo` to the commands of lane_dp."""
    text = "render a road, play it into a running lane_detector, write what it finds"
    command = commands.add_parser("demo", help=text, description=text)
    command.add_argument(
        "-o", "--output", type=Path, default=Path("demo"), metavar="DIR", help="where to write, default: demo"
    )
    rate = "speed, 2 is twice as fast as driven; default: what this machine keeps up with, at most 1"
    command.add_argument("--rate", type=positive, help=rate)
    command.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Run the demonstration."""
    from lane_dp_ros.tools.demo import run_demo

    run_demo(arguments.output, ros_module("demo_session"), arguments.rate, _command())


def _command() -> str:
    """Return how lane_dp was called, so that it can be typed again."""
    called = Path(sys.argv[0])
    if called.name != "lane_dp":
        return f"{sys.executable} -m lane_dp_ros.tools.cli"
    found = shutil.which("lane_dp")
    if found and Path(found).resolve() == called.resolve():
        return "lane_dp"
    return os.path.relpath(called) if called.resolve().is_relative_to(Path.cwd()) else str(called)
