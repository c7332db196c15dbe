# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""How the node keeps up with a camera: pairs answered, latency, and what share of a core it takes.

python benchmarks/bench_node.py [-o DIR] [--seconds S] [--rates HZ,HZ]
For each rate, pairs of KITTI's size are published over DDS to a lane_detector process of its own: those of
KITTI's odometry 02 forwards and backwards where they are (the data folder is $LANE_DP_DATA, else shared/data
beside the repository), else rendered ones. Prints a table and writes it to node.md. The latency of a pair is
the time from its publishing to the arrival of its lanes here. Publisher and listener run on the same machine.
"""

from __future__ import annotations

import argparse
import importlib
import os
import struct
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from command_line import data_folder, exit_code
from numpy.typing import NDArray

from lane_dp_ros import scenes
from lane_dp_ros.messages.bag_message import bag_message, typestore
from lane_dp_ros.messages.camera import camera_info_to_ros
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.messages.image import image_to_ros
from lane_dp_ros.messages.stamp import stamp_from_ros
from lane_dp_ros.messages.stereo_bag import FRAME_ID, StereoImages
from lane_dp_ros.messages.stereo_sync import SIDES
from lane_dp_ros.tools.cli.ros_module import ros_module
from lane_dp_ros.tools.datasets.kitti import load_pairs, read_odometry
from lane_dp_ros.tools.progress import progress

RATES, SECONDS = (10.0, 20.0, 30.0), 20.0  # Hz, s
DRIVE = "kitti_odometry/sequences/02"
RENDERED, RENDERED_RATE, SEED = 20, 10.0, 1  # pairs, their rate [Hz], the road
QUEUE = 10  # messages
START_TIMEOUT = 30.0  # s until the node has started and answers
WARM_UP_RATE = 5.0  # Hz, until the first answer
ANSWER_TIMEOUT = 1.5  # s without any answer: there are no more, and the node has reported once more
POLL = 0.01  # s
STAMP = struct.Struct("<iI")  # seconds and nanoseconds, the first that stands in a serialised header
STAMP_AT = 4  # bytes; behind what says how the message is serialised
IMAGE, CAMERA_INFO = "sensor_msgs/msg/Image", "sensor_msgs/msg/CameraInfo"
MARKER_ARRAY, DIAGNOSTICS = "visualization_msgs/msg/MarkerArray", "diagnostic_msgs/msg/DiagnosticArray"

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Drive:
    """Pairs of one camera, by their name, to be published again and again."""

    name: str
    pairs: Sequence[StereoImages]
    P_left: Floats
    P_right: Floats

    def messages(self, index: int) -> Iterator[tuple[str, str, bytearray]]:
        """Yield topic, type and bytes of what a camera publishes with a pair, without its stamp."""
        pair = self.pairs[index]
        header = bag_message("std_msgs/msg/Header", frame_id=FRAME_ID)
        for side, P in zip(SIDES, (self.P_left, self.P_right), strict=True):
            info = camera_info_to_ros(P, pair.left.shape, header, bag_message)
            yield f"{side}/camera_info", CAMERA_INFO, serialised(info, CAMERA_INFO)
        for side, image in zip(SIDES, (pair.left, pair.right), strict=True):
            assert image is not None
            yield f"{side}/image_rect", IMAGE, serialised(image_to_ros(image, header, bag_message), IMAGE)


@dataclass(frozen=True)
class Measured:
    """What became of the pairs that were published at a rate [Hz]; latencies in ms, `cpu` in cores.

    `dropped` are those that the node had no time for; the rest without an answer was lost on the way to it.
    """

    rate: float
    published: int
    dropped: int
    latencies: Floats
    cpu: float

    def row(self) -> str:
        """Return a line of the table."""
        answered = len(self.latencies)
        p50, p95 = np.percentile(self.latencies, [50, 95]) if answered else (np.nan, np.nan)
        share = f"{answered} of {self.published} ({answered / self.published:.0%})"
        lost = self.published - answered - self.dropped
        return (
            f"| {self.rate:g} | {share} | {self.dropped} | {lost} | {p50:.0f} | {p95:.0f} | {self.cpu:.0%} |"
        )


HEADS = """\
| Hz | pairs answered | dropped by the node | lost on the way | p50 ms | p95 ms | CPU of the node |
|---|---|---|---|---|---|---|"""


def serialised(message: Any, type_name: str) -> bytearray:
    """Return the CDR of a message, as DDS carries it."""
    return bytearray(typestore().serialize_cdr(message, type_name))


def set_stamp(data: bytearray, stamp_ns: int) -> None:
    """Set the stamp of a serialised message that begins with a header."""
    STAMP.pack_into(data, STAMP_AT, *divmod(stamp_ns, 10**9))


def there_and_back(count: int) -> Iterator[int]:
    """Yield 0, 1, ..., count - 1, ..., 1, 0, ... without end: no jump from the last pair to the first."""
    while True:
        yield from range(count - 1)
        yield from range(count - 1, 0, -1)
        if count == 1:
            yield 0


def drive(data: Path) -> Drive:
    """Return the pairs to publish."""
    folder = data / DRIVE
    if folder.is_dir():
        sequence = read_odometry(folder)
        return Drive("KITTI odometry 02", list(load_pairs(sequence)), sequence.P_left, sequence.P_right)
    rendered = progress(scenes.render_sequence(RENDERED, RENDERED_RATE, SEED), RENDERED, "pair")
    pairs = [StereoImages(pair.stamp_ns, pair.left, pair.right) for pair in rendered]
    P_left, P_right = scenes.CAMERA.P_left, scenes.CAMERA.P_left
    P_right[0, 3] -= scenes.CAMERA.fx * scenes.CAMERA.baseline
    return Drive("rendered", pairs, P_left, P_right)


class Camera:
    """Publishes the pairs of a drive, serialised before; `node` is rclpy's."""

    def __init__(self, node: Any, pairs: Drive) -> None:
        self._messages = [list(pairs.messages(i)) for i in range(len(pairs.pairs))]
        self._indices = there_and_back(len(self._messages))
        self._publishers = {
            topic: node.create_publisher(_message_class(type_name), topic, QUEUE)
            for topic, type_name, _ in self._messages[0]
        }

    def connected(self) -> bool:
        """Return whether somebody listens to each topic."""
        return all(publisher.get_subscription_count() for publisher in self._publishers.values())

    def publish(self, stamp_ns: int) -> None:
        """Publish the next pair, its camera infos first."""
        for topic, _, data in self._messages[next(self._indices)]:
            set_stamp(data, stamp_ns)
            self._publishers[topic].publish(bytes(data))


