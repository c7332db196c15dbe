# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The command `lane_dp review`: lanes found or detected, the page served, the table printed at the end."""

from __future__ import annotations

import argparse
import webbrowser
from pathlib import Path

from lane_dp_ros.core.config import PRESETS, DetectorConfig
from lane_dp_ros.core.pipeline import FrameResult
from lane_dp_ros.messages.bag import BagReader, BagWriter
from lane_dp_ros.messages.bag_message import bag_message
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.messages.lanes import lanes_to_ros
from lane_dp_ros.messages.node_config import NodeConfig
from lane_dp_ros.messages.stereo_bag import CAPACITY, find_stereo_topics, read_stereo_pairs
from lane_dp_ros.messages.stereo_sync import StereoSync
from lane_dp_ros.review.judgement import Judgement
from lane_dp_ros.review.lines_as_truth import Grounds
from lane_dp_ros.review.read_drive import find_lanes, find_topics, read_drive
from lane_dp_ros.review.review import Review
from lane_dp_ros.review.review_file import ReviewFile, locked
from lane_dp_ros.review.server import ReviewServer
from lane_dp_ros.tools.offline import answered, load_config
from lane_dp_ros.tools.progress import progress

PORT = 8642
EXPLANATION = """\
The lanes are those of --lanes OUT (what `lane_dp run BAG -o OUT` wrote), else those recorded in BAG; when it
has none they are detected first and kept in the bag BAG.lanes. Every key is saved at once to BAG.review.json;
the command, started again, goes on where it was left. Ctrl-C ends it and prints the table. An exported line
lies on the road surface that the detector finds in its frame's pair; without right images, on the one through
the lanes."""


def add_command(commands: argparse._SubParsersAction) -> argparse.ArgumentParser:
    """Add `review` to the commands."""
    text = "judge the two closest lanes of every frame by hand, on a local web page"
    command = commands.add_parser("review", help=text, description=text, epilog=EXPLANATION)
    command.add_argument("bag", type=Path, metavar="BAG", help="bag with the left images")
    command.add_argument("--lanes", type=Path, metavar="OUT", help="bag with the lanes, if not BAG")
    command.add_argument(
        "--review", type=Path, metavar="FILE", help="default: BAG.review.json beside the bag"
    )
    port = f"of 127.0.0.1, 0: any that is free; default: {PORT}"
    command.add_argument("--port", type=_port, default=PORT, help=port)
    command.add_argument("--open", action="store_true", help="open the page in the browser")
    config, preset = "ROS parameter file, as from dump-config", "values that FILE does not give"
    command.add_argument("--config", type=Path, metavar="FILE", help=config)
    command.add_argument("--preset", choices=PRESETS, default="default", help=preset)
    command.set_defaults(command=_review)
    return command


def _port(text: str) -> int:
    if not (text.isdecimal() and int(text) < 65536):
        raise argparse.ArgumentTypeError(f"{text} is not a port from 0 to 65535")
    return int(text)


def _review(arguments: argparse.Namespace) -> None:
    node, detector = load_config(arguments.preset, arguments.config)
    _check_images(bag := arguments.bag)
    path = arguments.review or _beside(bag, "review.json")
    with locked(path), ReviewServer(arguments.port) as server:
        file = ReviewFile(path)  # before the lanes, which may take minutes: it may be damaged
        lanes = arguments.lanes or _lanes_of(bag, node, detector, arguments.jobs)
        drive = read_drive(bag, lanes)
        file.use_for(drive.fingerprint)
        review = Review(drive, file, Grounds(drive, node, detector))
        _say_what_is_there(review, lanes)
        _serve(server, review, arguments.open)


def _check_images(bag: Path) -> None:
    with BagReader(bag) as reader:
        if not reader.message_count():
            raise CommandError(f"{bag} is an empty bag: left images were expected")
        try:
            find_topics(reader)
        except CommandError:
            if find_lanes(reader) is None:
                raise
            hint = "name the bag with the images, and this one as --lanes"
            raise CommandError(f"{bag} has lanes but no left images and their camera_info: {hint}") from None


def _lanes_of(bag: Path, node: NodeConfig, detector: DetectorConfig, jobs: int) -> Path:
    """Return the bag that has the lanes: this one, or the one beside it, written now if need be."""
    with BagReader(bag) as reader:
        if find_lanes(reader) is not None:
            return bag
        beside = _beside(bag, "lanes")
        if not beside.exists():
            with BagWriter(beside) as writer:
                detect_lanes(reader, writer, node, detector, jobs)
    return beside


def detect_lanes(
    reader: BagReader, writer: BagWriter, node: NodeConfig, detector: DetectorConfig, jobs: int
) -> None:
    """Write the `lanes` of every pair of a bag, with a progress bar.

    Raises CommandError when there are no pairs, or none that can be used.
    """
    topics = find_stereo_topics(reader)
    pairs = read_stereo_pairs(reader, topics, StereoSync(round(node.sync_tolerance * 1e9), CAPACITY))
    problem, written = f"no left and right stamps within {node.sync_tolerance:g} s", 0
    with answered(pairs, detector, jobs) as answers:
        total = reader.message_count([topics.images["left"]])
        for bag_pair, answer in progress(answers, total, "pair"):
            if not isinstance(answer, FrameResult) or answer.detection is None:
                problem = answer.problem if isinstance(answer, FrameResult) else answer
                continue
            lanes = lanes_to_ros(answer.lanes, bag_pair.pair.left.header, bag_message, node.lane_lifetime)
            writer.write(f"{topics.namespace}/lanes", bag_pair.time_ns, lanes)
            written += 1
    if not written:
        raise CommandError(f"{reader.path} has no stereo pair that can be used: {problem}")


def _beside(bag: Path, ending: str) -> Path:
    bag = bag.resolve()  # one file for one bag, by whatever path it is named
    return bag.with_name(f"{bag.name}.{ending}")


def _say_what_is_there(review: Review, lanes: Path) -> None:
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
