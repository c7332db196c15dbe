# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""How one camera stands before a rendered road, and which pixel sees which place."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.scenes.course import Course
from lane_dp_ros.scenes.road import Road

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]


@dataclass(frozen=True)
class Pose:
    """How the camera stands against the road: `lateral` [m] right of the road's axis, `pitch` [rad] positive
    where it looks down, `yaw` [rad] positive where it looks to the right.
    """

    lateral: float = 0.0
    pitch: float = 0.0
    yaw: float = 0.0


@dataclass(frozen=True)
class View:
    """One camera's view of the road: `eye` [m] is how far right of the left camera it stands.

    `seed` makes the world, `time` [s] has passed since the sequence began. World points are right, up and
    ahead [m] of the place on the road's axis that the vehicle passes, as in `Course`.
    """

    camera: StereoCamera
    size: tuple[int, int]  # width, height
    course: Course
    pose: Pose
    eye: float
    seed: int
    time: float

    @property
    def road(self) -> Road:
        """The road looked at."""
        return self.course.road

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns of the picture."""
        return self.size[1], self.size[0]

    @cached_property
    def axes(self) -> Floats:
        """The camera's axes as rows: its right, its down and its forward in the world."""
        sine, cosine = np.sin(self.pose.pitch), np.cos(self.pose.pitch)
        across, along = np.sin(self.pose.yaw), np.cos(self.pose.yaw)
        return np.array(
            [
                [along, 0, -across],
                [-sine * across, -cosine, -sine * along],
                [cosine * across, -sine, cosine * along],
            ]
        )

    @cached_property
    def origin(self) -> Floats:
        """Where the camera is, in the world."""
        ground = float(self.course.height(0.0, self.pose.lateral))
        foot = np.array([self.pose.lateral, ground + self.road.camera_height, 0.0])
        return foot + self.eye * self.axes[0]

    @property
    def horizon(self) -> float:
        """The picture row [px] of the horizon of the plane on which the vehicle stands."""
        return float(self.camera.cy - self.camera.fy * np.tan(self.pose.pitch))

    @cached_property
    def rays(self) -> Singles:
        """The direction (H, W, 3) in the world in which pixels look; of length 1 along the camera's axis."""
        x, y = self.slopes
        right, down, forward = self.axes.astype(np.float32)
        return x[None, :, None] * right + y[:, None, None] * down + forward

    @property
    def slopes(self) -> tuple[Singles, Singles]:
        """Tangents of the angles at which the columns (W,) and the rows (H,) look."""
        u, v = (np.arange(size, dtype=np.float32) for size in self.size)
        return (u - self.camera.cx) / self.camera.fx, (v - self.camera.cy) / self.camera.fy

    def optical(self, points: ArrayLike) -> Floats:
        """Return world points (N, 3) in the optical frame of this camera: right, down, forward [m]."""
        return (np.asarray(points, dtype=np.float64) - self.origin) @ self.axes.T

    def pixels(self, points: ArrayLike) -> Floats:
        """Return the pixels (N, 2) of world points (N, 3)."""
        return self.camera.project(self.optical(points))
