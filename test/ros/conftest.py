# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""A running lane detector node with a stereo camera before it and a listener behind it, all over real DDS."""

import os
from pathlib import Path

# ruff: noqa: E402
# Before any ROS import: the DDS profile, without which images get lost between processes.
PROFILE = Path(__file__).resolve().parents[2] / "config" / "fastdds_big_images.xml"
os.environ.setdefault("FASTRTPS_DEFAULT_PROFILES_FILE", str(PROFILE))

import threading
import time

import pytest
import rclpy
from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import CameraInfo, Image
from std_msgs.msg import Header
from visualization_msgs.msg import MarkerArray

from lane_dp_ros.messages.image import image_to_ros
from lane_dp_ros.messages.lanes import lanes_from_ros
from lane_dp_ros.ros import lane_detector_node
from lane_dp_ros.ros.lane_detector_node import LaneDetectorNode
from lane_dp_ros.ros.rclpy_message import rclpy_message
from lane_dp_ros.scenes import CAMERA, SIZE

SIDES = ("left", "right")
DEADLINE = 15.0  # s
FRAME_NS = 100_000_000
REPORT_PERIOD = 0.2  # s; a node in a process of its own keeps its second


@pytest.fixture(scope="session")
def scene_pair(scene_pairs):
    """A rendered road with lanes, as the left and the right image (BGR)."""
    return scene_pairs[0].left, scene_pairs[0].right


def projections(scale=1.0):
    """P of the scene's left and right camera, 12 values each; the images may be scaled."""
    left = CAMERA.P_left
    left[:2] *= scale
    right = left.copy()
    right[0, 3] -= left[0, 0] * CAMERA.baseline
    return left.ravel().tolist(), right.ravel().tolist()


