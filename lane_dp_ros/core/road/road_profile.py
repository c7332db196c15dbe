# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The road's surface: a robust profile through the v-disparity path, then the alignment with both images."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.dp.robust_fit import ransac, ransac_parabola, solved, tukey_weights
from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.geometry.disparity_map import DisparityMap
from lane_dp_ros.core.geometry.quadratic_surface import PIXELS, QuadraticSurface
from lane_dp_ros.core.geometry.road_surface import NEAR_DEPTH, RoadSurface
from lane_dp_ros.core.geometry.vertical_curve import VerticalCurve
from lane_dp_ros.core.parameter import Parameters, parameter
from lane_dp_ros.core.road.direct_alignment import STILL, aligned
from lane_dp_ros.core.road.road_samples import RoadSamples, road_samples
from lane_dp_ros.core.types import StereoFrame

Floats = NDArray[Any]

MIN_INLIERS = 0.27  # of the pixels, matched or not; fewer and what was fitted is not the road
MIN_AGREEMENT = 0.75  # of the road's pixels; with fewer alike in both images these show different moments
HEIGHT_FACTOR = 1.4  # by which the camera may stand higher or lower than its nominal height
CURVATURE_MAX = 0.03  # 1/m; over a vertical curve of 33 m radius no car passes
PITCH_RANGE = 0.15  # rad about the nominal pitch: vehicle and hill together
ROLL_MAX = 0.15  # rad; a road banked by 15 %
MAX_TRIALS = 80  # RANSAC samples
ROUNDS = 12  # of the robust fit
RIDGE = np.diag([1e-9, 1e-9, 140.0, 1e-6])  # px^2 a sample; holds a profile that the data leave open straight
HYPERBOLA = np.array([NEAR_DEPTH, -1.0, -0.1 / NEAR_DEPTH])  # scales of the profile's terms in RANSAC


@dataclass(frozen=True)
class RoadProfileConfig(Parameters):
    """The road's surface from the disparity."""

    model: str = parameter(
        "vertical_curve",
        "vertical_curve: a parabolic hill with a cross slope, aligned with both images; "
        "quadratic: the paper's disparity, quadratic in the image row.",
        choices=("vertical_curve", "quadratic"),
    )
    camera_height: float = parameter(
        1.65,
        "Camera above the road; the measured one is within a factor of 1.4. Serves where none is measured.",
        unit="m",
        limits=(0.3, 5.0),
    )
    camera_pitch: float = parameter(
        0.0, "Camera looks down on the road; serves where none is measured.", unit="rad", limits=(-0.3, 0.3)
    )


class RoadProfile(Protocol):
    """Measures the road's surface in a frame."""

    def measure(
        self,
        frame: StereoFrame,
        disparity: DisparityMap,
        camera: StereoCamera,
        rng: np.random.Generator,
        known: RoadSurface | None = None,
    ) -> RoadSurface | None:
        """Return the road's surface, None where the disparity shows no road at a possible camera height.

        `known` is the surface of a moment ago.
        """