class Answers:
    """When `lanes` messages came, by their stamps, in ns of the monotonic clock."""

    def __init__(self, node: Any) -> None:
        self._came: list[tuple[int, bytes]] = []
        node.create_subscription(_message_class(MARKER_ARRAY), "lanes", self._take, QUEUE, raw=True)

    def __len__(self) -> int:
        return len(self._came)

    def _take(self, data: bytes) -> None:
        self._came.append((time.monotonic_ns(), data))

    def by_stamp(self) -> dict[int, int]:
        """Return when each pair was answered."""
        arrays: list[Any] = [typestore().deserialize_cdr(data, MARKER_ARRAY) for _, data in self._came]
        stamps = [stamp_from_ros(array.markers[0].header.stamp) for array in arrays]
        return dict(zip(stamps, (when for when, _ in self._came), strict=True))


class Reports:
    """How many pairs a node has dropped, by its last report."""

    def __init__(self, node: Any) -> None:
        self.dropped = 0
        self._name = node.get_namespace()
        node.create_subscription(_message_class(DIAGNOSTICS), "/diagnostics", self._take, QUEUE)

    def _take(self, array: Any) -> None:
        for status in array.status:
            if status.name.startswith(self._name):
                values = {each.key: each.value for each in status.values}
                self.dropped = int(values.get("pairs dropped", self.dropped))


def measure(pairs: Drive, rate: float, seconds: float, log: Path) -> Measured:
    """Publish pairs to a new lane_detector process, `rate` of them a second."""
    session, player = ros_module("demo_session"), ros_module("bag_player")
    namespace = f"/lane_dp_bench_{os.getpid()}"
    with session.detector_process(namespace, log) as process, player.ros_node("camera", namespace) as node:
        camera, answers, reports = Camera(node, pairs), Answers(node), Reports(node)
        with session.spinning(node):
            _warm_up(camera, answers, lambda: session.check_alive(process, log))
            dropped, before, start = reports.dropped, cpu_seconds(process.pid), time.monotonic()
            sent = _publish(camera, rate, seconds)
            cpu = (cpu_seconds(process.pid) - before) / (time.monotonic() - start)
            _wait_for_answers(answers)
            session.check_alive(process, log)
    found = latencies(sent, answers.by_stamp())
    return Measured(rate, len(sent), reports.dropped - dropped, found, cpu)


