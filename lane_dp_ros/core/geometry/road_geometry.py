# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""A road's surface in physical terms: camera height, pitch, roll, vertical curvature."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.geometry.road_surface import NEAR_DEPTH, PIXELS, RoadSurface

Floats = NDArray[np.float64]


def geometry(surface: RoadSurface) -> Floats:
    """Return camera height [m], pitch [rad], roll [rad] and vertical curvature [1/m] of a surface.

    The curvature, of the road's height over the depth `NEAR_DEPTH` ahead, is positive where it climbs more
    and more.
    """
    height, pitch = surface.camera_height, surface.pitch
    curvature = surface.coefficients[2] * _curvature_unit(surface, height, pitch)
    return np.array([height, pitch, surface.roll, curvature])


def surface_of(like: RoadSurface, values: Floats) -> RoadSurface:
    """Return the surface, seen by the camera of `like`, that has this `geometry`."""
    height, pitch, roll, curvature = map(float, values)
    camera = like.camera
    near = camera.fx * camera.baseline / NEAR_DEPTH
    slope = camera.fx * camera.baseline * math.cos(pitch) / height * PIXELS / camera.fy  # at NEAR_DEPTH
    b2 = curvature / _curvature_unit(like, height, pitch)
    n = near / slope - math.tan(pitch) * camera.fy / PIXELS
    b1 = slope - 2 * b2 * n
    return RoadSurface(camera, (near - n * (b1 + b2 * n), b1, b2, b1 * math.tan(roll)))


def _curvature_unit(surface: RoadSurface, height: float, pitch: float) -> float:
    """Return the vertical curvature [1/m] of b2 = 1: d^2y/dz^2 by the second derivative of d(v)."""
    camera = surface.camera
    forward = (height / (NEAR_DEPTH * math.cos(pitch))) ** 3
    return 2 * (camera.fy / PIXELS) ** 2 * forward / (camera.fx * camera.baseline)
