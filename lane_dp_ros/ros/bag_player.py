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
from rclpy.signals import SignalHandlerOptions

from lane_dp_ros.messages.bag import BagReader, RawMessage
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.messages.stereo_sync import SIDES
from lane_dp_ros.messages.stereo_topics import IMAGES, StereoTopics, find_stereo_topics
from lane_dp_ros.messages.topic_choice import TopicChoice
from lane_dp_ros.ros.bag_clock import TOPIC as CLOCK
from lane_dp_ros.ros.bag_clock import BagClock
from lane_dp_ros.ros.recorded_qos import offered_qos
from lane_dp_ros.ros.start_errors import START_ERRORS, start_reason

DISCOVERY_TIMEOUT = 5.0  # s
SETTLING_TIME = 0.3  # s; when no more subscriptions came for so long, all are there
ACKNOWLEDGE_TIMEOUT = 5.0  # s
LINGER = 0.5  # s; best-effort subscriptions acknowledge nothing: leave them time to take the last pair
POLL = 0.02  # s
LONGEST_SLEEP = 3600.0  # s; time.sleep refuses what a very small rate may ask for

OnSent = Callable[[RawMessage], None]
GoesOn = Callable[[RawMessage], bool]


class _Pace:
    """The times of a bag against the clock from now on, `rate` times as fast as recorded."""

    def __init__(self, first_ns: int, rate: float) -> None:
        self._start, self._first_ns, self._rate = time.monotonic(), first_ns, rate

    def due(self, time_ns: int) -> float:
        """Return when a message that was recorded at `time_ns` is due [s, monotonic]."""
        return self._start + (time_ns - self._first_ns) / 1e9 / self._rate

    def bag_time_ns(self) -> int:
        """Return the bag's time of now [ns]."""
        return self._first_ns + round((time.monotonic() - self._start) * self._rate * 1e9)


class BagPlayer:
    """Publishes the messages of a bag as they are, on their topics, relative to the node's namespace.

    Each topic is offered with the QoS that was recorded. The topics that the reader's choice names become
    those of the node: left/image_rect and so on. With `clock` the bag's time is published on /clock.
    Topics whose message type is not installed, or whose name is none in ROS, are left out with a warning.
    Raises CommandError when none is left.
    """

    def __init__(self, node: Node, reader: BagReader, clock: bool = False) -> None:
        self._reader = reader
        self._clock = BagClock(node) if clock else None
        self._publishers: dict[str, Publisher] = {}
        for topic, name in _played_names(reader, clock).items():
            message_class = _message_class(type_name := reader.topics[topic])
            if message_class is None:
                # Poses are for viewers, of which there are none without tf2: nobody is to be told.
                if not type_name.startswith("tf2_msgs/"):
                    node.get_logger().warning(f"{topic} is left out: its type {type_name} is not installed")
                continue
            try:
                qos = offered_qos(reader.offered_qos(topic))
                self._publishers[topic] = node.create_publisher(message_class, name, qos)
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
        pace, count = None, 0
        for raw in self._reader.raw_messages(self._topics):
            pace = pace or _Pace(raw.time_ns, rate)
            self._wait(pace, raw.time_ns)
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

    def _wait(self, pace: _Pace, time_ns: int) -> None:
        """Sleep until a message is due, and let the clock tick meanwhile."""
        due = pace.due(time_ns)
        while True:
            tick = self._clock.tick(pace.bag_time_ns()) if self._clock else due
            if (delay := min(tick, due) - time.monotonic()) > 0:
                time.sleep(min(delay, LONGEST_SLEEP))
            elif time.monotonic() >= due:
                return

    def _subscriptions(self) -> int:
        return sum(publisher.get_subscription_count() for publisher in self._publishers.values())


def play(reader: BagReader, rate: float, loop: bool, ros_args: list[str], clock: bool = False) -> int:
    """Replay an open bag, once or without end, in a node named bag_player; return the number of messages.

    With `clock` the bag's time is published on /clock.

    KeyboardInterrupt passes through. Raises CommandError when the bag has nothing to play.
    """
    with ros_node("bag_player", ros_args=ros_args) as node:
        player = BagPlayer(node, reader, clock)
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


def _played_names(reader: BagReader, clock: bool) -> dict[str, str]:
    """Return the topics to play and how each is called, by name; a bag's own clock yields to ours."""
    named = _node_names(find_stereo_topics(reader), reader) if reader.choice != TopicChoice() else {}
    others = {topic: topic.lstrip("/") for topic in sorted(reader.topics) if topic not in named}
    kept = {topic: name for topic, name in others.items() if name not in named.values()}
    return {topic: name for topic, name in {**kept, **named}.items() if not (clock and topic == CLOCK)}


def _node_names(topics: StereoTopics, reader: BagReader) -> dict[str, str]:
    """Return what the node calls the topics of a stereo camera."""
    infos = {topics.infos[side]: f"{side}/camera_info" for side in SIDES}
    kinds = {kind: name for name, kind in IMAGES.items()}
    images = {topic: f"{side}/{kinds[reader.topics[topic]]}" for side, topic in topics.images.items()}
    return {**infos, **images}
