# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Detect lanes in every stereo pair of a bag: the node's work, without ROS and without dropping any."""

from __future__ import annotations

import sys
import time
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import TypeVar

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.pipeline import FrameResult
from lane_dp_ros.messages.bag import BagReader, BagWriter
from lane_dp_ros.messages.bag_message import bag_message
from lane_dp_ros.messages.errors import CommandError, one_line
from lane_dp_ros.messages.image import image_to_ros
from lane_dp_ros.messages.lanes import lanes_to_ros, road_edges_to_ros
from lane_dp_ros.messages.node_config import (
    NodeConfig,
    all_parameters,
    configs,
    is_of_ros,
    with_current_names,
)
from lane_dp_ros.messages.pictures import draw_birds_eye, draw_overlay
from lane_dp_ros.messages.stereo_bag import BagPair, find_stereo_topics, read_stereo_pairs, sync_of_bag
from lane_dp_ros.messages.stereo_pipeline import StereoInput, StereoPipeline, match_pair
from lane_dp_ros.messages.stereo_sync import SIDES
from lane_dp_ros.tools.parallel import parallel_map
from lane_dp_ros.tools.parameter_file import read_parameter_file
from lane_dp_ros.tools.progress import progress

Result = TypeVar("Result")


def load_config(preset: str, path: Path | None) -> tuple[NodeConfig, DetectorConfig]:
    """Return the preset with the values of a ROS parameter file, if any, on top.

    What `ros2 param dump` writes of ROS's own parameters is left out.
    Raises CommandError or ValueError naming what is wrong in the file.
    """
    values = {name: parameter.default for name, parameter in all_parameters(preset).items()}
    given = read_parameter_file(path) if path else {}
    given, renamed = with_current_names({n: value for n, value in given.items() if not is_of_ros(n)})
    for warning in renamed:
        print(f"lane_dp: {path}: {warning}", file=sys.stderr)
    try:
        return configs({**values, **given})
    except ValueError as error:
        raise CommandError(f"{path}: {error}") from None


@dataclass
class Summary:
    """What was found, as text by `str()`."""

    lanes_per_pair: list[int] = field(default_factory=list)
    road_edges: int = 0
    seconds: dict[str, list[float]] = field(default_factory=lambda: defaultdict(list))
    problems: Counter[str] = field(default_factory=Counter)
    doubts: int = 0  # pairs after which the pictures or their calibration were thought to be wrong
    complaint: str = ""  # the last reason
    unpaired: int = 0
    elapsed: float = 0.0
    jobs: int = 1

    def add(self, answer: FrameResult | str) -> None:
        """Count one pair, or the reason why it could not be read."""
        if isinstance(answer, str):
            self.problems[answer] += 1
            return
        self.lanes_per_pair.append(len(answer.lanes))
        self.road_edges += len(answer.road_edges)
        if answer.problem:
            self.problems[answer.problem] += 1
        if answer.check.complaint:
            self.doubts, self.complaint = self.doubts + 1, answer.check.complaint
        if answer.detection is not None:
            for stage, seconds in answer.seconds.items():
                self.seconds[stage].append(seconds)

    def __str__(self) -> str:
        pairs, lanes = len(self.lanes_per_pair), sum(self.lanes_per_pair)
        empty = self.lanes_per_pair.count(0)
        lines = [
            f"{pairs} pairs, {lanes / pairs:.2f} lanes per pair, {empty} pairs without lanes",
            f"{self.road_edges / pairs:.2f} road edges per pair",
        ]
        if self.unpaired:
            lines.append(f"{self.unpaired} images without a partner")
        lines += [f"  {count} x {problem}" for problem, count in self.problems.most_common(5)]
        lines += [f"  {self.doubts} x {self.complaint}"] if self.complaint else []
        milliseconds = {stage: 1e3 * sum(s) / len(s) for stage, s in self.seconds.items()}
        stages = ", ".join(f"{stage} {value:.1f}" for stage, value in milliseconds.items())
        lines.append(f"{sum(milliseconds.values()):.1f} ms a pair: {stages}")
        processes = "1 process" if self.jobs == 1 else f"{self.jobs} processes"
        lines.append(f"{pairs / self.elapsed:.1f} pairs/s, {processes}")
        return "\n".join(lines)


