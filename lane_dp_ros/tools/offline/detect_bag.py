# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Detect lanes in every stereo pair of a bag, and hand the answers to whatever keeps them."""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import Protocol

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.pipeline import FrameResult
from lane_dp_ros.messages.bag import BagReader
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.messages.node_config import NodeConfig
from lane_dp_ros.messages.stereo_bag import BagPair, StereoTopics, read_stereo_pairs, sync_of_bag
from lane_dp_ros.tools.offline.answered import answered
from lane_dp_ros.tools.offline.summary import Summary
from lane_dp_ros.tools.progress import progress


class Output(Protocol):
    """What keeps answers: a bag, a video, a table."""

    def write(self, pair: BagPair, answer: FrameResult) -> None:
        """Keep the answer to a pair; they come in the order of the bag."""


def detect_bag(
    reader: BagReader,
    topics: StereoTopics,
    outputs: Sequence[Output],
    config: tuple[NodeConfig, DetectorConfig],
    jobs: int = 1,
) -> Summary:
    """Answer every pair on `topics` into all `outputs`, with a progress bar.

    What is written does not depend on `jobs`, the number of processes. A pair that cannot be read is skipped,
    as by the node. Raises CommandError when the bag has no pairs, or none that can be used.
    """
    node, detector = config
    sync, summary = sync_of_bag(node.sync_tolerance), Summary()
    pairs = read_stereo_pairs(reader, topics, sync)
    total = reader.message_count([topics.images["left"]])
    start = time.perf_counter()
    with answered(pairs, detector, jobs) as answers:
        for pair, answer in progress(answers, total, "pair"):
            if isinstance(answer, FrameResult):
                for output in outputs:
                    output.write(pair, answer)
            summary.add(answer)
    summary.elapsed, summary.jobs = time.perf_counter() - start, jobs
    summary.unpaired = sum(sync.unpaired.values())
    if not summary.seconds:
        problem = next(iter(summary.problems), f"no left and right stamps within {node.sync_tolerance:g} s")
        raise CommandError(f"{reader.path} has no stereo pair that can be used: {problem}")
    return summary
