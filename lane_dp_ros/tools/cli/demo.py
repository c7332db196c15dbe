# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""lane_dp demo: a rendered road, through a running node, to lanes and pictures."""

from __future__ import annotations

import argparse
from pathlib import Path

from lane_dp_ros.tools.cli.arguments import add_rate
from lane_dp_ros.tools.cli.ros_module import ros_module


def add_command(commands: argparse._SubParsersAction) -> None:
    """Add `demo` to the commands of lane_dp."""
    text = "render a road, play it into a running lane_detector, write what it finds"
    command = commands.add_parser("demo", help=text, description=text)
    command.add_argument(
        "-o", "--output", type=Path, default=Path("demo"), metavar="DIR", help="where to write, default: demo"
    )
    add_rate(command)
    command.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Run the demonstration."""
    from lane_dp_ros.tools.demo import run_demo

    run_demo(arguments.output, ros_module("demo_session"), arguments.rate)
