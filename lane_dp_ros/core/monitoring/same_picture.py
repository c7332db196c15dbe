# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Whether left and right show the same picture: one camera that serves as both."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.geometry.road_surface import RoadSurface

Grey = NDArray[np.uint8]

SMOOTHING = (3, 3)  # px; of what coding and noise add
SURROUNDINGS = (15, 15)  # px; pictures are compared to their means there
MIN_DISPARITY = 3.0  # px of the road; where it is less, two cameras see nearly the same
MIN_GRADIENT = 8.0  # grey levels per pixel across the image; less tells no shift
MIN_PIXELS = 100
SHIFT_MAX = 0.5  # px that a pixel of the same picture seems to be shifted by, at most
SHARE = 0.7  # of the pixels; KITTI's and rendered pairs have at most 0.4, pictures coded anew at least 0.85


def is_same_picture(left: Grey, right: Grey, nominal: RoadSurface) -> bool:
    """Return whether two grey pictures (H, W) are one, which may be coded anew, brighter or of less contrast.

    `nominal` is the road expected. Looked at is what is distinct where that road has a disparity: there a
    pair of two cameras is shifted. Pictures without anything distinct there count as two.
    """
    near = _near_rows(nominal, left.shape)
    if np.count_nonzero(near) * left.shape[1] < MIN_PIXELS or left.shape[1] < 2:
        return False
    smooth = [cv2.GaussianBlur(image[near], SMOOTHING, 0).astype(np.float32) for image in (left, right)]
    a, b = (np.asarray(image - cv2.blur(image, SURROUNDINGS), np.float32) for image in smooth)
    across = np.abs(np.gradient(smooth[0], axis=1))
    distinct = across > MIN_GRADIENT
    if np.count_nonzero(distinct) < MIN_PIXELS or not np.any(b):
        return False
    error = a - b * (np.vdot(a, b) / np.vdot(b, b))
    share = np.mean(np.abs(error[distinct]) < SHIFT_MAX * across[distinct])
    return bool(share >= SHARE)


def _near_rows(nominal: RoadSurface, shape: tuple[int, ...]) -> NDArray[np.bool_]:
    """Return which rows (H,) show road so near that its disparity is distinct."""
    camera = nominal.camera
    expected = nominal.disparity(np.array([camera.cx]), np.arange(shape[0])) + camera.disparity_offset
    return np.asarray(np.abs(expected) > MIN_DISPARITY)
