# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The answers to the stereo pairs of a bag: the node's work, without ROS and without dropping any."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.detector import road_from_above
from lane_dp_ros.core.pipeline import Finding, FrameResult
from lane_dp_ros.messages.bag import BagReader
from lane_dp_ros.messages.errors import one_line
from lane_dp_ros.messages.stamp import NS_PER_S
from lane_dp_ros.messages.stereo_bag import BagPair, StereoTopics, read_stereo_pairs
from lane_dp_ros.messages.stereo_pipeline import StereoPipeline
from lane_dp_ros.messages.stereo_sync import StereoSync
from lane_dp_ros.tools.offline.look_ahead import LookAhead, Slice, Source, slices_ahead

LEFT_OVER, LEFT_OVER_WITH_PICTURES = 0.2, 0.5  # share of the work on a pair that needs the pair before


@contextmanager
def answered(
    reader: BagReader,
    topics: StereoTopics,
    sync: StereoSync,
    config: DetectorConfig,
    jobs: int = 1,
    pictures: bool = False,
) -> Iterator[Iterator[tuple[BagPair, FrameResult | str]]]:
    """Open an iterator over the pairs of a bag with their answers, tracked, from `jobs` processes, in order.

    A str in place of an answer says why the pair cannot be read. With several processes the others look
    ahead, see `LookAhead`, and the rest is done in this one; the answers do not depend on `jobs`, but without
    `pictures` their detections may be without what is as large as pictures.
    """
    pairs, pipeline = read_stereo_pairs(reader, topics, sync), StereoPipeline()
    source = Source(reader.path, reader.choice, topics, sync.tolerance_ns / NS_PER_S, config)
    left_over = LEFT_OVER_WITH_PICTURES if pictures else LEFT_OVER
    count = reader.message_count([topics.images["left"]])
    slices = slices_ahead(Slice(*reader.span_ns), count, jobs, left_over)
    with LookAhead(source, slices, jobs) as ahead:
        answers = ((pair, _answer(pipeline, pair, config, ahead.find(pair))) for pair in pairs)
        if not pictures:
            yield answers
        else:
            yield ((pair, _with_view(answer, config)) for pair, answer in answers)


def _answer(
    pipeline: StereoPipeline, pair: BagPair, config: DetectorConfig, found: Finding | None
) -> FrameResult | str:
    """Return the answer, or why there is none: as in the node, one bad frame must not end the run."""
    try:
        return pipeline.answer(pair.pair, pair.infos, config, found)
    except Exception as error:  # noqa: BLE001 - see above
        return one_line(error)


def _with_view(answer: FrameResult | str, config: DetectorConfig) -> FrameResult | str:
    """Return an answer with its bird's-eye view, which no other process sends."""
    if isinstance(answer, str) or answer.detection is None or answer.detection.birds_eye is not None:
        return answer
    view = road_from_above(answer.detection, answer.frame.left, config)
    return replace(answer, detection=replace(answer.detection, birds_eye=view))
