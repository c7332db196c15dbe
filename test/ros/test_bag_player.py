# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""lane_dp play over real DDS: every message arrives, in time, byte for byte."""

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy, qos_profile_sensor_data
from rclpy.serialization import deserialize_message
from rosbags.interfaces import Qos, QosDurability, QosHistory, QosLiveliness, QosReliability, QosTime
from rosbags.rosbag2 import Writer
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import CameraInfo, Image

from lane_dp_ros.messages.bag import BagReader, BagWriter, bag_message
from lane_dp_ros.messages.bag_message import typestore
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.messages.topic_choice import TopicChoice
from lane_dp_ros.ros.bag_player import BagPlayer, play, ros_node
from lane_dp_ros.ros.recorded_qos import offered_qos

ROOT = Path(__file__).resolve().parents[2]
COMMAND = [sys.executable, "-m", "lane_dp_ros.tools.cli", "play"]
RELIABLE = QoSProfile(depth=100, reliability=ReliabilityPolicy.RELIABLE)
TOPICS = {"left/image_rect": Image, "right/image_rect": Image, "left/camera_info": CameraInfo}


class Listener:
    """Keeps what comes on the given topics, with its time of arrival."""

    def __init__(self, topics: dict, qos: QoSProfile) -> None:
        self.arrived: dict[str, list[tuple[float, bytes]]] = {topic: [] for topic in topics}
        self.context = Context()
        rclpy.init(context=self.context)
        self.node = Node("listener", context=self.context)
        for topic, message in topics.items():
            self.node.create_subscription(message, topic, self._keep(topic), qos, raw=True)
        self._executor = SingleThreadedExecutor(context=self.context)
        self._executor.add_node(self.node)
        self._thread = threading.Thread(target=self._executor.spin)
        self._thread.start()

    def _keep(self, topic: str):
        return lambda data: self.arrived[topic].append((time.monotonic(), data))

    def close(self) -> None:
        self._executor.shutdown()
        self._thread.join()
        self.node.destroy_node()
        self.context.try_shutdown()

    def wait_for(self, topic: str, count: int, timeout: float = 15.0) -> None:
        end = time.monotonic() + timeout
        while len(self.arrived[topic]) < count:
            assert time.monotonic() < end, f"{len(self.arrived[topic])} of {count} messages on {topic}"
            time.sleep(0.01)


@pytest.fixture
def listen() -> Iterator:
    listeners: list[Listener] = []

    def make(topics: dict, qos: QoSProfile = RELIABLE) -> Listener:
        listeners.append(Listener(topics, qos))
        return listeners[-1]

    yield make
    for listener in listeners:
        listener.close()


@pytest.mark.parametrize("storage", ["mcap", "sqlite3"])
@pytest.mark.parametrize("qos", [RELIABLE, qos_profile_sensor_data], ids=["reliable", "best effort"])
def test_every_message_arrives_byte_for_byte(listen, write_stereo_bag, small_pairs, storage, qos) -> None:
    bag = write_stereo_bag(small_pairs, storage=storage)
    listener = listen(TOPICS, qos)
    with BagReader(bag) as reader:
        assert play(reader, rate=1.0, loop=False, ros_args=[]) == 20
        sent = {topic: [raw.data for raw in reader.raw_messages([f"/{topic}"])] for topic in TOPICS}
    for topic in TOPICS:
        listener.wait_for(topic, 5, timeout=2.0)
        assert [data for _, data in listener.arrived[topic]] == sent[topic]


@pytest.mark.parametrize("rate", [0.25, 1.0])
def test_time_passes_as_recorded(listen, write_stereo_bag, small_pairs, rate) -> None:
    listener = listen(TOPICS)
    with BagReader(write_stereo_bag(small_pairs)) as reader:
        play(reader, rate=rate, loop=False, ros_args=[])
    times = [arrived for arrived, _ in listener.arrived["left/image_rect"]]
    assert times[-1] - times[0] == pytest.approx(0.08 / rate, abs=0.06)


def test_namespace_and_remaps_are_honoured(listen, write_stereo_bag, small_pairs) -> None:
    listener = listen({"/car/left/image_rect": Image, "/car/eye": Image})
    arguments = ["--ros-args", "-r", "__ns:=/car", "-r", "right/image_rect:=eye"]
    with BagReader(write_stereo_bag(small_pairs)) as reader:
        play(reader, rate=1.0, loop=False, ros_args=arguments)
    listener.wait_for("/car/left/image_rect", 5)
    listener.wait_for("/car/eye", 5)