def detect_bag(
    reader: BagReader, writer: BagWriter, node: NodeConfig, detector: DetectorConfig, jobs: int = 1
) -> Summary:
    """Write `lanes`, `road_edges`, both pictures and the camera infos for every pair, with a progress bar.

    The pictures are `ipm/image` and `overlay/image`. What is written does not depend on `jobs`, the number of
    processes. A pair that cannot be read is skipped, as by the node. Raises CommandError when the bag has no
    stereo pairs, or none that can be used.
    """
    topics = find_stereo_topics(reader)
    sync, summary = sync_of_bag(node.sync_tolerance), Summary()
    pairs = read_stereo_pairs(reader, topics, sync)
    total = reader.message_count([topics.images["left"]])
    start = time.perf_counter()
    with answered(pairs, detector, jobs) as answers:
        for bag_pair, answer in progress(answers, total, "pair"):
            if isinstance(answer, FrameResult):
                _write_answer(writer, topics.namespace, bag_pair, answer, node.lane_lifetime)
            summary.add(answer)
    summary.elapsed, summary.jobs = time.perf_counter() - start, jobs
    summary.unpaired = sum(sync.unpaired.values())
    if not summary.seconds:
        problem = next(iter(summary.problems), f"no left and right stamps within {node.sync_tolerance:g} s")
        raise CommandError(f"{reader.path} has no stereo pair that can be used: {problem}")
    return summary


@contextmanager
def answered(
    pairs: Iterable[BagPair], config: DetectorConfig, jobs: int = 1
) -> Iterator[Iterator[tuple[BagPair, FrameResult | str]]]:
    """Open an iterator over the pairs with their answers, tracked, from `jobs` processes, in order.

    A str in place of an answer says why the pair cannot be read. With several processes these decode and
    match the pairs, the work that needs no pair before, and the rest is done in this one; the answers do not
    depend on `jobs`.
    """
    pipeline = StereoPipeline()
    if jobs == 1:
        yield ((bag_pair, _answer(partial(pipeline.answer, *bag_pair[:2]), config)) for bag_pair in pairs)
        return
    with parallel_map(partial(_matched, config), pairs, jobs) as matched:
        yield (
            (bag_pair, found if isinstance(found, str) else _answer(partial(pipeline.follow, found), config))
            for bag_pair, found in matched
        )


def _matched(config: DetectorConfig, bag_pair: BagPair) -> StereoInput | str:
    return _read(lambda: match_pair(bag_pair.pair, bag_pair.infos, config))


def _answer(answer: Callable[[DetectorConfig], FrameResult], config: DetectorConfig) -> FrameResult | str:
    return _read(partial(answer, config))


def _read(read: Callable[[], Result]) -> Result | str:
    """Return what `read` returns, or why it cannot: as in the node, one bad frame must not end the run."""
    try:
        return read()
    except Exception as error:  # noqa: BLE001 - see above
        return one_line(error)


def _write_answer(
    writer: BagWriter, namespace: str, bag_pair: BagPair, answer: FrameResult, lifetime: float
) -> None:
    header, time_ns = bag_pair.pair.left.header, bag_pair.time_ns
    lanes = lanes_to_ros(answer.lanes, header, bag_message, lifetime)
    edges = road_edges_to_ros(answer.road_edges, header, bag_message, lifetime)
    writer.write(f"{namespace}/lanes", time_ns, lanes)
    writer.write(f"{namespace}/road_edges", time_ns, edges)
    for side, info in zip(SIDES, bag_pair.infos, strict=True):  # what the lanes are projected with
        writer.write(f"{namespace}/{side}/camera_info", time_ns, info)
    lines = answer.lanes + answer.road_edges
    if answer.camera is not None:
        overlay = draw_overlay(answer.frame.left, lines, answer.camera)
        writer.write(f"{namespace}/overlay/image", time_ns, image_to_ros(overlay, header, bag_message))
    if answer.detection is not None and answer.detection.birds_eye is not None:
        view = draw_birds_eye(answer.detection.birds_eye, answer.frame.left, lines)
        writer.write(f"{namespace}/ipm/image", time_ns, image_to_ros(view, header, bag_message))
