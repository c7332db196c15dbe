# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Answers as a recording of Rerun (https://rerun.io): the left image, and lanes and road edges in space."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.pipeline import FrameResult
from lane_dp_ros.core.types import Lane
from lane_dp_ros.messages.image import JPEG_QUALITY
from lane_dp_ros.messages.lanes import ROAD_EDGE_WIDTH, lane_colour
from lane_dp_ros.messages.stereo_bag import BagPair
from lane_dp_ros.tools.offline.staged_file import staged_file


@contextmanager
def rerun_file(path: Path, force: bool = False) -> Iterator[RerunFile]:
    """Open an .rrd file, which appears at `path` when the block ends well.

    Raises ModuleNotFoundError where the SDK of Rerun is not installed, and as `staged_file`.
    """
    import rerun

    with staged_file(path, force) as written:
        recording = rerun.RecordingStream("lane_dp")
        recording.save(written)
        try:
            yield RerunFile(rerun, recording)
        finally:
            recording.disconnect()


class RerunFile:
    """Logs under `camera`, which is the left optical frame: x right, y down, z forward."""

    def __init__(self, rerun: Any, recording: Any) -> None:
        self._rerun, self._recording = rerun, recording

    def write(self, pair: BagPair, answer: FrameResult) -> None:
        """Log an answer at the stamp of its left image."""
        if answer.camera is None:
            return
        self._recording.set_time("stamp", timestamp=np.datetime64(pair.pair.stamp_ns, "ns"))
        self._log_image(answer, answer.camera)
        self._log_lines("camera/lanes", answer.lanes)
        self._log_lines("camera/road_edges", answer.road_edges)

    def _log_image(self, answer: FrameResult, camera: StereoCamera) -> None:
        rows, columns = answer.frame.left.shape[:2]
        axes = self._rerun.ViewCoordinates.RDF
        pinhole = self._rerun.Pinhole(
            image_from_camera=camera.P_left[:, :3], width=columns, height=rows, camera_xyz=axes
        )
        self._recording.log("camera", pinhole)
        _, data = cv2.imencode(".jpg", answer.frame.left, [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])
        image = self._rerun.EncodedImage(contents=data.tobytes(), media_type="image/jpeg")
        self._recording.log("camera/left", image)

    def _log_lines(self, entity: str, lanes: tuple[Lane, ...]) -> None:
        strips = self._rerun.LineStrips3D(
            [lane.points for lane in lanes],
            radii=[max(lane.paint_width, ROAD_EDGE_WIDTH) / 2 for lane in lanes],
            colors=[[*(round(255 * part) for part in lane_colour(lane)), 255] for lane in lanes],
            labels=[f"{lane.role} {lane.id} {lane.kind} {lane.confidence:.2f}" for lane in lanes],
        )
        self._recording.log(entity, strips)
