# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Stereo pairs with the disparity that LiDAR measured, in the layout of KITTI's stereo benchmark of 2015."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.tools.datasets.kitti import StereoSequence, load_pairs, read_single_pair, single_pairs

LIDAR, PER_PIXEL = "disp_occ_0", 256  # the folder, and its pictures' values per pixel of disparity


@dataclass(frozen=True)
class LidarFrame:
    """The files of one pair, and of the disparity of its left image."""

    pair: StereoSequence
    lidar: Path

    @property
    def name(self) -> str:
        """The file's name without its ending, 000072_10."""
        return self.lidar.stem

    @property
    def camera(self) -> StereoCamera:
        """The pair's camera. Raises CommandError for a calibration that is none of a rectified pair."""
        try:
            return StereoCamera.from_projections(self.pair.P_left, self.pair.P_right)
        except ValueError as error:
            raise CommandError(f"the calibration of {self.lidar}: {error}") from None

    def load(self) -> tuple[NDArray[np.uint8], NDArray[np.uint8], NDArray[np.float64]]:
        """Return the left and the right picture and the disparity (H, W) [px], 0 where there is none.

        Raises CommandError for a file that is no picture or of another type, and for unequal sizes.
        """
        images = next(load_pairs(self.pair))
        assert images.right is not None
        disparity = _load_disparity(self.lidar)
        if disparity.shape != images.left.shape[:2]:
            sizes = (f"{width}x{height}" for height, width in (disparity.shape, images.left.shape[:2]))
            raise CommandError("{} is {}, its left image {}, expected equal".format(self.lidar, *sizes))
        return images.left, images.right, disparity


def read_lidar_frames(folder: Path) -> tuple[list[LidarFrame], int]:
    """Return the pairs that have a LiDAR disparity, and the number of those without.

    `folder` has image_2/NNNNNN_10.png, image_3, disp_occ_0 and calib_cam_to_cam.txt, or a folder of that name
    with NNNNNN.txt; it may also be the parent of such a folder `training`. Raises CommandError naming what
    was looked for.
    """
    pairs = list(zip(*single_pairs(folder), strict=True))
    root = pairs[0][0].parents[1]
    measured = {path.name for path in (root / LIDAR).glob("*_10.png")}
    if odd := sorted(measured - {left.name for left, _ in pairs}):
        raise CommandError(
            f"{root / LIDAR / odd[0]} has no left image, expected {pairs[0][0].with_name(odd[0])}"
        )
    if not measured:
        looked = root / LIDAR / "*_10.png"
        raise CommandError(f"no LiDAR disparity of any of the {len(pairs)} images: looked for {looked}")
    frames = [
        LidarFrame(read_single_pair(left, right), root / LIDAR / left.name)
        for left, right in pairs
        if left.name in measured
    ]
    return frames, len(pairs) - len(frames)


def _load_disparity(path: Path) -> NDArray[np.float64]:
    picture = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    if picture is None:
        raise CommandError(f"{path} cannot be read as a picture")
    if picture.dtype != np.uint16 or picture.ndim != 2:
        came = f"{picture.dtype} {'gray' if picture.ndim == 2 else 'colour'}"
        raise CommandError(f"{path} is {came}, expected uint16 gray (disparity * {PER_PIXEL}, 0: none)")
    return picture / PER_PIXEL
