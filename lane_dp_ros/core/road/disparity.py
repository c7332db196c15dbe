# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Dense disparity of the rectified pair."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.geometry.disparity_map import DisparityMap
from lane_dp_ros.core.parameter import Parameters, check_order, parameter
from lane_dp_ros.core.types import StereoFrame

ABOVE_HORIZON = 0.03  # of fy; rows higher above the principal point hold no road (a slope of 3 %)
SPECKLE_RANGE = 2  # px; change of disparity inside a patch
SUBPIXEL = 16  # OpenCV's fixed-point disparities


@dataclass(frozen=True)
class DisparityConfig(Parameters):
    """The stereo matcher; names and meaning as in stereo_image_proc (semi-global block matching)."""

    disparity_range: int = parameter(
        128,
        "Number of disparities searched; bounds the nearest depth.",
        unit="px",
        limits=(32, 1024),
        step=32,
    )
    correlation_window_size: int = parameter(
        7, "Side of the matched window, odd.", unit="px", limits=(1, 31), step=2
    )
    P1: int = parameter(400, "Penalty on disparity changes of 1 px.", limits=(0, 4000))
    P2: int = parameter(1600, "Penalty on larger disparity changes, more than P1.", limits=(1, 16000))
    uniqueness_ratio: int = parameter(  # OpenCV divides by 100 less this
        10, "How much the best match must beat the second.", unit="%", limits=(0, 99)
    )
    speckle_size: int = parameter(
        100, "Smaller patches of disparity are invalid.", unit="px", limits=(0, 1000)
    )
    downscale: int = parameter(
        2, "Match at 1/downscale of the image's resolution; 2 takes a tenth of the time.", limits=(1, 4)
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        check_order(self, "disparity", "P1", "P2")


def dense_disparity(frame: StereoFrame, camera: StereoCamera, config: DisparityConfig) -> DisparityMap:
    """Return the disparity of a rectified grey pair.

    Semi-global matching (Hirschmueller 2008), three directions, on the rows that can show road only. The
    camera's disparity offset is taken off, so that depth is fx * baseline / disparity. Of images too small
    to match, and without a right image, nothing is known.
    """
    shape = frame.left.shape[0], frame.left.shape[1]
    first = int(np.clip(camera.cy - ABOVE_HORIZON * camera.fy, 0, shape[0]))
    matched = None if frame.right is None else _match(frame.left[first:], frame.right[first:], config)
    if matched is None:
        return DisparityMap.unknown(shape)
    return DisparityMap(shape, first, matched - np.float32(camera.disparity_offset))


def _match(
    left: NDArray[np.uint8], right: NDArray[np.uint8], config: DisparityConfig
) -> NDArray[np.float32] | None:
    """Match at the reduced resolution; None where the images are narrower than the range searched."""
    rows, columns = left.shape
    size = columns // config.downscale, rows // config.downscale
    window = config.correlation_window_size
    matcher = stereo_matcher(config)
    searched = matcher.getMinDisparity() + matcher.getNumDisparities()
    if min(size) < window + 2 or size[0] <= searched + window:  # OpenCV 4.6 aborts the process
        return None
    small = [cv2.resize(image, size, interpolation=cv2.INTER_AREA) for image in (left, right)]
    fixed = matcher.compute(*small)
    matched = fixed.astype(np.float32)
    matched *= np.float32(columns / size[0] / SUBPIXEL)
    matched[fixed < 0] = np.nan
    return matched


def stereo_matcher(config: DisparityConfig) -> cv2.StereoSGBM:
    """Return the matcher (Hirschmueller, PAMI 2008), for images that are 1/downscale of the full size."""
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
