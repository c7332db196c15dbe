# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Several detectors judged on the same data, beside the paper's published numbers."""

from __future__ import annotations

import re
import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from lane_dp_ros.core.tracking.tracker import LaneTracker, TrackingConfig
from lane_dp_ros.core.types import Lane
from lane_dp_ros.messages.bag_files import looks_like_bag
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.messages.topic_choice import TopicChoice
from lane_dp_ros.tools.evaluation.detectors import Detector
from lane_dp_ros.tools.evaluation.labelled_pairs import (
    SCENES,
    LabelledPair,
    find_truth,
    is_raw_drive,
    load_pairs,
    truth_candidates,
)
from lane_dp_ros.tools.evaluation.matching import judge
from lane_dp_ros.tools.evaluation.papers_tables import ALL, OURS, papers_tables
from lane_dp_ros.tools.evaluation.scores import FrameScore
from lane_dp_ros.tools.evaluation.summary import by_sequence
from lane_dp_ros.tools.evaluation.text import table
from lane_dp_ros.tools.parallel import parallel_map
from lane_dp_ros.tools.progress import progress

DRIVE = re.compile(r"\d{4}_\d\d_\d\d_drive_\d{4}")


@dataclass(frozen=True)
class Data:
    """A bag, drive or folder, its truth (None: there is none), and the paper's drive that it is, or ""."""

    path: Path
    truth: Path | None
    drive: str


def find_data(paths: Iterable[Path]) -> list[Data]:
    """Return what is at the paths, and the paper's drives in folders of drives.

    Raises CommandError for a path with nothing to judge, and for data without truth that is none of the
    paper's drives.
    """
    return [data for path in paths for data in _data_at(path)]


def _data_at(path: Path) -> list[Data]:
    if not path.exists():
        raise CommandError(f"{path}: no such folder or bag")
    if looks_like_bag(path) or is_raw_drive(path) or find_truth(path) or (path / SCENES).exists():
        return [_data(path)]
    below = sorted({*path.glob("*_drive_*"), *path.glob("*/*_drive_*")})
    drives = [_data(each) for each in below if looks_like_bag(each) or is_raw_drive(each)]
    if found := [data for data in drives if data.drive]:
        return found
    wanted = ", ".join(map(str, truth_candidates(path)))
    raise CommandError(f"{path} has no truth (looked for {wanted}), and none of the paper's drives is in it")


def _data(path: Path) -> Data:
    match = DRIVE.search(path.name)
    drive = match.group() if match and match.group() in OURS else ""
    truth = find_truth(path)
    if truth is None and not drive:
        wanted = ", ".join(map(str, truth_candidates(path)))
        raise CommandError(f"{path} has no truth: looked for {wanted}")
    return Data(path, truth, drive)


def judge_data(
    data: Data, detectors: Sequence[Detector], jobs: int, topics: TopicChoice | None = None
) -> list[list[FrameScore]]:
    """Return, for each detector, how each frame of the data was judged; shows a progress bar.

    The lanes of every detector get their identity from the same tracker, along frames that have stamps; it
    leaves them where they are.
    """
    if data.truth is None:
        return [[] for _ in detectors]
    count, pairs = load_pairs(data.path, data.truth, topics)
    trackers = [LaneTracker(TrackingConfig(enabled=False)) for _ in detectors]
    results: list[list[FrameScore]] = [[] for _ in detectors]
    with parallel_map(partial(_detect, tuple(detectors)), pairs, jobs) as detected:
        for pair, answers in progress(detected, count, "pair"):
            frame = replace(pair.frame, sequence=data.drive) if data.drive else pair.frame
            for tracker, (lanes, latency), judged in zip(trackers, answers, results, strict=True):
                known = lanes if frame.stamp_ns is None else tracker.update(lanes, frame.stamp_ns)
                judged.append(judge(frame, known, frame.camera, latency))
    return results


def _detect(detectors: Sequence[Detector], pair: LabelledPair) -> list[tuple[tuple[Lane, ...], float]]:
    """Return, for each detector, the lanes of a pair and the seconds that it took."""
    left, right = pair.load()
    answers = []
    for detector in detectors:
        start = time.perf_counter()
        lanes = detector.detect(left, right, pair.frame.camera)
        answers.append((lanes, time.perf_counter() - start))
    return answers


def comparison(
    paths: Sequence[Path], detectors: Sequence[Detector], jobs: int, topics: TopicChoice | None = None
) -> str:
    """Judge the data at the paths with each detector and return all tables, and what is missing in them."""
    found = find_data(paths)
    results: list[list[FrameScore]] = [[] for _ in detectors]
    for data in found:
        for i, judged in enumerate(judge_data(data, detectors, jobs, topics)):
            results[i] += judged
    summaries = [by_sequence(judged) for judged in results]
    parts = [papers_tables([detector.name for detector in detectors], summaries), *missing(found)]
    for detector, summary in zip(detectors, summaries, strict=True):
        if summary[ALL].frames:
            parts.append(f"\n{detector.name}\n{table('sequence', summary)}")
    return "\n".join(parts)


def missing(found: Sequence[Data]) -> list[str]:
    """Return a line for each of the paper's drives that was not judged, and why."""
    lines = []
    for drive in OURS:
        there = [data for data in found if data.drive == drive]
        if not there:
            lines.append(
                f"{drive}: no data, expected the folder {drive}_sync (KITTI raw, road) or a bag of it"
            )
        elif not any(data.truth for data in there):
            wanted = " or ".join(str(path) for data in there for path in truth_candidates(data.path))
            lines.append(f"{drive}: no truth, looked for {wanted}: lane_dp review exports one")
    return lines
