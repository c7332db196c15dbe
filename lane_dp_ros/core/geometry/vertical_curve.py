# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The road as it is built: a parabolic vertical curve with a cross slope."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.geometry.road_surface import MIN_DEPTH, NEAR_DEPTH, Array, RoadSurface

BELOW_CAMERA = 0.2  # m; no camera on a vehicle is nearer to the road
FLAT = 1e-9  # 1/m; less is no crest
SMALLEST = 1e-6  # 1/m; of inverse depths: farther than a thousand kilometres there is no road


@dataclass(frozen=True)
class VerticalCurve(RoadSurface):
    """y(x, z) = height - slope z - curvature / 2 (z - z0)^2 - cross_slope x, z0 = `NEAR_DEPTH`.

    y [m] is how far the road lies below the left camera's axis at x [m] right and z [m] ahead. `coefficients`
    are (height [m], slope, curvature [1/m], cross_slope): height and slope are those of the tangent at z0.
    Crests and sags of roads are parabolas (AASHTO, A Policy on Geometric Design of Highways and Streets). In
    the image the road's rows are a hyperbola of its disparity: v - cy = a d + b + c / d, c by the curvature.
    """

    @classmethod
    def plane(cls, camera: StereoCamera, height: float, pitch: float) -> VerticalCurve:
        """Return the flat road seen from `height` [m] by a camera pitched down by `pitch` [rad], no roll."""
        return cls.of_geometry(camera, np.array([height, pitch, 0.0, 0.0]))

    @classmethod
    def of_geometry(cls, camera: StereoCamera, values: Array) -> VerticalCurve:
        """Return the surface of this `geometry`: camera height, pitch, vertical curvature and roll."""
        height, pitch, curvature, roll = map(float, values)
        return cls(camera, (height / math.cos(pitch), math.tan(pitch), curvature, math.tan(roll)))

    @classmethod
    def of_foot(cls, camera: StereoCamera, foot: float, slope: float, curvature: float) -> VerticalCurve:
        """Return the surface without cross slope of a height [m] and slope at z = 0, and a curvature."""
        height = foot + curvature / 2 * NEAR_DEPTH**2
        return cls(camera, (height, slope + curvature * NEAR_DEPTH, curvature, 0.0))

    def with_coefficients(
        self, coefficients: ArrayLike, covariance: NDArray[np.float64] | None = None
    ) -> VerticalCurve:
        """Return the surface of the same camera with other coefficients (4,)."""
        height, slope, curvature, cross_slope = np.asarray(coefficients, dtype=np.float64).tolist()
        return VerticalCurve(self.camera, (height, slope, curvature, cross_slope), covariance)

    @property
    def is_below_camera(self) -> bool:
        """Whether the road passes below the camera, as that of a vehicle does."""
        return self._at_camera[0] > BELOW_CAMERA

    def disparity(self, u: Array, v: Array) -> Array:
        """See `RoadSurface`; zero where the viewing ray misses the road."""
        _, q = self._inverse_depth(u, v)
        return np.asarray(self.camera.fx * self.camera.baseline * q)

    def gradient(self, u: Array, v: Array) -> tuple[Array, Array]:
        """See `RoadSurface`."""
        root, q = self._inverse_depth(u, v)
        per_row = self.camera.fx * self.camera.baseline / self.camera.fy * q / np.maximum(root, SMALLEST)
        return per_row * (self.coefficients[3] * self.camera.fy / self.camera.fx), per_row

    def linearised(self, u: Array, v: Array) -> tuple[Array, Array]:
        """See `RoadSurface`: implicit derivatives of F(1 / z; coefficients) = 0, the viewing ray's height."""
        root, q = self._inverse_depth(u, v)
        unit = self.camera.fx * self.camera.baseline
        J = np.empty((4, *q.shape), q.dtype)
        far = np.maximum(q, SMALLEST)
        J[0], J[1], J[3] = -q, 1, (u - self.camera.cx) / self.camera.fx
        J[2] = (1 - NEAR_DEPTH * far) ** 2 / (2 * far)
        J *= unit * q / np.maximum(root, SMALLEST)
        return unit * q, J

    def ground_to_pixel(self, x: Array, z: Array) -> tuple[Array, Array]:
        """See `RoadSurface`."""
        camera, (_, _, curvature, cross_slope) = self.camera, self.coefficients
        foot, slope = self._at_camera
        z = np.maximum(z, MIN_DEPTH)
        tangent_u = x / z
        seen = np.minimum(z, self.summit)
        tangent_v = foot / seen - slope - curvature / 2 * seen - cross_slope * tangent_u
        return camera.cx + camera.fx * tangent_u, camera.cy + camera.fy * tangent_v

    @property
    def summit(self) -> float:
        """See `RoadSurface`."""
        foot, _ = self._at_camera
        curvature = self.coefficients[2]
        return math.sqrt(-2 * foot / curvature) if curvature < -FLAT and foot > 0 else math.inf

    @property
    def pitch(self) -> float:
        """See `RoadSurface`."""
        return math.atan(self.coefficients[1])

    @property
    def camera_height(self) -> float:
        """See `RoadSurface`."""
        return self.coefficients[0] * math.cos(self.pitch)

    @property
    def roll(self) -> float:
        """See `RoadSurface`."""
        return math.atan(self.coefficients[3])

    @property
    def vertical_curvature(self) -> float:
        """See `RoadSurface`."""
        return self.coefficients[2]

    @property
    def _at_camera(self) -> tuple[float, float]:
        """Height [m] and slope of the parabola at z = 0."""
        height, slope, curvature, _ = self.coefficients
        return height - curvature / 2 * NEAR_DEPTH**2, slope - curvature * NEAR_DEPTH

    def _inverse_depth(self, u: Array, v: Array) -> tuple[Array, Array]:
        """Return a root r and the inverse depth q = 1 / z [1/m] of the road at pixels; 0 for no road.

        q = (t + r) / 2 foot solves foot q^2 - t q - curvature / 2 = 0, with t = (v - cy) / fy + slope, on the
        near side of a crest. Its change per (v - cy) / fy is q / r.
        """
        camera, (_, _, curvature, cross_slope) = self.camera, self.coefficients
        foot, slope = self._at_camera
        t = (v - camera.cy) / camera.fy + cross_slope * (u - camera.cx) / camera.fx + slope
        square = t * t + 2 * foot * curvature
        root = np.sqrt(np.maximum(square, 0))
        q = np.maximum(t + root, 0) * (0.5 / foot)
        return root, np.where(square >= 0, q, 0) if curvature < 0 else q
