# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The stereo pairs of a bag, with their camera infos."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

from lane_dp_ros.messages.bag import BagReader
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.messages.stereo_sync import SIDES, Side, StereoPair, StereoSync

IMAGES = {"image_rect": "sensor_msgs/msg/Image", "image_rect/compressed": "sensor_msgs/msg/CompressedImage"}
CAPACITY = 50  # images that wait for a partner: one side may be recorded a few seconds after the other


class BagPair(NamedTuple):
    """A pair of image messages, its camera infos (left, right), and when it was recorded."""

    pair: StereoPair
    infos: tuple[Any, Any]
    time_ns: int


@dataclass(frozen=True)
class StereoTopics:
    """The topics of a stereo camera in a bag, by side; `namespace` is what stands before left/..."""

    namespace: str
    images: dict[Side, str]
    infos: dict[Side, str]


def find_stereo_topics(reader: BagReader) -> StereoTopics:
    """Return the stereo topics, in whatever namespace; raw images where there are both raw and compressed.

    Raises CommandError, listing the topics that are there, when there are none or those of several cameras.
    """
    for name, type_name in IMAGES.items():
        ending = f"/left/{name}"
        found = [t for t, kind in reader.topics.items() if t.endswith(ending) and kind == type_name]
        if len(found) > 1:
            cameras = ", ".join(sorted(found))
            raise CommandError(f"{reader.path} has several stereo cameras: {cameras}, expected one")
        if found:
            return _topics_in(reader, found[0].removesuffix(ending), name)
    raise _missing(reader, "left/image_rect or left/image_rect/compressed")


def _topics_in(reader: BagReader, namespace: str, image: str) -> StereoTopics:
    images: dict[Side, str] = {side: f"{namespace}/{side}/{image}" for side in SIDES}
    infos: dict[Side, str] = {side: f"{namespace}/{side}/camera_info" for side in SIDES}
    for topic in (*images.values(), *infos.values()):
        if not reader.message_count([topic]):
            raise _missing(reader, topic)
    return StereoTopics(namespace, images, infos)


def _missing(reader: BagReader, wanted: str) -> CommandError:
    there = ", ".join(f"{t} ({reader.message_count([t])})" for t in sorted(reader.topics)) or "no topics"
    return CommandError(f"{reader.path} has no messages on {wanted}; it has {there}")


def read_stereo_pairs(reader: BagReader, topics: StereoTopics, sync: StereoSync) -> Iterator[BagPair]:
    """Yield every pair that `sync` makes, with the last camera infos before it, or else the first ones."""
    infos = {side: next(reader.messages([topic]))[2] for side, topic in topics.infos.items()}
    info_sides = {topic: side for side, topic in topics.infos.items()}
    image_sides = {topic: side for side, topic in topics.images.items()}
    for topic, time_ns, message in reader.messages([*image_sides, *info_sides]):
        if topic in info_sides:
            infos[info_sides[topic]] = message
        elif pair := sync.add(image_sides[topic], _stamp_ns(message), message):
            yield BagPair(pair, (infos["left"], infos["right"]), time_ns)


def _stamp_ns(message: Any) -> int:
    stamp = message.header.stamp
    return int(stamp.sec) * 1_000_000_000 + int(stamp.nanosec)
