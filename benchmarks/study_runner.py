# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The frames that the benchmarks judge, held in memory, and quick verdicts on many configurations.

Worker processes keep their share of the pairs, and what the detector's functions returned for them: whatever
a change of the configuration does not touch is not computed again.
"""

from __future__ import annotations

import inspect
import itertools
import sys
from collections import OrderedDict, defaultdict
from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from functools import wraps
from multiprocessing import get_context
from pathlib import Path
from typing import Any
from unittest.mock import patch

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core import detector as lane_detector
from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.detector import LaneDetection, LaneDetector
from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.geometry.road_axis import RoadAxis
from lane_dp_ros.core.lanes import search as lane_search
from lane_dp_ros.core.parameter import Parameters
from lane_dp_ros.core.pipeline import FrameResult, LanePipeline
from lane_dp_ros.core.types import Lane, StereoFrame
from lane_dp_ros.tools.datasets.kitti import read_odometry
from lane_dp_ros.tools.evaluation.annotations import LabelledFrame
from lane_dp_ros.tools.evaluation.labelled_pairs import LabelledPair, load_pairs
from lane_dp_ros.tools.evaluation.matching import judge, judge_unpainted
from lane_dp_ros.tools.evaluation.scores import FrameScore

Image = NDArray[np.uint8]

UNPAINTED = "kitti_odometry/06"  # a whole sequence without paint: any line is false
REMEMBERED = 200  # calls per frame; the detector makes about fifty, or twice that along a second axis

CORE = "lane_dp_ros.core."
CALLERS = lane_detector, lane_search
# Quick, and full of constants that thresholds.py changes; or they only call functions that remember.
ALWAYS_RUN = {
    f"{CORE}{module}"
    for module in (
        "detector",
        "lanes.search",
        "lanes.selection",
        "lanes.axis_refinement",
        "lanes.lifting",
        "lanes.mono_fallback",
    )
}


@dataclass(frozen=True, eq=False)
class JudgedPair:
    """A pair in grey, and what is known of it: its labels, or None where there is no paint.

    Pairs with a stamp are consecutive in their sequence.
    """

    name: str
    sequence: str
    left: Image
    right: Image
    camera: StereoCamera
    frame: LabelledFrame | None = None
    stamp_ns: int | None = None

    def detected(self, config: DetectorConfig) -> LaneDetection:
        """Return what the detector finds in this pair, by itself."""
        return LaneDetector(self.camera, config).detect(self.left, self.right)

    def followed(self, config: DetectorConfig, pipeline: LanePipeline) -> tuple[Lane, ...]:
        """Return what the node publishes for this pair after those before it."""
        detection = self.detected(config)
        if self.stamp_ns is None:
            return detection.lanes
        answer = FrameResult(self.left, "", self.camera, detection, detection.lanes, right=self.right)
        return pipeline.follow(answer, self.stamp_ns, config).lanes

    def judged(self, lanes: tuple[Lane, ...]) -> FrameScore:
        """Return the verdict on lanes."""
        if self.frame is None:
            return judge_unpainted(self.name, lanes, self.sequence, self.stamp_ns or 0)
        return judge(self.frame, lanes, self.camera)


def labelled_pairs(data: Path, truth: Path) -> list[JudgedPair]:
    """Return the labelled pairs of a folder, a bag or a suite of scenes."""
    return [_labelled(pair) for pair in load_pairs(data, truth)[1]]


def _labelled(pair: LabelledPair) -> JudgedPair:
    frame, (left, right) = pair.frame, map(_grey, pair.load())
    return JudgedPair(frame.name, frame.sequence, left, right, frame.camera, frame, frame.stamp_ns)


def kitti_pairs(data: Path) -> list[JudgedPair]:
    """Return the labelled pairs of the KITTI frames, and all of the sequence without paint."""
    labelled = labelled_pairs(data, data / "labels" / "lanes.json")
    return [pair for pair in labelled if pair.sequence != UNPAINTED] + drive_pairs(data, "06")


def drive_pairs(data: Path, name: str) -> list[JudgedPair]:
    """Return all pairs of a drive of KITTI's odometry, in order, without their labels."""
    drive = read_odometry(data / "kitti_odometry" / "sequences" / name)
    camera = StereoCamera.from_projections(drive.P_left, drive.P_right)
    sequence = f"kitti_odometry/{name}"
    return [
        JudgedPair(f"{sequence}/{left.stem}", sequence, _read(left), _read(right), camera, None, stamp_ns)
        for left, right, stamp_ns in zip(drive.left, drive.right, drive.stamps_ns, strict=True)
    ]


def _grey(image: Image) -> Image:
    """Return what the detector makes of a picture first."""
    return np.ascontiguousarray(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY) if image.ndim == 3 else image)


def _read(path: Path) -> Image:
    return np.asarray(cv2.imread(str(path), cv2.IMREAD_GRAYSCALE), np.uint8)


