# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Dense disparity of the rectified pair."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.config import DisparityConfig
from lane_dp_ros.core.geometry.camera import StereoCamera

ABOVE_HORIZON = 0.03  # of fy; rows higher above the principal point hold no road (a slope of 3 %)
SPECKLE_RANGE = 2  # px; change of disparity inside a patch
SUBPIXEL = 16  # OpenCV's fixed-point disparities


def dense_disparity(
    left: NDArray[np.uint8], right: NDArray[np.uint8] | None, camera: StereoCamera, config: DisparityConfig
) -> NDArray[np.float32]:
    """Return the disparity (H, W) [px] of a rectified grey pair (H, W), NaN where there is no match.

    Semi-global matching (Hirschmueller 2008), three directions, on the rows that can show road only. The
    camera's disparity offset is taken off, so that depth is fx * baseline / disparity. Images too small
    to match, or no right image, give NaN everywhere.
    """
    disparity = np.full(left.shape, np.nan, dtype=np.float32)
    first = int(np.clip(camera.cy - ABOVE_HORIZON * camera.fy, 0, left.shape[0]))
    matched = None if right is None else _match(left[first:], right[first:], config)
    if matched is not None:
        disparity[first:] = matched - np.float32(camera.disparity_offset)
    return disparity


def _match(
    left: NDArray[np.uint8], right: NDArray[np.uint8], config: DisparityConfig
) -> NDArray[np.float32] | None:
    """Match at the reduced resolution; None where the images are narrower than the range searched."""
    rows, columns = left.shape
    size = columns // config.downscale, rows // config.downscale
    window = config.correlation_window_size
    matcher = _matcher(config)
    searched = matcher.getMinDisparity() + matcher.getNumDisparities()
    if min(size) < window + 2 or size[0] <= searched + window:  # OpenCV 4.6 aborts the process
        return None
    small = [cv2.resize(image, size, interpolation=cv2.INTER_AREA) for image in (left, right)]
    fixed = matcher.compute(*small)
    scale = columns / size[0] / SUBPIXEL
    found = np.where(fixed >= 0, fixed * np.float32(scale), np.nan)
    return np.asarray(cv2.resize(found.astype(np.float32), (columns, rows), interpolation=cv2.INTER_NEAREST))


def _matcher(config: DisparityConfig) -> cv2.StereoSGBM:
    scale = config.downscale
    return cv2.StereoSGBM.create(
        minDisparity=0,
        numDisparities=-(-config.disparity_range // scale // 16) * 16,
        blockSize=config.correlation_window_size,
        P1=config.P1,
        P2=config.P2,
        uniquenessRatio=config.uniqueness_ratio,
        speckleWindowSize=config.speckle_size,
        speckleRange=SPECKLE_RANGE,
        mode=cv2.STEREO_SGBM_MODE_SGBM_3WAY,
    )