def write_unknown_type(path: Path) -> Path:
    with Writer(path, version=9) as writer:
        for name in ("no_such_msgs/msg/Thing", "std_msgs/msg/NoSuchName", "no_such_msgs/srv/Thing"):
            topic = f"/{name.rpartition('/')[2]}{name.count('srv')}"
            connection = writer.add_connection(topic, name, msgdef="int32 data", rihs01="RIHS01_0")
            writer.write(connection, 1, b"\0\1\0\0\7\0\0\0")
    return path


def test_types_that_are_not_installed_are_left_out(tmp_path) -> None:
    message = r"nothing to play: its topics are .*\(no_such_msgs/msg/Thing\)"
    bag = write_unknown_type(tmp_path / "odd")
    with BagReader(bag) as reader, pytest.raises(CommandError, match=message):
        play(reader, rate=1.0, loop=False, ros_args=[])


def test_a_bag_without_anything_to_play(tmp_path) -> None:
    with BagWriter(tmp_path / "empty"):
        pass
    with BagReader(tmp_path / "empty") as reader, pytest.raises(CommandError, match="nothing to play"):
        play(reader, rate=1.0, loop=False, ros_args=[])


def test_names_that_ros_does_not_have_are_left_out(listen, tmp_path) -> None:
    with BagWriter(tmp_path / "bag") as writer:
        for topic in ("/1st topic", "/a-b/info", "/left/camera_info"):
            writer.write(topic, 1, bag_message("sensor_msgs/msg/CameraInfo", width=7))
    listener = listen({"left/camera_info": CameraInfo})
    with BagReader(tmp_path / "bag") as reader:
        assert play(reader, 1.0, False, []) == 1
    listener.wait_for("left/camera_info", 1)


@pytest.mark.parametrize(
    ("ros_args", "message"),
    [
        (["--ros-args", "-r", "no rule"], "Couldn't parse remap rule"),
        (["--ros-args", "--no-such-option"], "no-such-option"),
        (["--ros-args", "-r", "__node:=1st"], "Couldn't parse remap rule"),
    ],
)
def test_bad_ros_arguments_are_a_known_error(write_stereo_bag, small_pairs, ros_args, message) -> None:
    with (
        BagReader(write_stereo_bag(small_pairs)) as reader,
        pytest.raises(CommandError, match=f"^ROS does not start: .*{message}") as caught,
    ):
        play(reader, 1.0, False, ros_args)
    assert ".c:" not in str(caught.value)  # the place in ROS's sources


def test_the_slowest_rate_waits(listen, write_stereo_bag, small_pairs) -> None:
    """Until the second pair, which is not to come for ages; time.sleep refuses so long a time."""
    bag = write_stereo_bag(small_pairs)
    listener = listen({"left/image_rect": Image})
    process = subprocess.Popen([*COMMAND, str(bag), "--rate", "1e-300"], cwd=ROOT, stderr=subprocess.PIPE)
    listener.wait_for("left/image_rect", 1)
    time.sleep(0.5)
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=20)
    assert (process.returncode, said) == (130, b"")
    assert len(listener.arrived["left/image_rect"]) == 1


def test_loop_until_interrupted(listen, write_stereo_bag, small_pairs) -> None:
    listener = listen({"left/image_rect": Image})
    command = [*COMMAND, str(write_stereo_bag(small_pairs)), "--loop"]
    process = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        listener.wait_for("left/image_rect", 12)
        process.send_signal(signal.SIGINT)
        output = process.communicate(timeout=10)
    finally:
        process.kill()
        process.wait()
    assert process.returncode == 130
    assert output == ("", "")


def test_without_a_subscription_it_warns_and_plays(write_stereo_bag, small_pairs) -> None:
    command = [*COMMAND, str(write_stereo_bag(small_pairs)), "--ros-args", "-r", "__ns:=/nobody"]
    result = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=60, check=True)
    assert "nobody subscribed within 5 s" in result.stderr
    assert "20 messages played" in result.stdout


@pytest.mark.parametrize("given", ["", "/my/own.xml"])
def test_it_takes_the_users_dds_profile_or_else_the_packages(given: str) -> None:
    code = "from lane_dp_ros.messages.dds_profile import *; use_dds_profile(); print(os.environ[VARIABLE])"
    environment = {**os.environ, "FASTRTPS_DEFAULT_PROFILES_FILE": given}
    command = [sys.executable, "-c", code]
    result = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=True)
    used = Path(result.stdout.strip())
    if given:
        assert used == Path(given)
    else:
        assert used.read_text() == (ROOT / "config/fastdds_big_images.xml").read_text()


def write_with_offers(path: Path, *offers: Qos, topic: str = "/left/camera_info") -> Path:
    with Writer(path, version=9) as writer:
        name = "sensor_msgs/msg/CameraInfo"
        connection = writer.add_connection(
            topic, name, typestore=typestore(), offered_qos_profiles=list(offers)
        )
        for width in range(5):
            data = typestore().serialize_cdr(bag_message(name, width=width), name)
            writer.write(connection, 10**9 + width * 10**8, bytes(data))
    return path


