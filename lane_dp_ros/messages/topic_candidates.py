# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Topics of a bag that may be those of a stereo camera: by their names, or by their CameraInfos."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import permutations
from typing import Any, NamedTuple

import numpy as np

from lane_dp_ros.messages.bag_reader import BagReader
from lane_dp_ros.messages.stereo_sync import SIDES, Side

IMAGE, COMPRESSED = "sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"
COMPRESSED_ENDING = "/compressed"  # of what image_transport compresses as JPEG or PNG
INFO = "sensor_msgs/msg/CameraInfo"
BASELINES = (0.02, 3.0)  # m; of cameras on a vehicle
# Words for left and right; of a name with several kinds the first here counts: a rig may be called cam1.
_SIDES = (("infra1", "infra2"), ("infra_1", "infra_2"), ("left", "right"), ("cam0", "cam1"))
_NO_PICTURE = re.compile("depth|disparity|confidence|mask|overlay|/zstd$", re.IGNORECASE)
_LEVELS = 3  # above an image's topic at which its camera_info may be


class Missing(NamedTuple):
    """A topic that a candidate needs and that has no messages."""

    side: Side
    topic: str
    is_info: bool


@dataclass(frozen=True)
class Candidate:
    """Topics that go together; `camera` is what they begin with, up to the side.

    `empty` are those without messages. Of one camera's candidates the one of the least `rank` is taken.
    """

    camera: str
    images: dict[Side, str]
    infos: dict[Side, str]
    is_compressed: bool
    empty: frozenset[str]

    @property
    def rank(self) -> tuple[Any, ...]:
        """Raw images first, those named as the node's, then by name."""
        left = self.images["left"]
        name = left.removesuffix(COMPRESSED_ENDING).rpartition("/")[2]
        return self.is_compressed, name != "image_rect", len(left), left

    @property
    def missing_count(self) -> int:
        """How many of the topics have no messages."""
        return len(self.empty)

    def missing(self, sides: Sequence[Side]) -> Missing | None:
        """Return the first topic of some sides that has no messages, None when they are complete."""
        for is_info, topics in ((False, self.images), (True, self.infos)):
            for side in sides:
                if topics[side] in self.empty:
                    return Missing(side, topics[side], is_info)
        return None


def candidates_by_name(reader: BagReader) -> list[Candidate]:
    """Return what is named left and right, whether or not all of it has messages."""
    images = [topic for topic in _images(reader) if _side(topic)]
    lefts = {topic if _is_left(topic) else partner(topic, ()) or topic for topic in images}
    return [candidate(reader, left, partner(left, ()) or left) for left in sorted(lefts)]


def candidates_by_baseline(reader: BagReader) -> list[Candidate]:
    """Return pairs of images whose CameraInfos stand a baseline apart, whatever their names."""
    infos = {image: info for image in _images(reader) if (info := _info_beside(reader, image))}
    full = [
        image for image in infos if reader.message_count([image]) and reader.message_count([infos[image]])
    ]
    pairs = [candidate(reader, *pair) for pair in permutations(full, 2) if _same_kind(reader, *pair)]
    return [pair for pair in pairs if is_rectified(reader, pair) and has_baseline(reader, pair)]


def candidate(reader: BagReader, left: str, right: str) -> Candidate:
    """Return two image topics with their CameraInfos: the named ones, or those beside the images."""
    images: dict[Side, str] = {"left": left, "right": right}
    infos: dict[Side, str] = {
        side: reader.choice.info(side) or _info_beside(reader, image) or f"{_folder(image)}/camera_info"
        for side, image in images.items()
    }
    empty = frozenset(t for t in (*images.values(), *infos.values()) if not reader.message_count([t]))
    found = _side(left)
    camera = left[: found.start()] if found else left
    return Candidate(camera, images, infos, reader.topics.get(left) == COMPRESSED, empty)


def partner(topic: str, there: Collection[str]) -> str | None:
    """Return what the other side's topic is called, None for a name without a side.

    With `there`, only if it is one of these.
    """
    found = _side(topic)
    if found is None:
        return None
    for pair in _SIDES:
        for word, other in (pair, pair[::-1]):
            if found.group().lower() == word:
                name = _word(word).sub(partial(_as_cased, other), topic)
                return name if not there or name in there else None
    return None


def is_rectified(reader: BagReader, found: Candidate) -> bool:
    """Return whether the images are rectified: their names say so, or their CameraInfo has no distortion."""
    if "rect" in found.images["left"].lower():
        return True
    info = first_message(reader, found.infos["left"])
    return info is None or (
        not np.any(info.d) and np.allclose(np.reshape(info.r, (3, 3)), np.eye(3), atol=1e-6)
    )


def has_baseline(reader: BagReader, found: Candidate) -> bool:
    """Return whether the CameraInfos are those of a stereo camera, left and right as said."""
    left, right = (first_message(reader, found.infos[side]) for side in SIDES)
    if left is None or right is None or (left.width, left.height) != (right.width, right.height):
        return False
    P_left, P_right = (np.reshape(info.p, (3, 4)) for info in (left, right))
    if not P_left[0, 0] > 0 or not np.allclose(P_left[:, :3], P_right[:, :3], rtol=1e-3):
        return False
    return bool(BASELINES[0] <= (P_left[0, 3] - P_right[0, 3]) / P_left[0, 0] <= BASELINES[1])


def first_message(reader: BagReader, topic: str) -> Any | None:
    """Return the first message of a topic, None where there is none."""
    return next((message for _, _, message in reader.messages([topic])), None)


def _images(reader: BagReader) -> Iterator[str]:
    prefix = reader.choice.prefix
    whole = f"{prefix.rstrip('/')}/"  # /cam1 is not /cam10, where both are there
    begins = whole if any(topic.startswith(whole) for topic in reader.topics) else prefix
    for topic, kind in reader.topics.items():
        if kind in (IMAGE, COMPRESSED) and topic.startswith(begins) and not _NO_PICTURE.search(topic):
            yield topic


def _same_kind(reader: BagReader, left: str, right: str) -> bool:
    names = {topic.rpartition("/")[2] for topic in (left, right)}
    return reader.topics[left] == reader.topics[right] and len(names) == 1


def _folder(image: str) -> str:
    """Return the folder of an image's topic; compressed images lie below the raw ones' name."""
    return image.removesuffix(COMPRESSED_ENDING).rpartition("/")[0]


def _info_beside(reader: BagReader, image: str) -> str | None:
    """Return the CameraInfo's topic beside an image or above it; the first that has messages."""
    infos = {topic for topic, kind in reader.topics.items() if kind == INFO}
    folder = _folder(image)
    places = [image.removesuffix(COMPRESSED_ENDING), *(folder.rsplit("/", n)[0] for n in range(_LEVELS))]
    found = [info for place in places if (info := f"{place}/camera_info") in infos]
    return next((info for info in found if reader.message_count([info])), found[0] if found else None)


def _word(word: str) -> re.Pattern[str]:
    return re.compile(rf"(?<![a-z]){word}(?![a-z0-9])", re.IGNORECASE)


def _side(topic: str) -> re.Match[str] | None:
    """Return where a topic's name first says a side, by the first of the pairs of words that it has."""
    for pair in _SIDES:
        if found := [match for word in pair if (match := _word(word).search(topic))]:
            return min(found, key=lambda match: match.start())
    return None


def _is_left(topic: str) -> bool:
    found = _side(topic)
    return found is not None and found.group().lower() in [pair[0] for pair in _SIDES]


def _as_cased(word: str, like: re.Match[str]) -> str:
    return word.upper() if like.group().isupper() else word.capitalize() if like.group().istitle() else word
