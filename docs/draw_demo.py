# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Draw the moving picture of the README: rendered drives, and what the pipeline finds in them.

python docs/draw_demo.py    write docs/demo.webp
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.pipeline import LanePipeline
from lane_dp_ros.core.types import StereoFrame
from lane_dp_ros.messages.pictures import draw_birds_eye, draw_overlay
from lane_dp_ros.scenes.scene import CAMERA, ScenePair
from lane_dp_ros.scenes.suite import Drive

TARGET = Path(__file__).resolve().parent / "demo.webp"
DRIVES = ("guard_rails", "tree_shadows")
FRAMES, RATE = 24, 10.0  # of each drive; [Hz]
HEIGHT = 260  # px of the picture
QUALITY = 55  # of the lossy compression

Image8 = NDArray[np.uint8]


def frames(category: str) -> Iterator[Image8]:
    """Yield the pictures (H, W, 3) BGR of a drive: the left image with the lanes, and the road from above."""
    pipeline, drive = LanePipeline(), Drive(category, FRAMES, RATE)
    for index in range(FRAMES):
        yield picture(pipeline, drive.render(index))


def picture(pipeline: LanePipeline, pair: ScenePair) -> Image8:
    """Return what a pipeline makes of a pair, BGR."""
    frame = StereoFrame(pair.left, pair.right)
    result = pipeline.process(frame, CAMERA, pair.stamp_ns, DetectorConfig())
    lines = (*result.lanes, *result.road_edges)
    views = [draw_overlay(pair.left, lines, CAMERA)]
    if result.detection is not None and result.detection.birds_eye is not None:
        views.append(draw_birds_eye(result.detection.birds_eye, pair.left, lines))
    return np.hstack([_of_height(view) for view in views])


def _of_height(view: Image8) -> Image8:
    width = round(HEIGHT * view.shape[1] / view.shape[0])
    return np.asarray(cv2.resize(view, (width, HEIGHT), interpolation=cv2.INTER_AREA), dtype=np.uint8)


def main() -> None:
    """Render, detect, write."""
    cv2.setNumThreads(1)
    drawn = [each for category in DRIVES for each in frames(category)]
    first, *rest = [Image.fromarray(np.ascontiguousarray(each[:, :, ::-1])) for each in drawn]
    period = round(1000 / RATE)  # ms
    first.save(TARGET, save_all=True, append_images=rest, duration=period, loop=0, quality=QUALITY, method=6)


if __name__ == "__main__":
    main()
