# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Dense disparity of the rectified pair."""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.geometry.disparity_map import DisparityMap
from lane_dp_ros.core.parameter import Parameters, check_order, parameter
from lane_dp_ros.core.types import StereoFrame

Image = NDArray[np.uint8]

ABOVE_HORIZON = 0.03  # of fy; rows higher above the principal point hold no road (a slope of 3 %)
SPECKLE_RANGE = 2  # px; change of disparity inside a patch
SUBPIXEL = 16  # OpenCV's fixed-point disparities
SEARCHED = 32  # disparities searched in the reduced images: enough to start from, a fortieth of the time


@dataclass(frozen=True)
class DisparityConfig(Parameters):
    """The stereo matcher; names and meaning as in stereo_image_proc (semi-global block matching).

    What is in px counts pixels of the reduced images.
    """

    correlation_window_size: int = parameter(
        5, "Side of the matched window, odd.", unit="px", limits=(1, 31), step=2
    )
    P1: int = parameter(400, "Penalty on disparity changes of 1 px.", limits=(0, 4000))
    P2: int = parameter(1600, "Penalty on larger disparity changes, more than P1.", limits=(1, 16000))
    uniqueness_ratio: int = parameter(  # OpenCV divides by 100 less this
        10, "How much the best match must beat the second.", unit="%", limits=(0, 99)
    )
    speckle_size: int = parameter(
        25, "Smaller patches of disparity are invalid.", unit="px", limits=(0, 1000)
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        check_order(self, "disparity", "P1", "P2")


def dense_disparity(
    frame: StereoFrame, camera: StereoCamera, config: DisparityConfig, largest: float
) -> DisparityMap:
    """Return the disparity of a rectified grey pair, up to `largest` [px].

    Semi-global matching (Hirschmueller 2008), three directions, on the rows that can show road only, reduced
    so far that there are 32 disparities to search. The camera's disparity offset is taken off, so that depth
    is fx * baseline / disparity. Of images too small to match, and without a right image, nothing is known.
    """
    shape = frame.left.shape[0], frame.left.shape[1]
    first = int(np.clip(camera.cy - ABOVE_HORIZON * camera.fy, 0, shape[0]))
    downscale = max(1, math.ceil(largest / SEARCHED))
    offset = round(camera.disparity_offset)
    if frame.right is None or abs(offset) >= shape[1] or first >= shape[0]:
        return DisparityMap.unknown(shape)
    right = _moved(frame.right[first:], offset)
    matched = _match(frame.left[first:], right, downscale, config)
    if matched is None:
        return DisparityMap.unknown(shape)
    matched -= np.float32(camera.disparity_offset - offset)
    found = DisparityMap(shape, first, matched, downscale)
    u_right = found.centres[0] - np.float32(camera.disparity_offset) - found.matched
    with np.errstate(invalid="ignore"):
        found.matched[(u_right < 0) | (u_right > shape[1] - 1)] = np.nan  # matched with a border repeated
    return found


def _moved(image: Image, columns: int) -> Image:
    """Return an image moved to the right, or to the left where negative, its border repeated."""
    if columns == 0:
        return image
    pads = max(columns, 0), max(-columns, 0)
    padded = cv2.copyMakeBorder(image, 0, 0, *pads, cv2.BORDER_REPLICATE)
    start = pads[1]
    return np.asarray(padded[:, start : start + image.shape[1]])


def _match(left: Image, right: Image, downscale: int, config: DisparityConfig) -> NDArray[np.float32] | None:
    """Match at the reduced resolution; None where the images are too small."""
    size = left.shape[1] // downscale, left.shape[0] // downscale
    if min(size) < config.correlation_window_size + 2:
        return None
    small = [_reduced(image, size, downscale) for image in (left, right)]
    fixed = stereo_matcher(config, SEARCHED).compute(*small)[:, SEARCHED:]
    matched = fixed.astype(np.float32)
    matched *= np.float32(downscale / SUBPIXEL)
    matched[fixed < 0] = np.nan
    return matched


def _reduced(image: Image, size: tuple[int, int], downscale: int) -> Image:
    """Return the mean of cells of whole pixels, `size` of them across and along.

    To the left of the image there is room for all that is searched: the matcher leaves no strip blind.
    """
    whole = image[: size[1] * downscale, : size[0] * downscale]
    small = cv2.resize(whole, size, interpolation=cv2.INTER_AREA)
    return np.asarray(cv2.copyMakeBorder(small, 0, 0, SEARCHED, 0, cv2.BORDER_REPLICATE))


def stereo_matcher(config: DisparityConfig, disparities: int) -> cv2.StereoSGBM:
    """Return the matcher (Hirschmueller, PAMI 2008) that searches a number of disparities, from 0 on."""
    return cv2.StereoSGBM.create(
        minDisparity=0,
        numDisparities=disparities,
        blockSize=config.correlation_window_size,
        P1=config.P1,
        P2=config.P2,
        uniquenessRatio=config.uniqueness_ratio,
        speckleWindowSize=config.speckle_size,
        speckleRange=SPECKLE_RANGE,
        mode=cv2.STEREO_SGBM_MODE_SGBM_3WAY,
    )
