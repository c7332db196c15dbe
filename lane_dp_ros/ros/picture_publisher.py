# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The pictures that somebody may look at, drawn in a thread of their own: lanes do not wait for them."""

from __future__ import annotations

import time
from typing import Any

from rclpy.node import Node
from sensor_msgs.msg import Image

from lane_dp_ros.core.pipeline import FrameResult
from lane_dp_ros.messages.errors import one_line
from lane_dp_ros.messages.image import Image8, image_to_ros
from lane_dp_ros.messages.pictures import draw_birds_eye, draw_overlay
from lane_dp_ros.ros.publishing import DEPTH, is_watched, publish
from lane_dp_ros.ros.rclpy_message import rclpy_message
from lane_dp_ros.ros.worker import LatestOnlyWorker

LOG_PERIOD = 5.0  # s; the same complaint is logged no more often


class PicturePublisher:
    """Publishes `overlay/image` and `ipm/image` for a node while somebody subscribes to them.

    Where drawing is slower than the lanes are found, pictures are left out. `close()` ends its thread.
    """

    def __init__(self, node: Node) -> None:
        self._node = node
        self._birds_eye = node.create_publisher(Image, "ipm/image", DEPTH)
        self._overlay = node.create_publisher(Image, "overlay/image", DEPTH)
        self._worker = LatestOnlyWorker(self._work)
        self.seconds = 0.0
        """Computing time of the last pictures."""

    def offer(self, result: FrameResult, header: Any) -> None:
        """Have the pictures of a result drawn and published, if anybody looks at them; returns at once."""
        if is_watched(self._node, self._overlay) or is_watched(self._node, self._birds_eye):
            self._worker.offer((result, header))
        else:
            self.seconds = 0.0

    def close(self) -> None:
        """End the thread, after the picture in work, if any."""
        self._worker.close()

    def _work(self, item: tuple[FrameResult, Any]) -> None:
        result, header = item
        start = time.perf_counter()
        try:
            self._draw(result, header)
        except Exception as error:  # noqa: BLE001 - a picture that cannot be drawn must not end the node
            message = f"A picture cannot be drawn: {one_line(error)}"
            self._node.get_logger().error(message, throttle_duration_sec=LOG_PERIOD)
        self.seconds = time.perf_counter() - start

    def _draw(self, result: FrameResult, header: Any) -> None:
        left, lines = result.frame.left, result.lanes + result.road_edges
        if result.camera is not None and is_watched(self._node, self._overlay):
            self._publish(self._overlay, draw_overlay(left, lines, result.camera), header)
        view = result.detection.birds_eye if result.detection else None
        if view is not None and is_watched(self._node, self._birds_eye):
            self._publish(self._birds_eye, draw_birds_eye(view, left, lines), header)

    def _publish(self, publisher: Any, picture: Image8, header: Any) -> None:
        publish(self._node, publisher, image_to_ros(picture, header, rclpy_message))
