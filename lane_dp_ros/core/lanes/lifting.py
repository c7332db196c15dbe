# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""From lines in road coordinates to lanes in the left optical frame."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from lane_dp_ros.core.lane import Lane, LaneRole
from lane_dp_ros.core.types import BirdsEyeView, LaneEvidence, LaneLine

SPACING = 0.25  # m along the axis; on the outside of the sharpest bend points are still within 0.5 m
MIN_RADIUS = 0.1  # of the axis's; a line nearer to the centre of the bend is none
DOUBT, SURE = 0.15, 10.0  # share of wrong lines among the weakest; m of paint that leave 1/e of the doubt


def to_lanes(
    lines: Sequence[LaneLine], evidence: Sequence[LaneEvidence], view: BirdsEyeView
) -> tuple[Lane, ...]:
    """Return the lanes of lines and their evidence, from left to right."""
    offsets = [float(line.n[0]) for line in lines]
    order = np.argsort(offsets)
    roles = ego_roles([offsets[i] for i in order])
    return tuple(_lane(lines[i], evidence[i], view, role) for i, role in zip(order, roles, strict=True))


def ego_roles(offsets: Sequence[float]) -> list[LaneRole]:
    """Return the role of each lateral offset [m]: the nearest on each side of the vehicle are ego lines."""
    roles: list[LaneRole] = ["other"] * len(offsets)
    left = [i for i, n in enumerate(offsets) if n < 0]
    right = [i for i, n in enumerate(offsets) if n >= 0]
    if left:
        roles[max(left, key=lambda i: offsets[i])] = "ego_left"
    if right:
        roles[min(right, key=lambda i: offsets[i])] = "ego_right"
    return roles


def _lane(line: LaneLine, evidence: LaneEvidence, view: BirdsEyeView, role: LaneRole) -> Lane:
    first, last = _seen(line, view)
    s = np.linspace(first, last, max(2, int(np.ceil((last - first) / SPACING)) + 1))
    radius = max(1 - view.axis.curvature * float(line.n[0]), MIN_RADIUS)
    return Lane(
        points=view.to_points(s, np.interp(s, line.s, line.n)),
        confidence=1 - DOUBT * float(np.exp(-line.score / SURE)),
        paint_width=evidence.paint_width,
        role=role,
        curvature=view.axis.curvature / radius + line.bend,
        lateral_offset=float(line.n[0]),
    )


def _seen(line: LaneLine, view: BirdsEyeView) -> tuple[float, float]:
    """Return s [m] between which a line lies in the picture; all of it where the view is too coarse."""
    s = line.s[view.seen[line.rows, view.nearest_columns(line.n)]]
    return (float(s[0]), float(s[-1])) if len(s) > 1 else (float(line.s[0]), float(line.s[-1]))
