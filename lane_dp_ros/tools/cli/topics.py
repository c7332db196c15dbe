# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""lane_dp topics: what a bag has, and which topics are taken for the stereo camera's."""

from __future__ import annotations

import argparse

from lane_dp_ros.messages.bag import BagReader
from lane_dp_ros.messages.stereo_sync import SIDES
from lane_dp_ros.messages.stereo_topics import find_stereo_topics
from lane_dp_ros.tools.cli.arguments import add_bag, add_topics, topic_choice


def add_command(commands: argparse._SubParsersAction) -> None:
    """Add `topics` to the commands of lane_dp."""
    text = "list the topics of a bag, and those taken for the stereo camera's"
    command = commands.add_parser("topics", help=text, description=text)
    add_bag(command)
    add_topics(command)
    command.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Print both; raise CommandError where there is no one stereo camera."""
    with BagReader(arguments.bag, topic_choice(arguments)) as reader:
        width = max(map(len, reader.topics), default=0)
        for topic, kind in sorted(reader.topics.items()):
            print(f"{topic:{width}}  {reader.message_count([topic]):7}  {kind}")
        found = find_stereo_topics(reader)
        for side in SIDES:
            print(f"{side}: {found.images[side]} with {found.infos[side]}")
