# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The lanes of every frame that is to be judged: recorded in a bag, or detected first."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property, partial
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.detector import LaneDetection, LaneDetector
from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.geometry.road_surface import RoadSurface
from lane_dp_ros.core.pipeline import FrameResult
from lane_dp_ros.core.types import Lane, StereoFrame
from lane_dp_ros.messages.bag import BagReader
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.messages.node_config import NodeConfig
from lane_dp_ros.messages.stereo_bag import find_stereo_topics, read_stereo_pairs, sync_of_bag
from lane_dp_ros.tools.evaluation.image_arrivals import image_arrivals
from lane_dp_ros.tools.evaluation.truth_file import LabelledFrame
from lane_dp_ros.tools.offline.answered import answered
from lane_dp_ros.tools.parallel import parallel_map
from lane_dp_ros.tools.progress import progress

Image8 = NDArray[np.uint8]


@dataclass(frozen=True)
class FrameAnswer:
    """The lanes of one frame, in the left optical frame of `camera` (None: that of the truth).

    `latency` [s] is None where it is not known. `surface` is the road's as measured in this frame, None where
    none was found; it means nothing where `surface_sought` is False, as of lanes that were recorded.
    `road_edges` are in the same frame as the lanes, None where nothing tells of any.
    """

    lanes: tuple[Lane, ...]
    camera: StereoCamera | None = None
    latency: float | None = None
    surface: RoadSurface | None = None
    surface_sought: bool = False
    road_edges: tuple[Lane, ...] | None = None


Detect = Callable[[Image8, Image8, StereoCamera], FrameAnswer]


@dataclass(frozen=True)
class BagAnswers:
    """The answers of a bag by stamp [ns], and the stamps of all its frames, answered or not."""

    answers: dict[int, FrameAnswer]
    stamps: frozenset[int]
    notes: tuple[str, ...] = ()

    def at(self, stamp_ns: int) -> FrameAnswer:
        """Return the answer of a stamp [ns]; nothing found, of what others tell of, where there is none."""
        return self.answers.get(stamp_ns, self._nothing)

    @cached_property
    def _nothing(self) -> FrameAnswer:
        tells_of_edges = any(answer.road_edges is not None for answer in self.answers.values())
        return FrameAnswer((), road_edges=() if tells_of_edges else None)


def detected_answers(reader: BagReader, config: tuple[NodeConfig, DetectorConfig], jobs: int) -> BagAnswers:
    """Detect the lanes of every stereo pair of a bag, as `lane_dp run` does, with a progress bar.

    The latency is the detector's computing time. Raises CommandError when the bag has no stereo pairs.
    """
    topics, (node, detector) = find_stereo_topics(reader), config
    total = reader.message_count([topics.images["left"]])
    pairs = read_stereo_pairs(reader, topics, sync_of_bag(node.sync_tolerance))
    answers: dict[int, FrameAnswer] = {}
    problems: list[str] = []
    with answered(pairs, detector, jobs) as found:
        for bag_pair, answer in progress(found, total, "pair"):
            answers[bag_pair.pair.stamp_ns] = _frame_answer(answer)
            problems += [text for text in [answer if isinstance(answer, str) else answer.problem] if text]
    if not answers:
        tolerance = f"no left and right stamps within {node.sync_tolerance:g} s"
        raise CommandError(f"{reader.path} has no stereo pair that can be used: {tolerance}")
    notes = tuple(f"{problems.count(text)} x {text}" for text in sorted(set(problems)))
    arrivals = image_arrivals(reader, {side: [image] for side, image in topics.images.items()})
    return BagAnswers(answers, frozenset(answers) | frozenset(arrivals), notes)


def file_answers(
    root: Path, frames: Iterable[LabelledFrame], detect: Detect, jobs: int
) -> Iterator[tuple[LabelledFrame, FrameAnswer]]:
    """Yield each frame whose images are files below `root` with the lanes detected in it alone.

    `detect` must be picklable. Raises CommandError naming a frame without image paths, or a file that is no
    picture.
    """
    frames = tuple(frames)
    for frame in frames:
        if not (frame.left and frame.right):
            raise CommandError(
                f"frame {frame.name!r} names no files left and right, as a folder's truth must"
            )
    with parallel_map(partial(_detect_files, root, detect), frames, jobs) as found:
        yield from progress(found, len(frames), "pair")


def read_picture(path: Path) -> Image8:
    """Return a picture, (H, W) gray or (H, W, 3) BGR. Raises CommandError for what is none."""
    if not path.is_file():
        raise CommandError(f"{path}: no such picture")
    image = cv2.imread(str(path), cv2.IMREAD_ANYCOLOR)
    if image is None:
        raise CommandError(f"{path} cannot be read as a picture")
    return np.asarray(image, dtype=np.uint8)


def detect_pair(detector: DetectorConfig, left: Image8, right: Image8, camera: StereoCamera) -> FrameAnswer:
    """Return the lanes and the road's surface of a pair by itself, and the computing time."""
    return _detected(LaneDetector(camera, detector).detect(StereoFrame(left, right)), camera)


def _detect_files(root: Path, detect: Detect, frame: LabelledFrame) -> FrameAnswer:
    left, right = read_picture(root / frame.left), read_picture(root / frame.right)
    if (left.shape[1], left.shape[0]) != frame.size:
        came, wanted = f"{left.shape[1]}x{left.shape[0]}", f"{frame.size[0]}x{frame.size[1]}"
        raise CommandError(f"{root / frame.left} is {came}, its frame in the truth {wanted}, expected equal")
    return detect(left, right, frame.camera)


def _frame_answer(answer: FrameResult | str) -> FrameAnswer:
    if isinstance(answer, str) or answer.detection is None:
        return FrameAnswer((), road_edges=())
    found = _detected(answer.detection, answer.camera)
    return replace(found, lanes=answer.lanes, road_edges=answer.road_edges)


def _detected(detection: LaneDetection, camera: StereoCamera | None) -> FrameAnswer:
    """Return what a detection says of the lanes and the road; its latency is the computing time."""
    seconds = sum(detection.seconds.values())
    lanes, edges = detection.lanes, detection.road_edges
    return FrameAnswer(lanes, camera, seconds, detection.road, surface_sought=True, road_edges=edges)
