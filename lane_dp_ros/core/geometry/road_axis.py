# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The road's axis: a heading and a curvature, and the road coordinates s, n along it (a Frenet frame)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]  # floats; single precision in, single precision out

STRAIGHT = 1e-6  # 1/m; below, an arc is a straight line to float precision


@dataclass(frozen=True)
class RoadAxis:
    """The direction of the road over the ground: an arc through the camera's foot.

    `heading` [rad] is the arc's direction at the camera, positive to the right of the optical axis;
    `curvature` [1/m] is positive where the road bends to the right. Road coordinates are s [m] along the
    arc and n [m] to its right; lines of constant n are concentric with it. (The dense vanishing point of
    Ozgunalp et al. 2017 in metric form: two numbers in place of a quartic u_vp(v).)
    """

    heading: float = 0.0
    curvature: float = 0.0

    def to_ground(self, s: Array, n: Array) -> tuple[Array, Array]:
        """Return the ground (x, z) [m] of road coordinates."""
        direction = self.heading + self.curvature * s
        if abs(self.curvature) < STRAIGHT:
            x, z = math.sin(self.heading) * s, math.cos(self.heading) * s
        else:
            x = (math.cos(self.heading) - np.cos(direction)) / self.curvature
            z = (np.sin(direction) - math.sin(self.heading)) / self.curvature
        return x + n * np.cos(direction), z - n * np.sin(direction)

    def from_ground(self, x: Array, z: Array) -> tuple[Array, Array]:
        """Return the road coordinates (s, n) [m] of ground points."""
        c, h = self.curvature, self.heading
        if abs(c) < STRAIGHT:
            return x * math.sin(h) + z * math.cos(h), self.offset(x, z)
        to_x, to_z = self._from_centre(x, z)
        side = math.copysign(1.0, c)
        s = np.arctan2(side * to_z, -side * to_x) - h
        s = (s + np.pi) % (2 * np.pi) - np.pi
        return s / c, self.offset(x, z)

    def offset(self, x: Array, z: Array) -> Array:
        """Return n alone."""
        c, h = self.curvature, self.heading
        if abs(c) < STRAIGHT:
            return np.asarray(x * math.cos(h) - z * math.sin(h))
        to_x, to_z = self._from_centre(x, z)
        return np.asarray(1 / c - math.copysign(1.0, c) * np.hypot(to_x, to_z))

    def _from_centre(self, x: Array, z: Array) -> tuple[Array, Array]:
        """Return the ground points seen from the arc's centre."""
        return x - math.cos(self.heading) / self.curvature, z + math.sin(self.heading) / self.curvature
