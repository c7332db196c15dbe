# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Where the frames to learn from are found: labelled data, and drives without any paint."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from functools import partial
from pathlib import Path
from typing import Any

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.types import StereoFrame
from lane_dp_ros.messages.bag import BagReader
from lane_dp_ros.messages.bag_files import looks_like_bag
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.messages.node_config import NodeConfig
from lane_dp_ros.messages.stereo_bag import find_stereo_topics, read_stereo_pairs, sync_of_bag
from lane_dp_ros.messages.stereo_pipeline import read_pair
from lane_dp_ros.messages.stereo_sync import StereoPair
from lane_dp_ros.messages.topic_choice import TopicChoice
from lane_dp_ros.tools.datasets.kitti import read_odometry
from lane_dp_ros.tools.evaluation.answers import read_picture
from lane_dp_ros.tools.evaluation.labelled_pairs import (
    LabelledPair,
    find_truth,
    load_pairs,
    truth_candidates,
)
from lane_dp_ros.tools.evidence_fit.collecting import FrameSource, KnownPair

THINNED = 3  # of the frames without paint, which follow one another, each third is varied


def labelled_frames(data: Path, topics: TopicChoice | None = None) -> list[FrameSource]:
    """Return the labelled frames of a bag or a folder, with the truth that lies in it or beside it.

    `topics` are those of a bag's stereo camera. Raises CommandError or ValueError, in one
    line, for data without labels.
    """
    truth = find_truth(data)
    if truth is None:
        places = ", ".join(map(str, truth_candidates(data)))
        raise CommandError(f"{data} has no labelled frames: looked for {places}")
    _, pairs = load_pairs(data, truth, topics)
    return [FrameSource(_drive(pair, data), partial(_labelled, pair), varied=True) for pair in pairs]


def unpainted_frames(
    path: Path, drives: Collection[str], topics: TopicChoice | None = None
) -> list[FrameSource]:
    """Return the frames of a bag, or of a folder sequences/NN of KITTI's odometry, that shows no paint.

    They are of that one of the `drives` of labelled frames which ends in the same name, else of one of their
    own.
    """
    name = path.stem if looks_like_bag(path) else path.name
    drive = next((each for each in drives if each.rpartition("/")[2] == name), name)
    loads = list(_of_bag(path, name, topics) if looks_like_bag(path) else _of_sequence(path, name))
    if not loads:
        raise CommandError(f"{path} has no stereo pair to learn from")
    return [FrameSource(drive, load, varied=i % THINNED == 0) for i, load in enumerate(loads)]


def _drive(pair: LabelledPair, data: Path) -> str:
    """Return the drive of a labelled frame: what its label names, else its sequence, else its file."""
    frame = pair.frame
    return frame.drive or (frame.sequence if frame.sequence != "." else data.stem)


def _labelled(pair: LabelledPair) -> KnownPair:
    frame = pair.frame
    return KnownPair(frame.name, StereoFrame(*pair.load()).grey(), frame.camera, frame)


def _of_sequence(folder: Path, name: str) -> Iterator[partial[KnownPair]]:
    drive = read_odometry(folder)
    camera = StereoCamera.from_projections(drive.P_left, drive.P_right)
    for left, right in zip(drive.left, drive.right, strict=True):
        yield partial(_of_files, f"{name}/{left.stem}", left, right, camera)


def _of_files(name: str, left: Path, right: Path, camera: StereoCamera) -> KnownPair:
    return KnownPair(name, StereoFrame(read_picture(left), read_picture(right)).grey(), camera)


def _of_bag(bag: Path, name: str, topics: TopicChoice | None) -> Iterator[partial[KnownPair]]:
    with BagReader(bag, topics) as reader:
        sync = sync_of_bag(NodeConfig().sync_tolerance)
        for pair, infos, _ in read_stereo_pairs(reader, find_stereo_topics(reader), sync):
            if pair.right is not None:
                yield partial(_of_messages, f"{name}/{pair.stamp_ns}", pair, infos)


def _of_messages(name: str, pair: StereoPair, infos: tuple[Any, Any]) -> KnownPair:
    read = read_pair(pair, infos)
    if read.camera is None:
        raise CommandError(f"{name}: {read.problem}")
    return KnownPair(name, read.frame.grey(), read.camera)
