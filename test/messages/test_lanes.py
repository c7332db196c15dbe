# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Lanes to markers and back, on rclpy's own messages."""

import numpy as np
import pytest
from builtin_interfaces.msg import Time
from hypothesis import given, settings
from hypothesis import strategies as st
from rclpy.serialization import deserialize_message, serialize_message
from std_msgs.msg import Header
from visualization_msgs.msg import MarkerArray

from lane_dp_ros.core.types import Lane
from lane_dp_ros.messages.lanes import lanes_from_ros, lanes_to_ros
from lane_dp_ros.ros.rclpy_message import rclpy_message

HEADER = Header(stamp=Time(sec=12, nanosec=345), frame_id="left_optical")


def lane(points, role="other", id=3, confidence=0.75):
    return Lane(np.asarray(points, float), confidence, 0.125, role, 0.0, 0.0, id)


STRAIGHT = [[1.5, 1.65, 6.0], [1.5, 1.6, 6.5], [1.5, 1.55, 7.0]]


def test_markers_are_what_the_interface_promises():
    msg = lanes_to_ros((lane(STRAIGHT, "ego_right"),), HEADER, rclpy_message, lifetime=0.3)
    clear, line = msg.markers
    assert (clear.action, clear.ns, clear.header) == (clear.DELETEALL, "lanes", HEADER)
    assert (line.action, line.type, line.ns, line.id) == (line.ADD, line.LINE_STRIP, "ego_right", 3)
    assert (line.header, line.scale.x, line.pose.orientation.w) == (HEADER, 0.125, 1.0)
    assert line.color.a == 0.75
    assert (line.lifetime.sec, line.lifetime.nanosec) == (0, 300_000_000)
    assert [[p.x, p.y, p.z] for p in line.points] == STRAIGHT


def test_no_lane_is_one_message_that_clears():
    msg = lanes_to_ros((), HEADER, rclpy_message, lifetime=0.5)
    assert [m.action for m in msg.markers] == [3]
    assert lanes_from_ros(msg) == ()


def test_shape_of_received_lanes_comes_from_their_points():
    z = np.linspace(5, 30, 60)
    curved = np.column_stack([1.7 + 0.02 * z + 0.0025 * z**2, np.full_like(z, 1.65), z])
    (got,) = lanes_from_ros(lanes_to_ros((lane(curved),), HEADER, rclpy_message, 0.5))
    assert got.lateral_offset == pytest.approx(1.7)
    assert got.curvature == pytest.approx(2 * 0.0025, rel=1e-3)


coordinate = st.floats(-100, 100)
lanes = st.lists(
    st.builds(
        lane,
        points=st.lists(st.tuples(coordinate, coordinate, coordinate), min_size=1, max_size=4),
        role=st.sampled_from(["ego_left", "ego_right", "other"]),
        id=st.integers(0, 2**31 - 1),
        confidence=st.floats(2**-10, 1, width=32),
    ),
    max_size=4,
)


@settings(deadline=None)
@given(lanes)
def test_lanes_round_trip_over_the_wire(sent):
    wire = serialize_message(lanes_to_ros(tuple(sent), HEADER, rclpy_message, lifetime=0.5))
    received = lanes_from_ros(deserialize_message(wire, MarkerArray))
    assert [(a.role, a.id, a.confidence, a.paint_width) for a in received] == [
        (a.role, a.id, a.confidence, a.paint_width) for a in sent
    ]
    for a, b in zip(received, sent, strict=True):
        np.testing.assert_array_equal(a.points, b.points)
