# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The node's inputs: image and CameraInfo topics of both sides in, pairs with their calibration out."""

from __future__ import annotations

import time
from collections.abc import Callable
from copy import copy
from functools import partial
from typing import Any

from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from rclpy.qos_overriding_options import QoSOverridingOptions
from rclpy.subscription import Subscription
from sensor_msgs.msg import CameraInfo, CompressedImage, Image

from lane_dp_ros.messages.camera_infos import CameraInfos
from lane_dp_ros.messages.errors import one_line
from lane_dp_ros.messages.stamp import NS_PER_S, stamp_from_ros
from lane_dp_ros.messages.stereo_sync import RIGHT_SILENT_AFTER_NS, SIDES, Side, StereoPair, StereoSync
from lane_dp_ros.ros.diagnostics import Topics

EARLY_MAX = 1.0  # s; a pair that waited longer for the first CameraInfo is stale
Infos = tuple[CameraInfo, CameraInfo]
OnPair = Callable[[StereoPair, Infos, float], None]


class StereoSubscriber:
    """Subscribes to a stereo camera for a node.

    `on_pair(pair, infos, arrived)` is called, in the executor's thread, with each pair that is complete, its
    CameraInfo of both sides, and when its last message came [s, monotonic]; `heard(topic, now)` with each
    message. Raises ValueError for QoS overrides that cannot be used.
    """

    def __init__(
        self,
        node: Node,
        image_transport: str,
        tolerance: float,
        on_pair: OnPair,
        heard: Callable[[str, float], None],
    ) -> None:
        self._node, self._on_pair, self._heard = node, on_pair, heard
        self.sync = StereoSync(0, alone_after_ns=RIGHT_SILENT_AFTER_NS)
        self.set_tolerance(tolerance)
        self.early_dropped = 0
        self._infos = CameraInfos()
        self._early: tuple[StereoPair, float] | None = None
        # First, so that of what comes at the same time the calibration is taken in before the images.
        self._info_rank: dict[Side, int] = {}
        subscriptions = {side: self._subscribe_to_infos(side) for side in SIDES}
        self._info_subscriptions = [subscriptions[side][0] for side in SIDES]
        self._image_subscriptions: list[Subscription] = []
        self._subscribe_to_images(image_transport)

    @property
    def topics(self) -> Topics:
        """The topics that are listened to, by their full names."""
        images, infos = self._image_subscriptions, self._info_subscriptions
        return Topics(tuple(s.topic_name for s in images), tuple(s.topic_name for s in infos))

    def set_tolerance(self, seconds: float) -> None:
        """Let the stamps of a pair differ by so much."""
        self.sync.tolerance_ns = round(seconds * NS_PER_S)

    def change_transport(self, image_transport: str) -> None:
        """Listen to raw or compressed images from now on.

        Whoever asks for it: no subscription may vanish while the executor waits for it.
        """
        executor = self._node.executor
        if executor is not None:
            executor.create_task(self._change_transport, image_transport)
        else:
            self._change_transport(image_transport)

    def _change_transport(self, image_transport: str) -> None:
        self.sync.clear()
        try:
            self._subscribe_to_images(image_transport)
        except ValueError as error:
            self._node.get_logger().error(one_line(error))

    def _subscribe_to_infos(self, side: Side) -> list[Subscription]:
        topics = _info_topics(self._node, side)
        return [
            self._subscribe(CameraInfo, topic, partial(self._on_info, side, rank))
            for rank, topic in enumerate(topics)
        ]

    def _subscribe_to_images(self, image_transport: str) -> None:
        before, subscriptions = self._image_subscriptions, []
        for side in SIDES:
            message, topic = Image, f"{side}/image_rect"
            if image_transport == "compressed":
                # As image_transport has it: a remap of the raw topic's name moves the compressed one along.
                message, topic = CompressedImage, self._node.resolve_topic_name(topic) + "/compressed"
            subscriptions.append(self._subscribe(message, topic, partial(self._on_image, side)))
        self._image_subscriptions = subscriptions
        for old in before:
            self._node.destroy_subscription(old)

    def _subscribe(self, message: Any, topic: str, callback: Any) -> Subscription:
        # A copy, because rclpy writes the overrides into the profile that it is given.
        qos = copy(qos_profile_sensor_data)
        options = QoSOverridingOptions.with_default_policies()
        try:
            return self._node.create_subscription(
                message, topic, callback, qos, qos_overriding_options=options
            )
        except (
            RuntimeError,
            AssertionError,
            AttributeError,
        ) as error:  # what rclpy raises for a bad override
            reason = str(error) or "a value of the wrong type"
            raise ValueError(f"qos_overrides of {topic}: {reason}") from error

    def _on_image(self, side: Side, msg: Any) -> None:
        now = time.monotonic()
        self._heard(self._image_subscriptions[SIDES.index(side)].topic_name, now)
        pair = self.sync.add(side, stamp_from_ros(msg.header.stamp), msg)
        infos = self._infos.both(now)
        if pair is not None and infos is not None:
            self._on_pair(pair, infos, now)
        elif pair is not None:
            # The first CameraInfo may be a moment behind the first images: the newest pair waits for it.
            self.early_dropped += self._early is not None
            self._early = (pair, now)

    def _on_info(self, side: Side, rank: int, msg: CameraInfo) -> None:
        """Take a CameraInfo in, unless one from a topic of a better rank, which is nearer to 0, has come."""
        if rank > self._info_rank.get(side, rank):
            return
        self._info_rank[side] = rank
        now = time.monotonic()
        self._heard(self._info_subscriptions[SIDES.index(side)].topic_name, now)
        self._infos.hear(side, msg, now)
        infos = self._infos.both(now)
        if self._early is None or infos is None:
            return
        pair, arrived = self._early
        if now - arrived <= EARLY_MAX:
            self._on_pair(pair, infos, arrived)
        else:
            self.early_dropped += 1
        self._early = None


def _info_topics(node: Node, side: Side) -> list[str]:
    """Return the topics that a side's CameraInfo may come on, the best one first.

    Where the images are remapped and SIDE/camera_info is not, it is camera_info beside the images, as
    image_transport has it; the one under the node's own name serves until that has come.
    """
    image, info = f"{side}/image_rect", f"{side}/camera_info"
    if _is_remapped(node, image) and not _is_remapped(node, info):
        beside = f"{node.resolve_topic_name(image).rpartition('/')[0]}/camera_info"
        return list(dict.fromkeys([beside, node.resolve_topic_name(info)]))
    return [info]


def _is_remapped(node: Node, topic: str) -> bool:
    return node.resolve_topic_name(topic) != node.resolve_topic_name(topic, only_expand=True)