def latencies(sent: dict[int, int], answered: dict[int, int]) -> Floats:
    """Return the ms from sending to answer of the pairs that were answered; times in ns, by stamp."""
    return np.array([(answered[stamp] - when) / 1e6 for stamp, when in sent.items() if stamp in answered])


def cpu_seconds(pid: int) -> float:
    """Return the CPU time of a process so far; NaN on systems without /proc."""
    try:
        stat = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8")
    except FileNotFoundError:
        return float("nan")
    user, system = stat.rpartition(")")[2].split()[11:13]  # fields 14 and 15; the name may hold blanks
    return (int(user) + int(system)) / os.sysconf("SC_CLK_TCK")


def _warm_up(camera: Camera, answers: Answers, check: Any) -> None:
    """Publish until the node answers, then let it finish."""
    deadline = time.monotonic() + START_TIMEOUT
    while not len(answers):
        check()
        if time.monotonic() > deadline:
            raise CommandError(f"lane_detector did not answer within {START_TIMEOUT:g} s")
        if camera.connected():
            camera.publish(time.time_ns())
        time.sleep(1 / WARM_UP_RATE)
    _wait_for_answers(answers)


def _publish(camera: Camera, rate: float, seconds: float) -> dict[int, int]:
    """Publish at a rate; return when each pair was published [ns], by its stamp."""
    count, start, sent = round(rate * seconds), time.monotonic(), {}
    for i in progress(range(count), count, f"pair at {rate:g} Hz"):
        time.sleep(max(0.0, start + i / rate - time.monotonic()))
        stamp_ns = time.time_ns()
        sent[stamp_ns] = time.monotonic_ns()
        camera.publish(stamp_ns)
    return sent


def _wait_for_answers(answers: Answers) -> None:
    count, since = len(answers), time.monotonic()
    while time.monotonic() - since < ANSWER_TIMEOUT:
        time.sleep(POLL)
        if len(answers) > count:
            count, since = len(answers), time.monotonic()


def _message_class(type_name: str) -> Any:
    package, _, name = type_name.split("/")
    return getattr(importlib.import_module(f"{package}.msg"), name)


def run(arguments: argparse.Namespace) -> None:
    """Measure at each rate, print the table, write it."""
    arguments.output.mkdir(parents=True, exist_ok=True)
    pairs = drive(arguments.data)
    log = arguments.output / "lane_detector.log"
    rows = [measure(pairs, rate, arguments.seconds, log).row() for rate in arguments.rates]
    height, width = pairs.pairs[0].left.shape[:2]
    text = "\n".join(
        [
            f"## The node, {pairs.name}, {width}x{height}, {arguments.seconds:g} s at each rate\n",
            HEADS,
            *rows,
            f"\nCPU in parts of a core; the machine has {os.cpu_count()}, which the publisher needs, too.",
        ]
    )
    (arguments.output / "node.md").write_text(f"{text}\n", encoding="utf-8")
    print(text)


def _rates(text: str) -> tuple[float, ...]:
    rates = tuple(map(float, text.split(",")))
    if not all(0 < rate <= 1000 for rate in rates):
        raise argparse.ArgumentTypeError(f"{text}: expected rates of more than 0 and up to 1000 Hz")
    return rates


def _seconds(text: str) -> float:
    seconds = float(text)
    if not 1 <= seconds <= 3600:
        raise argparse.ArgumentTypeError(f"{text}: expected 1 to 3600 s")
    return seconds


def main() -> int:
    """Measure and print; 1 for a known error, in one line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", "--output", type=Path, default=Path("bench"), metavar="DIR")
    parser.add_argument("--seconds", type=_seconds, default=SECONDS, metavar="S", help="default: 20")
    parser.add_argument("--rates", type=_rates, default=RATES, metavar="HZ,HZ", help="default: 10,20,30")
    parser.add_argument("--data", type=Path, default=data_folder(), metavar="DATA")
    return exit_code(run, parser.parse_args())


if __name__ == "__main__":
    sys.exit(main())
