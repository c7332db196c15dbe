# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Start a lane_detector process, play a bag into it over DDS, and record what it publishes."""

from __future__ import annotations

import ctypes
import os
import signal
import subprocess
import sys
import threading
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import QoSProfile
from sensor_msgs.msg import Image
from visualization_msgs.msg import MarkerArray

from lane_dp_ros.messages.bag import BagReader, BagWriter, RawMessage
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.messages.stamp import NS_PER_S
from lane_dp_ros.ros.bag_player import BagPlayer, ros_node

Process = subprocess.Popen[bytes]

OUTPUTS = {
    "lanes": (MarkerArray, "visualization_msgs/msg/MarkerArray"),
    "road_edges": (MarkerArray, "visualization_msgs/msg/MarkerArray"),
    "ipm/image": (Image, "sensor_msgs/msg/Image"),
    "overlay/image": (Image, "sensor_msgs/msg/Image"),
}
START_TIMEOUT = 30.0  # s until the process has started and found us: a cold disk, a busy machine
ANSWER_TIMEOUT = 3.0  # s without any answer: there are no more
STOP_TIMEOUT = 5.0  # s until a process that does not end by itself is killed
POLL = 0.002  # s
MEASURED_PAIRS, WARM_UP = 8, 3  # pairs that measure the machine, the first of them without saying anything
AT_ONCE = 1e6  # times as fast as recorded
HEADROOM = 1.25  # times the longest time between two answers, for what else the machine does
PR_SET_PDEATHSIG = 1  # prctl: the signal that a process gets when its parent dies


@dataclass
class Session:
    """When pairs went out and answers came back, on the monotonic clock [ns]."""

    rate: float = 1.0
    """How many times as fast as recorded the bag was played."""
    sent_ns: dict[int, int] = field(default_factory=dict)
    """By recording time in the bag: when the last message of that time was published."""
    answers: list[tuple[int, bytes]] = field(default_factory=list)
    """When each `lanes` message came, and its serialised bytes."""
    recorded: Counter[str] = field(default_factory=Counter)
    """How many messages came, by topic."""

    def sent(self, raw: RawMessage) -> None:
        """Note that a message went out."""
        self.sent_ns[raw.time_ns] = time.monotonic_ns()

    def answered(self, pairs: int) -> bool:
        """Return whether everything has come that answers so many pairs."""
        return self.recorded.total() >= len(OUTPUTS) * pairs


def run_session(reader: BagReader, writer: BagWriter, log: Path, rate: float | None = None) -> Session:
    """Play a bag into a new lane_detector process and record what it publishes, see `OUTPUTS`.

    The bag is played `rate` times as fast as it was recorded. Without a rate, a few of its pairs measure
    first what this machine keeps up with, and then each pair waits, if need be, for the answer to the one
    before the last: every pair is answered. All take place in a namespace of their own: nothing reaches other
    nodes of this machine or network.
    What the process prints goes to `log`. Raises CommandError when the node does not come up or ends early.
    """
    namespace = f"/lane_dp_demo_{os.getpid()}"
    with detector_process(namespace, log) as process, ros_node("lane_dp_demo", namespace) as node:
        listener = _Listener(node)
        with spinning(node):
            player = BagPlayer(node, reader)
            _wait_until_connected(node, player, process, log)
            session = Session(rate or _keeps_up_with(player, listener))
            goes_on = None if rate else partial(_waits_for_answers, session)
            listener.session, listener.writer = session, writer
            player.play(session.rate, session.sent, goes_on)
            _wait_until_answered(session, len(session.sent_ns))
            check_alive(process, log)
    return session


class _Listener:
    """Notes in `session`, and writes with `writer` where there is one, what a node publishes."""

    def __init__(self, node: Node) -> None:
        self.session, self.writer = Session(), None  # type: Session, BagWriter | None
        for topic, (message_class, type_name) in OUTPUTS.items():
            callback = partial(self._hear, topic, type_name)
            node.create_subscription(message_class, topic, callback, QoSProfile(depth=100), raw=True)

    def _hear(self, topic: str, type_name: str, data: bytes) -> None:
        if topic == "lanes":
            self.session.answers.append((time.monotonic_ns(), data))
        if self.writer is not None:
            self.writer.write_raw(RawMessage(f"/{topic}", type_name, time.time_ns(), data))
        self.session.recorded[topic] += 1


