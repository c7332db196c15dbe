# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Draw the gallery of docs/gallery.md: rendered scenes, what is found in them, failures, and a report.

python docs/draw_gallery.py [DIR]    write the pictures to DIR, default docs/_pictures
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.detector import LaneDetector
from lane_dp_ros.core.types import StereoFrame
from lane_dp_ros.messages.pictures import draw_overlay
from lane_dp_ros.scenes.scene import CAMERA
from lane_dp_ros.scenes.suite import Drive

PICTURES = Path(__file__).resolve().parent / "_pictures"
SHEET = (
    *("straight", "tight_curve", "crest", "motorway", "double_lines", "yellow_lines", "road_works"),
    *("hatching", "zebra", "kerbs", "concrete", "low_sun", "night_in_town", "tree_shadows", "bridge"),
    *("wet", "vehicles", "parked_cars", "guard_rails", "tram_rails"),
)
FOUND = ("tree_shadows", "night", "kerbs", "yellow_lines", "bridge", "tight_curve", "vehicles", "wet_night")
FAILURES = ("over_exposure", "wet", "no_paint_ghost_lines")
REPORTED = ("over_exposure", "wet", "no_paint_ghost_lines", "low_sun", "slush", "vehicles")
FRAME = 2
WIDTH = 700  # px of a picture of two side by side
TRUTH_COLOUR = (60, 60, 255)  # blue, green, red
JPEG = [cv2.IMWRITE_JPEG_QUALITY, 85]

Image8 = NDArray[np.uint8]


def lane_dp(*arguments: object) -> None:
    """Run a command of lane_dp. Raises CalledProcessError where it fails."""
    command = [sys.executable, "-m", "lane_dp_ros.tools.cli", *map(str, arguments)]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)


def detected(category: str, with_truth: bool) -> Image8:
    """Return a scene's left image with what is found in it and, below that, in red what is there."""
    pair = Drive(category).render(FRAME)
    found = LaneDetector(CAMERA).detect(StereoFrame(pair.left, pair.right))
    picture = pair.left.copy()
    if with_truth:
        lines = [np.rint(label.uv).astype(np.int32) for label in pair.truth.labels if label.painted]
        cv2.polylines(picture, lines, False, TRUTH_COLOUR, 2, cv2.LINE_AA)
    return draw_overlay(picture, (*found.lanes, *found.road_edges), CAMERA)


def side_by_side(pictures: Sequence[Image8]) -> Image8:
    """Return pictures of one size in two columns."""
    height = round(WIDTH * pictures[0].shape[0] / pictures[0].shape[1])
    small = [cv2.resize(each, (WIDTH, height), interpolation=cv2.INTER_AREA) for each in pictures]
    return np.vstack([np.hstack(small[i : i + 2]) for i in range(0, len(small), 2)])


def draw_sheet(folder: Path) -> None:
    """Draw the sheet of thumbnails that `lane_dp scenes --sheet` writes."""
    with tempfile.TemporaryDirectory() as place:
        sheet = Path(place) / "sheet.png"
        lane_dp("scenes", *SHEET, "--sheet", sheet)
        cv2.imwrite(str(folder / "sheet.jpg"), cv2.imread(str(sheet)), JPEG)


def write_report(folder: Path) -> None:
    """Write the page of an evaluation of a few scenes to a folder `extra`, which Sphinx copies as it is."""
    with tempfile.TemporaryDirectory() as place:
        scenes = Path(place) / "scenes"
        lane_dp("scenes", *REPORTED, "--frames", 3, "-o", scenes)
        lane_dp("evaluate", scenes, "--report", folder / "extra" / "report")


def main(folder: Path = PICTURES) -> None:
    """Draw all."""
    cv2.setNumThreads(1)
    folder.mkdir(parents=True, exist_ok=True)
    draw_sheet(folder)
    found = side_by_side([detected(each, with_truth=False) for each in FOUND])
    cv2.imwrite(str(folder / "found.jpg"), found, JPEG)
    failures = np.vstack([detected(each, with_truth=True) for each in FAILURES])
    cv2.imwrite(str(folder / "failures.jpg"), failures, JPEG)
    write_report(folder)


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:2]))
