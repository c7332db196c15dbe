# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The road's surface, as the disparity that the camera sees on it; what all models of it have in common."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.geometry.camera import StereoCamera

Array = NDArray[Any]  # floats; single precision in, single precision out
Coefficients = tuple[float, float, float, float]

NEAR_DEPTH = 10.0  # m; where height and pitch are read off a surface that is not flat
RECTIFICATION = 0.2  # px; standard deviation of disparities where the rectification is a good one
UNEVENNESS = 0.012  # m; standard deviation of a road's heights about any smooth surface
MIN_DEPTH = 1.0  # m; nearer ground is behind the bonnet and outside every view


@dataclass(frozen=True)
class RoadSurface(ABC):
    """A model of the road's surface with four `coefficients`.

    The ground coordinates of a pixel are x [m] right and z [m] ahead of the left camera. `covariance` (4, 4)
    is that of the coefficients, None where the surface was not measured.
    """

    camera: StereoCamera
    coefficients: Coefficients
    covariance: NDArray[np.float64] | None = field(default=None, compare=False, repr=False)

    @abstractmethod
    def disparity(self, u: Array, v: Array) -> Array:
        """Return the surface's disparity [px] at pixels (u, v); not positive above its horizon."""

    @abstractmethod
    def gradient(self, u: Array, v: Array) -> tuple[Array, Array]:
        """Return the change of disparity per column and per row [px/px] at pixels (u, v)."""

    @abstractmethod
    def linearised(self, u: Array, v: Array) -> tuple[Array, Array]:
        """Return disparity (N,) at pixels (u, v), (N,), and its derivatives (4, N) by the coefficients."""

    @abstractmethod
    def ground_to_pixel(self, x: Array, z: Array) -> tuple[Array, Array]:
        """Return the pixels (u, v) of ground points; of those behind a crest the pixels of the crest."""

    @property
    @abstractmethod
    def roll(self) -> float:
        """Angle [rad] of the road's cross slope: positive where it climbs to the right."""

    @property
    @abstractmethod
    def vertical_curvature(self) -> float:
        """Second derivative [1/m] of the road's height over depth: positive where it climbs more and more."""

    @property
    def summit(self) -> float:
        """The depth [m] beyond which a crest hides the road; infinite without one."""
        return math.inf

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

    def depth_deviation(self, u: Array, v: Array) -> Array:
        """Return the standard deviation [m] of the ground's depth at pixels (u, v), (N,).

        z = f b / d, so sigma_z = z^2 / (f b) sigma_d, with that of the disparity by the covariance of the
        coefficients, by what is left of the rectification's error, and by the road's unevenness. NaN at and
        above the horizon, and everywhere on a surface that was not measured.
        """
        if self.covariance is None:
            return np.full(np.shape(u), np.nan)
        d, J = self.linearised(u, v)
        of_surface = np.einsum("i...,ij,j...->...", J, self.covariance, J)
        uneven = UNEVENNESS / self.camera_height * d
        deviation = np.sqrt(of_surface + RECTIFICATION**2 + uneven**2)
        return np.asarray(self.camera.fx * self.camera.baseline / np.where(d > 0, d, np.nan) ** 2 * deviation)

    def depth_deviation_ahead(self, depth: float) -> float | None:
        """Return the standard deviation [m] of the ground's depth straight ahead, None where unknown.

        It is on surfaces that were not measured, and behind a crest.
        """
        if depth >= self.summit:
            return None
        u, v = self.ground_to_pixel(np.zeros(1), np.full(1, depth))
        deviation = float(self.depth_deviation(u, v)[0])
        return deviation if math.isfinite(deviation) else None

    @cached_property
    def camera_height(self) -> float:
        """Height [m] of the camera above the road near the vehicle."""
        slope = float(self._near_gradient) * self.camera.fy  # change of disparity per unit of (v - cy) / fy
        return float(self.camera.fx * self.camera.baseline * np.cos(self.pitch) / slope)

    @cached_property
    def pitch(self) -> float:
        """Angle [rad] by which the camera looks down on the road near the vehicle: atan((cy - v_vp) / fy)."""
        return float(np.arctan2(self.camera.cy - self.horizon(self.near_row), self.camera.fy))

    def horizon(self, v: Array | float) -> Array:
        """Return v_vp(v) = v - f(v) / f'(v), the horizon of the road at row v (Ozgunalp et al. 2017)."""
        v = np.asarray(v, dtype=np.float64)
        u = np.full_like(v, self.camera.cx)
        return v - self.disparity(u, v) / self.gradient(u, v)[1]

    @cached_property
    def near_row(self) -> float:
        """The image row that shows the road `NEAR_DEPTH` ahead."""
        return float(self.ground_to_pixel(np.zeros(1), np.full(1, NEAR_DEPTH))[1][0])

    @property
    def _near_gradient(self) -> float:
        """Change of disparity per row [px/px] near the vehicle."""
        return float(self.gradient(np.full(1, self.camera.cx), np.full(1, self.near_row))[1][0])


def geometry(surface: RoadSurface) -> Array:
    """Return camera height [m], pitch [rad], vertical curvature [1/m] and roll [rad] of a surface.

    In the order of the coefficients of `VerticalCurve`.
    """
    return np.array([surface.camera_height, surface.pitch, surface.vertical_curvature, surface.roll])


def plane_slope(camera: StereoCamera, height: float, pitch: float) -> tuple[float, float]:
    """Return the disparity [px] at the principal point, and its change per row, of a flat road.

    The camera stands `height` [m] above it and looks down on it by `pitch` [rad].
    """
    scale = camera.fx * camera.baseline / height
    return scale * math.sin(pitch), scale * math.cos(pitch) / camera.fy
