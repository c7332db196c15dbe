# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The road's surface, written as the disparity that the camera sees on it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.geometry.camera import StereoCamera

Array = NDArray[Any]  # floats; single precision in, single precision out

PIXELS = 100.0  # rows and columns enter the polynomial in hundreds of pixels: coefficients of like size
NEAR_DEPTH = 10.0  # m; where height and pitch are read off a surface that is not flat
MIN_DEPTH = 1.0  # m; nearer ground is behind the bonnet and outside every view


@dataclass(frozen=True)
class RoadSurface:
    """The road's surface, written as the disparity that the camera sees on it.

    d(u, v) = b0 + b1 n + b2 n^2 + b3 m with n = (v - cy) / 100 and m = (u - cx) / 100 (Ozgunalp et al.
    2017: the quadratic vertical profile f(v); b3 adds the roll of the camera against the road).
    The ground coordinates of a pixel are x [m] right and z [m] ahead of the left camera.
    """

    camera: StereoCamera
    coefficients: tuple[float, float, float, float]

    @classmethod
    def plane(cls, camera: StereoCamera, height: float, pitch: float) -> RoadSurface:
        """Return the flat road seen from `height` [m] by a camera pitched down by `pitch` [rad], no roll."""
        scale = camera.fx * camera.baseline / height
        b0, b1 = scale * math.sin(pitch), scale * math.cos(pitch) * PIXELS / camera.fy
        return cls(camera, (b0, b1, 0.0, 0.0))

    def disparity(self, u: Array, v: Array) -> Array:
        """Return the surface's disparity [px] at pixels (u, v)."""
        b0, b1, b2, b3 = self.coefficients
        n = (v - self.camera.cy) / PIXELS
        return b0 + n * (b1 + b2 * n) + b3 * (u - self.camera.cx) / PIXELS

    def gradient(self, v: Array) -> Array:
        """Return the change of disparity per row, f'(v) [px/px]."""
        _, b1, b2, _ = self.coefficients
        return (b1 + 2 * b2 * (v - self.camera.cy) / PIXELS) / PIXELS

    def ground_to_pixel(self, x: Array, z: Array) -> tuple[Array, Array]:
        """Return the pixels (u, v) of ground points; the root of the quadratic on the road's side."""
        b0, b1, b2, b3 = self.coefficients
        z = np.maximum(z, MIN_DEPTH)
        m = x / z * (self.camera.fx / PIXELS)
        c = b0 + b3 * m - self.camera.fx * self.camera.baseline / z
        root = np.sqrt(np.maximum(b1 * b1 - 4 * b2 * c, 0))
        return self.camera.cx + PIXELS * m, self.camera.cy - PIXELS * 2 * c / (b1 + root)

    def pixel_to_ground(self, u: Array, v: Array) -> tuple[Array, Array]:
        """Return the ground (x, z) [m] of pixels, NaN at and above the horizon."""
        d = self.disparity(u, v)
        z = self.camera.fx * self.camera.baseline / np.where(d > 0, d, np.nan)
        return (u - self.camera.cx) * z / self.camera.fx, z

    def height_above(self, disparity: Array, u: Array, v: Array) -> Array:
        """Return how high [m] above the road the points lie that have `disparity` at pixels (u, v).

        A point on the viewing ray at a fraction of the ground's distance stands that fraction lower below
        the camera; NaN where the disparity is.
        """
        with np.errstate(divide="ignore", invalid="ignore"):
            return self.camera_height * (1 - self.disparity(u, v) / disparity)

    @cached_property
    def camera_height(self) -> float:
        """Height [m] of the camera above the road near the vehicle."""
        return float(self.camera.fx * self.camera.baseline * np.cos(self.pitch) / self._slope)

    @cached_property
    def pitch(self) -> float:
        """Angle [rad] by which the camera looks down on the road near the vehicle: atan((cy - v_vp) / fy)."""
        return float(np.arctan2(self.camera.cy - self.horizon(self.near_row), self.camera.fy))

    @property
    def roll(self) -> float:
        """Angle [rad] of the road's cross slope in the image."""
        return float(np.arctan2(self.coefficients[3], self.coefficients[1]))

    @property
    def gradient_u(self) -> float:
        """The change of disparity per column [px/px]: the road's cross slope."""
        return self.coefficients[3] / PIXELS

    def horizon(self, v: Array | float) -> Array:
        """Return v_vp(v) = v - f(v) / f'(v), the horizon of the road at row v (Ozgunalp et al. 2017)."""
        v = np.asarray(v, dtype=np.float64)
        return v - self.disparity(np.full_like(v, self.camera.cx), v) / self.gradient(v)

    @cached_property
    def near_row(self) -> float:
        """The image row that shows the road `NEAR_DEPTH` ahead."""
        return float(self.ground_to_pixel(np.zeros(1), np.full(1, NEAR_DEPTH))[1][0])

    @property
    def _slope(self) -> float:
        """Change of disparity [px] per unit of (v - cy) / fy near the vehicle."""
        return float(self.gradient(np.full(1, self.near_row))[0]) * self.camera.fy


def geometry(surface: RoadSurface) -> Array:
    """Return camera height [m], pitch [rad], roll [rad] and vertical curvature [1/m] of a surface.

    The curvature, of the road's height over the depth `NEAR_DEPTH` ahead, is positive where it climbs more
    and more.
    """
    height, pitch = surface.camera_height, surface.pitch
    curvature = surface.coefficients[2] * _curvature_unit(surface, height, pitch)
    return np.array([height, pitch, surface.roll, curvature])


def surface_of(like: RoadSurface, values: Array) -> RoadSurface:
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
