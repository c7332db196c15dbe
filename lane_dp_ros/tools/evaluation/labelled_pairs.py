# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The image pairs that a truth is known of: of a bag, a KITTI raw drive, or a folder of images."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.messages.bag import BagReader
from lane_dp_ros.messages.bag_files import looks_like_bag
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.messages.image import stereo_images_from_ros
from lane_dp_ros.messages.node_config import NodeConfig
from lane_dp_ros.messages.stereo_bag import CAPACITY, find_stereo_topics, read_stereo_pairs
from lane_dp_ros.messages.stereo_sync import StereoSync
from lane_dp_ros.messages.topic_choice import TopicChoice
from lane_dp_ros.tools.datasets import kitti
from lane_dp_ros.tools.evaluation.answers import read_picture
from lane_dp_ros.tools.evaluation.truth_file import LabelledFrame, load_truth

Image8 = NDArray[np.uint8]

BAG_ENDINGS = (".mcap", ".db3", ".bag")
SCENES = "scenes.mcap"  # what lane_dp scenes writes beside its truth.json


@dataclass(frozen=True)
class LabelledPair:
    """A frame of the truth and how to get its images, left and right, here or in another process."""

    frame: LabelledFrame
    load: Callable[[], tuple[Image8, Image8]]


class BagSource(NamedTuple):
    """A bag, and what was said of its topics."""

    path: Path
    topics: TopicChoice | None


def truth_candidates(data: Path) -> list[Path]:
    """Return where the truth of some data is looked for, the first choice first."""
    stem = data.stem if data.suffix in BAG_ENDINGS else data.name
    inside = [data / "truth.json", data / "labels" / "lanes.json"]
    return [
        *(inside if data.is_dir() and not looks_like_bag(data) else []),
        data.with_name(f"{stem}.truth.json"),
    ]


def find_truth(data: Path) -> Path | None:
    """Return the file with the truth of some data, None where there is none."""
    return next((path for path in truth_candidates(data) if path.is_file()), None)


def is_raw_drive(data: Path) -> bool:
    """Whether it looks like a drive of KITTI's raw data."""
    return any((data / f"image_{camera:02}" / "data").is_dir() for camera in (0, 2))


def load_pairs(
    data: Path, truth: Path, topics: TopicChoice | None = None
) -> tuple[int, Iterator[LabelledPair]]:
    """Return the number of labelled frames, and their pairs in order of time.

    `topics` are those of a bag's stereo camera. Raises CommandError or ValueError for data or truth that
    cannot be used, or that have nothing in common.
    """
    frames = load_truth(truth)
    if not frames:
        raise CommandError(f"{truth} has no frames, expected at least one")
    bag = data / SCENES if (data / SCENES).exists() else data
    if looks_like_bag(bag):
        return len(frames), _pairs_of_bag(BagSource(bag, topics), truth, _by_stamp(frames, truth))
    if is_raw_drive(data):
        return len(frames), _pairs_of_drive(data, truth, _by_stamp(frames, truth))
    return len(frames), _pairs_of_files(data, truth, frames)


def _by_stamp(frames: tuple[LabelledFrame, ...], truth: Path) -> dict[int, LabelledFrame]:
    by_stamp = {frame.stamp_ns: frame for frame in frames if frame.stamp_ns is not None}
    if len(by_stamp) < len(frames):
        raise CommandError(f"{truth}: each frame of a drive or bag needs a stamp_ns of its own")
    return by_stamp


def _pairs_of_bag(bag: BagSource, truth: Path, frames: dict[int, LabelledFrame]) -> Iterator[LabelledPair]:
    sync = StereoSync(round(NodeConfig().sync_tolerance * 1e9), CAPACITY)
    found = 0
    with BagReader(*bag) as reader:
        for pair, *_ in read_stereo_pairs(reader, find_stereo_topics(reader), sync):
            if pair.stamp_ns in frames:
                found += 1
                load = partial(stereo_images_from_ros, pair.left, pair.right)
                yield LabelledPair(frames[pair.stamp_ns], load)
    _check_complete(bag.path, truth, found, len(frames))


def _pairs_of_drive(drive: Path, truth: Path, frames: dict[int, LabelledFrame]) -> Iterator[LabelledPair]:
    sequence = kitti.read_raw(drive)
    found = 0
    files = zip(sequence.stamps_ns, sequence.calibrations, sequence.left, sequence.right, strict=True)
    for stamp_ns, calibration, left, right in files:
        if stamp_ns in frames:
            found += 1
            yield LabelledPair(frames[stamp_ns], partial(kitti.load_pair, calibration, left, right))
    _check_complete(drive, truth, found, len(frames))


def _check_complete(data: Path, truth: Path, found: int, wanted: int) -> None:
    """A part of a drive would give numbers that stand beside those of the whole."""
    if found < wanted:
        raise CommandError(f"{data} has pairs for {found} of the {wanted} stamps in {truth}, expected all")


def _pairs_of_files(folder: Path, truth: Path, frames: tuple[LabelledFrame, ...]) -> Iterator[LabelledPair]:
    for frame in frames:
        if not (frame.left and frame.right):
            raise CommandError(f"{truth}: frame {frame.name!r} names no files left and right")
        yield LabelledPair(frame, partial(_read, folder / frame.left, folder / frame.right))


def _read(left: Path, right: Path) -> tuple[Image8, Image8]:
    return read_picture(left), read_picture(right)
