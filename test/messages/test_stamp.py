# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Stamps to nanoseconds and back, on rclpy's own messages."""

import pytest
from builtin_interfaces.msg import Time

from lane_dp_ros.messages.stamp import stamp_from_ros, stamp_to_ros
from lane_dp_ros.ros.rclpy_message import rclpy_message


def test_a_stamp_is_its_seconds_and_nanoseconds():
    assert stamp_from_ros(Time(sec=12, nanosec=345)) == 12_000_000_345


@pytest.mark.parametrize("stamp_ns", [0, 999_999_999, 1_000_000_000, (2**31 - 1) * 10**9 + 5])
def test_stamp_round_trip(stamp_ns):
    assert stamp_from_ros(stamp_to_ros(stamp_ns, rclpy_message)) == stamp_ns
