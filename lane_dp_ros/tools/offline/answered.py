# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The answers to the stereo pairs of a bag: the node's work, without ROS and without dropping any."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from functools import partial
from typing import TypeVar

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.pipeline import FrameResult
from lane_dp_ros.messages.errors import one_line
from lane_dp_ros.messages.stereo_bag import BagPair
from lane_dp_ros.messages.stereo_pipeline import StereoInput, StereoPipeline, match_pair
from lane_dp_ros.tools.parallel import parallel_map

Result = TypeVar("Result")


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
