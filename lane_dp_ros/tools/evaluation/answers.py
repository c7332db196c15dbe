# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The lanes of every frame that is to be judged: recorded in a bag, or detected first."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

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
from lane_dp_ros.messages.camera import camera_from_ros
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.messages.lanes import lanes_from_ros
from lane_dp_ros.messages.node_config import NodeConfig
from lane_dp_ros.messages.stereo_bag import IMAGES, find_stereo_topics, read_stereo_pairs, sync_of_bag
from lane_dp_ros.tools.evaluation.truth_file import LabelledFrame
from lane_dp_ros.tools.offline import answered
from lane_dp_ros.tools.parallel import parallel_map
from lane_dp_ros.tools.progress import progress

Image8 = NDArray[np.uint8]

MARKERS = "visualization_msgs/msg/MarkerArray"


@dataclass(frozen=True)
class FrameAnswer:
    """The lanes of one frame, in the left optical frame of `camera` (None: that of the truth).

    `latency` [s] is None where it is not known. `surface` is the road's as measured in this frame, None where
    none was found; it means nothing where `surface_sought` is False, as of lanes that were recorded.
    """

    lanes: tuple[Lane, ...]
    camera: StereoCamera | None = None
    latency: float | None = None
    surface: RoadSurface | None = None
    surface_sought: bool = False


Detect = Callable[[Image8, Image8, StereoCamera], FrameAnswer]


@dataclass(frozen=True)
class BagAnswers:
    """The answers of a bag by stamp [ns], and the stamps of all its frames, answered or not."""

    answers: dict[int, FrameAnswer]
    stamps: frozenset[int]
    notes: tuple[str, ...] = ()


def lanes_topic(reader: BagReader) -> str | None:
    """Return the topic of recorded lanes, in whatever namespace, None without.

    Raises CommandError when there are several.
    """
    topics = [t for t, kind in reader.topics.items() if kind == MARKERS and t.rpartition("/")[2] == "lanes"]
    found = sorted(topic for topic in topics if reader.message_count([topic]))
    if len(found) > 1:
        raise CommandError(f"{reader.path} has several topics of lanes: {', '.join(found)}, expected one")
    return found[0] if found else None


def recorded_answers(reader: BagReader, topic: str) -> BagAnswers:
    """Return the lanes that a bag carries; of two answers to one stamp (a bag played twice) the first.

    The latency of an answer is the time from the recording of its image pair to its own: one recorder, one
    clock. It is not known for a bag without the images, or one that was written offline.
    Raises CommandError for lanes with points that are not finite numbers.
    """
    namespace = topic.rpartition("/")[0]
    camera, arrivals = _camera(reader, namespace), _arrivals(reader, namespace)
    answers: dict[int, FrameAnswer] = {}
    repeated = 0
    for _, time_ns, message in reader.messages([topic]):
        if not message.markers:
            raise CommandError(f"{reader.path}: a message on {topic} has no marker, so no stamp")
        stamp_ns = _stamp_ns(message.markers[0])
        if stamp_ns in answers:
            repeated += 1
            continue
        lanes = _lanes(reader, topic, message)
        waited = time_ns - arrivals.get(stamp_ns, time_ns)
        answers[stamp_ns] = FrameAnswer(lanes, camera, waited / 1e9 if waited > 0 else None)
    notes = (f"{repeated} more answers to stamps that had one: the first is judged",) if repeated else ()
    return BagAnswers(answers, frozenset(answers) | frozenset(arrivals), notes)


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
    return BagAnswers(answers, frozenset(answers) | frozenset(_arrivals(reader, topics.namespace)), notes)


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
        return FrameAnswer(())
    return replace(_detected(answer.detection, answer.camera), lanes=answer.lanes)


def _detected(detection: LaneDetection, camera: StereoCamera | None) -> FrameAnswer:
    """Return what a detection says of the lanes and the road; its latency is the computing time."""
    seconds = sum(detection.seconds.values())
    return FrameAnswer(detection.lanes, camera, seconds, detection.road, surface_sought=True)


def _lanes(reader: BagReader, topic: str, message: Any) -> tuple[Lane, ...]:
    for marker in message.markers:
        points = np.array([[p.x, p.y, p.z] for p in marker.points], dtype=np.float64)
        if not np.all(np.isfinite([*points.ravel(), marker.color.a])):
            where = f"{topic}, stamp {_stamp_ns(marker)} ns, marker {marker.ns} {marker.id}"
            raise CommandError(f"{reader.path}: {where} holds values that are not finite numbers (NaN?)")
    return lanes_from_ros(message)


def _camera(reader: BagReader, namespace: str) -> StereoCamera | None:
    """Return the camera of the bag's camera infos, None without them."""
    infos = [_first(reader, f"{namespace}/{side}/camera_info") for side in ("left", "right")]
    return None if None in infos else camera_from_ros(*infos)


def _first(reader: BagReader, topic: str) -> Any | None:
    return next((message for _, _, message in reader.messages([topic])), None)


def _arrivals(reader: BagReader, namespace: str) -> dict[int, int]:
    """Return, for each stamp [ns] of a left image, when the later one of its pair was recorded [ns]."""
    topics = {side: [f"{namespace}/{side}/{name}" for name in IMAGES] for side in ("left", "right")}
    arrivals = {_stamp_ns(message): time_ns for _, time_ns, message in reader.messages(topics["left"])}
    for _, time_ns, message in reader.messages(topics["right"]):
        stamp_ns = _stamp_ns(message)
        if stamp_ns in arrivals:
            arrivals[stamp_ns] = max(arrivals[stamp_ns], time_ns)
    return arrivals


def _stamp_ns(message: Any) -> int:
    stamp = message.header.stamp
    return int(stamp.sec) * 1_000_000_000 + int(stamp.nanosec)
