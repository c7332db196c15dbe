# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""lane_dp dump-config: every parameter, as a ROS parameter file."""

from __future__ import annotations

import argparse

from lane_dp_ros.core.config import PRESETS


def add_command(commands: argparse._SubParsersAction) -> None:
    """Add `dump-config` to the commands of lane_dp."""
    text = "print every parameter with unit, range and default as a ROS parameter file"
    command = commands.add_parser("dump-config", help=text, description=text)
    command.add_argument("--preset", choices=PRESETS, default="default")
    command.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Print."""
    print(dumped_config(arguments.preset), end="")


def dumped_config(preset: str) -> str:
    """Return what `lane_dp dump-config --preset PRESET` prints."""
    from lane_dp_ros.messages.node_config import all_parameters
    from lane_dp_ros.tools.parameter_file import parameter_file

    title = f"Every parameter of lane_detector, preset {preset}: lane_dp dump-config --preset {preset}"
    return parameter_file(all_parameters(preset), all_parameters("default"), title)
