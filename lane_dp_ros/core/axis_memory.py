# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The road's axis from pair to pair: where it leaps, the lanes along the one before are looked at, too."""

from __future__ import annotations

from lane_dp_ros.core.geometry.road_axis import RoadAxis

MEMORY_NS = 500_000_000  # later the road may well run otherwise
HEADING_LEAP, CURVATURE_LEAP = 0.05, 0.01  # rad, 1/m; less from pair to pair is the road or the vehicle


class AxisMemory:
    """Remembers the axis along which the lanes of the last pairs were found."""

    def __init__(self) -> None:
        self._known: tuple[RoadAxis, int] | None = None

    def other_axis(self, axis: RoadAxis, stamp_ns: int) -> RoadAxis | None:
        """Return the axis of a moment ago where `axis` leaps away from it, None otherwise."""
        if self._known is None or not 0 <= stamp_ns - self._known[1] <= MEMORY_NS:
            return None
        known = self._known[0]
        turned = abs(axis.heading - known.heading) > HEADING_LEAP
        bent = abs(axis.curvature - known.curvature) > CURVATURE_LEAP
        return known if turned or bent else None

    def update(self, axis: RoadAxis, stamp_ns: int) -> None:
        """Remember the axis of a pair in which lanes were found."""
        self._known = axis, stamp_ns
