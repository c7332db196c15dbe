# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What each pixel of a view sees, before any light falls on it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Singles = NDArray[np.float32]
Mask = NDArray[np.bool_]

SKY_DISTANCE = 1e4  # [m] at which the sky's places are given


@dataclass(frozen=True)
class Surface:
    """The visible surface of each pixel: arrays (H, W) and (H, W, 3), drawn into from far to near.

    `albedo` BGR, the share of the light that is thrown back, linear: 1 is white. `emission` BGR is light
    given off by itself (the sky), linear: 1 is a white sheet in daylight. `position` right, up, ahead [m]
    of the place on the road's axis that the vehicle passes; `depth` [m] along the camera's axis, inf for the
    sky. `normal` right, up, ahead, of length 1. `s` along the road from its start and `n` to the right of its
    axis [m] are given where `ground` is true; there `paint` is the share that paint of lane lines covers.
    `lamps` BGR is light given off that does not depend on the day's, as `emission`, linear.
    """

    albedo: Singles
    emission: Singles
    position: Singles
    depth: Singles
    normal: Singles
    s: Singles
    n: Singles
    ground: Mask
    paint: Singles
    lamps: Singles

    @classmethod
    def empty(cls, shape: tuple[int, int]) -> Surface:
        """Return a surface (H, W) that sees nothing: black, infinitely far."""
        plane, space = np.zeros(shape, np.float32), np.zeros((*shape, 3), np.float32)
        depth = np.full(shape, np.inf, np.float32)
        up = space + np.array([0, 1, 0], np.float32)
        return cls(
            space.copy(),
            space.copy(),
            space.copy(),
            depth,
            up,
            plane.copy(),
            plane.copy(),
            plane > 0,
            plane,
            space,
        )


@dataclass(frozen=True)
class Footprint:
    """What each pixel covers of the ground: s, n [m], its reach along and across the road [m].

    `row_length` (H,) [m]: how much of the ground a pixel of this row covers along the line of sight.
    """

    s: Singles
    n: Singles
    reach_s: Singles
    reach_n: Singles
    row_length: Singles

    def at(self, where: tuple[NDArray[np.intp], ...]) -> Footprint:
        """Return the footprints (N,) of some pixels, given by their rows and columns."""
        return Footprint(
            self.s[where], self.n[where], self.reach_s[where], self.reach_n[where], self.row_length
        )
