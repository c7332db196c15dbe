# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""lane_dp run: lanes detected in every stereo pair of bags, offline."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.tools.cli.arguments import add_config, add_jobs, add_topics, topic_choice

if TYPE_CHECKING:
    from lane_dp_ros.tools.offline.run_bags import Outputs


def add_command(commands: argparse._SubParsersAction) -> None:
    """Add `run` to the commands of lane_dp."""
    text = "detect lanes in every stereo pair of bags, without ROS, as fast as it goes"
    command = commands.add_parser("run", help=text, description=text)
    bags = "bag folders, .mcap, .db3 or .bag files; of several all outputs are folders with a file for each"
    command.add_argument("bags", type=Path, nargs="+", metavar="BAG", help=bags)
    _add_outputs(command)
    add_config(command)
    add_jobs(command, default=1)
    add_topics(command)
    command.set_defaults(run=run, usage_error=command.error)


def _add_outputs(command: argparse.ArgumentParser) -> None:
    bag = "bag to write: lanes, road edges, camera infos, pictures; a file if it ends in .mcap, or a folder"
    command.add_argument("-o", "--output", type=Path, metavar="OUT", help=bag)
    video = "an .mp4 of the left image with the lanes"
    command.add_argument("--video", type=Path, metavar="FILE", help=video)
    csv = "a table with a row for each line, for spreadsheets"
    command.add_argument("--csv", type=Path, metavar="FILE", help=csv)
    parquet = "the same with all points, for pandas, polars or duckdb; needs pyarrow"
    command.add_argument("--parquet", type=Path, metavar="FILE", help=parquet)
    rerun = "a recording for Rerun's viewer; needs rerun-sdk"
    command.add_argument("--rerun", type=Path, metavar="FILE", help=rerun)
    pictures = command.add_mutually_exclusive_group()
    jpeg = "pictures in OUT as JPEG, on overlay/image/compressed and ipm/image/compressed: the default"
    pictures.add_argument(
        "--jpeg", dest="pictures", action="store_const", const="jpeg", default="jpeg", help=jpeg
    )
    raw = "pictures in OUT as they are, on overlay/image and ipm/image: ten times as large"
    pictures.add_argument("--raw-images", dest="pictures", action="store_const", const="raw", help=raw)
    none = "no pictures in OUT"
    pictures.add_argument("--no-images", dest="pictures", action="store_const", const="none", help=none)
    left = "the left image in OUT, too, so that a viewer draws the lanes over it"
    command.add_argument("--left-image", action="store_true", help=left)
    existing = command.add_mutually_exclusive_group()
    existing.add_argument("--force", action="store_true", help="replace outputs that are there")
    skip = "of several bags leave out those whose outputs are there"
    existing.add_argument("--skip-existing", action="store_true", help=skip)


def run(arguments: argparse.Namespace) -> None:
    """Detect, write what is wanted, print a summary.

    Raises CommandError when a bag cannot be used; of several, once all others are done.
    """
    from lane_dp_ros.tools.detection_config import load_config
    from lane_dp_ros.tools.offline.run_bags import Outputs, run_bag

    outputs = Outputs(
        arguments.output,
        arguments.video,
        arguments.csv,
        arguments.parquet,
        arguments.rerun,
        arguments.pictures,
        arguments.left_image,
        arguments.force,
    )
    if not outputs.paths:
        arguments.usage_error("nothing to write: name an output: -o OUT, --video, --csv, --parquet, --rerun")
    config = load_config(arguments.preset, arguments.config)
    if len(arguments.bags) > 1 or arguments.skip_existing:
        _run_many(arguments, outputs, config)
        return
    summary = run_bag(arguments.bags[0], outputs, config, arguments.jobs, topic_choice(arguments))
    print(f"{', '.join(map(str, outputs.paths))}: {summary}")


def _run_many(arguments: argparse.Namespace, outputs: Outputs, config: Any) -> None:
    from lane_dp_ros.tools.offline.run_bags import run_bags

    bags, failures, skipped = list(dict.fromkeys(arguments.bags)), [], 0
    topics = topic_choice(arguments)
    for ran in run_bags(bags, outputs, config, arguments.jobs, arguments.skip_existing, topics):
        if ran.failure:
            failures.append(ran.failure)
        skipped += ran.summary is None and not ran.failure
        said = ran.failure.removeprefix(f"{ran.bag}: ") or ran.summary or "skipped, its outputs are there"
        print(f"{ran.bag}: {said}", flush=True)
    done = len(bags) - len(failures) - skipped
    print(f"{len(bags)} bags: {done} done, {skipped} skipped, {len(failures)} failed")
    if failures:
        raise CommandError(f"{len(failures)} of {len(bags)} bags failed: {'; '.join(failures)}")
