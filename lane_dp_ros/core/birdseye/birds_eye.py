# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Inverse perspective mapping: the road from above, straightened along its axis, in metres."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.config import BirdsEyeConfig
from lane_dp_ros.core.geometry.road_axis import RoadAxis
from lane_dp_ros.core.geometry.road_surface import RoadSurface
from lane_dp_ros.core.types import BirdsEyeView

Floats = NDArray[Any]

IMAGE_BORDER = 2  # px; interpolation next to the border makes up grey values
DEPTH_MIN = 3.0  # m
SAMPLES = (2, 4)  # across and along each cell; more give nothing
BELOW_CAMERAS = 0.01  # m; what stands higher hides no road
HOLES = np.ones((3, 5), np.uint8)  # cells; between those that a standing thing moves to
ABOVE_PX = 1.0  # px; less difference in disparity is noise, however many metres it is


def birds_eye_view(
    image: NDArray[np.uint8],
    disparity: NDArray[np.float32],
    surface: RoadSurface,
    axis: RoadAxis,
    config: BirdsEyeConfig,
    ground: RoadSurface | None = None,
) -> BirdsEyeView:
    """Return the bird's-eye view of the grey left image (H, W) (paper, section IV-2, eq. 6).

    The map from road to image is `ground` where given (the flat road of the paper's equation), else
    `surface`. Cells whose disparity stands more than `config.height_tolerance` above the surface are not
    `on_road`.
    """
    ground = surface if ground is None else ground
    s, n = _grid(config)
    x, z = axis.to_ground(s[:, None].astype(np.float32), n[None].astype(np.float32))
    map_u, map_v = (np.asarray(a, dtype=np.float32) for a in ground.ground_to_pixel(x, z))
    seen = _inside(map_u, map_v, image.shape) & (z > DEPTH_MIN)
    rows, columns = image.shape
    np.clip(map_u, 0, columns - 1, out=map_u)  # the border goes on: no false edge where the view ends
    np.clip(map_v, 0, rows - 1, out=map_v)
    matched = cv2.remap(disparity, map_u, map_v, cv2.INTER_NEAREST)
    height = surface.height_above(matched, map_u, map_v).astype(np.float32)
    with np.errstate(invalid="ignore"):
        stands_out = matched - surface.disparity(map_u, map_v) > ABOVE_PX
        on_road = seen & ~((height > config.height_tolerance) & stands_out)
    grey = _area_mean(image, map_u, map_v)
    return BirdsEyeView(grey, seen, on_road, height, map_u, map_v, s, n, axis, ground, surface)


def right_view(image: NDArray[np.uint8], view: BirdsEyeView) -> BirdsEyeView:
    """Return what the grey right image (H, W) shows in the cells of a view of the left one.

    The surface's disparity leads from pixel to pixel. `seen` is what both cameras see, `on_road` what of it
    neither sees standing on the road. All that is no picture stays the left camera's.
    """
    shift = view.surface.disparity(view.map_u, view.map_v) + view.surface.camera.disparity_offset
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
    camera = view.surface.camera
    aside = camera.baseline * height / np.maximum(view.surface.camera_height - height, BELOW_CAMERAS)
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
