# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Judge the lanes of a bag or of a folder of images by labels."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from pathlib import Path

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.messages.bag import BagReader
from lane_dp_ros.messages.bag_files import looks_like_bag
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.messages.node_config import NodeConfig
from lane_dp_ros.messages.stereo_bag import find_stereo_topics
from lane_dp_ros.messages.topic_choice import TopicChoice
from lane_dp_ros.tools.detection_config import load_config
from lane_dp_ros.tools.evaluation.answers import (
    BagAnswers,
    FrameAnswer,
    detect_pair,
    detected_answers,
    file_answers,
)
from lane_dp_ros.tools.evaluation.depth import depth_errors
from lane_dp_ros.tools.evaluation.matching import judge, judge_unpainted
from lane_dp_ros.tools.evaluation.recorded_lanes import lanes_topic, recorded_answers
from lane_dp_ros.tools.evaluation.scores import FrameScore
from lane_dp_ros.tools.evaluation.truth_file import LabelledFrame, load_truth

SCENES_BAG, SCENES_TRUTH = "scenes.mcap", "truth.json"  # what `lane_dp scenes` writes into its folder


@dataclass(frozen=True)
class Evaluation:
    """The judged frames, and remarks."""

    results: tuple[FrameScore, ...]
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class DetectorChoice:
    """With which parameters to detect where lanes are not recorded, in how many processes, on what topics."""

    preset: str | None = None
    config: Path | None = None
    jobs: int = 1
    topics: TopicChoice | None = None

    @property
    def given(self) -> bool:
        """Whether the user asked for certain parameters."""
        return self.preset is not None or self.config is not None

    @cached_property
    def configs(self) -> tuple[NodeConfig, DetectorConfig]:
        """The parameters, read once. Raises CommandError naming what is wrong in the file."""
        return load_config(self.preset or "default", self.config)

    def answer_bag(self, reader: BagReader) -> BagAnswers:
        """Detect in the stereo pairs of a bag."""
        return detected_answers(reader, self.configs, self.jobs)

    def answer_files(
        self, root: Path, frames: Sequence[LabelledFrame]
    ) -> Iterator[tuple[LabelledFrame, FrameAnswer]]:
        """Detect in the image files that the frames name, below `root`."""
        return file_answers(root, frames, partial(detect_pair, self.configs[1]), self.jobs)


def evaluate_path(path: Path, truth: Path | None, choice: DetectorChoice) -> Evaluation:
    """Judge a bag, a folder written by `lane_dp scenes`, or a folder of images that the truth names.

    Raises CommandError or ValueError, in one line, for input that cannot be judged.
    """
    if (path / SCENES_BAG).exists():
        path, truth = path / SCENES_BAG, truth or path / SCENES_TRUTH
    if not path.exists():
        raise CommandError(f"{path}: no such bag or folder")
    if truth is None:
        raise CommandError(f"{path} needs --truth FILE, or --unpainted if none of its frames has any paint")
    if not truth.is_file():
        raise CommandError(f"{truth}: no such file, expected labels: docs/truth_format.md, or lane_dp review")
    frames = load_truth(truth)
    if not frames:
        raise CommandError(f"{truth} has no frames, expected at least one")
    if path.is_dir() and not looks_like_bag(path):
        found = choice.answer_files(path, frames)
        return Evaluation(tuple(_judged(frame, answer) for frame, answer in found))
    return _judged_bag(path, truth, frames, read_answers(path, choice))


def evaluate_unpainted(path: Path, choice: DetectorChoice) -> Evaluation:
    """Judge a bag none of whose frames has any paint: every detection is false."""
    bag = read_answers(path, choice)
    results = tuple(
        replace(
            judge_unpainted(f"{path.stem}/{stamp_ns}", answer.lanes, path.stem, stamp_ns),
            latency=answer.latency,
            camera=answer.camera,
        )
        for stamp_ns in sorted(bag.stamps)
        for answer in [bag.at(stamp_ns)]
    )
    return Evaluation(results, notes=bag.notes)


def read_answers(path: Path, choice: DetectorChoice) -> BagAnswers:
    """Return the lanes recorded in a bag, or those detected in its images.

    Raises CommandError for a bag that has neither, and for parameters that would have no effect.
    """
    with BagReader(path, choice.topics) as reader:
        if not reader.message_count():
            raise CommandError(f"{path} is empty: no message in it")
        topic = lanes_topic(reader)
        if topic is None:
            _check_images(reader)
            return choice.answer_bag(reader)
        if choice.given:
            raise CommandError(
                f"{path} carries {topic}, judged as recorded: leave --preset and --config away"
            )
        return recorded_answers(reader, topic)


def _check_images(reader: BagReader) -> None:
    """Raise CommandError for a bag without lanes that cannot be detected in, either."""
    try:
        find_stereo_topics(reader)
    except CommandError as error:
        raise CommandError(f"no topic named lanes to judge; to detect first, {error}") from None


def _judged_bag(path: Path, truth: Path, frames: Sequence[LabelledFrame], bag: BagAnswers) -> Evaluation:
    """Judge the frames within the bag's time; one there without an answer counts as nothing found."""
    by_stamp = {frame.stamp_ns: frame for frame in frames if frame.stamp_ns is not None}
    if len(by_stamp) < len(frames):
        raise CommandError(f"{truth}: each frame of a bag needs a stamp_ns of its own")
    if not bag.stamps & by_stamp.keys():
        spans = f"{_span(by_stamp)} in {truth}, {_span(bag.stamps)} in {path}"
        raise CommandError(f"truth and bag have no stamp in common: {spans}")
    first, last = min(bag.stamps), max(bag.stamps)
    judged = tuple(by_stamp[stamp] for stamp in sorted(by_stamp) if first <= stamp <= last)
    results = tuple(_judged(frame, bag.at(frame.stamp_ns or 0)) for frame in judged)
    unanswered = sum(frame.stamp_ns not in bag.answers for frame in judged)
    notes = {
        f"{len(frames) - len(judged)} frames of the truth lie outside the bag's time, left out": len(frames)
        - len(judged),
        f"{unanswered} frames without an answer, judged as nothing found": unanswered,
    }
    return Evaluation(results, (*bag.notes, *(note for note, count in notes.items() if count)))


def _judged(frame: LabelledFrame, answer: FrameAnswer) -> FrameScore:
    camera = answer.camera or frame.camera
    score = judge(frame, answer.lanes, camera, answer.latency, answer.road_edges)
    return replace(score, depth=depth_errors(frame, answer.surface)) if answer.surface_sought else score


def _span(stamps: Sequence[int] | frozenset[int] | dict[int, LabelledFrame]) -> str:
    return f"{min(stamps) / 1e9:.3f} to {max(stamps) / 1e9:.3f} s"
