# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""lane_dp play: a bag replayed on its topics."""

from __future__ import annotations

import argparse

from lane_dp_ros.messages.bag import BagReader
from lane_dp_ros.tools.cli.arguments import add_bag, add_rate, add_topics, topic_choice
from lane_dp_ros.tools.cli.ros_module import ros_module


def add_command(commands: argparse._SubParsersAction) -> None:
    """Add `play` to the commands of lane_dp."""
    text = "replay a rosbag2 on its topics in real time"
    epilog = (
        "Topics that are named are published as those of the node: left/image_rect and so on. "
        "--ros-args ... is passed on to ROS"
    )
    command = commands.add_parser("play", help=text, description=text, epilog=epilog)
    add_bag(command)
    add_rate(command)
    command.add_argument("--loop", action="store_true", help="start again at the end, until Ctrl-C")
    command.add_argument("--clock", action="store_true", help="publish the bag's time on /clock")
    add_topics(command)
    command.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Replay the bag."""
    with BagReader(arguments.bag, topic_choice(arguments)) as reader:
        play = ros_module("bag_player").play
        count = play(reader, arguments.rate, arguments.loop, arguments.ros_args, arguments.clock)
    print(f"{arguments.bag}: {count} messages played")