class VerticalCurveProfile:
    """A hyperbola through the v-disparity path, fitted to all pixels, then aligned with both images.

    Where more of the pair lies on the surface of a moment ago, that is the one that is fitted; where that
    comes to nothing, the other.
    """

    def __init__(self, config: RoadProfileConfig) -> None:
        self._config = config

    def measure(
        self,
        frame: StereoFrame,
        disparity: DisparityMap,
        camera: StereoCamera,
        rng: np.random.Generator,
        known: RoadSurface | None = None,
    ) -> RoadSurface | None:
        """See `RoadProfile`."""
        samples = road_samples(disparity, camera, self._config.camera_height)
        if samples is None:
            return None
        starts = [each for each in (self._start(samples, rng), known) if isinstance(each, VerticalCurve)]
        for start in sorted(starts, key=samples.share_on, reverse=True):
            fitted = self._fitted(samples, start)
            if fitted is not None and is_road(fitted, samples, self._config):
                found = aligned(fitted, frame, disparity)
                if found.agreement < MIN_AGREEMENT:
                    return None
                return found.surface if is_road(found.surface, samples, self._config) else fitted
        return None

    def _start(self, samples: RoadSamples, rng: np.random.Generator) -> VerticalCurve | None:
        """Return the profile through the v-disparity path, by RANSAC on v - cy = a d + b + c / d."""
        camera = samples.camera
        rows, path = samples.path()
        q = path / (camera.fx * camera.baseline)
        A = HYPERBOLA * np.stack([q, np.ones_like(q), 1 / q], axis=1)
        tangents = (samples.row_v[rows] - camera.cy) / camera.fy
        threshold = samples.tolerance * self._config.camera_height / (camera.fx * camera.baseline)
        found = ransac(A, tangents, threshold, MAX_TRIALS, rng)
        if found is None:
            return None
        foot, slope, half = HYPERBOLA * found.coefficients * [1, -1, -1]
        return VerticalCurve.of_foot(camera, float(foot), float(slope), float(2 * half))

    def _fitted(self, samples: RoadSamples, start: VerticalCurve) -> VerticalCurve | None:
        """Return the surface nearest to all samples, by Gauss-Newton steps with Tukey's weights."""
        surface, ridge = start, RIDGE * len(samples.d)
        for i in range(ROUNDS):
            if not surface.is_below_camera:
                return None
            d, J = surface.linearised(samples.u, samples.v)
            residuals = samples.d - d
            weighted = J * tukey_weights(residuals, (3 if i == 0 else 2) * samples.tolerance)
            b = np.array(surface.coefficients)
            normal = (weighted @ J.T).astype(np.float64) + ridge
            step = solved(normal, (weighted @ residuals).astype(np.float64) - ridge @ [0, 0, b[2], 0])
            surface = surface.with_coefficients(b + step)
            if np.all(np.abs(step) < STILL):
                break
        return surface if surface.is_below_camera else None


class QuadraticProfile:
    """The paper's: a quadratic through the v-disparity path, by RANSAC (Fan & Dahnoun 2018)."""

    def __init__(self, config: RoadProfileConfig) -> None:
        self._config = config

    def measure(
        self,
        frame: StereoFrame,  # noqa: ARG002
        disparity: DisparityMap,
        camera: StereoCamera,
        rng: np.random.Generator,
        known: RoadSurface | None = None,  # noqa: ARG002
    ) -> RoadSurface | None:
        """See `RoadProfile`."""
        samples = road_samples(disparity, camera, self._config.camera_height)
        if samples is None:
            return None
        rows, path = samples.path()
        n = (samples.row_v[rows].astype(np.float64) - camera.cy) / PIXELS
        found = ransac_parabola(n, path, samples.tolerance, MAX_TRIALS, rng)
        if found is None:
            return None
        b0, b1, b2 = found.coefficients.tolist()
        surface = QuadraticSurface(camera, (b0, b1, b2, 0.0))
        return surface if is_road(surface, samples, self._config) else None


def road_profile(config: RoadProfileConfig) -> RoadProfile:
    """Return the profile that `config.model` names."""
    return QuadraticProfile(config) if config.model == "quadratic" else VerticalCurveProfile(config)


def plausible_heights(config: RoadProfileConfig) -> tuple[float, float]:
    """Return the lowest and the highest height [m] that the camera may have above the road."""
    return config.camera_height / HEIGHT_FACTOR, config.camera_height * HEIGHT_FACTOR


def largest_disparity(camera: StereoCamera, rows: int, config: RoadProfileConfig) -> float:
    """Return the disparity [px] of the nearest road that an image of so many rows can show.

    With the camera as low as it may be above a flat road, or the road as steep against it as it may be.
    """
    tangent = (rows - camera.cy) / camera.fy + np.tan(config.camera_pitch)
    lowest, _ = plausible_heights(config)
    inverse_depth = max(tangent / lowest, (tangent + np.tan(PITCH_RANGE)) / config.camera_height)
    return float(max(inverse_depth, 0) * camera.fx * camera.baseline)


def is_road(surface: RoadSurface, samples: RoadSamples, config: RoadProfileConfig) -> bool:
    """Return whether a surface is where a road may be, and much of what is seen lies on it."""
    return samples.share_on(surface) * samples.matched >= MIN_INLIERS and is_plausible(surface, config)


def is_plausible(surface: RoadSurface, config: RoadProfileConfig) -> bool:
    """Return whether a road may lie so under the camera."""
    lowest, highest = plausible_heights(config)
    return (
        lowest <= surface.camera_height <= highest
        and abs(surface.pitch - config.camera_pitch) <= PITCH_RANGE
        and abs(surface.roll) <= ROLL_MAX
        and abs(surface.vertical_curvature) <= CURVATURE_MAX
    )
