# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Lanes to visualization_msgs/MarkerArray, and back."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.types import Lane
from lane_dp_ros.messages.make import Make

# Marker constants of visualization_msgs/msg/Marker.
LINE_STRIP, ADD, DELETEALL = 4, 0, 3
NAMESPACE_OF_ALL = "lanes"
COLOURS = {"ego_left": (0.1, 0.9, 0.2), "ego_right": (0.1, 0.5, 1.0), "other": (1.0, 0.8, 0.1)}


def lanes_to_ros(lanes: tuple[Lane, ...], header: Any, make: Make, lifetime: float) -> Any:
    """Return lanes as visualization_msgs/MarkerArray: DELETEALL, then one LINE_STRIP for each lane.

    `header` is the left image's; `lifetime` [s] is how long a viewer keeps them.
    """
    clear = make("visualization_msgs/msg/Marker", header=header, ns=NAMESPACE_OF_ALL, action=DELETEALL)
    seconds, fraction = divmod(float(lifetime), 1.0)
    duration = make("builtin_interfaces/msg/Duration", sec=int(seconds), nanosec=int(fraction * 1e9))
    markers = [_marker(lane, header, make, duration) for lane in lanes]
    return make("visualization_msgs/msg/MarkerArray", markers=[clear, *markers])


def _marker(lane: Lane, header: Any, make: Make, lifetime: Any) -> Any:
    red, green, blue = COLOURS[lane.role]
    return make(
        "visualization_msgs/msg/Marker",
        header=header,
        ns=lane.role,
        id=int(lane.id),
        type=LINE_STRIP,
        action=ADD,
        pose=make("geometry_msgs/msg/Pose", orientation=make("geometry_msgs/msg/Quaternion", w=1.0)),
        scale=make("geometry_msgs/msg/Vector3", x=float(lane.paint_width)),
        color=make("std_msgs/msg/ColorRGBA", r=red, g=green, b=blue, a=float(lane.confidence)),
        lifetime=lifetime,
        points=[make("geometry_msgs/msg/Point", x=x, y=y, z=z) for x, y, z in lane.points.tolist()],
    )


def lanes_from_ros(marker_array: Any) -> tuple[Lane, ...]:
    """Return the lanes of a visualization_msgs/MarkerArray, as `lanes_to_ros` wrote them.

    A message does not carry `curvature` and `lateral_offset`: they come from a parabola x(z) fitted to
    the points.
    """
    strips = (m for m in marker_array.markers if m.action == ADD and m.type == LINE_STRIP and m.points)
    return tuple(_lane(marker) for marker in strips)


def _lane(marker: Any) -> Lane:
    points = np.array([[p.x, p.y, p.z] for p in marker.points])
    curvature, lateral_offset = _shape(points)
    return Lane(
        points=points,
        confidence=float(marker.color.a),
        paint_width=float(marker.scale.x),
        role=marker.ns if marker.ns in COLOURS else "other",
        curvature=curvature,
        lateral_offset=lateral_offset,
        id=int(marker.id),
    )


def _shape(points: NDArray[np.float64]) -> tuple[float, float]:
    """Return curvature [1/m] and x [m], both at z = 0, of the parabola x(z) nearest to `points` (N, 3)."""
    x, z = points[:, 0], points[:, 2]
    powers = np.column_stack([z**2 / 2, z, np.ones_like(z)])
    (second, slope, offset), *_ = np.linalg.lstsq(powers, x, rcond=None)
    return float(second / (1 + slope**2) ** 1.5), float(offset)
