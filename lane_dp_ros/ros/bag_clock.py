# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The time of a bag that is played, on /clock, for nodes with use_sim_time."""

from __future__ import annotations

import time

from rclpy.node import Node
from rosgraph_msgs.msg import Clock

from lane_dp_ros.messages.stamp import stamp_to_ros
from lane_dp_ros.ros.rclpy_message import rclpy_message

TOPIC = "/clock"
FREQUENCY = 40.0  # Hz, as ros2 bag play has it


class BagClock:
    """Publishes the time of a bag at a steady rate while it is played."""

    def __init__(self, node: Node) -> None:
        self._publisher = node.create_publisher(Clock, TOPIC, 1)
        self._next = 0.0

    def tick(self, time_ns: int) -> float:
        """Publish the bag's time [ns] when that is due; return when it will be due again [s, monotonic]."""
        now = time.monotonic()
        if now >= self._next:
            self._publisher.publish(Clock(clock=stamp_to_ros(max(0, time_ns), rclpy_message)))
            self._next = now + 1 / FREQUENCY
        return self._next