def _keeps_up_with(player: BagPlayer, listener: _Listener) -> float:
    """Return how many times as fast as recorded, 1 at most, this machine answers pair after pair."""
    session, due, done = listener.session, [], []  # type: Session, list[int], list[float]

    def goes_on(raw: RawMessage) -> bool:
        """Send a pair when the one before is answered on every topic."""
        if raw.time_ns not in session.sent_ns:
            _wait_until_answered(session, len(session.sent_ns))
            due.append(raw.time_ns)
            done.append(time.monotonic())
        return len(due) <= MEASURED_PAIRS

    player.play(AT_ONCE, session.sent, goes_on)
    recorded, took = (float(np.max(np.diff(each)[WARM_UP:], initial=0.0)) for each in (due, done))
    return min(1.0, recorded / NS_PER_S / (HEADROOM * took)) if recorded and took else 1.0


def _waits_for_answers(session: Session, raw: RawMessage) -> bool:
    """Let no more than two pairs be on their way: one more would take the place of one that waits."""
    if raw.time_ns not in session.sent_ns:
        _wait_until_answered(session, len(session.sent_ns) - 1)
    return True


def _wait_until_connected(node: Node, player: BagPlayer, process: Process, log: Path) -> None:
    deadline = time.monotonic() + START_TIMEOUT
    while any(node.count_publishers(topic) == 0 for topic in OUTPUTS):
        check_alive(process, log)
        if time.monotonic() > deadline:
            raise CommandError(f"lane_detector did not come up within {START_TIMEOUT:g} s, see {log}")
        time.sleep(POLL)
    if not player.wait_for_subscriptions(deadline - time.monotonic()):
        raise CommandError(f"lane_detector did not subscribe within {START_TIMEOUT:g} s, see {log}")


def _wait_until_answered(session: Session, pairs: int) -> None:
    """Wait until so many pairs are answered on every topic, or nothing has come for a while."""
    count, since = session.recorded.total(), time.monotonic()
    while not session.answered(pairs) and time.monotonic() - since < ANSWER_TIMEOUT:
        time.sleep(POLL)
        if session.recorded.total() > count:
            count, since = session.recorded.total(), time.monotonic()


def check_alive(process: Process, log: Path) -> None:
    """Raise CommandError, with the last line of its log, when a lane_detector process has ended."""
    if process.poll() is not None:
        said = [line for line in log.read_text(errors="replace").splitlines() if line.strip()]
        last = said[-1].strip() if said else "it said nothing"
        raise CommandError(f"lane_detector ended with exit code {process.returncode}: {last} (see {log})")


@contextmanager
def detector_process(namespace: str, log: Path) -> Iterator[Process]:
    """Run lane_detector while the block runs, not a moment longer; what it prints goes to `log`."""
    package_root = str(Path(__file__).resolve().parents[2])
    paths = [package_root, *filter(None, [os.environ.get("PYTHONPATH")])]
    module = "lane_dp_ros.ros.lane_detector_node"
    command = [sys.executable, "-m", module, "--ros-args", "-r", f"__ns:={namespace}"]
    with log.open("wb") as output:
        process = subprocess.Popen(
            command,
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=subprocess.STDOUT,
            env={**os.environ, "PYTHONPATH": os.pathsep.join(paths)},
            preexec_fn=_die_with_parent if sys.platform == "linux" else None,  # noqa: PLW1509 - no thread runs yet
        )
    try:
        yield process
    finally:
        _stop(process)


def _die_with_parent() -> None:
    # So that not even a SIGKILL of ours leaves the child behind.
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGTERM)


def _stop(process: Process) -> None:
    if process.poll() is None:
        process.send_signal(signal.SIGINT)
    try:
        process.wait(STOP_TIMEOUT)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


@contextmanager
def spinning(node: Node) -> Iterator[None]:
    """Have a thread call the node's callbacks while the block runs."""
    executor = SingleThreadedExecutor(context=node.context)
    executor.add_node(node)
    thread = threading.Thread(target=_spin, args=(executor,), name="recorder")
    thread.start()
    try:
        yield
    finally:
        # A thread that still spins when Python ends aborts the process.
        executor.shutdown()
        thread.join()


def _spin(executor: Any) -> None:
    with suppress(ExternalShutdownException):
        executor.spin()
