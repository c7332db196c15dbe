# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Find the left images and the lanes of a drive in its bags, and join them by their stamps."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from lane_dp_ros.core.types import Lane
from lane_dp_ros.messages.bag import BagReader
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.messages.lanes import lanes_from_ros
from lane_dp_ros.messages.stamp import stamp_from_ros
from lane_dp_ros.messages.stereo_sync import Side
from lane_dp_ros.messages.stereo_topics import StereoTopics, find_stereo_topics, no_messages
from lane_dp_ros.messages.topic_choice import TopicChoice
from lane_dp_ros.review.drive import Drive, Frame
from lane_dp_ros.tools.progress import progress

MARKERS = "visualization_msgs/msg/MarkerArray"


def find_left_topics(reader: BagReader) -> StereoTopics:
    """Return where the left images are; the right ones may have no messages.

    Raises CommandError, listing what is there, when there are no left images or those of several cameras.
    """
    try:
        return find_stereo_topics(reader)
    except CommandError:
        if reader.choice.right:
            raise
        return find_stereo_topics(reader, ("left",))


def find_lanes(reader: BagReader) -> str | None:
    """Return the topic of the lanes, None where there are none."""
    topic = _only(reader, "/lanes", MARKERS)
    return topic if topic and reader.message_count([topic]) else None


def read_drive(bag: Path, lanes_bag: Path, topics: TopicChoice | None = None) -> Drive:
    """Return the frames of `bag` with the lanes of `lanes_bag`, joined by their stamps.

    `topics` are those of the stereo camera in `bag`. Raises CommandError when no left image has lanes.
    """
    with BagReader(lanes_bag) as reader:
        if (topic := find_lanes(reader)) is None:
            raise no_messages(reader, "lanes (visualization_msgs/msg/MarkerArray)")
        lanes = dict(_read_lanes(reader, topic))
    with BagReader(bag, topics) as reader:
        found = find_left_topics(reader)
        images = {stamp: (time_ns, infos) for stamp, time_ns, infos in _read_images(reader, found)}
    if not (common := sorted(images.keys() & lanes.keys())):
        raise CommandError(
            f"the lanes of {lanes_bag} are of {_span(lanes)}, the left images of {bag} of {_span(images)}: "
            "no stamp in common"
        )
    frames = tuple(Frame(i, stamp, *images[stamp], lanes[stamp]) for i, stamp in enumerate(common))
    _ = [frame.camera for frame in frames]  # what is wrong with a calibration is said before the first page
    return Drive(bag, found, frames, len(images) - len(frames))


def _read_lanes(reader: BagReader, topic: str) -> Iterator[tuple[int, tuple[Lane, ...]]]:
    for _, _, array in reader.messages([topic]):
        if array.markers:  # without any there is no stamp
            stamp = stamp_from_ros(array.markers[0].header.stamp)
            points = [(p.x, p.y, p.z) for marker in array.markers for p in marker.points]
            if not np.all(np.isfinite(points)):
                raise CommandError(f"{reader.path}: the lanes of stamp {stamp} ns hold NaN or infinity")
            yield stamp, lanes_from_ros(array)


def _read_images(reader: BagReader, topics: StereoTopics) -> Iterator[tuple[int, int, dict[Side, Any]]]:
    """Yield stamp, time and camera infos (the last before, or else the first) of every left image."""
    sides = {topic: side for side, topic in topics.infos.items()}
    there = [topic for topic in sides if reader.message_count([topic])]
    infos = {sides[topic]: next(reader.messages([topic]))[2] for topic in there}
    wanted = [topics.images["left"], *sides]
    for topic, time_ns, message in progress(reader.messages(wanted), reader.message_count(wanted), "msg"):
        if topic in sides:
            infos = {**infos, sides[topic]: message}
        else:
            yield stamp_from_ros(message.header.stamp), time_ns, infos


def _only(reader: BagReader, ending: str, kind: str) -> str | None:
    found = sorted(t for t, type_name in reader.topics.items() if t.endswith(ending) and type_name == kind)
    if len(found) > 1:
        raise CommandError(f"{reader.path} has several topics {ending}: {', '.join(found)}, expected one")
    return found[0] if found else None


def _span(by_stamp: dict[int, Any]) -> str:
    stamps = sorted(by_stamp)
    return f"{stamps[0] / 1e9:.3f} to {stamps[-1] / 1e9:.3f} s" if stamps else "no time at all"
