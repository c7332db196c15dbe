# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""How the node publishes, also while ROS is shut down."""

from __future__ import annotations

from typing import Any

from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node
from rclpy.publisher import Publisher

DEPTH = 10  # messages kept for a subscription that is slower
RCLError = rclpy_implementation.RCLError


def is_watched(node: Node, publisher: Publisher) -> bool:
    """Return whether somebody subscribes to a publisher; nobody does once ROS is shut down."""
    try:
        return bool(publisher.get_subscription_count())
    except RCLError:
        if node.context.ok():
            raise
        return False


def publish(node: Node, publisher: Publisher, msg: Any) -> None:
    """Publish a message of a node, whichever thread works and whether or not ROS goes down meanwhile."""
    try:
        publisher.publish(msg)
    except RCLError:
        if node.context.ok():  # else ROS was shut down, and nobody listens any more
            raise
