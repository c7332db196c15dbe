# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The example of docs/controller.md: lanes in, the vehicle's place in its lane out, over real DDS."""

import importlib.util
import time
from pathlib import Path

import numpy as np
import pytest
import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Float64, Header
from visualization_msgs.msg import MarkerArray

from lane_dp_ros.core.types import Lane
from lane_dp_ros.messages.lanes import lanes_to_ros
from lane_dp_ros.ros.rclpy_message import rclpy_message

EXAMPLE = Path(__file__).resolve().parents[2] / "docs" / "examples" / "lane_offset.py"
NAMES = ("lateral_offset", "heading", "curvature")
DEADLINE, SILENCE = 10.0, 0.5  # s


def lane(role, c0, c1=0.0, c2=0.0, confidence=0.9):
    """A lane along x = c0 + c1 z + c2 z^2, every half metre from 6 to 30 m."""
    z = np.arange(6.0, 30.0, 0.5)
    points = np.column_stack([c0 + c1 * z + c2 * z**2, np.full(len(z), 1.65), z])
    return Lane(points, confidence, 0.15, role, curvature=2 * c2, lateral_offset=c0)


class Rig:
    """The example's node, something that publishes lanes, and a listener behind it."""

    def __init__(self, module, **parameters):
        self._context = Context()
        rclpy.init(context=self._context)
        overrides = [rclpy.parameter.Parameter(name, value=value) for name, value in parameters.items()]
        self._nodes = [
            module.LaneOffset(context=self._context, parameter_overrides=overrides),
            Node("other", context=self._context),
        ]
        self._executor = SingleThreadedExecutor(context=self._context)
        for node in self._nodes:
            self._executor.add_node(node)
        self.heard = {}
        self._publisher = self._nodes[1].create_publisher(MarkerArray, "lanes", 10)
        for name in NAMES:
            self._nodes[1].create_subscription(
                Float64, f"lane/{name}", lambda msg, name=name: self.heard.update({name: msg.data}), 10
            )
        self.spin_until(lambda: self._publisher.get_subscription_count() and self.is_heard, DEADLINE)

    @property
    def is_heard(self):
        return all(self._nodes[0].count_subscribers(f"lane/{name}") for name in NAMES)

    def spin_until(self, is_done, seconds):
        end = time.monotonic() + seconds
        while not is_done() and time.monotonic() < end:
            self._executor.spin_once(timeout_sec=0.05)
        return is_done()

    def answer(self, *lanes, wait=DEADLINE):
        """Return what comes for a message with these lanes, empty for nothing."""
        self.heard.clear()
        self._publisher.publish(lanes_to_ros(lanes, Header(), rclpy_message, 0.5))
        self.spin_until(lambda: len(self.heard) == len(NAMES), wait)
        return dict(self.heard)

    def close(self):
        self._executor.shutdown()
        for node in self._nodes:
            node.destroy_node()
        self._context.try_shutdown()


@pytest.fixture(scope="module")
def example():
    spec = importlib.util.spec_from_file_location("lane_offset", EXAMPLE)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def rig(example):
    rig = Rig(example, camera_offset=0.1)
    yield rig
    rig.close()


def test_offset_heading_and_curvature_are_those_of_the_lane(rig):
    # The lane's middle lies 0.2 m right of the camera, and that 0.1 m right of the vehicle's middle.
    found = rig.answer(lane("ego_left", -1.55, 0.02, 0.0025), lane("ego_right", 1.95, 0.02, 0.0025))
    assert found["lateral_offset"] == pytest.approx(-0.3, abs=1e-6)
    assert found["heading"] == pytest.approx(0.02, abs=1e-4)
    assert found["curvature"] == pytest.approx(0.005, rel=1e-2)


@pytest.mark.parametrize(
    "lanes",
    [
        (),
        (lane("ego_left", -1.75),),
        (lane("ego_left", -1.75), lane("ego_right", 1.75, confidence=0.4)),
        (lane("ego_left", -1.75), lane("ego_right", 4.0)),
        (lane("other", -1.75), lane("ego_right", 1.75)),
    ],
    ids=["none", "one", "unsure", "too wide", "another's"],
)
def test_a_lane_that_is_not_seen_on_both_sides_is_not_told(rig, lanes):
    assert rig.answer(lane("ego_left", -1.75), lane("ego_right", 1.75))
    assert rig.answer(*lanes, wait=SILENCE) == {}
