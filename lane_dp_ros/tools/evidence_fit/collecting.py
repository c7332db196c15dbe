# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""From frames to examples: every candidate is measured, in each way that its frame could have been taken."""

from __future__ import annotations

import pickle
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.detector import LaneDetector
from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.lanes.candidate import LaneEvidence
from lane_dp_ros.core.lanes.scoring import EvidenceScoring
from lane_dp_ros.core.search import LaneSearch
from lane_dp_ros.core.types import StereoFrame
from lane_dp_ros.tools.evaluation.annotations import LabelledFrame
from lane_dp_ros.tools.evidence_fit.examples import Example, example
from lane_dp_ros.tools.evidence_fit.variations import GAMMAS, exposed, mirrored, resized
from lane_dp_ros.tools.parallel import parallel_map
from lane_dp_ros.tools.progress import progress

SCALE = 0.7  # of the pictures of one of the variations
VARIATION_WEIGHT = 0.25  # of an example that is another view of a frame
SCENE_WEIGHT = 0.3  # of a rendered one; a real frame as it is counts 1


@dataclass(frozen=True, eq=False)
class KnownPair:
    """A grey frame, its camera, and its labels; None: it has no paint."""

    name: str
    frame: StereoFrame
    camera: StereoCamera
    truth: LabelledFrame | None = None


@dataclass(frozen=True, eq=False)
class FrameSource:
    """A frame of a drive and how to get it, here or in another process.

    `varied`: it is learnt from in a mirror, at other exposures and smaller, too.
    """

    drive: str
    load: Callable[[], KnownPair]
    varied: bool = False


@dataclass(frozen=True, eq=False)
class Kept:
    """Loads a pair once, and from then on from a file: rendering takes longer than all else."""

    load: Callable[[], KnownPair]
    path: Path

    def __call__(self) -> KnownPair:
        """Return the pair."""
        if self.path.exists():
            kept: KnownPair = pickle.loads(self.path.read_bytes())  # written here, below
            return kept
        pair = self.load()
        self.path.write_bytes(pickle.dumps(pair))
        return pair


@dataclass(frozen=True, eq=False)
class Collected:
    """A frame and its examples, the first of the frame as it is, the others of its variations."""

    source: FrameSource
    examples: tuple[Example, ...]

    @property
    def drive(self) -> str:
        """The drive of the frame."""
        return self.source.drive

    @property
    def category(self) -> str:
        """What a rendered scene is mixed of, empty for a real frame."""
        return self.examples[0].category

    @property
    def weights(self) -> tuple[float, ...]:
        """How much each example counts in the fit."""
        whole = SCENE_WEIGHT if self.examples[0].rendered else 1.0
        return (whole, *[whole * VARIATION_WEIGHT] * (len(self.examples) - 1))


def collect(sources: Sequence[FrameSource], jobs: int) -> list[Collected]:
    """Return the examples of all frames, worked out in `jobs` processes behind a progress bar."""
    with parallel_map(_examples, sources, jobs) as found:
        return [Collected(source, made) for source, made in progress(found, len(sources), "frame")]


class _AllHeights(EvidenceScoring):
    """Has the height of every line measured: what decides is not known before the fit."""

    def needs_height(self, evidence: Sequence[LaneEvidence]) -> NDArray[np.bool_]:
        """Return True for each line."""
        return np.ones(len(evidence), bool)


class _MeasuringSearch(LaneSearch):
    def __init__(self, config: DetectorConfig) -> None:
        super().__init__(config)
        self._scoring = _AllHeights(config.lane_selection)


class MeasuringDetector(LaneDetector):
    """A detector that measures everything of every candidate."""

    def __init__(self, camera: StereoCamera, config: DetectorConfig | None = None) -> None:
        super().__init__(camera, config)
        self._search = _MeasuringSearch(self.config)


def _examples(source: FrameSource) -> tuple[Example, ...]:
    return tuple(_example(pair, source.drive) for pair in _views(source))


def _views(source: FrameSource) -> Iterator[KnownPair]:
    pair = source.load()
    yield pair
    if source.varied:
        yield mirrored(pair)
        yield from (exposed(pair, gamma) for gamma in GAMMAS)
        yield resized(pair, SCALE)


def _example(pair: KnownPair, drive: str) -> Example:
    """Return the example of a pair. Borders are all labelled in scenes, and where a person labelled any."""
    detection = MeasuringDetector(pair.camera).detect(pair.frame)
    truth = pair.truth
    edges_known = truth is not None and (
        bool(truth.category) or not all(label.painted for label in truth.labels)
    )
    return example(pair.name, drive, detection, truth, edges_known)
