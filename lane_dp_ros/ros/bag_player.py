# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Replay a rosbag2 on its topics in real time, without ros2 bag."""

from __future__ import annotations

import importlib
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import rclpy
from rclpy.context import Context
from rclpy.duration import Duration
from rclpy.exceptions import NameValidationException
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.signals import SignalHandlerOptions

from lane_dp_ros.messages.bag import BagReader, RawMessage
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.ros.start_errors import START_ERRORS, start_reason

DEPTH = 100  # messages that wait for a reliable subscription that is slower than the bag
DISCOVERY_TIMEOUT = 5.0  # s
SETTLING_TIME = 0.3  # s; when no more subscriptions came for so long, all are there
ACKNOWLEDGE_TIMEOUT = 5.0  # s
LINGER = 0.5  # s; best-effort subscriptions acknowledge nothing: leave them time to take the last pair
POLL = 0.02  # s
LONGEST_SLEEP = 3600.0  # s; time.sleep refuses what a very small rate may ask for

OnSent = Callable[[RawMessage], None]
GoesOn = Callable[[RawMessage], bool]


class BagPlayer:
    """Publishes the messages of a bag as they are, on their topics, relative to the node's namespace.

    Topics whose message type is not installed, or whose name is none in ROS, are left out with a warning.
    Raises CommandError when none is left.
    """

    def __init__(self, node: Node, reader: BagReader) -> None:
        self._reader = reader
        self._publishers: dict[str, Publisher] = {}
        qos = QoSProfile(depth=DEPTH, reliability=ReliabilityPolicy.RELIABLE)
        for topic, type_name in sorted(reader.topics.items()):
            message_class = _message_class(type_name)
            if message_class is None:
                node.get_logger().warning(f"{topic} is left out: its type {type_name} is not installed")
                continue
            try:
                self._publishers[topic] = node.create_publisher(message_class, topic.lstrip("/"), qos)
            except NameValidationException:
                node.get_logger().warning(f"{topic} is left out: ROS has no topics of such a name")
        self._topics = [topic for topic in self._publishers if reader.message_count([topic])]
        if not self._topics:
            raise CommandError(f"{reader.path} has nothing to play: {_described(reader)}")

    def wait_for_subscriptions(self, timeout: float = DISCOVERY_TIMEOUT) -> bool:
        """Wait until the subscriptions are there; tell whether there is one at all."""
        deadline = time.monotonic() + timeout
        matched, since = self._subscriptions(), time.monotonic()
        while time.monotonic() < deadline and not (matched and time.monotonic() - since > SETTLING_TIME):
            time.sleep(POLL)
            if (now_matched := self._subscriptions()) != matched:
                matched, since = now_matched, time.monotonic()
        return matched > 0

    def play(self, rate: float = 1.0, on_sent: OnSent | None = None, goes_on: GoesOn | None = None) -> int:
        """Publish the bag once, `rate` times as fast as recorded; return the number of messages.

        `goes_on(raw)` is asked before each message when it is due: it may wait, and ends the play by False.
        """
        start, first_ns, count = time.monotonic(), None, 0
        for raw in self._reader.raw_messages(self._topics):
            first_ns = raw.time_ns if first_ns is None else first_ns
            _sleep_until(start + (raw.time_ns - first_ns) / 1e9 / rate)
            if goes_on is not None and not goes_on(raw):
                break
            self._publishers[raw.topic].publish(raw.data)
            count += 1
            if on_sent is not None:
                on_sent(raw)
        return count

    def finish(self) -> None:
        """Wait until the last messages are received."""
        deadline = time.monotonic() + ACKNOWLEDGE_TIMEOUT
        for publisher in self._publishers.values():
            publisher.wait_for_all_acked(Duration(seconds=max(0.0, deadline - time.monotonic())))
        time.sleep(LINGER)

    def _subscriptions(self) -> int:
        return sum(publisher.get_subscription_count() for publisher in self._publishers.values())


def play(reader: BagReader, rate: float, loop: bool, ros_args: list[str]) -> int:
    """Replay an open bag, once or without end, in a node named bag_player; return the number of messages.

    KeyboardInterrupt passes through. Raises CommandError when the bag has nothing to play.
    """
    with ros_node("bag_player", ros_args=ros_args) as node:
        player = BagPlayer(node, reader)
        if not player.wait_for_subscriptions():
            node.get_logger().warning(f"nobody subscribed within {DISCOVERY_TIMEOUT:g} s, playing anyway")
        count = player.play(rate)
        while loop:
            player.play(rate)
        player.finish()
        return count


@contextmanager
def ros_node(name: str, namespace: str = "", ros_args: Sequence[str] = ()) -> Iterator[Node]:
    """Give a node in a ROS context of its own, which ends with the block.

    Raises CommandError when ROS does not start with these arguments and this environment.
    """
    context = Context()
    try:
        # Ctrl-C stays Python's: ROS would pull the publishers from under a loop.
        rclpy.init(args=list(ros_args), context=context, signal_handler_options=SignalHandlerOptions.NO)
        node = Node(name, namespace=namespace, context=context)
    except START_ERRORS as error:
        context.try_shutdown()
        raise CommandError(f"ROS does not start: {start_reason(error)}") from None
    try:
        yield node
    finally:
        node.destroy_node()
        context.try_shutdown()


def _message_class(type_name: str) -> Any:
    """Return the Python class of e.g. "sensor_msgs/msg/Image", None where it is not installed."""
    package, _, name = type_name.partition("/msg/")
    try:
        return getattr(importlib.import_module(f"{package}.msg"), name, None)
    except (ModuleNotFoundError, ValueError):
        return None


def _described(reader: BagReader) -> str:
    topics = [f"{topic} ({type_name})" for topic, type_name in sorted(reader.topics.items())]
    return "its topics are " + ", ".join(topics) if topics else "it has no topics"


def _sleep_until(due: float) -> None:
    while (delay := due - time.monotonic()) > 0:
        time.sleep(min(delay, LONGEST_SLEEP))