class Rig:
    """A camera, a listener and the node, unless that runs elsewhere; every wait has a deadline."""

    def __init__(self, scene_pair, with_node=True, cli_args=None, namespace="", **node_options):
        self.scene_pair = scene_pair
        self.stamp_ns = 1_000_000_000
        self.frame_ns = FRAME_NS
        self.context = Context()
        rclpy.init(context=self.context)
        options = {"context": self.context, "cli_args": cli_args, "namespace": namespace}
        self.node = LaneDetectorNode(**options, **node_options) if with_node else None
        self.other = Node("other", **options)
        self._nodes = [self.node, self.other] if with_node else [self.other]
        self.arrays, self.edge_arrays, self.statuses = [], [], []
        self._listened = [
            self.listen(MarkerArray, "lanes", self.arrays.append),
            self.listen(MarkerArray, "road_edges", self.edge_arrays.append),
            self.listen(DiagnosticArray, "/diagnostics", lambda msg: self.statuses.extend(msg.status)),
        ]
        self.image_publishers = self._publishers(Image, "image_rect")
        self.info_publishers = self._publishers(CameraInfo, "camera_info")
        self._executor = SingleThreadedExecutor(context=self.context)
        for node in self._nodes:
            self._executor.add_node(node)
        self._thread = threading.Thread(target=self._executor.spin)
        self._thread.start()

    def wait_until_connected(self):
        self.wait(lambda: all(subscription.get_publisher_count() for subscription in self._listened))
        self.wait_for_subscriptions([*self.image_publishers.values(), *self.info_publishers.values()])

    def _publishers(self, message, name):
        return {side: self.other.create_publisher(message, f"{side}/{name}", 10) for side in SIDES}

    def listen(self, message, topic, callback):
        return self.other.create_subscription(message, topic, callback, 100)

    def close(self):
        self._executor.shutdown()
        self._thread.join()
        for node in self._nodes:
            node.destroy_node()
        self.context.try_shutdown()

    def wait(self, condition, timeout=DEADLINE):
        """Poll until `condition()` holds and return what it gave."""
        end = time.monotonic() + timeout
        while not (result := condition()):
            if time.monotonic() > end:
                said = sorted({f"{status.level!r} {status.message}" for status in self.statuses})
                pytest.fail(f"not within {timeout} s; diagnostics so far: {said}")
            time.sleep(0.005)
        return result

    def wait_for_subscriptions(self, publishers):
        self.wait(lambda: all(publisher.get_subscription_count() for publisher in publishers))

    def header(self, stamp_ns):
        return Header(stamp=Time(sec=stamp_ns // 10**9, nanosec=stamp_ns % 10**9), frame_id="left_optical")

    def image(self, pixels, stamp_ns=0):
        return image_to_ros(pixels, self.header(stamp_ns), rclpy_message)

    def send_infos(self, left=None, right=None, size=SIZE):
        default = projections()
        for side, P in zip(SIDES, (left or default[0], right or default[1]), strict=True):
            self.info_publishers[side].publish(CameraInfo(width=size[0], height=size[1], p=P))

    def next_stamp(self):
        self.stamp_ns += self.frame_ns
        return self.stamp_ns

    def send(self, left=None, right=None, stamp_ns=None):
        """Publish two images, messages or pixels, by default of the scene; return their stamp [ns]."""
        stamp_ns = stamp_ns or self.next_stamp()
        for side, given, default in zip(SIDES, (left, right), self.scene_pair, strict=True):
            message = given if isinstance(given, Image) else self.image(default if given is None else given)
            message.header = self.header(stamp_ns)
            self.image_publishers[side].publish(message)
        return stamp_ns

    def answers(self, stamp_ns, arrays=None):
        """The messages so far, on `lanes` unless others are given, that answer the pair of that stamp."""
        stamp, arrays = self.header(stamp_ns).stamp, self.arrays if arrays is None else arrays
        return [array for array in arrays if array.markers[0].header.stamp == stamp]

    def answer(self, stamp_ns):
        """The lanes that answer the pair of that stamp; waits for them."""
        array = self.wait(lambda: self.answers(stamp_ns))[0]
        assert (array.markers[0].action, array.markers[0].ns) == (3, "lanes")
        return lanes_from_ros(array)

    def edge_answer(self, stamp_ns):
        """The message on `road_edges` that answers the pair of that stamp; waits for it."""
        (array,) = self.wait(lambda: self.answers(stamp_ns, self.edge_arrays))
        assert (array.markers[0].action, array.markers[0].ns) == (3, "road_edges")
        return array

    def warm_up(self):
        """Send until the first answer: a node in another process may not have found this camera yet."""

        def answered():
            self.send_infos()
            self.send()
            return self.arrays

        self.wait(answered)

    def assert_lives(self):
        """A good pair, with its CameraInfo, is answered with lanes."""
        self.send_infos()
        assert {"ego_left", "ego_right"} <= {lane.role for lane in self.answer(self.send())}
        self.assert_one_answer_each()

    def assert_one_answer_each(self):
        for arrays in (self.arrays, self.edge_arrays):
            stamps = [(m.markers[0].header.stamp.sec, m.markers[0].header.stamp.nanosec) for m in arrays]
            assert len(stamps) == len(set(stamps))

    def diagnosis(self, text, level):
        """The first status with that text in its message; waits for it."""
        status = self.wait(lambda: next((s for s in self.statuses if text in s.message), None))
        assert status.level == level
        return {entry.key: entry.value for entry in status.values}


@pytest.fixture
def make_rig(scene_pair, monkeypatch):
    """Return a function that starts a `Rig`; all are closed after the test."""
    monkeypatch.setattr(lane_detector_node, "REPORT_PERIOD", REPORT_PERIOD)
    rigs = []

    def make(**node_options):
        rigs.append(Rig(scene_pair, **node_options))
        rigs[-1].wait_until_connected()
        return rigs[-1]

    yield make
    for rig in rigs:
        rig.close()


@pytest.fixture
def rig(make_rig):
    return make_rig()
