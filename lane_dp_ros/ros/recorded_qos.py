# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The QoS with which a bag's topic is played: what its publishers offered when it was recorded."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rclpy.duration import Duration
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

DEPTH = 100  # messages that wait for a reliable subscription that is slower than the bag
FOREVER = 2**31 - 1  # s; from here on a recorded time means that there is none


def offered_qos(recorded: Sequence[Any]) -> QoSProfile:
    """Return the QoS of a publisher in place of those that offered `recorded` (rosbags.interfaces.Qos).

    Where they differ, or nothing was recorded, it is reliable, volatile and without times: ROS's default.
    """
    qos = QoSProfile(depth=DEPTH, reliability=ReliabilityPolicy.RELIABLE)
    if {each.reliability.name for each in recorded} == {"BEST_EFFORT"}:
        qos.reliability = ReliabilityPolicy.BEST_EFFORT
    if {each.durability.name for each in recorded} == {"TRANSIENT_LOCAL"}:
        qos.durability = DurabilityPolicy.TRANSIENT_LOCAL
        qos.depth = max(1, *(each.depth for each in recorded))  # a late subscription gets so many
    for name in ("deadline", "lifespan"):
        times = {getattr(each, name) for each in recorded}
        if len(times) == 1 and any(time := times.pop()) and time.sec < FOREVER:
            setattr(qos, name, Duration(seconds=time.sec, nanoseconds=time.nsec))
    return qos
