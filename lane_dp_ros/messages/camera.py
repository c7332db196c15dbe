# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""sensor_msgs/CameraInfo to the stereo camera, and back."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.messages.make import Make


def camera_from_ros(left_info: Any, right_info: Any) -> StereoCamera:
    """Return the stereo camera that two sensor_msgs/CameraInfo messages describe (their P).

    Raises ValueError for sizes that differ or values that make no stereo camera.
    """
    left, right = ((int(info.width), int(info.height)) for info in (left_info, right_info))
    if left != right:
        raise ValueError(f"CameraInfo is {_size(left)} left and {_size(right)} right, expected equal sizes")
    return StereoCamera.from_projections(left_info.p, right_info.p)


def _size(size: tuple[int, int]) -> str:
    return f"{size[0]}x{size[1]}"


def camera_info_to_ros(P: NDArray[np.float64], shape: tuple[int, ...], header: Any, make: Make) -> Any:
    """Return the sensor_msgs/CameraInfo of a rectified camera: no distortion, no rotation, K from P (3, 4).

    `shape` is that of its images: (H, W) or (H, W, 3).
    """
    return make(
        "sensor_msgs/msg/CameraInfo",
        header=header,
        height=shape[0],
        width=shape[1],
        distortion_model="plumb_bob",
        d=np.zeros(5),
        k=P[:, :3],
        r=np.eye(3),
        p=P,
    )
