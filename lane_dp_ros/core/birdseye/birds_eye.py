# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Inverse perspective mapping: the road from above, straightened along its axis, in metres."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import cv2
import numpy as np
from numpy.typing import ArrayLike, NDArray

from lane_dp_ros.core.geometry.disparity_map import DisparityMap
from lane_dp_ros.core.geometry.road_axis import RoadAxis
from lane_dp_ros.core.geometry.road_surface import RoadSurface
from lane_dp_ros.core.parameter import Parameters, parameter

Floats = NDArray[Any]

IMAGE_BORDER = 2  # px; interpolation next to the border makes up grey values
DEPTH_MIN = 3.0  # m
SAMPLES = (2, 4)  # across and along each cell; more give nothing, fewer along lose faint lines
BELOW_CAMERAS = 0.01  # m; what stands higher hides no road
HOLES = np.ones((3, 5), np.uint8)  # cells; between those that a standing thing moves to
ABOVE_PX = 1.0  # px; less difference in disparity is noise, however many metres it is


@dataclass(frozen=True)
class BirdsEyeConfig(Parameters):
    """The piece of road that is looked at, in road coordinates."""

    near: float = parameter(
        4.0,
        "Where the view begins, ahead of the camera; road nearer than 3 m is not looked at.",
        unit="m",
        limits=(0.0, 20.0),
    )
    length: float = parameter(30.0, "Length of the view along the road.", unit="m", limits=(10.0, 100.0))
    width: float = parameter(16.0, "Width of the view, half to each side.", unit="m", limits=(4.0, 40.0))
    forward_resolution: float = parameter(0.25, "Cell length.", unit="m", limits=(0.02, 1.0))
    lateral_resolution: float = parameter(0.05, "Cell width.", unit="m", limits=(0.01, 0.2))
    height_tolerance: float = parameter(
        0.12, "What stands higher above the road's surface is not road.", unit="m", limits=(0.02, 1.0)
    )


