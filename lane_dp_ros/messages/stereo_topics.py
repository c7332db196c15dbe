# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Find the topics of the stereo camera in a bag: named, or guessed where there is one sensible answer."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass

from lane_dp_ros.messages.bag_reader import BagReader
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.messages.stereo_sync import SIDES, Side
from lane_dp_ros.messages.topic_candidates import (
    INFO,
    Candidate,
    candidate,
    candidates_by_baseline,
    candidates_by_name,
    has_baseline,
    is_rectified,
    partner,
)
from lane_dp_ros.messages.topic_choice import OPTIONS

IMAGES = {"image_rect": "sensor_msgs/msg/Image", "image_rect/compressed": "sensor_msgs/msg/CompressedImage"}
LISTED = 30  # topics that a refusal lists

_LOGGER = logging.getLogger(__name__)


@dataclass(frozen=True)
class StereoTopics:
    """The topics of a stereo camera in a bag, by side; `namespace` is where its lanes belong."""

    namespace: str
    images: dict[Side, str]
    infos: dict[Side, str]

    @property
    def are_standard(self) -> bool:
        """Whether they are named as those of the node, in whatever namespace."""
        names = [{side: f"{self.namespace}/{side}/{name}" for side in SIDES} for name in IMAGES]
        return self.images in names


def find_stereo_topics(reader: BagReader, sides: Sequence[Side] = SIDES) -> StereoTopics:
    """Return the topics that the reader's choice names, or else those of the one camera that there is.

    A guess goes by type and name (left and right, infra1 and infra2 ...), else by the baseline between two
    CameraInfos; of one camera's images raw ones come before compressed ones, topics without messages do not
    count. A guess of other names than the node's is told. With `sides` left alone the right side may be
    missing. Raises CommandError, listing what is there and how to name it, for no camera or several, and for
    a named topic of another type.
    """
    choice = reader.choice
    _check_types(reader)
    if choice.left or choice.right:
        return _complete(reader, _named(reader), sides)
    by_name = candidates_by_name(reader)
    found = [each for each in by_name if not each.missing(sides) and is_rectified(reader, each)]
    found = found or candidates_by_baseline(reader)
    if not found:
        raise _missing(reader, by_name, sides)
    topics = _topics(min(_of_one_camera(reader, found), key=lambda each: each.rank))
    if not topics.are_standard:
        _LOGGER.info("%s: left is %s, right %s", reader.path, *topics.images.values())
    return topics


def _check_types(reader: BagReader) -> None:
    """Raise CommandError for a topic that was named as an image or a CameraInfo and is none."""
    choice, images = reader.choice, tuple(IMAGES.values())
    for side in SIDES:
        named = ((choice.image(side), side, images), (choice.info(side), f"{side}-info", (INFO,)))
        for topic, option, wanted in named:
            kind = reader.topics.get(topic or "")
            if kind is not None and kind not in wanted:
                told = f"--{option} {topic} is {kind}, expected {' or '.join(wanted)}"
                raise CommandError(f"{told}; {reader.path} has {_there(reader)}")


def _named(reader: BagReader) -> Candidate:
    """Return the candidate that the user named, a side that was not named after the other."""
    choice = reader.choice
    left, right = (choice.image(side) for side in SIDES)
    left = left or partner(right or "", reader.topics)
    right = right or partner(left or "", reader.topics)
    if left is None or right is None:
        side = "left" if left is None else "right"
        raise CommandError(f"{reader.path}: name both sides, add --{side} TOPIC; it has {_there(reader)}")
    if left == right:
        raise CommandError(f"{left} is named for both sides, expected the left and the right camera's topic")
    named = candidate(reader, left, right)
    if not is_rectified(reader, named):
        text = "%s is taken as rectified, though its name does not say so and its CameraInfo has distortion"
        _LOGGER.warning(text, left)
    return named


def _complete(reader: BagReader, named: Candidate, sides: Sequence[Side]) -> StereoTopics:
    if missing := named.missing(sides):
        option = f"--{missing.side}-info TOPIC" if missing.is_info else f"--{missing.side} TOPIC"
        what = f"{reader.path} has no messages on {missing.topic} for {option}"
        raise CommandError(f"{what}; it has {_there(reader)}")
    return _topics(named)


def _of_one_camera(reader: BagReader, found: list[Candidate]) -> list[Candidate]:
    cameras = {each.camera for each in found}
    if len(cameras) > 1:
        found = [each for each in found if has_baseline(reader, each)] or found
        cameras = {each.camera for each in found}
    if len(cameras) > 1:
        names = ", ".join(sorted(cameras))
        raise CommandError(
            f"{reader.path} has several stereo cameras, their topics begin with {names}: name one by "
            "--camera PREFIX, or its topics by --left and --right"
        )
    return found


def _missing(reader: BagReader, by_name: list[Candidate], sides: Sequence[Side]) -> CommandError:
    wanted = "left/image_rect or left/image_rect/compressed"
    if by_name:
        nearest = min(by_name, key=lambda each: (each.missing_count, each.rank))
        missing = nearest.missing(sides)
        if missing is None:
            raw = "is not rectified, by its CameraInfo: rectify it (image_proc), or insist by --left"
            return CommandError(f"{reader.path}: {nearest.images['left']} {raw}; it has {_there(reader)}")
        wanted = missing.topic
    message = no_messages(reader, wanted)
    return CommandError(f"{message}; name the camera's topics: {OPTIONS}")


def no_messages(reader: BagReader, wanted: str) -> CommandError:
    """Return what to say of a bag that lacks a topic: what it has."""
    return CommandError(f"{reader.path} has no messages on {wanted}; it has {_there(reader)}")


def _there(reader: BagReader) -> str:
    """Return what a bag has, the topics of cameras first."""
    kinds = (*IMAGES.values(), INFO)
    topics = sorted(reader.topics, key=lambda topic: (reader.topics[topic] not in kinds, topic))
    told = [f"{topic} ({reader.message_count([topic])})" for topic in topics[:LISTED]]
    if len(topics) > LISTED:
        told.append(f"{len(topics) - LISTED} more topics")
    return ", ".join(told) or "no topics"


def _topics(found: Candidate) -> StereoTopics:
    left, right = (topic.split("/")[:-1] for topic in found.images.values())
    common = 0
    while common < min(len(left), len(right)) and left[common] == right[common]:
        common += 1
    return StereoTopics("/".join(left[:common]), found.images, found.infos)
