# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The images of the frames that the report shows, one frame at a time."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.detector import LaneDetection, LaneDetector
from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.types import StereoFrame
from lane_dp_ros.messages.bag import BagReader
from lane_dp_ros.messages.bag_files import looks_like_bag
from lane_dp_ros.messages.errors import CommandError, one_line
from lane_dp_ros.messages.image import Image8, image_from_ros
from lane_dp_ros.messages.node_config import NodeConfig
from lane_dp_ros.messages.stamp import stamp_from_ros
from lane_dp_ros.messages.stereo_bag import find_stereo_topics, read_stereo_pairs, sync_of_bag
from lane_dp_ros.messages.stereo_pipeline import detect_alone, read_pair
from lane_dp_ros.messages.stereo_sync import StereoPair
from lane_dp_ros.messages.topic_choice import TopicChoice
from lane_dp_ros.tools.evaluation.annotations import LabelledFrame
from lane_dp_ros.tools.evaluation.answers import read_picture
from lane_dp_ros.tools.evaluation.scores import FrameScore

SCENES_BAG = "scenes.mcap"  # what `lane_dp scenes` writes into its folder
DRAWN = "overlay/image"  # what `lane_dp run` writes beside its lanes


@dataclass(frozen=True, eq=False)
class FrameImages:
    """What can be shown of a frame: the left image, and what led the detector to its lanes.

    `camera` is that of the image, None where it is not known. `note` says why something is not there.
    """

    left: Image8 | None = None
    camera: StereoCamera | None = None
    detection: LaneDetection | None = None
    note: str = ""


def frame_images(
    source: Path,
    shown: Sequence[FrameScore],
    config: DetectorConfig | None,
    topics: TopicChoice | None = None,
) -> Iterator[tuple[FrameScore, FrameImages]]:
    """Yield each frame to show with what there is of it, in any order, no more than one at a time.

    `source` is what was judged: a bag, a folder that `lane_dp scenes` wrote, or a folder of images. The
    detector looks at each pair once more, with `config`, for what no evaluation keeps; None: there are but
    the images, and none into which lanes were drawn.
    """
    if (source / SCENES_BAG).exists():
        source = source / SCENES_BAG
    if source.is_dir() and not looks_like_bag(source):
        yield from ((each, _images_of_files(source, each.truth, config)) for each in shown)
    else:
        with BagReader(source, topics) as reader:
            yield from _images_of_bag(reader, shown, config)


def _images_of_files(root: Path, frame: LabelledFrame | None, config: DetectorConfig | None) -> FrameImages:
    if frame is None:
        return FrameImages(note="no images: the truth does not name them")
    try:
        left = read_picture(root / frame.left)
        if config is None:
            return FrameImages(left, frame.camera)
        right = read_picture(root / frame.right)
        detection = LaneDetector(frame.camera, config).detect(StereoFrame(left, right))
        return FrameImages(left, frame.camera, detection)
    except (CommandError, ValueError) as error:
        return FrameImages(note=f"no images: {one_line(error)}")


def _images_of_bag(
    reader: BagReader, shown: Sequence[FrameScore], config: DetectorConfig | None
) -> Iterator[tuple[FrameScore, FrameImages]]:
    missing = {each.stamp_ns: each for each in shown}
    if _has_pairs(reader):
        found = _pairs(reader, missing.__contains__, config)
    else:
        found = iter(()) if config is None else _drawn_images(reader, missing.__contains__)
    for stamp_ns, images in found:
        yield missing.pop(stamp_ns), images
    for each in missing.values():
        yield each, FrameImages(note="no images: the bag has none of this frame")


def _has_pairs(reader: BagReader) -> bool:
    try:
        find_stereo_topics(reader)
    except CommandError:
        return False
    return True


def _pairs(
    reader: BagReader, wanted: Callable[[int], bool], config: DetectorConfig | None
) -> Iterator[tuple[int, FrameImages]]:
    """Yield stamp [ns] and images of the stereo pairs that are wanted."""
    sync = sync_of_bag(NodeConfig().sync_tolerance)
    for bag_pair in read_stereo_pairs(reader, find_stereo_topics(reader), sync):
        if wanted(stamp_ns := bag_pair.pair.stamp_ns):
            try:
                yield stamp_ns, _images_of_pair(bag_pair.pair, bag_pair.infos, config)
            except ValueError as error:
                yield stamp_ns, FrameImages(note=f"no images: {one_line(error)}")


def _images_of_pair(pair: StereoPair, infos: tuple[Any, Any], config: DetectorConfig | None) -> FrameImages:
    if config is None:
        read = read_pair(pair, infos)
        return FrameImages(read.frame.left, read.camera, note=read.problem)
    read, found = detect_alone(pair, infos, config)
    without_road = found is not None and found.road is None
    problem = read.problem or (found.note if found is not None and without_road else "")
    return FrameImages(read.frame.left, read.camera, found, problem)


def _drawn_images(reader: BagReader, wanted: Callable[[int], bool]) -> Iterator[tuple[int, FrameImages]]:
    """Yield stamp [ns] and image of the overlays that `lane_dp run` wrote, lanes in them, where there are."""
    note = "the bag has no stereo pairs: the picture is its overlay, view from above and cost are missing"
    topics = [topic for topic in reader.topics if topic == DRAWN or topic.endswith(f"/{DRAWN}")]
    for _topic, _time_ns, message in reader.messages(topics) if topics else ():
        if wanted(stamp_ns := stamp_from_ros(message.header.stamp)):
            yield stamp_ns, FrameImages(image_from_ros(message), note=note)
