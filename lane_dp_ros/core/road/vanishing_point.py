# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The road's direction from the edges on it: the paper's dense vanishing point, or an arc in metres."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.geometry.disparity_map import DisparityMap
from lane_dp_ros.core.geometry.quadratic_surface import QuadraticSurface
from lane_dp_ros.core.geometry.road_axis import RoadAxis
from lane_dp_ros.core.geometry.road_surface import RoadSurface
from lane_dp_ros.core.parameter import Parameters, parameter
from lane_dp_ros.core.road.arc_vote import arc_of_edges
from lane_dp_ros.core.road.dense_vote import QuarticVanishingPoint, quartic_vanishing_point
from lane_dp_ros.core.road.edge_pixels import edge_pixels

Image = NDArray[np.uint8]


@dataclass(frozen=True)
class VanishingPointConfig(Parameters):
    """The road's direction from the edges on it."""

    method: str = parameter(
        "arc",
        "arc: heading and curvature of the road's axis by voting; dense: the paper's quartic u_vp(v).",
        choices=("arc", "dense"),
    )
    centred_principal_point: bool = parameter(
        False, "Pitch and yaw by the paper's formula, which takes the image's middle for the principal point."
    )
    heading_max: float = parameter(
        0.5, "Largest angle between road and vehicle; for arc.", unit="rad", limits=(0.1, 0.8)
    )
    curvature_max: float = parameter(
        0.05, "Sharpest bend, 1/radius; for arc.", unit="1/m", limits=(0.005, 0.1)
    )


@dataclass(frozen=True)
class RoadDirection:
    """The road's axis, the plane by which the road is mapped to the image, and where the axis vanishes.

    `vanishing_point` (u, v) [px] is that of the direction at the vehicle; `u_of_row` are the coefficients,
    constant first, of the quartic u_vp(v) along the road ahead, empty where only an arc was estimated.
    """

    axis: RoadAxis
    ipm_plane: RoadSurface
    vanishing_point: tuple[float, float]
    u_of_row: tuple[float, ...] = ()


class DirectionEstimator(Protocol):
    """Estimates the road's direction in a frame."""

    def estimate(self, left: Image, disparity: DisparityMap, surface: RoadSurface) -> RoadDirection:
        """Return the direction of the road whose `surface` the grey image `left` (H, W) shows."""

    def follow(self, axis: RoadAxis, surface: RoadSurface) -> RoadDirection | None:
        """Return the direction of a road whose `axis` is known, None where the image must tell it."""


class ArcVanishingPoint:
    """The axis as an arc, a heading and a curvature; the road is mapped by its measured surface."""

    def __init__(self, config: VanishingPointConfig) -> None:
        self._config = config

    def estimate(self, left: Image, disparity: DisparityMap, surface: RoadSurface) -> RoadDirection:
        """See `DirectionEstimator`."""
        edges = edge_pixels(left, disparity, surface)
        axis = arc_of_edges(edges, self._config.heading_max, self._config.curvature_max)
        return direction_along(axis, surface)

    def follow(self, axis: RoadAxis, surface: RoadSurface) -> RoadDirection | None:
        """See `DirectionEstimator`."""
        return direction_along(axis, surface)


class DenseVanishingPoint:
    """The paper's vanishing point (Ozgunalp et al. 2017): a straight road on the plane that it tells."""

    def __init__(self, config: VanishingPointConfig) -> None:
        self._config = config

    def estimate(self, left: Image, disparity: DisparityMap, surface: RoadSurface) -> RoadDirection:
        """See `DirectionEstimator`."""
        edges = edge_pixels(left, disparity, surface)
        point = quartic_vanishing_point(edges, surface, left.shape)
        if point is None:
            u, v = vanishing_point_of(RoadAxis(), surface)
            point = QuarticVanishingPoint(u, v, ())
        centred = self._config.centred_principal_point
        pitch, yaw = pitch_and_yaw((point.u, point.v), surface.camera, left.shape, centred)
        plane = QuadraticSurface.plane(surface.camera, surface.camera_height, pitch)
        return RoadDirection(RoadAxis(yaw), plane, (point.u, point.v), point.u_of_row)

    def follow(self, axis: RoadAxis, surface: RoadSurface) -> RoadDirection | None:  # noqa: ARG002
        """See `DirectionEstimator`: the plane of the road depends on the vanishing point of the frame."""
        return None


def direction_estimator(config: VanishingPointConfig) -> DirectionEstimator:
    """Return the estimator that `config.method` names."""
    return ArcVanishingPoint(config) if config.method == "arc" else DenseVanishingPoint(config)


def direction_along(axis: RoadAxis, surface: RoadSurface) -> RoadDirection:
    """Return the direction of a known axis on a measured surface."""
    return RoadDirection(axis, surface, vanishing_point_of(axis, surface))


def vanishing_point_of(axis: RoadAxis, surface: RoadSurface) -> tuple[float, float]:
    """Return the vanishing point (u, v) [px] of the road's direction at the vehicle."""
    camera = surface.camera
    u = camera.cx + camera.fx * np.tan(axis.heading) / np.cos(surface.pitch)
    return float(u), float(camera.cy - camera.fy * np.tan(surface.pitch))


def pitch_and_yaw(
    point: tuple[float, float], camera: StereoCamera, shape: tuple[int, ...], centred: bool = False
) -> tuple[float, float]:
    """Return pitch (down) and yaw (right) [rad] of the road against the camera.

    pitch = atan((cy - v_vp) / fy), yaw = atan((u_vp - cx) cos(pitch) / fx). With `centred` the paper's
    formula (section IV-2, eq. 7 and 8; Nieto et al. 2007): beta = atan(tan(alpha_v) (1 - 2 v_vp / V)),
    gamma = atan(tan(alpha_u) (2 u_vp / U - 1)), which takes the middle of the image of `shape` (V, U) for
    the principal point.
    """
    if centred:
        rows, columns = shape[:2]
        tan_v, tan_u = rows / (2 * camera.fy), columns / (2 * camera.fx)
        pitch, yaw = (
            np.arctan(tan_v * (1 - 2 * point[1] / rows)),
            np.arctan(tan_u * (2 * point[0] / columns - 1)),
        )
    else:
        pitch = np.arctan((camera.cy - point[1]) / camera.fy)
        yaw = np.arctan((point[0] - camera.cx) * np.cos(pitch) / camera.fx)
    return float(pitch), float(yaw)
