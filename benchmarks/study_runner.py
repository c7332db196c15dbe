# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The frames that the benchmarks judge, held in memory, and the verdicts on many configurations."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from types import ModuleType
from typing import Any
from unittest.mock import patch

import cv2

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.detector import LaneDetection, LaneDetector
from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.lanes.candidate import Candidate
from lane_dp_ros.core.lanes.lifting import to_lanes
from lane_dp_ros.core.pipeline import FrameResult, LanePipeline
from lane_dp_ros.core.types import Lane, StereoFrame
from lane_dp_ros.tools.datasets.kitti import load_pairs as load_drive
from lane_dp_ros.tools.datasets.kitti import read_odometry
from lane_dp_ros.tools.evaluation.annotations import LabelledFrame
from lane_dp_ros.tools.evaluation.labelled_pairs import load_pairs
from lane_dp_ros.tools.evaluation.matching import judge, judge_unpainted
from lane_dp_ros.tools.evaluation.scores import FrameScore

UNPAINTED = "kitti_odometry/06"  # a whole sequence without paint: any line is false


@dataclass(frozen=True, eq=False)
class JudgedPair:
    """A grey frame, and what is known of it: its labels, or None where there is no paint.

    Pairs with a stamp are consecutive in their sequence.
    """

    name: str
    sequence: str
    frame: StereoFrame
    camera: StereoCamera
    truth: LabelledFrame | None = None
    stamp_ns: int | None = None

    def detected(self, config: DetectorConfig) -> LaneDetection:
        """Return what the detector finds in this pair, by itself."""
        return LaneDetector(self.camera, config).detect(self.frame)

    def followed(self, config: DetectorConfig, pipeline: LanePipeline) -> LaneDetection | FrameResult:
        """Return what the node publishes for this pair after those before it."""
        if self.stamp_ns is None:
            return self.detected(config)
        return pipeline.process(self.frame, self.camera, self.stamp_ns, config)

    def judged(self, lanes: Sequence[Lane], road_edges: Sequence[Lane] | None = None) -> FrameScore:
        """Return the verdict on lanes, and on the road edges where any are given and labelled."""
        if self.truth is None:
            return judge_unpainted(self.name, lanes, self.sequence, self.stamp_ns or 0)
        return judge(self.truth, lanes, self.truth.camera, road_edges=road_edges)

    def score(self, found: LaneDetection | FrameResult) -> FrameScore:
        """Return the verdict on all that was found in this pair."""
        return self.judged(found.lanes, found.road_edges)


def labelled_pairs(data: Path, truth: Path) -> list[JudgedPair]:
    """Return the labelled pairs of a folder, a bag or a suite of scenes."""
    loaded = ((pair.frame, StereoFrame(*pair.load()).grey()) for pair in load_pairs(data, truth)[1])
    return [JudgedPair(t.name, t.sequence, frame, t.camera, t, t.stamp_ns) for t, frame in loaded]


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
        JudgedPair(
            f"{sequence}/{path.stem}",
            sequence,
            StereoFrame(pair.left, pair.right).grey(),
            camera,
            stamp_ns=pair.stamp_ns,
        )
        for path, pair in zip(drive.left, load_drive(drive), strict=True)
    ]


def lane_of(candidate: Candidate, detection: LaneDetection) -> Lane:
    """Return the lane that one of a detection's candidates is, or would be if it were not refused."""
    assert detection.birds_eye is not None
    return to_lanes([candidate], detection.birds_eye)[0]


class Judges:
    """Processes that each keep a share of the pairs and judge them with any configuration.

    Consecutive pairs are detected as the node does it, with its memory; `alone`: each by itself. Close it, or
    use it as a context.
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
        """Return the verdicts in the order of the pairs; `patches`, see `patched`, hold meanwhile."""
        shares = [pool.submit(_judged, config, dict(patches or {})) for pool in self._pools]
        named = {result.name: result for share in shares for result in share.result()}
        return [named[name] for name in self._order]


def replacing(owner: ModuleType | type, **values: Any) -> dict[str, Any]:
    """Return what `patched` takes to replace names of a module or a class.

    Raises AttributeError for a name that there is none of.
    """
    for name in values:
        getattr(owner, name)
    where = owner.__name__ if isinstance(owner, ModuleType) else f"{owner.__module__}.{owner.__qualname__}"
    return {f"{where}.{name}": value for name, value in values.items()}


@contextmanager
def patched(patches: Mapping[str, Any]) -> Iterator[None]:
    """Replace {dotted name: value} as long as the block lasts. Raises AttributeError for an unknown name."""
    with ExitStack() as stack:
        for name, value in patches.items():
            stack.enter_context(patch(name, value))
        yield


_pairs: Sequence[JudgedPair] = ()
_alone = False


def _set_up(pairs: Sequence[JudgedPair], alone: bool) -> None:
    global _pairs, _alone
    cv2.setNumThreads(1)  # each process has a core
    _pairs, _alone = pairs, alone


def _judged(config: DetectorConfig, patches: Mapping[str, Any]) -> list[FrameScore]:
    pipelines: defaultdict[str, LanePipeline] = defaultdict(lambda: LanePipeline(monitored=False))
    with patched(patches):
        return [
            pair.score(pair.detected(config) if _alone else pair.followed(config, pipelines[pair.sequence]))
            for pair in _pairs
        ]
