# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Lanes and road edges to markers and back, on rclpy's own messages."""

import numpy as np
import pytest
from builtin_interfaces.msg import Time
from hypothesis import given, settings
from hypothesis import strategies as st
from rclpy.serialization import deserialize_message, serialize_message
from std_msgs.msg import Header
from visualization_msgs.msg import MarkerArray

from lane_dp_ros.core.types import Lane
from lane_dp_ros.messages.bag_message import bag_message
from lane_dp_ros.messages.lanes import lanes_from_ros, lanes_to_ros, road_edges_to_ros
from lane_dp_ros.ros.rclpy_message import rclpy_message

HEADER = Header(stamp=Time(sec=12, nanosec=345), frame_id="left_optical")


def lane(points, role="other", id=3, confidence=0.75, paint=("", "", None)):
    return Lane(np.asarray(points, float), confidence, 0.125, role, 0.0, 0.0, id, *paint)


def road_edge(points, role="other", id=3, confidence=0.75):
    return Lane(np.asarray(points, float), confidence, 0.0, role, 0.0, 0.0, id, "edge")


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


def test_kind_and_colour_are_the_text():
    white = lane(STRAIGHT, paint=("dashed", "white", None))
    _, line, unknown = lanes_to_ros((white, lane(STRAIGHT)), HEADER, rclpy_message, 0.5).markers
    assert (line.text, unknown.text) == ("dashed white", "")


@pytest.mark.parametrize(
    ("role", "namespace"),
    [("ego_left", "road_edge_left"), ("ego_right", "road_edge_right"), ("other", "road_edge")],
)
def test_road_edges_have_the_form_of_lanes(role, namespace):
    msg = road_edges_to_ros((road_edge(STRAIGHT, role),), HEADER, rclpy_message, lifetime=0.3)
    clear, line = msg.markers
    assert (clear.action, clear.ns, clear.header) == (clear.DELETEALL, "road_edges", HEADER)
    assert (line.action, line.type, line.ns, line.id) == (line.ADD, line.LINE_STRIP, namespace, 3)
    assert (line.header, line.pose.orientation.w, line.text) == (HEADER, 1.0, "edge")
    assert line.scale.x > 0  # else RViz shows nothing
    colour = (line.color.r, line.color.g, line.color.b, line.color.a)
    assert colour == pytest.approx((0.8, 0.3, 0.9, 0.75))
    assert (line.lifetime.sec, line.lifetime.nanosec) == (0, 300_000_000)
    assert [[p.x, p.y, p.z] for p in line.points] == STRAIGHT


def test_no_road_edge_is_one_message_that_clears():
    msg = road_edges_to_ros((), HEADER, rclpy_message, lifetime=0.5)
    assert [(m.action, m.ns) for m in msg.markers] == [(3, "road_edges")]
    assert lanes_from_ros(msg) == ()


def test_the_text_of_another_writer_tells_no_kind():
    msg = lanes_to_ros((lane(STRAIGHT, paint=("solid", "white", None)),), HEADER, rclpy_message, 0.5)
    msg.markers[1].text = "a solid white line"
    (got,) = lanes_from_ros(msg)
    assert (got.kind, got.colour, got.sides, got.id) == ("", "", None, 3)


def test_shape_of_received_lanes_comes_from_their_points():
    z = np.linspace(5, 30, 60)
    curved = np.column_stack([1.7 + 0.02 * z + 0.0025 * z**2, np.full_like(z, 1.65), z])
    (got,) = lanes_from_ros(lanes_to_ros((lane(curved),), HEADER, rclpy_message, 0.5))
    assert got.lateral_offset == pytest.approx(1.7)
    assert got.curvature == pytest.approx(2 * 0.0025, rel=1e-3)


coordinate = st.floats(-100, 100)
common = {
    "points": st.lists(st.tuples(coordinate, coordinate, coordinate), min_size=1, max_size=4),
    "role": st.sampled_from(["ego_left", "ego_right", "other"]),
    "id": st.integers(0, 2**31 - 1),
    "confidence": st.floats(2**-10, 1, width=32),
}
colour = st.sampled_from(["white", "yellow", ""])
side = st.sampled_from(["solid", "dashed", ""])
paint = st.one_of(
    st.tuples(st.sampled_from(["solid", "dashed", ""]), colour, st.none()),
    st.tuples(st.just("double"), colour, st.tuples(side, side)),
)
lanes = st.lists(st.builds(lane, **common, paint=paint), max_size=4)
road_edges = st.lists(st.builds(road_edge, **common), max_size=4)


def told(line):
    """All that a message carries of a line but its points."""
    return line.role, line.id, line.confidence, line.paint_width, line.kind, line.colour, line.sides


def assert_received(received, sent):
    assert list(map(told, received)) == list(map(told, sent))
    for a, b in zip(received, sent, strict=True):
        np.testing.assert_array_equal(a.points, b.points)


@settings(deadline=None)
@given(lanes)
def test_lanes_round_trip_over_the_wire(sent):
    wire = serialize_message(lanes_to_ros(tuple(sent), HEADER, rclpy_message, lifetime=0.5))
    assert_received(lanes_from_ros(deserialize_message(wire, MarkerArray)), sent)


@settings(deadline=None)
@given(road_edges)
def test_road_edges_round_trip_over_the_wire(sent):
    wire = serialize_message(road_edges_to_ros(tuple(sent), HEADER, rclpy_message, lifetime=0.5))
    assert_received(lanes_from_ros(deserialize_message(wire, MarkerArray)), sent)


def test_road_edges_round_trip_in_the_messages_of_a_bag():
    stamp = bag_message("builtin_interfaces/msg/Time", sec=12, nanosec=345)
    header = bag_message("std_msgs/msg/Header", stamp=stamp, frame_id="left_optical")
    sent = (road_edge(STRAIGHT, "ego_left", 5, 0.5), road_edge(STRAIGHT, "other", 6, 0.25))
    assert_received(lanes_from_ros(road_edges_to_ros(sent, header, bag_message, 0.5)), sent)
