# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The arguments that several commands take, and the types of their values."""

from __future__ import annotations

import argparse
from dataclasses import fields
from pathlib import Path

from lane_dp_ros.core.presets import PRESETS
from lane_dp_ros.messages.stereo_sync import SIDES
from lane_dp_ros.messages.topic_choice import TopicChoice
from lane_dp_ros.tools.parallel import available_cpus


def add_bag(command: argparse.ArgumentParser) -> None:
    """Add BAG, the bag to read."""
    command.add_argument("bag", type=Path, metavar="BAG", help="bag folder, or a .mcap, .db3 or .bag file")


def add_topics(command: argparse.ArgumentParser) -> None:
    """Add --left, --right, --left-info, --right-info and --camera: the stereo camera's topics in a bag."""
    group = command.add_argument_group(
        "topics", "of the rectified stereo camera in the bag; needed where there are several, or odd names"
    )
    for side in SIDES:
        image = f"images of the {side} camera, raw or compressed"
        group.add_argument(f"--{side}", metavar="TOPIC", help=image)
    for side in SIDES:
        info = f"CameraInfo of the {side} camera; default: camera_info beside its images"
        group.add_argument(f"--{side}-info", metavar="TOPIC", help=info)
    prefix = "what the topics of the camera begin with, such as /zed/zed_node"
    group.add_argument("--camera", metavar="PREFIX", help=prefix)
    command.set_defaults(topics_error=command.error)


def topic_choice(arguments: argparse.Namespace) -> TopicChoice:
    """Return the topics that the arguments name; wrong usage ends the process as argparse does."""
    names = {field.name: getattr(arguments, field.name) for field in fields(TopicChoice)}
    if names["camera"] and (names["left"] or names["right"]):
        arguments.topics_error("expected either --camera or --left and --right")
    return TopicChoice(**names)


def add_output(command: argparse.ArgumentParser) -> None:
    """Add --output and --force, of a command that writes a bag."""
    bag = "the bag to write: a file if it ends in .mcap, or a folder; of sqlite3 always a folder"
    command.add_argument("-o", "--output", type=Path, required=True, metavar="OUT", help=bag)
    command.add_argument("--force", action="store_true", help="replace OUT if it is a bag")


def add_config(command: argparse.ArgumentParser) -> None:
    """Add --config and --preset, what to detect with."""
    config, preset = "ROS parameter file, as from dump-config", "values that FILE does not give"
    command.add_argument("--config", type=Path, metavar="FILE", help=config)
    command.add_argument("--preset", choices=PRESETS, default="default", help=preset)


def add_rate(command: argparse.ArgumentParser) -> None:
    """Add --rate, how fast to play."""
    command.add_argument("--rate", type=positive, default=1.0, help="speed, 2 is twice as fast; default: 1")


def add_jobs(command: argparse.ArgumentParser, default: int | None = None) -> None:
    """Add --jobs, how many processes work."""
    jobs = default or available_cpus()
    text = f"processes that work, default: {default or f'one a CPU, here {jobs}'}"
    command.add_argument("--jobs", type=count, default=jobs, metavar="N", help=text)


def count(text: str) -> int:
    """Return a whole number > 0."""
    if not (text.isdecimal() and int(text) > 0):
        raise argparse.ArgumentTypeError(f"{text} is not a whole number > 0")
    return int(text)


def seed(text: str) -> int:
    """Return a whole number >= 0."""
    if not text.isdecimal():
        raise argparse.ArgumentTypeError(f"{text} is not a whole number >= 0")
    return int(text)


def port(text: str) -> int:
    """Return the number of a TCP port."""
    if not (text.isdecimal() and int(text) < 65536):
        raise argparse.ArgumentTypeError(f"{text} is not a port from 0 to 65535")
    return int(text)


def positive(text: str) -> float:
    """Return a finite number > 0."""
    if not 0 < (value := _number(text)) < float("inf"):
        raise argparse.ArgumentTypeError(f"{text} is not a number > 0")
    return value


def limit(text: str) -> float:
    """Return a finite number >= 0."""
    if not 0 <= (value := _number(text)) < float("inf"):
        raise argparse.ArgumentTypeError(f"{text} is not a number >= 0")
    return value


def _number(text: str) -> float:
    """Return a number, NaN for what is none."""
    try:
        return float(text)
    except ValueError:
        return float("nan")
