# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""lane_dp run: lanes detected in every stereo pair of a bag, offline."""

from __future__ import annotations

import argparse

from lane_dp_ros.messages.bag import BagReader, BagWriter
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.tools.cli.arguments import (
    add_bag,
    add_config,
    add_jobs,
    add_output,
    add_topics,
    topic_choice,
)


def add_command(commands: argparse._SubParsersAction) -> None:
    """Add `run` to the commands of lane_dp."""
    text = "detect lanes in every stereo pair of a bag, without ROS, as fast as it goes"
    command = commands.add_parser("run", help=text, description=text)
    add_bag(command)
    add_output(command)
    add_config(command)
    add_jobs(command, default=1)
    add_topics(command)
    command.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Detect, write the bag, print a summary."""
    from lane_dp_ros.tools.offline import detect_bag, load_config

    config = load_config(arguments.preset, arguments.config)
    with BagReader(arguments.bag, topic_choice(arguments)) as reader:
        bag = arguments.bag.resolve()
        if arguments.output.resolve() in (bag, *bag.parents):  # a bag may be given by the file in its folder
            raise CommandError(f"{arguments.output} is the input bag itself: choose another output")
        with BagWriter(arguments.output, force=arguments.force) as writer:
            summary = detect_bag(reader, writer, *config, arguments.jobs)
    print(f"{arguments.output}: {summary}")
