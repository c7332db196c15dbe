# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Two image messages and two CameraInfo in, lanes with identities out: for node and offline run alike."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.detector import LaneDetection, LaneDetector
from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.geometry.disparity_map import DisparityMap
from lane_dp_ros.core.pipeline import FrameResult, LanePipeline
from lane_dp_ros.core.stopwatch import Stopwatch
from lane_dp_ros.core.types import Image, StereoFrame
from lane_dp_ros.messages.camera import camera_from_ros
from lane_dp_ros.messages.errors import one_line
from lane_dp_ros.messages.image import left_image_from_ros, stereo_images_from_ros
from lane_dp_ros.messages.stereo_sync import StereoPair


@dataclass(frozen=True, eq=False)
class StereoInput:
    """A pair of messages, read: the frame and its camera, or one line that says why they cannot be used."""

    frame: StereoFrame
    stamp_ns: int
    camera: StereoCamera | None = None
    problem: str = ""
    disparity: DisparityMap | None = None
    """What `LaneDetector.match` gave for the frame, where that was asked for."""


def read_pair(pair: StereoPair, infos: tuple[Any, Any]) -> StereoInput:
    """Return what a pair of sensor_msgs/Image or CompressedImage, with its CameraInfo, holds.

    Raises ValueError when an image cannot be read. All else that is wrong is the input's `problem`.
    """
    if pair.right is None:
        left, right = left_image_from_ros(pair.left), None
    else:
        left, right = stereo_images_from_ros(pair.left, pair.right)
    try:
        camera = _camera_for(infos, left, right)
        return StereoInput(StereoFrame(left, right), pair.stamp_ns, camera)
    except Exception as error:  # noqa: BLE001 - one bad frame, whatever is wrong with it, must not end the node
        return StereoInput(StereoFrame(left), pair.stamp_ns, problem=one_line(error))


def match_pair(pair: StereoPair, infos: tuple[Any, Any], config: DetectorConfig) -> StereoInput:
    """Return what a pair holds, with its disparity: the work that needs no pair before it.

    Raises ValueError when an image cannot be read. All else that goes wrong is the input's `problem`.
    """
    read = read_pair(pair, infos)
    if read.camera is None:
        return read
    try:
        return replace(read, disparity=LaneDetector(read.camera, config).match(read.frame))
    except Exception as error:  # noqa: BLE001 - as above
        return replace(read, camera=None, problem=one_line(error))


def detect_alone(
    pair: StereoPair, infos: tuple[Any, Any], config: DetectorConfig
) -> tuple[StereoInput, LaneDetection | None]:
    """Return a pair, read, and what is found in it without those before; None where there is no stereo pair.

    Raises ValueError when an image cannot be read. All else that goes wrong is the input's `problem`.
    """
    read = read_pair(pair, infos)
    if read.camera is None or read.frame.right is None:
        return read, None
    try:
        return read, LaneDetector(read.camera, config).detect(read.frame)
    except Exception as error:  # noqa: BLE001 - as above
        return replace(read, problem=one_line(error)), None


class StereoPipeline:
    """Answers pair after pair; the pairs must come in order."""

    def __init__(self, monitored: bool = True) -> None:
        self._pipeline = LanePipeline(monitored)

    def answer(self, pair: StereoPair, infos: tuple[Any, Any], config: DetectorConfig) -> FrameResult:
        """Return the lanes of a pair of messages with its CameraInfo.

        Raises ValueError when an image cannot be read. All else that goes wrong is the result's `problem`.
        """
        watch = Stopwatch()
        with watch("conversion"):
            read = read_pair(pair, infos)
        result = self.follow(read, config)
        return replace(result, seconds={**watch.seconds, **result.seconds})

    def follow(self, read: StereoInput, config: DetectorConfig) -> FrameResult:
        """Return the lanes of a pair that was read before."""
        if read.camera is None:  # nobody can tell where in this picture a line from before would be
            return FrameResult(read.frame, problem=read.problem)
        try:
            return self._pipeline.process(read.frame, read.camera, read.stamp_ns, config, read.disparity)
        except Exception as error:  # noqa: BLE001 - as above
            return FrameResult(read.frame, problem=one_line(error))


def _camera_for(infos: tuple[Any, Any], left: Image, right: Image | None) -> StereoCamera:
    """Return the camera; raise ValueError where the images' sizes contradict each other or the CameraInfo."""
    left_size = _size(left)
    if right is not None and _size(right) != left_size:
        raise ValueError(f"images are {left_size} left and {_size(right)} right, expected equal sizes")
    camera = camera_from_ros(*infos)
    info_size = f"{infos[0].width}x{infos[0].height}"
    if left_size != info_size:
        raise ValueError(f"images are {left_size}, their CameraInfo says {info_size}, expected equal sizes")
    return camera


def _size(image: Image) -> str:
    return f"{image.shape[1]}x{image.shape[0]}"
