# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Answers as a video: the left image with the lanes drawn."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.pipeline import FrameResult
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.messages.pictures import draw_overlay
from lane_dp_ros.messages.stereo_bag import BagPair
from lane_dp_ros.tools.offline.staged_file import staged_file

CODEC = "mp4v"  # MPEG-4 part 2: of what every OpenCV can write, what most players take
ENDING = ".mp4"
PERIODS = 10  # pairs before which the frame rate is told
SLOWEST, FASTEST = 1.0, 120.0  # frames a second


@contextmanager
def video(path: Path, force: bool = False) -> Iterator[LaneVideo]:
    """Open a video, which appears at `path` when the block ends well.

    Raises as `staged_file`, and CommandError for a name that is not an .mp4's and when not every picture
    reached the disk.
    """
    with staged_file(path, force) as written, _quiet_opencv():
        if path.suffix.lower() != ENDING:
            raise CommandError(f"{path}: a video is written as {ENDING}, such as {path.with_suffix(ENDING)}")
        lane_video = LaneVideo(written)
        try:
            yield lane_video
        finally:
            lane_video.close()
        found = _count_pictures(written)
        if found != lane_video.count:
            told = f"{found} of {lane_video.count} pictures can be read of it"
            raise CommandError(f"cannot write {path}: {told}, as when the disk is full")


@contextmanager
def _quiet_opencv() -> Iterator[None]:
    """Keep OpenCV and its FFmpeg from writing to standard error what an error of ours says in a line."""
    os.environ.setdefault("OPENCV_FFMPEG_LOGLEVEL", "-8")  # read when the first video is opened; -8: nothing
    log = getattr(cv2.utils, "logging", cv2)  # in OpenCV 5, and in 4
    before = log.setLogLevel(0)
    try:
        yield
    finally:
        log.setLogLevel(before)


class LaneVideo:
    """Writes an .mp4 of pictures, all in the size of the first, as fast as they were taken in the median.

    `count` is the number of pictures handed to the file.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._waiting: list[tuple[int, NDArray[np.uint8]]] = []
        self._writer: cv2.VideoWriter | None = None
        self._size = (0, 0)
        self.count = 0

    def write(self, pair: BagPair, answer: FrameResult) -> None:
        """Append the left image of a pair with its lanes and road edges."""
        if answer.camera is not None:
            lines = answer.lanes + answer.road_edges
            self.append(pair.pair.stamp_ns, draw_overlay(answer.frame.left, lines, answer.camera))

    def append(self, stamp_ns: int, picture: NDArray[np.uint8]) -> None:
        """Append a picture (H, W, 3) BGR that was taken at `stamp_ns`."""
        if self._writer is not None:
            self._append(picture)
            return
        self._waiting.append((stamp_ns, picture))
        if len(self._waiting) > PERIODS:
            self._open()

    def close(self) -> None:
        """Write what waits, and the end of the file."""
        if self._writer is None and self._waiting:
            self._open()
        if self._writer is not None:
            self._writer.release()

    def _open(self) -> None:
        """Begin the file, now that the rate is known, with the pictures so far."""
        pictures = [picture for _, picture in self._waiting]
        rate = _rate([stamp for stamp, _ in self._waiting])
        self._size = (pictures[0].shape[1] // 2 * 2, pictures[0].shape[0] // 2 * 2)  # the codec's
        self._writer = cv2.VideoWriter(str(self._path), cv2.VideoWriter.fourcc(*CODEC), rate, self._size)
        if not self._writer.isOpened():
            raise CommandError(f"this OpenCV, {cv2.__version__}, cannot write {CODEC} to {self._path.name}")
        self._waiting.clear()
        for picture in pictures:
            self._append(picture)

    def _append(self, picture: NDArray[np.uint8]) -> None:
        assert self._writer is not None
        columns, rows = self._size
        fitting = picture[:rows, :columns]
        if fitting.shape[:2] != (rows, columns):  # else OpenCV leaves it out without a word
            fitting = np.asarray(cv2.resize(picture, self._size), np.uint8)
        self._writer.write(fitting)
        self.count += 1


def _count_pictures(path: Path) -> int:
    """Return how many pictures can be read of a video: OpenCV's writer tells of no error."""
    film = cv2.VideoCapture(str(path))
    count = int(film.get(cv2.CAP_PROP_FRAME_COUNT)) if film.isOpened() else 0
    film.release()
    return count


def _rate(stamps_ns: list[int]) -> float:
    """Return the frames a second at which stamps come in the median; 10 where there is but one."""
    periods = [step for step in np.diff(stamps_ns) if step > 0]
    return float(np.clip(1e9 / np.median(periods), SLOWEST, FASTEST)) if periods else 10.0
