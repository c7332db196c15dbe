# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The frames of a drive: left images from one bag, their lanes from the same or from another."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.types import Lane
from lane_dp_ros.messages.bag import BagReader
from lane_dp_ros.messages.camera import camera_from_ros
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.messages.image import Image8, compressed_image_from_ros, image_from_ros
from lane_dp_ros.messages.stamp import stamp_from_ros
from lane_dp_ros.messages.stereo_sync import Side
from lane_dp_ros.messages.stereo_topics import StereoTopics

PARTNER_WINDOW = 2_000_000_000  # ns of recording around a left image in which its right one is looked for


@dataclass(frozen=True, eq=False)
class Frame:
    """A left image that has lanes; `time_ns` is when it was recorded, `infos` the CameraInfo by side."""

    index: int
    stamp_ns: int
    time_ns: int
    infos: dict[Side, Any]
    lanes: tuple[Lane, ...]

    @property
    def size(self) -> tuple[int, int]:
        """The image's width and height [px], as its calibration has them."""
        return int(self.infos["left"].width), int(self.infos["left"].height)

    @property
    def camera(self) -> StereoCamera:
        """The stereo camera; without the right side's calibration one of 1 m baseline.

        The place of a line is not touched by that: ground and depth take fx * baseline from the same camera.
        Raises ValueError for values that make no camera.
        """
        left = self.infos["left"]
        if "right" in self.infos:
            return camera_from_ros(left, self.infos["right"])
        P_right = np.reshape(left.p, (3, 4)).copy()
        P_right[0, 3] -= P_right[0, 0]
        return StereoCamera.from_projections(left.p, P_right)


@dataclass(frozen=True)
class Drive:
    """The frames of a bag that have lanes, by stamp; `left_out` are left images that have none."""

    bag: Path
    topics: StereoTopics
    frames: tuple[Frame, ...]
    left_out: int

    @property
    def name(self) -> str:
        """The drive's name: the bag's, without its ending."""
        return self.bag.stem

    @property
    def fingerprint(self) -> str:
        """A digest of the lanes, by which a file of judgements knows that it judges these."""
        digest = hashlib.sha256()
        for frame in self.frames:
            digest.update(f"{frame.stamp_ns}:{[(lane.role, lane.id) for lane in frame.lanes]}".encode())
            for lane in frame.lanes:
                digest.update(np.round(lane.points, 6).tobytes())
        return digest.hexdigest()[:16]

    def left_message(self, frame: Frame) -> Any:
        """Return the message of a frame's left image."""
        with BagReader(self.bag) as reader:  # each time anew: SQLite serves one thread only
            found = reader.messages_between(self.topics.images["left"], frame.time_ns, frame.time_ns + 1)
            message = next(
                (each for each in found if stamp_from_ros(each.header.stamp) == frame.stamp_ns), None
            )
        if message is None:
            raise CommandError(f"{self.bag} has changed: the left image of frame {frame.index} is gone")
        return message

    def right_message(self, frame: Frame, tolerance_ns: int) -> Any | None:
        """Return the message of the right image that goes with a frame, None where there is none."""
        start, end = frame.time_ns - PARTNER_WINDOW, frame.time_ns + PARTNER_WINDOW
        with BagReader(self.bag) as reader:
            found = reader.messages_between(self.topics.images["right"], start, end)
            near = [
                (abs(stamp_from_ros(message.header.stamp) - frame.stamp_ns), message) for message in found
            ]
        distance, message = min(near, key=lambda pair: pair[0], default=(tolerance_ns + 1, None))
        return message if distance <= tolerance_ns else None

    def image(self, frame: Frame) -> Image8:
        """Return the left image, gray or BGR. Raises ValueError when it cannot be read."""
        message = self.left_message(frame)
        return compressed_image_from_ros(message) if hasattr(message, "format") else image_from_ros(message)
