# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""lane_dp convert: a data set's folder written as a bag."""

from __future__ import annotations

import argparse
from pathlib import Path

from lane_dp_ros.messages.bag import STORAGES, BagWriter
from lane_dp_ros.tools.cli.arguments import add_output
from lane_dp_ros.tools.datasets.kitti import LAYOUTS


def add_command(commands: argparse._SubParsersAction) -> None:
    """Add `convert` to the commands of lane_dp."""
    text = "write a data set's folder as a bag with the topics of the node"
    command = commands.add_parser("convert", help=text, description=text)
    command.add_argument("layout", choices=sorted(LAYOUTS), help="how the folder is laid out")
    command.add_argument("folder", type=Path, metavar="DIR")
    add_output(command)
    command.add_argument("--storage", choices=STORAGES, default="mcap", help="default: mcap")
    command.add_argument("--jpeg", action="store_true", help="JPEG images on .../image_rect/compressed")
    command.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Find the pairs, write the bag."""
    from lane_dp_ros.tools.datasets.convert import convert

    sequence = LAYOUTS[arguments.layout](arguments.folder)
    with BagWriter(arguments.output, arguments.storage, arguments.force) as writer:
        convert(sequence, writer, arguments.jpeg)
    sources = f"{sequence.left[0].parent} and {sequence.right[0].parent}"
    print(f"{arguments.output}: {len(sequence)} pairs from {sources}")
