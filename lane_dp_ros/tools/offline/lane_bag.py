# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Answers as a bag: the topics of the node, beside the camera infos that the lanes are projected with."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.pipeline import FrameResult
from lane_dp_ros.core.types import Lane
from lane_dp_ros.messages.bag import BagWriter
from lane_dp_ros.messages.bag_message import bag_message
from lane_dp_ros.messages.image import compressed_image_to_ros, image_to_ros
from lane_dp_ros.messages.lanes import lanes_to_ros, road_edges_to_ros
from lane_dp_ros.messages.pictures import draw_birds_eye, draw_overlay
from lane_dp_ros.messages.stereo_bag import BagPair
from lane_dp_ros.messages.stereo_sync import SIDES

RESOLUTION = 2.0**-13  # m, 0.12 mm: coordinates are multiples of it, and a bag compresses to a third
Pictures = Literal["jpeg", "raw", "none"]


@dataclass(frozen=True)
class LaneBag:
    """Writes `lanes`, `road_edges`, the camera infos and pictures of each answer to a bag.

    The pictures are `overlay/image` and `ipm/image`, as JPEG on their `/compressed` topics, raw, or none;
    with `left_image` the left image too. `namespace` stands before all topics; `lifetime` [s] is the lanes'.
    """

    writer: BagWriter
    namespace: str
    lifetime: float
    pictures: Pictures = "jpeg"
    left_image: bool = False

    def write(self, pair: BagPair, answer: FrameResult) -> None:
        """Write an answer under the time at which its pair was recorded."""
        header = pair.pair.left.header
        lanes = lanes_to_ros(_rounded(answer.lanes), header, bag_message, self.lifetime)
        edges = road_edges_to_ros(_rounded(answer.road_edges), header, bag_message, self.lifetime)
        self._write("lanes", pair, lanes)
        self._write("road_edges", pair, edges)
        for side, info in zip(SIDES, pair.infos, strict=True):
            self._write(f"{side}/camera_info", pair, info)
        if self.left_image:
            self._write_picture("left/image_rect", pair, answer.frame.left)
        if self.pictures != "none":
            self._write_drawn(pair, answer)

    def _write_drawn(self, pair: BagPair, answer: FrameResult) -> None:
        lines, left = answer.lanes + answer.road_edges, answer.frame.left
        if answer.camera is not None:
            self._write_picture("overlay/image", pair, draw_overlay(left, lines, answer.camera))
        if answer.detection is not None and answer.detection.birds_eye is not None:
            self._write_picture("ipm/image", pair, draw_birds_eye(answer.detection.birds_eye, left, lines))

    def _write_picture(self, name: str, pair: BagPair, picture: NDArray[np.uint8]) -> None:
        header = pair.pair.left.header
        if self.pictures == "raw":
            self._write(name, pair, image_to_ros(picture, header, bag_message))
        else:
            self._write(f"{name}/compressed", pair, compressed_image_to_ros(picture, header, bag_message))

    def _write(self, name: str, pair: BagPair, message: Any) -> None:
        self.writer.write(f"{self.namespace}/{name}", pair.time_ns, message)


def _rounded(lanes: tuple[Lane, ...]) -> tuple[Lane, ...]:
    return tuple(replace(lane, points=np.rint(lane.points / RESOLUTION) * RESOLUTION) for lane in lanes)
