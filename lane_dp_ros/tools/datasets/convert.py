# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Write stereo pairs as a bag with the topics that the node subscribes to."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.messages.bag import BagWriter
from lane_dp_ros.messages.bag_message import bag_message
from lane_dp_ros.messages.conversions import image_to_ros
from lane_dp_ros.tools.datasets.kitti import StereoImages, StereoSequence, load_pairs
from lane_dp_ros.tools.progress import progress

FRAME_ID = "left_camera_optical_frame"  # of both sides, as in image_pipeline: P_right refers to it, too
JPEG_QUALITY = 95


@dataclass(frozen=True)
class StereoBagWriter:
    """Writes pairs and their camera infos; as JPEG on the compressed topics if `jpeg`."""

    writer: BagWriter
    P_left: NDArray[np.float64]
    P_right: NDArray[np.float64]
    jpeg: bool = False

    def write(self, pair: StereoImages) -> None:
        """Write one pair: camera infos first, so that the first pair can be used."""
        header = bag_message("std_msgs/msg/Header", stamp=time_message(pair.stamp_ns), frame_id=FRAME_ID)
        for side, P in (("left", self.P_left), ("right", self.P_right)):
            info = camera_info(header, P, pair.left.shape)
            self.writer.write(f"/{side}/camera_info", pair.stamp_ns, info)
        for side, image in (("left", pair.left), ("right", pair.right)):
            topic = f"/{side}/image_rect"
            if self.jpeg:
                self.writer.write(f"{topic}/compressed", pair.stamp_ns, jpeg_message(image, header))
            else:
                self.writer.write(topic, pair.stamp_ns, image_to_ros(image, header, bag_message))


def convert(sequence: StereoSequence, writer: BagWriter, jpeg: bool = False) -> None:
    """Write a sequence to an open bag, with a progress bar."""
    stereo = StereoBagWriter(writer, sequence.P_left, sequence.P_right, jpeg)
    for pair in progress(load_pairs(sequence), len(sequence), "pair"):
        stereo.write(pair)


def time_message(stamp_ns: int) -> Any:
    """Return builtin_interfaces/Time."""
    seconds, nanoseconds = divmod(stamp_ns, 1_000_000_000)
    return bag_message("builtin_interfaces/msg/Time", sec=seconds, nanosec=nanoseconds)


def camera_info(header: Any, P: NDArray[np.float64], shape: tuple[int, ...]) -> Any:
    """Return the sensor_msgs/CameraInfo of a rectified camera: no distortion, no rotation, K from P."""
    return bag_message(
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


def jpeg_message(image: NDArray[np.uint8], header: Any) -> Any:
    """Return sensor_msgs/CompressedImage, its format written as compressed_image_transport does."""
    encoding = "mono8" if image.ndim == 2 else "bgr8"
    _, data = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])
    form = f"{encoding}; jpeg compressed {encoding}"
    return bag_message("sensor_msgs/msg/CompressedImage", header=header, format=form, data=data)