NONE = QosTime(0, 0)


def offer(reliability: str, durability: str, lifespan: QosTime = NONE) -> Qos:
    return Qos(
        QosHistory.KEEP_LAST,
        1,
        QosReliability[reliability],
        QosDurability[durability],
        QosTime(2**31 - 1, 4294967295),
        lifespan,
        QosLiveliness.AUTOMATIC,
        QosTime(0, 0),
        False,
    )


BEST_EFFORT, LATCHED = offer("BEST_EFFORT", "VOLATILE"), offer("RELIABLE", "TRANSIENT_LOCAL")


@pytest.mark.parametrize(
    ("offers", "reliability", "durability"),
    [
        ([], "RELIABLE", "VOLATILE"),
        ([BEST_EFFORT], "BEST_EFFORT", "VOLATILE"),
        ([LATCHED], "RELIABLE", "TRANSIENT_LOCAL"),
        ([LATCHED, BEST_EFFORT], "RELIABLE", "VOLATILE"),
        ([offer("UNKNOWN", "UNKNOWN")], "RELIABLE", "VOLATILE"),
    ],
)
def test_each_topic_is_offered_as_it_was_recorded(tmp_path, listen, offers, reliability, durability) -> None:
    listener = listen({})
    with (
        BagReader(write_with_offers(tmp_path / "bag", *offers)) as reader,
        ros_node("bag_player") as node,
    ):
        BagPlayer(node, reader)
        end = time.monotonic() + 10
        while not (found := listener.node.get_publishers_info_by_topic("/left/camera_info")):
            assert time.monotonic() < end
            time.sleep(0.05)
    assert [(info.qos_profile.reliability.name, info.qos_profile.durability.name) for info in found] == [
        (reliability, durability)
    ]


def test_recorded_times_are_offered_unless_they_mean_none() -> None:
    qos = offered_qos([offer("RELIABLE", "VOLATILE", QosTime(2, 500_000_000))])
    assert (qos.lifespan.nanoseconds, qos.deadline.nanoseconds) == (2_500_000_000, 0)


def test_a_latched_topic_reaches_who_comes_late(tmp_path, listen) -> None:
    bag = write_with_offers(tmp_path / "bag", LATCHED)
    with BagReader(bag) as reader, ros_node("bag_player") as node:
        BagPlayer(node, reader).play(rate=100.0)
        late = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        listener = listen({"left/camera_info": CameraInfo}, late)
        listener.wait_for("left/camera_info", 1)


@pytest.mark.parametrize("own_clock", [False, True])
def test_the_clock_runs_with_the_bag(tmp_path, listen, own_clock) -> None:
    bag = write_with_offers(tmp_path / "bag", topic="/clock" if own_clock else "/left/camera_info")
    listener = listen({"/clock": Clock})
    with BagReader(bag) as reader:
        if own_clock:  # its topic of that name is left out
            with pytest.raises(CommandError, match="nothing to play"):
                play(reader, 1.0, False, [], clock=True)
            return
        play(reader, rate=0.5, loop=False, ros_args=[], clock=True)
    read = [(arrived, deserialize_message(data, Clock).clock) for arrived, data in listener.arrived["/clock"]]
    times = [(arrived, clock.sec + clock.nanosec / 1e9) for arrived, clock in read]
    assert len(times) == pytest.approx(0.8 * 40, abs=8)  # 0.4 s at half the speed, 40 Hz
    assert times[0][1] == pytest.approx(1.0, abs=0.02)
    assert times[-1][1] == pytest.approx(1.4, abs=0.04)
    passed = (times[-1][1] - times[0][1]) / (times[-1][0] - times[0][0])
    assert passed == pytest.approx(0.5, abs=0.1)


def test_named_topics_are_played_as_those_of_the_node(
    tmp_path, listen, write_stereo_bag, small_pairs
) -> None:
    with BagReader(write_stereo_bag(small_pairs)) as reader, BagWriter(tmp_path / "two") as writer:
        for topic, time_ns, message in reader.messages():
            writer.write(f"/a{topic}", time_ns, message)
            writer.write(f"/b{topic}", time_ns, message)
            writer.write(topic, time_ns, message)
    listener = listen({**TOPICS, "b/left/image_rect": Image})
    with BagReader(tmp_path / "two", TopicChoice(camera="/a")) as reader:
        assert play(reader, 1.0, False, []) == 40
    for topic in ("left/image_rect", "left/camera_info", "b/left/image_rect"):
        listener.wait_for(topic, 5, timeout=2.0)
        assert len(listener.arrived[topic]) == 5  # the topic of that name in the bag is left out