class Judges:
    """Processes that each keep a share of the pairs and judge them with any configuration.

    Consecutive pairs are detected as the node does it, with its memory; `alone`: each by itself. What the
    detector's functions returned is kept. Close it, or use it as a context.
    """

    def __init__(self, pairs: Sequence[JudgedPair], jobs: int, alone: bool = False) -> None:
        whole = dict.fromkeys(pair.name if alone else pair.sequence for pair in pairs)
        share_of = {name: i % jobs for i, name in enumerate(whole)}
        shares: list[list[JudgedPair]] = [[] for _ in range(jobs)]
        for pair in pairs:
            shares[share_of[pair.name if alone else pair.sequence]].append(pair)
        # One pool for each share: a pool of several would hand a share to any of its processes.
        self._pools = [
            ProcessPoolExecutor(1, get_context("spawn"), _set_up, (share, alone)) for share in shares
        ]
        self._order = [pair.name for pair in pairs]

    def __enter__(self) -> Judges:
        return self

    def __exit__(self, *error: object) -> None:
        for pool in self._pools:
            pool.shutdown(cancel_futures=True)

    def results(self, config: DetectorConfig, patches: Mapping[str, Any] | None = None) -> list[FrameScore]:
        """Return the verdicts in the order of the pairs; `patches` replaces names of modules meanwhile.

        Raises AttributeError for a name that there is none of.
        """
        shares = [pool.submit(_judged, config, dict(patches or {})) for pool in self._pools]
        named = {result.name: result for share in shares for result in share.result()}
        return [named[name] for name in self._order]


@contextmanager
def patched(patches: Mapping[str, Any]) -> Iterator[None]:
    """Replace {dotted name: value} as long as the block lasts. Raises AttributeError for an unknown name."""
    with ExitStack() as stack:
        for name, value in patches.items():
            stack.enter_context(patch(name, value))
        yield


_pairs: Sequence[JudgedPair] = ()
_alone = False
_memories: list[Memory] = []


def _set_up(pairs: Sequence[JudgedPair], alone: bool) -> None:
    global _pairs, _alone, _memories  # noqa: PLW0603  (a process's own)
    cv2.setNumThreads(1)  # each process has a core
    _pairs, _alone = pairs, alone
    _memories = [Memory() for _ in pairs]


def _judged(config: DetectorConfig, patches: Mapping[str, Any]) -> list[FrameScore]:
    results = []
    pipelines: defaultdict[str, LanePipeline] = defaultdict(LanePipeline)
    with patched(patches):
        for pair, memory in zip(_pairs, _memories, strict=True):
            with memory.in_use(patches):
                found = (
                    pair.detected(config).lanes if _alone else pair.followed(config, pipelines[pair.sequence])
                )
            results.append(pair.judged(found))
    return results


class Memory:
    """What the stages of the detector returned for one pair, by the very objects that they were called with.

    Configurations and plain values are told apart by what they are, pictures of the road by their parts, all
    else by identity; with a name replaced in a module that a function uses, it is called anew. That holds as
    long as the stages are functions of their arguments, generators of random numbers among them: these are
    left as the function left them.
    """

    def __init__(self) -> None:
        self._kept: OrderedDict[tuple[Any, ...], tuple[Any, Any, Any]] = OrderedDict()

    @contextmanager
    def in_use(self, patches: Mapping[str, Any] | None = None) -> Iterator[None]:
        """Let the detector's functions remember as long as the block lasts; `patches` are in force."""
        with patched(
            {
                f"{caller.__name__}.{name}": self._remembering(function, _inside(function, patches or {}))
                for caller in CALLERS
                for name, function in vars(caller).items()
                if inspect.isfunction(function) and _is_remembered(function)
            }
        ):
            yield

    def _remembering(self, function: Callable[..., Any], inside: Hashable) -> Callable[..., Any]:
        @wraps(function)
        def remembering(*arguments: Any, **named: Any) -> Any:
            values = (*arguments, *itertools.chain(*sorted(named.items())))
            key = (function, inside, *map(_identity, values))
            generators = [value.bit_generator for value in values if isinstance(value, np.random.Generator)]
            if key in self._kept:
                self._kept.move_to_end(key)
            else:
                # The arguments are kept as well: as long as they live, no other object has their identity.
                answer = function(*arguments, **named)
                self._kept[key] = answer, values, [each.state for each in generators]
                if len(self._kept) > REMEMBERED:
                    self._kept.popitem(last=False)
            answer, _, states = self._kept[key]
            for generator, state in zip(generators, states, strict=True):
                generator.state = state
            return answer

        return remembering


def _modules_used(name: str) -> frozenset[str]:
    """Return the core's modules whose functions or classes a module may call, and its own name."""
    used, new = set[str](), {name}
    while new:
        used |= new
        owners = {
            getattr(value, "__module__", None) for each in new for value in vars(sys.modules[each]).values()
        }
        new = {owner for owner in owners if owner is not None and owner.startswith(CORE)} - used
    return frozenset(used)


# Now, while nothing is replaced.
MODULES_USED = {name: _modules_used(name) for name in tuple(sys.modules) if name.startswith(CORE)}


def _inside(function: Callable[..., Any], patches: Mapping[str, Any]) -> Hashable:
    """Return those of the patches that may change what a function returns."""
    used = MODULES_USED[function.__module__]
    return frozenset(each for each in patches.items() if each[0].rpartition(".")[0] in used)


def _is_remembered(function: Callable[..., Any]) -> bool:
    return function.__module__.startswith(CORE) and function.__module__ not in ALWAYS_RUN


def _identity(value: Any) -> Any:
    """Return what tells an argument apart from others."""
    if isinstance(value, np.random.Generator):
        return str(value.bit_generator.state)
    if isinstance(value, (list, tuple)):
        return tuple(_identity(each) for each in value)
    if isinstance(value, StereoFrame):  # put together anew each time
        return tuple(_identity(each) for each in vars(value).values())
    if isinstance(value, (Parameters, StereoCamera, RoadAxis, bool, int, float, str, type(None))):
        return value
    return "id", id(value)
