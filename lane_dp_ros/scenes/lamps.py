# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Artificial light on a rendered road: one's own head lamps, those that come towards one, street lamps."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.scenes.objects import SceneObject, at
from lane_dp_ros.scenes.surface import Surface
from lane_dp_ros.scenes.vehicles import Vehicle
from lane_dp_ros.scenes.view import View

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]

OWN_LAMPS = (0.27, 0.65, 1.7)  # [m] right of the left camera, above the ground, ahead: between the two lamps
HALF_WIDTH = 0.30  # [rad] at which a lamp shines 37 % as bright as straight ahead
CUT_OFF = -0.012  # slope above which low beam is dark, as traffic rules want it; it rises to the right
BELOW = 0.085  # slope below the cut-off over which the light falls to 37 %
STREET_LAMPS = (5.5, 8.0)  # [m] right of the road's axis, above it
WARM = np.array([0.70, 0.88, 1.0], np.float32)  # BGR of a halogen lamp
SODIUM = np.array([0.28, 0.62, 1.0], np.float32)


def own_lamps(surface: Surface, view: View) -> Singles:
    """Return the light (H, W) of one's own low beam on what each pixel sees: 1 straight ahead at 10 m."""
    right, above, ahead = OWN_LAMPS
    lamp = np.array([view.pose.lateral + right, above, ahead], np.float32)
    return _low_beam(surface.position - lamp, view.pose.yaw) * np.float32(100.0)


def oncoming_lamps(surface: Surface, view: View, objects: Sequence[SceneObject]) -> Singles:
    """Return the light (H, W) on the ground of vehicles that come towards the camera with their lamps on."""
    light = np.zeros(view.shape, np.float32)
    for vehicle, place in lamps_towards(view, objects):
        reach = surface.position - place.astype(np.float32)
        beam = _low_beam(reach * np.array([-1, 1, -1], np.float32), 0.0)
        light += np.float32(15.0 * vehicle.lamps) * beam  # asphalt throws little of it forward
    return np.where(surface.ground, light, 0)


def lamps_towards(view: View, objects: Sequence[SceneObject]) -> list[tuple[Vehicle, Floats]]:
    """Return the oncoming vehicles whose lamps are on, and where in the world (3,) [m] their lamps are."""
    lit = [o for o in at(objects, view.time) if isinstance(o, Vehicle) and o.oncoming and o.lamps > 0]
    places = [(o, np.array(o.head_lamps()) - (view.course.position, 0, 0)) for o in lit]
    return [(o, view.course.points(*place)[0]) for o, place in places if 2.0 < place[0] < 120.0]


def street_lamps(surface: Surface, spacing: float) -> Singles:
    """Return the light (H, W) of lamps that stand every `spacing` metres on the right; 1 right under one."""
    right, high = STREET_LAMPS
    along = np.mod(surface.s + np.float32(spacing / 2), np.float32(spacing)) - np.float32(spacing / 2)
    squared = along**2 + (surface.n - np.float32(right)) ** 2 + np.float32(high**2)
    return np.where(surface.ground, (np.float32(high**2) / squared) ** np.float32(1.5), np.float32(0.3))


def _low_beam(reach: Singles, yaw: float) -> Singles:
    """Return 1 / distance^2 times how bright a lamp shines in a direction; `reach` (H, W, 3) is from it."""
    ahead = np.maximum(reach[..., 2], np.float32(0.5))
    across = reach[..., 0] / ahead - np.float32(yaw)
    below = CUT_OFF + 0.03 * np.clip(across * 6, 0, 1) - reach[..., 1] / ahead
    beam = np.exp(-((across / HALF_WIDTH) ** 2) - np.maximum(below, 0) / BELOW + 60 * np.minimum(below, 0))
    dark = np.float32(0.012)  # that a low beam throws above its cut-off
    squared = ahead**2 + reach[..., 0] ** 2
    return np.where(reach[..., 2] > 0.5, np.maximum(beam, dark) / squared, 0).astype(np.float32)
