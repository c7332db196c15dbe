# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The bag whose lanes are reviewed: found, or detected and written beside the images."""

from __future__ import annotations

from pathlib import Path

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.pipeline import FrameResult
from lane_dp_ros.messages.bag import BagReader, BagWriter
from lane_dp_ros.messages.bag_message import bag_message
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.messages.lanes import lanes_to_ros
from lane_dp_ros.messages.node_config import NodeConfig
from lane_dp_ros.messages.stereo_bag import find_stereo_topics, read_stereo_pairs, sync_of_bag
from lane_dp_ros.messages.topic_choice import TopicChoice
from lane_dp_ros.review.read_drive import find_lanes, find_left_topics
from lane_dp_ros.tools.offline.answered import answered
from lane_dp_ros.tools.progress import progress


def check_images(bag: Path, topics: TopicChoice | None = None) -> None:
    """Raise CommandError for a bag without left images, saying what would be right."""
    with BagReader(bag, topics) as reader:
        if not reader.message_count():
            raise CommandError(f"{bag} is an empty bag: left images were expected")
        try:
            find_left_topics(reader)
        except CommandError:
            if find_lanes(reader) is None:
                raise
            hint = "name the bag with the images, and this one as --lanes"
            raise CommandError(f"{bag} has lanes but no left images and their camera_info: {hint}") from None


def lanes_bag(
    bag: Path, node: NodeConfig, detector: DetectorConfig, jobs: int, topics: TopicChoice | None = None
) -> Path:
    """Return the bag that has the lanes: this one, or the one beside it, written now if need be."""
    with BagReader(bag, topics) as reader:
        if find_lanes(reader) is not None:
            return bag
        path = beside(bag, "lanes")
        if not path.exists():
            with BagWriter(path) as writer:
                detect_lanes(reader, writer, node, detector, jobs)
    return path


def detect_lanes(
    reader: BagReader, writer: BagWriter, node: NodeConfig, detector: DetectorConfig, jobs: int
) -> None:
    """Write the `lanes` of every pair of a bag, with a progress bar.

    Raises CommandError when there are no pairs, or none that can be used.
    """
    topics = find_stereo_topics(reader)
    pairs = read_stereo_pairs(reader, topics, sync_of_bag(node.sync_tolerance))
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


def beside(bag: Path, ending: str) -> Path:
    """Return the path of what belongs to a bag: BAG.ENDING."""
    bag = bag.resolve()  # one file for one bag, by whatever path it is named
    return bag.with_name(f"{bag.name}.{ending}")
