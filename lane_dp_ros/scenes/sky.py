# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The sky, and woods before it that stand at one distance all around."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.scenes.course import HAZE_DISTANCE
from lane_dp_ros.scenes.surface import SKY_DISTANCE, Surface
from lane_dp_ros.scenes.textures import foliage
from lane_dp_ros.scenes.view import View

Singles = NDArray[np.float32]

WOODS_DISTANCE = 250.0  # [m] to the woods on the horizon

HORIZON = np.array([238, 234, 230], np.float32)  # grey levels BGR, as all colours here
ZENITH = np.array([236, 206, 172], np.float32)
WOODS = np.array([52, 72, 62], np.float32)


def draw_sky(surface: Surface, view: View) -> None:
    """Draw sky and woods into an empty surface: the sky as what it emits, the woods as what they reflect."""
    rows = slice(0, _last_row(view) + 1)
    turned = view.road.heading(np.array([view.course.position])) + view.pose.yaw + view.eye / WOODS_DISTANCE
    bearing = (np.arctan(view.slopes[0]) + turned).astype(np.float32)
    up = ((view.horizon - np.arange(view.shape[0])[rows]) / view.camera.fy).astype(np.float32)
    shape = (len(up), view.size[0])
    woods, cover = _woods(bearing, up * np.float32(WOODS_DISTANCE))
    sky = _sky(np.broadcast_to(bearing, shape), np.broadcast_to(up[:, None], shape))
    surface.emission[rows] = np.square(sky * np.float32(1 / 255)) * (1 - cover)
    surface.albedo[rows] = np.square(woods * np.float32(1 / 255)) * cover
    is_wood = cover[..., 0] > 0.5
    far = np.where(is_wood, WOODS_DISTANCE, SKY_DISTANCE).astype(np.float32)
    surface.position[rows] = view.origin.astype(np.float32) + view.rays[rows] * far[..., None]
    surface.depth[rows] = np.where(is_wood, WOODS_DISTANCE, np.inf)
    surface.normal[rows] = -view.axes[2]


def _last_row(view: View) -> int:
    """Return the last row in which the ground leaves the sky free; hills may show it anywhere."""
    lowest = view.shape[0] - 1
    if view.road.hill:
        return lowest
    drop = view.road.camera_height + 30 * abs(np.tan(view.road.roll))
    return min(lowest, int(view.horizon + view.camera.fy * drop / HAZE_DISTANCE) + 2)


def _sky(bearing: Singles, up: Singles) -> Singles:
    clouds = foliage(bearing * 90, up * 300)
    blue = np.clip(up * 2.5, 0, 1)[..., None]
    return HORIZON * (1 - blue) + ZENITH * blue + 5 * clouds[..., None]


def _woods(bearing: Singles, up: Singles) -> tuple[Singles, Singles]:
    """Return colour (H, W, 3) and cover (H, W, 1) of woods; `up` (H,) [m] is each row's height there."""
    tops = 11 + 4 * np.sin(3.1 * bearing) + 2.5 * np.sin(11 * bearing + 1) + 1.2 * np.sin(37 * bearing)
    across, height = np.meshgrid(bearing * WOODS_DISTANCE * 6, up * 6)
    noise = foliage(across.astype(np.float32), height.astype(np.float32))
    cover = np.clip((tops + noise * 0.7 - up[:, None]) * 2, 0, 1)[..., None]
    light = 0.85 + 0.02 * up[:, None] + 0.28 * noise
    return np.maximum(WOODS * light[..., None], 0).astype(np.float32), cover.astype(np.float32)
