# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""lane_dp review: the page served on which lanes are judged by hand, the table printed at the end."""

from __future__ import annotations

import argparse
import webbrowser
from pathlib import Path
from typing import TYPE_CHECKING

from lane_dp_ros.messages.errors import CommandError, one_line, reason
from lane_dp_ros.tools.cli.arguments import add_config, add_jobs, add_topics, port, topic_choice

if TYPE_CHECKING:
    from lane_dp_ros.review.review import Review
    from lane_dp_ros.review.server import ReviewServer

PORT = 8642
FILES = {".json": "coco", ".xml": "cvat", ".zip": "cvat"}  # the format of a file of lines by its ending
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
    files = "of lines, COCO's .json or CVAT's .xml (for images 1.1)"
    command.add_argument(
        "--import", type=Path, metavar="FILE", dest="imported", help=f"take in a file {files}"
    )
    command.add_argument("--export", type=Path, metavar="FILE", help=f"write a file {files}")
    of_host = f"of 127.0.0.1, 0: any that is free; default: {PORT}"
    command.add_argument("--port", type=port, default=PORT, help=of_host)
    command.add_argument("--open", action="store_true", help="open the page in the browser")
    add_config(command)
    add_jobs(command)
    add_topics(command)
    command.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Find or detect the lanes; take files of lines in and write them, or serve the page."""
    from lane_dp_ros.review.annotation_zip import read_annotations
    from lane_dp_ros.review.lanes_bag import beside, check_images
    from lane_dp_ros.review.review_file import locked
    from lane_dp_ros.review.server import ReviewServer

    check_images(bag := arguments.bag, topic_choice(arguments))
    text = None if arguments.imported is None else read_annotations(arguments.imported)
    if arguments.export is not None:
        _check_new(arguments.export)
    path = arguments.review or beside(bag, "review.json")
    if text is None and arguments.export is None:
        with locked(path), ReviewServer(arguments.port) as server:
            _serve(server, _review(arguments, path), arguments.open)
        return
    with locked(path):
        review = _review(arguments, path)
        if text is not None:
            _import(review, arguments.imported, text)
        if arguments.export is not None:
            _export(review, arguments.export)


def _review(arguments: argparse.Namespace, path: Path) -> Review:
    """Return the review of a bag whose judgements are in the file at `path`, and say what is there."""
    from lane_dp_ros.review.lanes_bag import lanes_bag
    from lane_dp_ros.review.lines_as_truth import Grounds
    from lane_dp_ros.review.read_drive import read_drive
    from lane_dp_ros.review.review import Review
    from lane_dp_ros.review.review_file import ReviewFile
    from lane_dp_ros.tools.detection_config import load_config

    node, detector = load_config(arguments.preset, arguments.config)
    topics = topic_choice(arguments)
    file = ReviewFile(path)  # before the lanes, which may take minutes: it may be damaged
    lanes = arguments.lanes or lanes_bag(arguments.bag, node, detector, arguments.jobs, topics)
    drive = read_drive(arguments.bag, lanes, topics)
    file.use_for(drive.fingerprint)
    review = Review(drive, file, Grounds(drive, node, detector))
    _say_what_is_there(review, lanes)
    return review


def _check_new(path: Path) -> None:
    """Raise CommandError where a file of lines cannot be written there."""
    if path.suffix not in FILES:
        raise CommandError(f"cannot write {path}: expected a name that ends in {', '.join(FILES)}")
    if path.exists():
        raise CommandError(f"{path} exists already: choose another name")


def _import(review: Review, path: Path, text: str) -> None:
    try:
        answer = review.import_lines(text)
    except ValueError as error:
        raise CommandError(f"{path}: {one_line(error)}") from None
    left_out = f", {answer['left_out']} shapes that are no polylines left out" if answer["left_out"] else ""
    print(f"{path}: {answer['images']} images, lines of {answer['changed']} frames changed{left_out}")


def _export(review: Review, path: Path) -> None:
    from lane_dp_ros.review.annotation_zip import write_cvat_zip
    from lane_dp_ros.tools.progress import progress

    answer = review.export_lines(FILES[path.suffix])
    try:
        if path.suffix == ".zip":
            write_cvat_zip(path, answer["text"], progress(review.pictures(), answer["frames"], "picture"))
        else:
            path.write_text(answer["text"], encoding="utf-8")
    except OSError as error:
        raise CommandError(f"cannot write {path}: {reason(error)}") from None
    print(f"{path}: lines of {answer['frames']} frames")


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
