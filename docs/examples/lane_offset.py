# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Where the vehicle stands in its lane, from `lanes`: what a lateral controller starts from.

python3 lane_offset.py --ros-args -p camera_offset:=0.05 -r __ns:=/stereo

Publishes, for each `lanes` message that shows the lane, `lane/lateral_offset` [m] (positive: the vehicle is
right of the lane's middle), `lane/heading` [rad] (positive: the lane leads to the right of where the vehicle
points) and `lane/curvature` [1/m] (positive: a right bend). Nothing is published for a message that does not:
whoever steers by them must stop doing so when they stay away.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Float64
from visualization_msgs.msg import Marker, MarkerArray

EGO = ("ego_left", "ego_right")
LANE_WIDTHS = (2.4, 5.0)  # m; two lines that are nearer or farther do not bound one lane


class LaneState(NamedTuple):
    """The middle of the lane, seen from the vehicle: offset [m], heading [rad], curvature [1/m]."""

    lateral_offset: float
    heading: float
    curvature: float


def line_of(marker: Marker, look_ahead: float) -> np.ndarray | None:
    """Return c0, c1, c2 of x = c0 + c1 z + c2 z^2 through a marker's points up to `look_ahead` [m].

    x is to the right and z ahead of the left camera [m]. None where fewer than three points are that near.
    """
    points = np.array([(point.x, point.z) for point in marker.points if point.z <= look_ahead])
    if len(points) < 3:
        return None
    return np.polynomial.polynomial.polyfit(points[:, 1], points[:, 0], 2)


class LaneOffset(Node):
    """Publishes the lane's state for each `lanes` message that shows the lines on both sides."""

    def __init__(self, **options) -> None:
        super().__init__("lane_offset", **options)
        self._camera_offset = self.declare_parameter("camera_offset", 0.0)  # m right of the vehicle's middle
        self._min_confidence = self.declare_parameter("min_confidence", 0.6)
        self._look_ahead = self.declare_parameter("look_ahead", 20.0)  # m
        self._outputs = [self.create_publisher(Float64, f"lane/{name}", 10) for name in LaneState._fields]
        self.create_subscription(MarkerArray, "lanes", self._on_lanes, 10)

    def _on_lanes(self, message: MarkerArray) -> None:
        state = self._state(message)
        for publisher, value in zip(self._outputs, state or (), strict=False):
            publisher.publish(Float64(data=value))

    def _state(self, message: MarkerArray) -> LaneState | None:
        """Return the state of the lane, None where not both of its lines are seen well."""
        lines = [self._line(message, role) for role in EGO]
        if any(line is None for line in lines):
            return None
        left, right = lines
        if not LANE_WIDTHS[0] <= right[0] - left[0] <= LANE_WIDTHS[1]:
            return None
        c0, c1, c2 = ((left + right) / 2).tolist()
        curvature = 2 * c2 / (1 + c1**2) ** 1.5
        return LaneState(-(c0 + self._camera_offset.value), float(np.arctan(c1)), curvature)

    def _line(self, message: MarkerArray, role: str) -> np.ndarray | None:
        """Return the line of that role, None where there is none that is sure enough."""
        for marker in message.markers:
            if marker.ns == role and marker.action == Marker.ADD:
                sure = marker.color.a >= self._min_confidence.value  # opacity is the confidence
                return line_of(marker, self._look_ahead.value) if sure else None
        return None


def main() -> None:
    """Run until Ctrl-C."""
    rclpy.init()
    try:
        rclpy.spin(LaneOffset())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
