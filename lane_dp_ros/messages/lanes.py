# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Lanes and road edges to visualization_msgs/MarkerArray, and back."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.types import Lane, LaneRole
from lane_dp_ros.messages.make import Make
from lane_dp_ros.messages.paint_text import Paint, paint_from_text, paint_to_text

# Marker constants of visualization_msgs/msg/Marker.
LINE_STRIP, ADD, DELETEALL = 4, 0, 3
RGB = tuple[float, float, float]
COLOURS: dict[LaneRole, RGB] = {
    "ego_left": (0.1, 0.9, 0.2),
    "ego_right": (0.1, 0.5, 1.0),
    "other": (1.0, 0.8, 0.1),
}
ROAD_EDGE_COLOUR: RGB = (0.8, 0.3, 0.9)
ROAD_EDGE_WIDTH = 0.05  # m; it has no paint, but RViz shows no line without a width
ROAD_EDGE_NAMESPACES: dict[LaneRole, str] = {
    "ego_left": "road_edge_left",
    "ego_right": "road_edge_right",
    "other": "road_edge",
}
ROAD_EDGE_ROLES = {namespace: role for role, namespace in ROAD_EDGE_NAMESPACES.items()}


def lane_colour(lane: Lane) -> RGB:
    """Return the colour, red, green and blue in [0, 1], in which a lane or a road edge is shown."""
    return ROAD_EDGE_COLOUR if lane.kind == "edge" else COLOURS[lane.role]


def lanes_to_ros(lanes: tuple[Lane, ...], header: Any, make: Make, lifetime: float) -> Any:
    """Return lanes as visualization_msgs/MarkerArray: DELETEALL, then one LINE_STRIP for each lane.

    `header` is the left image's; `lifetime` [s] is how long a viewer keeps them.
    """
    return _marker_array("lanes", lanes, header, make, lifetime)


def road_edges_to_ros(edges: tuple[Lane, ...], header: Any, make: Make, lifetime: float) -> Any:
    """Return road edges, lanes of kind "edge", in the form of `lanes_to_ros`, all of a nominal width."""
    return _marker_array("road_edges", edges, header, make, lifetime)


def _marker_array(namespace: str, lanes: tuple[Lane, ...], header: Any, make: Make, lifetime: float) -> Any:
    clear = make("visualization_msgs/msg/Marker", header=header, ns=namespace, action=DELETEALL)
    seconds, fraction = divmod(float(lifetime), 1.0)
    duration = make("builtin_interfaces/msg/Duration", sec=int(seconds), nanosec=int(fraction * 1e9))
    markers = [_marker(lane, header, make, duration) for lane in lanes]
    return make("visualization_msgs/msg/MarkerArray", markers=[clear, *markers])


def _marker(lane: Lane, header: Any, make: Make, lifetime: Any) -> Any:
    is_edge = lane.kind == "edge"
    red, green, blue = lane_colour(lane)
    return make(
        "visualization_msgs/msg/Marker",
        header=header,
        ns=ROAD_EDGE_NAMESPACES[lane.role] if is_edge else lane.role,
        id=int(lane.id),
        type=LINE_STRIP,
        action=ADD,
        pose=make("geometry_msgs/msg/Pose", orientation=make("geometry_msgs/msg/Quaternion", w=1.0)),
        scale=make("geometry_msgs/msg/Vector3", x=ROAD_EDGE_WIDTH if is_edge else float(lane.paint_width)),
        color=make("std_msgs/msg/ColorRGBA", r=red, g=green, b=blue, a=float(lane.confidence)),
        lifetime=lifetime,
        points=[make("geometry_msgs/msg/Point", x=x, y=y, z=z) for x, y, z in lane.points.tolist()],
        text=paint_to_text(Paint(lane.kind, lane.colour, lane.sides)),
    )


def lanes_from_ros(marker_array: Any) -> tuple[Lane, ...]:
    """Return the lanes or road edges of a visualization_msgs/MarkerArray, as the functions above wrote them.

    A message does not carry `curvature` and `lateral_offset`: they come from a parabola x(z) fitted to
    the points.
    """
    strips = (m for m in marker_array.markers if m.action == ADD and m.type == LINE_STRIP and m.points)
    return tuple(_lane(marker) for marker in strips)


def _lane(marker: Any) -> Lane:
    points = np.array([[p.x, p.y, p.z] for p in marker.points])
    curvature, lateral_offset = _shape(points)
    role, paint = _role_and_paint(marker)
    return Lane(
        points=points,
        confidence=float(marker.color.a),
        paint_width=0.0 if paint.kind == "edge" else float(marker.scale.x),
        role=role,
        curvature=curvature,
        lateral_offset=lateral_offset,
        id=int(marker.id),
        **paint._asdict(),
    )


def _role_and_paint(marker: Any) -> tuple[LaneRole, Paint]:
    if marker.ns in ROAD_EDGE_ROLES:
        return ROAD_EDGE_ROLES[marker.ns], Paint("edge")
    return marker.ns if marker.ns in COLOURS else "other", paint_from_text(marker.text)


def _shape(points: NDArray[np.float64]) -> tuple[float, float]:
    """Return curvature [1/m] and x [m], both at z = 0, of the parabola x(z) nearest to `points` (N, 3)."""
    x, z = points[:, 0], points[:, 2]
    powers = np.column_stack([z**2 / 2, z, np.ones_like(z)])
    (second, slope, offset), *_ = np.linalg.lstsq(powers, x, rcond=None)
    return float(second / (1 + slope**2) ** 1.5), float(offset)
