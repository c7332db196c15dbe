# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The paper's road: its disparity is a quadratic of the image row."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.geometry.road_surface import (
    MIN_DEPTH,
    NEAR_DEPTH,
    Array,
    RoadSurface,
    plane_slope,
)

PIXELS = 100.0  # rows and columns enter the polynomial in hundreds of pixels: coefficients of like size


@dataclass(frozen=True)
class QuadraticSurface(RoadSurface):
    """d(u, v) = b0 + b1 n + b2 n^2 + b3 m with n = (v - cy) / 100 and m = (u - cx) / 100.

    Ozgunalp et al. 2017: the quadratic vertical profile f(v); b3 adds the cross slope. The labels of
    annotated frames have their ground in this form, too.
    """

    @classmethod
    def plane(cls, camera: StereoCamera, height: float, pitch: float) -> QuadraticSurface:
        """Return the flat road seen from `height` [m] by a camera pitched down by `pitch` [rad], no roll."""
        b0, slope = plane_slope(camera, height, pitch)
        return cls(camera, (b0, slope * PIXELS, 0.0, 0.0))

    def disparity(self, u: Array, v: Array) -> Array:
        """See `RoadSurface`."""
        b0, b1, b2, b3 = self.coefficients
        n = (v - self.camera.cy) / PIXELS
        return b0 + n * (b1 + b2 * n) + b3 * (u - self.camera.cx) / PIXELS

    def gradient(self, u: Array, v: Array) -> tuple[Array, Array]:  # noqa: ARG002
        """See `RoadSurface`."""
        _, b1, b2, b3 = self.coefficients
        along = (b1 + 2 * b2 * (v - self.camera.cy) / PIXELS) / PIXELS
        return np.full_like(along, b3 / PIXELS), along

    def linearised(self, u: Array, v: Array) -> tuple[Array, Array]:
        """See `RoadSurface`."""
        n, m = (v - self.camera.cy) / PIXELS, (u - self.camera.cx) / PIXELS
        return self.disparity(u, v), np.stack([np.ones_like(n), n, n * n, m])

    def ground_to_pixel(self, x: Array, z: Array) -> tuple[Array, Array]:
        """See `RoadSurface`: the root of the quadratic on the road's side."""
        b0, b1, b2, b3 = self.coefficients
        z = np.maximum(z, MIN_DEPTH)
        m = x / z * (self.camera.fx / PIXELS)
        c = b0 + b3 * m - self.camera.fx * self.camera.baseline / z
        root = np.sqrt(np.maximum(b1 * b1 - 4 * b2 * c, 0))
        return self.camera.cx + PIXELS * m, self.camera.cy - PIXELS * 2 * c / (b1 + root)

    @property
    def roll(self) -> float:
        """See `RoadSurface`."""
        return float(np.arctan2(self.coefficients[3], self.coefficients[1]))

    @property
    def vertical_curvature(self) -> float:
        """See `RoadSurface`: d^2y/dz^2 at `NEAR_DEPTH`, by the second derivative of d(v)."""
        camera = self.camera
        forward = (self.camera_height / (NEAR_DEPTH * np.cos(self.pitch))) ** 3
        unit = 2 * (camera.fy / PIXELS) ** 2 * forward / (camera.fx * camera.baseline)
        return float(self.coefficients[2] * unit)
