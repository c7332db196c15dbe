# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The stereo pairs of a bag, with their camera infos: read, and written on the topics of the node."""

from __future__ import annotations

import bisect
from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.messages.bag import BagReader, BagWriter
from lane_dp_ros.messages.bag_message import bag_message
from lane_dp_ros.messages.camera import camera_info_to_ros
from lane_dp_ros.messages.camera_infos import CameraInfos
from lane_dp_ros.messages.image import compressed_image_to_ros, image_to_ros
from lane_dp_ros.messages.stamp import NS_PER_S, stamp_from_ros, stamp_to_ros
from lane_dp_ros.messages.stereo_sync import RIGHT_SILENT_AFTER_NS, SIDES, Side, StereoPair, StereoSync
from lane_dp_ros.messages.stereo_topics import StereoTopics, find_stereo_topics

__all__ = [
    "BagPair",
    "StereoBagWriter",
    "StereoImages",
    "StereoTopics",
    "find_stereo_topics",
    "read_stereo_pairs",
    "sync_of_bag",
]

FRAME_ID = "left_camera_optical_frame"  # of both sides, as in image_pipeline: P_right refers to it, too
CAPACITY = 50  # images that wait for a partner: one side may be recorded a few seconds after the other


class BagPair(NamedTuple):
    """A pair of image messages, its camera infos (left, right), and when it was recorded."""

    pair: StereoPair
    infos: tuple[Any, Any]
    time_ns: int


def read_stereo_pairs(reader: BagReader, topics: StereoTopics, sync: StereoSync) -> Iterator[BagPair]:
    """Yield every pair that `sync` makes, with the camera infos that `CameraInfos` holds for it.

    Before the first ones have come, the first ones serve.
    """
    for image in _by_stamp(_images(reader, topics)):
        if pair := sync.add(image.side, image.stamp_ns, image.message):
            yield BagPair(pair, image.infos, image.time_ns)


def sync_of_bag(tolerance: float) -> StereoSync:
    """Return what pairs the images of a bag as the node does: stamps may differ by `tolerance` [s]."""
    return StereoSync(round(tolerance * NS_PER_S), CAPACITY, alone_after_ns=RIGHT_SILENT_AFTER_NS)


class _Image(NamedTuple):
    """An image message, when it was recorded, and the camera infos (left, right) at that time."""

    stamp_ns: int
    side: Side
    message: Any
    time_ns: int
    infos: tuple[Any, Any]


def _images(reader: BagReader, topics: StereoTopics) -> Iterator[_Image]:
    """Yield the images in the order in which they were recorded."""
    infos = CameraInfos()
    for side, topic in topics.infos.items():
        _, time_ns, message = next(reader.messages([topic]))
        infos.hear(side, message, time_ns / NS_PER_S)
    info_sides = {topic: side for side, topic in topics.infos.items()}
    image_sides = {topic: side for side, topic in topics.images.items()}
    for topic, time_ns, message in reader.messages([*image_sides, *info_sides]):
        if topic in info_sides:
            infos.hear(info_sides[topic], message, time_ns / NS_PER_S)
        else:
            both = infos.both(time_ns / NS_PER_S)
            assert both is not None  # both sides were heard above
            stamp_ns = stamp_from_ros(message.header.stamp)
            yield _Image(stamp_ns, image_sides[topic], message, time_ns, both)


def _by_stamp(images: Iterable[_Image]) -> Iterator[_Image]:
    """Yield images in the order of their stamps, though one side may be recorded seconds after the other.

    An image waits until the other side has come as far, or `CAPACITY` others wait. Where a side's stamps
    run backwards, all that waits goes first.
    """
    waiting: deque[_Image] = deque()
    last: dict[Side, int] = {}
    for image in images:
        if image.stamp_ns < last.get(image.side, image.stamp_ns):
            yield from waiting
            waiting.clear()
            last.clear()
        last[image.side] = image.stamp_ns
        bisect.insort(waiting, image, key=lambda each: each.stamp_ns)
        come = min(last.get(side, waiting[0].stamp_ns - 1) for side in SIDES)
        while waiting and (waiting[0].stamp_ns <= come or len(waiting) > CAPACITY):
            yield waiting.popleft()
    yield from waiting


class StereoImages(NamedTuple):
    """One pair, uint8, (H, W) gray or (H, W, 3) BGR, with the left image's stamp; `right` may be None."""

    stamp_ns: int
    left: NDArray[np.uint8]
    right: NDArray[np.uint8] | None


@dataclass
class StereoBagWriter:
    """Writes pairs and their camera infos; as JPEG on the compressed topics if `jpeg`.

    With `camera_height` [m] the pose of the camera is written once on /tf_static: level, above `base_link`,
    which lies on the road.
    """

    writer: BagWriter
    P_left: NDArray[np.float64]
    P_right: NDArray[np.float64]
    jpeg: bool = False
    camera_height: float | None = None
    _posed: bool = field(default=False, init=False)

    def write(self, pair: StereoImages) -> None:
        """Write one pair: camera infos first, so that the first pair can be used."""
        stamp = stamp_to_ros(pair.stamp_ns, bag_message)
        if self.camera_height is not None and not self._posed:
            pose = _camera_pose(self.camera_height, stamp)
            self.writer.write("/tf_static", pair.stamp_ns, pose, latched=True)
            self._posed = True
        header = bag_message("std_msgs/msg/Header", stamp=stamp, frame_id=FRAME_ID)
        for side, P in (("left", self.P_left), ("right", self.P_right)):
            info = camera_info_to_ros(P, pair.left.shape, header, bag_message)
            self.writer.write(f"/{side}/camera_info", pair.stamp_ns, info)
        for side, image in (("left", pair.left), ("right", pair.right)):
            topic = f"/{side}/image_rect"
            if image is None:
                continue
            if self.jpeg:
                message = compressed_image_to_ros(image, header, bag_message)
                self.writer.write(f"{topic}/compressed", pair.stamp_ns, message)
            else:
                self.writer.write(topic, pair.stamp_ns, image_to_ros(image, header, bag_message))


def _camera_pose(height: float, stamp: Any) -> Any:
    """Return tf2_msgs/TFMessage: the optical frame in base_link, whose x is ahead and y left (REP 103)."""
    turned = bag_message("geometry_msgs/msg/Quaternion", x=-0.5, y=0.5, z=-0.5, w=0.5)
    above = bag_message("geometry_msgs/msg/Vector3", z=height)
    transform = bag_message(
        "geometry_msgs/msg/TransformStamped",
        header=bag_message("std_msgs/msg/Header", stamp=stamp, frame_id="base_link"),
        child_frame_id=FRAME_ID,
        transform=bag_message("geometry_msgs/msg/Transform", translation=above, rotation=turned),
    )
    return bag_message("tf2_msgs/msg/TFMessage", transforms=[transform])
