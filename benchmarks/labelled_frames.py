# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Judge any detector as `lane_dp evaluate` judges ours: the function lanes(left, right, camera) of a file.

python benchmarks/labelled_frames.py FILE.py BAG_OR_DIR --truth FILE [the options of lane_dp evaluate]
`left`, `right` are uint8 (H, W, 3) BGR, `camera` a StereoCamera; it returns polylines (N, 3) [m] in the left
optical frame.
"""

from __future__ import annotations

import argparse
import runpy
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from command_line import exit_code
from numpy.typing import NDArray

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.tracking.tracker import LaneTracker, TrackingConfig
from lane_dp_ros.core.types import Lane
from lane_dp_ros.messages.bag import BagReader
from lane_dp_ros.messages.camera import camera_from_ros
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.messages.image import stereo_images_from_ros
from lane_dp_ros.messages.node_config import NodeConfig
from lane_dp_ros.messages.stereo_bag import CAPACITY, BagPair, find_stereo_topics, read_stereo_pairs
from lane_dp_ros.messages.stereo_sync import StereoSync
from lane_dp_ros.tools.cli.evaluate import add_arguments, evaluate
from lane_dp_ros.tools.evaluation.answers import BagAnswers, FrameAnswer, file_answers
from lane_dp_ros.tools.evaluation.evaluate import DetectorChoice
from lane_dp_ros.tools.evaluation.truth_file import LabelledFrame
from lane_dp_ros.tools.parallel import available_cpus, parallel_map
from lane_dp_ros.tools.progress import progress

Image8 = NDArray[np.uint8]
PAINT_WIDTH = 0.12  # m; a polyline has none


@dataclass(frozen=True)
class FunctionChoice(DetectorChoice):
    """Detects by the function `lanes` of a Python file."""

    file: Path = Path()

    def answer_bag(self, reader: BagReader) -> BagAnswers:
        """Detect in the stereo pairs of a bag, and give the lines ids as the node does."""
        topics, tracker = find_stereo_topics(reader), LaneTracker(TrackingConfig(enabled=False))
        pairs = read_stereo_pairs(
            reader, topics, StereoSync(round(NodeConfig().sync_tolerance * 1e9), CAPACITY)
        )
        total = reader.message_count([topics.images["left"]])
        answers = {}
        with parallel_map(partial(answer_pair, self.file), pairs, self.jobs) as found:
            for pair, answer in progress(found, total, "pair"):
                stamp_ns = pair.pair.stamp_ns
                answers[stamp_ns] = replace(answer, lanes=tracker.update(answer.lanes, stamp_ns))
        if not answers:
            raise CommandError(f"{reader.path} has no stereo pair that can be used")
        return BagAnswers(answers, frozenset(answers))

    def answer_files(
        self, root: Path, frames: Sequence[LabelledFrame]
    ) -> Iterator[tuple[LabelledFrame, FrameAnswer]]:
        """Detect in the image files that the frames name."""
        return file_answers(root, frames, partial(detect, self.file), self.jobs)


def answer_pair(file: Path, bag_pair: BagPair) -> FrameAnswer:
    """Detect in a pair of image messages."""
    left, right = stereo_images_from_ros(bag_pair.pair.left, bag_pair.pair.right)
    camera = camera_from_ros(*bag_pair.infos)
    return detect(file, left, right, camera)


def detect(file: Path, left: Image8, right: Image8, camera: StereoCamera) -> FrameAnswer:
    """Return what the function finds as lanes of confidence 1, and the seconds that it takes."""
    start = time.perf_counter()
    polylines = function_of(file)(bgr(left), bgr(right), camera)
    seconds = time.perf_counter() - start
    lanes = tuple(lane(np.asarray(points, dtype=np.float64)) for points in polylines)
    return FrameAnswer(lanes, camera, seconds)


@cache
def function_of(file: Path) -> Any:
    """Return the function `lanes` of a Python file. Raises CommandError for a file without one."""
    function = runpy.run_path(str(file)).get("lanes")
    if not callable(function):
        raise CommandError(f"{file} has no function lanes(left, right, camera)")
    return function


def bgr(image: Image8) -> Image8:
    """Return a gray or BGR picture as BGR."""
    picture = cv2.cvtColor(image, cv2.COLOR_GRAY2BGR) if image.ndim == 2 else image
    return np.asarray(picture, dtype=np.uint8)


def lane(points: NDArray[np.float64]) -> Lane:
    """Return a lane of these points (N, 3), its offset at the vehicle for the tracker."""
    x, z = points[:, 0], points[:, 2]
    offset = float(np.interp(0.0, z, x)) if len(points) < 3 else float(np.polyfit(z, x, 2)[-1])
    return Lane(points, 1.0, PAINT_WIDTH, "other", 0.0, offset)


def main() -> int:
    """Judge and print; 1 for a known error, in one line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file", type=Path, metavar="FILE.py")
    add_arguments(parser)
    parser.add_argument("--jobs", type=int, default=available_cpus(), metavar="N")
    return exit_code(run, parser.parse_args())


def run(arguments: argparse.Namespace) -> None:
    """Judge what the file's function finds; the file is read first, to say at once what it lacks."""
    function_of(arguments.file)
    if arguments.surface is not None:
        raise CommandError("--surface judges the road that lane_dp measures: the lanes of a file have none")
    evaluate(arguments, FunctionChoice(jobs=arguments.jobs, file=arguments.file))


if __name__ == "__main__":
    sys.exit(main())
