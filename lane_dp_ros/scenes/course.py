# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The course of a rendered road: from places along and across it, (s, n), to the ground and back."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lane_dp_ros.scenes.road import Road

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]

HAZE_DISTANCE = 300.0  # [m] beyond which the ground is lost in haze
TABLE_STEP = 0.1  # [m] between the places at which the course is worked out
MAX_TURN = np.deg2rad(80)  # a road that has turned farther could come back into view: there it ends
FAR_OFF = 1000.0  # [m] to the side


@dataclass(frozen=True)
class Course:
    """The road as seen from a vehicle `position` metres along it.

    Here s [m] counts from the vehicle; x [m] to the right, up [m] and z [m] ahead start at the place on the
    road's axis that the vehicle passes, and lie as the road's axis does there.
    """

    road: Road
    position: float

    @cached_property
    def s(self) -> Floats:
        """The places along the road for which the tables below are worked out."""
        s = np.arange(-20.0, HAZE_DISTANCE, TABLE_STEP, dtype=np.float64)
        turned = np.abs(self._turned(s)) > MAX_TURN
        return s[: turned.argmax()] if turned.any() else s

    @cached_property
    def heading(self) -> Floats:
        """The road's direction [rad] against the vehicle's."""
        return self._turned(self.s)

    @cached_property
    def axis(self) -> tuple[Floats, Floats]:
        """The x and z of the middle of the driven lane."""
        here = int(np.abs(self.s).argmin())
        steps = [f((self.heading[:-1] + self.heading[1:]) / 2) * TABLE_STEP for f in (np.sin, np.cos)]
        x, z = (np.concatenate([[0.0], np.cumsum(step)]) for step in steps)
        return x - x[here], z - z[here]

    def places(self, s: Floats, n: Floats | float) -> tuple[Floats, Floats]:
        """Return x and z [m] of the places s along the road, n to the right of its axis."""
        heading, x, z = (np.interp(s, self.s, table) for table in (self.heading, *self.axis))
        return x + n * np.cos(heading), z - n * np.sin(heading)

    def points(self, s: ArrayLike, n: ArrayLike, above: ArrayLike = 0.0) -> Floats:
        """Return the points (N, 3), right, up, ahead [m], at s along, n across and `above` the ground."""
        s, n, above = np.broadcast_arrays(*(np.asarray(a, np.float64) for a in (s, n, above)))
        x, z = self.places(s, n)
        return np.column_stack([x, self.height(s, n) + above, z])

    def height(self, s: ArrayLike, n: ArrayLike) -> NDArray[np.floating[Any]]:
        """Return how high [m] the ground is at (s, n) above the plane on which the vehicle stands."""
        return self.road.height(np.asarray(s) + self.position, np.asarray(n), self.position)

    def locate(self, x: Singles, z: Singles) -> tuple[Singles, Singles, Singles]:
        """Return s, n and the road's heading for places on the ground; n is far off where no road is near.

        Begins on the circle that fits the next 60 m and steps towards the foot of the perpendicular.
        """
        tables = [t.astype(np.float32) for t in (*self.axis, np.sin(self.heading), np.cos(self.heading))]
        k = np.float32(np.interp(60.0, self.s, self.heading) / 60 or 1e-9)
        s = np.arctan2(k * z, 1 - k * x) / k
        for _ in range(3):
            i = np.clip(np.rint((s - self.s[0]) / TABLE_STEP), 0, len(self.s) - 1).astype(np.int32)
            x0, z0, sine, cosine = (table[i] for table in tables)
            ahead = (x - x0) * sine + (z - z0) * cosine
            s = self.s.astype(np.float32)[i] + ahead
        n = (x - x0) * cosine - (z - z0) * sine
        n = np.where(np.abs(ahead) < 1, n, np.copysign(FAR_OFF, n)).astype(np.float32)
        return s, n, self.heading.astype(np.float32)[i]

    def direction(self, s: Singles) -> tuple[Singles, Singles]:
        """Return the sine and cosine of the road's heading at s."""
        i = np.clip(np.rint((s - self.s[0]) / TABLE_STEP), 0, len(self.s) - 1).astype(np.int32)
        heading = self.heading.astype(np.float32)
        return np.sin(heading)[i], np.cos(heading)[i]

    def _turned(self, s: Floats) -> Floats:
        return self.road.heading(self.position + s) - self.road.heading(np.array([self.position]))
