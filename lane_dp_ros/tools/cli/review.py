# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""lane_dp review: the page served on which lanes are judged by hand, the table printed at the end."""

from __future__ import annotations

import argparse
import webbrowser
from pathlib import Path
from typing import TYPE_CHECKING

from lane_dp_ros.tools.cli.arguments import add_config, add_jobs, add_topics, port, topic_choice

if TYPE_CHECKING:
    from lane_dp_ros.review.review import Review
    from lane_dp_ros.review.server import ReviewServer

PORT = 8642
EXPLANATION = """\
The lanes are those of --lanes OUT (what `lane_dp run BAG -o OUT` wrote), else those recorded in BAG; when it
has none they are detected first and kept in the bag BAG.lanes. Every key is saved at once to BAG.review.json;
the command, started again, goes on where it was left. Ctrl-C ends it and prints the table. An exported line
lies on the road surface that the detector finds in its frame's pair; without right images, on the one through
the lanes."""


def add_command(commands: argparse._SubParsersAction) -> None:
    """Add `review` to the commands of lane_dp."""
    text = "judge the two closest lanes of every frame by hand, on a local web page"
    command = commands.add_parser("review", help=text, description=text, epilog=EXPLANATION)
    command.add_argument("bag", type=Path, metavar="BAG", help="bag with the left images")
    command.add_argument("--lanes", type=Path, metavar="OUT", help="bag with the lanes, if not BAG")
    command.add_argument(
        "--review", type=Path, metavar="FILE", help="default: BAG.review.json beside the bag"
    )
    of_host = f"of 127.0.0.1, 0: any that is free; default: {PORT}"
    command.add_argument("--port", type=port, default=PORT, help=of_host)
    command.add_argument("--open", action="store_true", help="open the page in the browser")
    add_config(command)
    add_jobs(command)
    add_topics(command)
    command.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Find or detect the lanes, and serve the page."""
    from lane_dp_ros.review.lanes_bag import beside, check_images, lanes_bag
    from lane_dp_ros.review.lines_as_truth import Grounds
    from lane_dp_ros.review.read_drive import read_drive
    from lane_dp_ros.review.review import Review
    from lane_dp_ros.review.review_file import ReviewFile, locked
    from lane_dp_ros.review.server import ReviewServer
    from lane_dp_ros.tools.detection_config import load_config

    node, detector = load_config(arguments.preset, arguments.config)
    bag, topics = arguments.bag, topic_choice(arguments)
    check_images(bag, topics)
    path = arguments.review or beside(bag, "review.json")
    with locked(path), ReviewServer(arguments.port) as server:
        file = ReviewFile(path)  # before the lanes, which may take minutes: it may be damaged
        lanes = arguments.lanes or lanes_bag(bag, node, detector, arguments.jobs, topics)
        drive = read_drive(bag, lanes, topics)
        file.use_for(drive.fingerprint)
        review = Review(drive, file, Grounds(drive, node, detector))
        _say_what_is_there(review, lanes)
        _serve(server, review, arguments.open)


def _say_what_is_there(review: Review, lanes: Path) -> None:
    from lane_dp_ros.review.judgement import Judgement

    drive, file = review.drive, review.file
    judged = sum(file.judgement(frame.stamp_ns) != Judgement() for frame in drive.frames)
    left_out = f", {drive.left_out} images without lanes left out" if drive.left_out else ""
    print(f"{drive.bag}: {len(drive.frames)} frames{left_out}; lanes of {lanes}")
    print(f"{file.path}: {judged} frames judged")


def _serve(server: ReviewServer, review: Review, open_browser: bool) -> None:
    print(f"review at {server.url} (Ctrl-C ends it)", flush=True)
    if open_browser:
        webbrowser.open(server.url)
    try:
        server.serve(review)
    except KeyboardInterrupt:
        pass  # the way to end it
    finally:
        print(f"\n{review.table.text(review.drive.name)}", flush=True)
