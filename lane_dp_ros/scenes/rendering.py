# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The light that reaches one camera: first all that it sees, from far to near, then the light on it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.scenes import light, objects
from lane_dp_ros.scenes.ground import draw_ground
from lane_dp_ros.scenes.light import Light
from lane_dp_ros.scenes.objects import SceneObject
from lane_dp_ros.scenes.sky import draw_sky
from lane_dp_ros.scenes.structures import Bridge
from lane_dp_ros.scenes.surface import Surface
from lane_dp_ros.scenes.verge import draw_verges
from lane_dp_ros.scenes.view import View

Singles = NDArray[np.float32]


def render(view: View, illumination: Light, things: tuple[SceneObject, ...]) -> tuple[Singles, Surface]:
    """Return the light (H, W, 3) BGR, linear, that comes to each pixel, and the surface it comes from."""
    surface = Surface.empty(view.shape)
    draw_sky(surface, view)
    draw_ground(surface, view)
    bridges = tuple(thing for thing in things if isinstance(thing, Bridge))
    objects.composite(surface, view, bridges)  # behind the leaves of trees, through whose borders one sees
    draw_verges(surface, view)
    objects.composite(surface, view, tuple(thing for thing in things if thing not in bridges))
    return light.shade(surface, view, illumination, things), surface