@dataclass(frozen=True, eq=False)
class BirdsEyeView:
    """The left image seen from above.

    Cell (row, column) shows the ground at road coordinates s[row], n[column] [m] (see `RoadAxis`): row 0
    is the farthest, columns go from left to right. `ipm_plane` maps road to image; `road_surface` gives
    depth. They are the same but for the paper's formulas, whose flat plane is a little off the road.
    """

    image: NDArray[np.uint8]
    """(rows, columns), grey; beyond the left image its border repeated."""
    seen: NDArray[np.bool_]
    """Cells that the camera sees."""
    on_road: NDArray[np.bool_]
    """Cells that are seen and do not stand above the road."""
    height: NDArray[np.float32]
    """Height [m] above the road's surface, NaN where there is no disparity."""
    map_u: NDArray[np.float32]
    map_v: NDArray[np.float32]
    s: NDArray[np.float64]
    n: NDArray[np.float64]
    axis: RoadAxis
    ipm_plane: RoadSurface
    road_surface: RoadSurface

    @cached_property
    def resolution(self) -> tuple[float, float]:
        """Metres per row and per column."""
        return float(self.s[0] - self.s[1]), float(self.n[1] - self.n[0])

    def warp(self, image: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """Return this view of any image of the left camera's size, grey or BGR; black where unseen."""
        warped = cv2.remap(image, self.map_u, self.map_v, cv2.INTER_LINEAR)
        warped[~self.seen] = 0
        return np.asarray(warped, dtype=np.uint8)

    def to_pixels(self, s: ArrayLike, n: ArrayLike) -> NDArray[np.float64]:
        """Return the pixels (N, 2) of the left image at road coordinates s, n (N,) [m]."""
        x, z = self.axis.to_ground(np.asarray(s, dtype=np.float64), np.asarray(n, dtype=np.float64))
        return np.column_stack(self.ipm_plane.ground_to_pixel(x, z))

    def to_points(self, s: ArrayLike, n: ArrayLike) -> NDArray[np.float64]:
        """Return points (N, 3) [m] of the road's surface, left optical frame, at road coordinates."""
        pixels = self.to_pixels(s, n)
        _, depth = self.road_surface.pixel_to_ground(pixels[:, 0], pixels[:, 1])
        return self.road_surface.camera.back_project(pixels, depth)

    def to_road(self, points: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return road coordinates s, n (N,) [m] of points (N, 3) [m] in the left optical frame."""
        u, v = self.road_surface.camera.project(points).T
        s, n = self.axis.from_ground(*self.ipm_plane.pixel_to_ground(u, v))
        return np.asarray(s), np.asarray(n)

    def columns(self, n: ArrayLike) -> NDArray[np.float64]:
        """Return the columns (N,), with fractions, of lateral positions n (N,) [m]."""
        return np.asarray((np.asarray(n) - self.n[0]) / self.resolution[1])

    def nearest_columns(self, n: ArrayLike) -> NDArray[np.intp]:
        """Return the columns (N,) of lateral positions n (N,) [m]; beyond the view those of its border."""
        nearest = np.rint(self.columns(n)).astype(np.intp)
        return np.asarray(np.minimum(np.maximum(nearest, 0), len(self.n) - 1))

    def cells(self, points: ArrayLike) -> NDArray[np.float64]:
        """Return column and row (N, 2), with fractions, of points (N, 3) [m] in the left optical frame."""
        s, n = self.to_road(points)
        return np.column_stack([self.columns(n), (self.s[0] - s) / self.resolution[0]])


def birds_eye_view(
    image: NDArray[np.uint8],
    disparity: DisparityMap,
    road_surface: RoadSurface,
    axis: RoadAxis,
    config: BirdsEyeConfig,
    ipm_plane: RoadSurface | None = None,
) -> BirdsEyeView:
    """Return the bird's-eye view of the grey left image (H, W) (paper, section IV-2, eq. 6).

    The map from road to image is `ipm_plane` where given (the flat road of the paper's equation), else
    `road_surface`. Cells whose disparity stands more than `config.height_tolerance` above the surface are
    not `on_road`.
    """
    ipm_plane = road_surface if ipm_plane is None else ipm_plane
    s, n = _grid(config)
    x, z = axis.to_ground(s[:, None].astype(np.float32), n[None].astype(np.float32))
    map_u, map_v = (np.asarray(a, dtype=np.float32) for a in ipm_plane.ground_to_pixel(x, z))
    seen = _inside(map_u, map_v, image.shape) & (z > DEPTH_MIN) & (z < road_surface.summit)
    rows, columns = image.shape
    np.clip(map_u, 0, columns - 1, out=map_u)  # the border goes on: no false edge where the view ends
    np.clip(map_v, 0, rows - 1, out=map_v)
    height, stands = _above_road(disparity.nearest(map_u, map_v), map_u, map_v, road_surface, config)
    grey = _area_mean(image, map_u, map_v)
    return BirdsEyeView(grey, seen, seen & ~stands, height, map_u, map_v, s, n, axis, ipm_plane, road_surface)


def _above_road(
    matched: Floats, u: Floats, v: Floats, road_surface: RoadSurface, config: BirdsEyeConfig
) -> tuple[NDArray[np.float32], NDArray[np.bool_]]:
    """Return how high [m] the disparity `matched` lies above the surface, and where it is no road."""
    on_surface = road_surface.disparity(u, v).astype(np.float32)
    with np.errstate(divide="ignore", invalid="ignore"):
        height = np.float32(road_surface.camera_height) * (1 - on_surface / matched)
        stands = (height > config.height_tolerance) & (matched - on_surface > ABOVE_PX)
    return np.asarray(height, dtype=np.float32), stands


def right_view(image: NDArray[np.uint8], view: BirdsEyeView) -> BirdsEyeView:
    """Return what the grey right image (H, W) shows in the cells of a view of the left one.

    The surface's disparity leads from pixel to pixel. `seen` is what both cameras see, `on_road` what of it
    neither sees standing on the road. All that is no picture stays the left camera's.
    """
    surface = view.road_surface
    shift = surface.disparity(view.map_u, view.map_v) + surface.camera.disparity_offset
    map_u = np.asarray(view.map_u - shift, dtype=np.float32)
    seen = view.seen & _inside(map_u, view.map_v, image.shape)
    np.clip(map_u, 0, image.shape[1] - 1, out=map_u)
    grey = _area_mean(image, map_u, view.map_v)
    return replace(view, image=grey, seen=seen, on_road=view.on_road & seen & ~_hidden_from_right(view))


def _hidden_from_right(view: BirdsEyeView) -> NDArray[np.bool_]:
    """Return the cells in whose place the right camera sees what stands on the road.

    What stands h above the road is seen against ground that lies farther off; between what the left and the
    right camera see it against lie b h / (H - h), for a baseline b and cameras at the height H.
    """
    rows, columns = np.nonzero(view.seen & ~view.on_road)
    height = view.height[rows, columns]
    camera = view.road_surface.camera
    aside = camera.baseline * height / np.maximum(view.road_surface.camera_height - height, BELOW_CAMERAS)
    first = columns - np.rint(aside / view.resolution[1]).astype(int)
    hidden = np.zeros(view.seen.shape, np.uint8)
    hidden[rows[first >= 0], first[first >= 0]] = 1
    return np.asarray(cv2.morphologyEx(hidden, cv2.MORPH_CLOSE, HOLES) > 0)


def _area_mean(
    image: NDArray[np.uint8], map_u: NDArray[np.float32], map_v: NDArray[np.float32]
) -> NDArray[np.uint8]:
    """Return the mean grey value over each cell: near the vehicle a cell covers dozens of pixels."""
    rows, columns = map_u.shape
    fine = columns * SAMPLES[0], rows * SAMPLES[1]
    u, v = (cv2.resize(each, fine, interpolation=cv2.INTER_LINEAR) for each in (map_u, map_v))
    sampled = cv2.remap(image, u, v, cv2.INTER_LINEAR)
    return np.asarray(cv2.resize(sampled, (columns, rows), interpolation=cv2.INTER_AREA), dtype=np.uint8)


def _grid(config: BirdsEyeConfig) -> tuple[Floats, Floats]:
    """Return s of the rows, far to near, and n of the columns, at the cells' centres."""
    rows = round(config.length / config.forward_resolution)
    columns = round(config.width / config.lateral_resolution)
    s = config.near + (np.arange(rows)[::-1] + 0.5) * config.forward_resolution
    return s, (np.arange(columns) + 0.5) * config.lateral_resolution - config.width / 2


def _inside(u: Floats, v: Floats, shape: tuple[int, ...]) -> NDArray[np.bool_]:
    rows, columns = shape[:2]
    edge = IMAGE_BORDER
    return np.asarray((u >= edge) & (u < columns - edge) & (v >= edge) & (v < rows - edge))
