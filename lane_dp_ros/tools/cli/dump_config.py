# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""lane_dp dump-config: every parameter, as a ROS parameter file."""

from __future__ import annotations

import argparse

from lane_dp_ros.core.presets import PRESETS


def add_command(commands: argparse._SubParsersAction) -> None:
    """Add `dump-config` to the commands of lane_dp."""
    text = "print every parameter with unit, range and default as a ROS parameter file"
    command = commands.add_parser("dump-config", help=text, description=text)
    command.add_argument("--preset", choices=PRESETS, default="default")
    expert = "with those for experts, which are not meant to be tuned by hand"
    command.add_argument("--expert", action="store_true", help=expert)
    command.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Print."""
    print(dumped_config(arguments.preset, arguments.expert), end="")


def dumped_config(preset: str, expert: bool = False) -> str:
    """Return what `lane_dp dump-config --preset PRESET` prints, with --expert or without."""
    from lane_dp_ros.messages.node_config import all_parameters
    from lane_dp_ros.tools.parameter_file import parameter_file

    option = " --expert" if expert else ""
    title = (
        f"Every parameter of lane_detector, preset {preset}: lane_dp dump-config --preset {preset}{option}"
    )
    return parameter_file(all_parameters(preset, expert), all_parameters("default", expert), title)
