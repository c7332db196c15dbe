# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What judging gives for each frame: the FrameScore, with the verdict on every detected line."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.types import Lane
from lane_dp_ros.tools.evaluation.annotations import LabelledFrame
from lane_dp_ros.tools.evaluation.depth import DepthErrors
from lane_dp_ros.tools.evaluation.lateral import NOT_COMPARED, LateralErrors
from lane_dp_ros.tools.evaluation.paint_kinds import PaintComparison
from lane_dp_ros.tools.evaluation.tusimple_culane import CULane, TuSimple

Floats = NDArray[np.float64]
Verdict = Literal["match", "false", "duplicate", "ignored", "beyond"]


@dataclass(frozen=True)
class JudgedLine:
    """A detected line and its verdict.

    "match" of a label; "false"; "duplicate", beside a label that a better one matches; "ignored", beside any
    other label (unsure, unpainted, or not matched by anything); "beyond" what is labelled, more than 9 m
    aside: not judged.

    `label` is the id of the label that it matches, None for all but matches. `beside_edge`: it matches no
    painted label, and runs along one of kind "edge".
    """

    lane: Lane
    verdict: Verdict
    label: str | None = None
    beside_edge: bool = False

    @property
    def wrong(self) -> bool:
        """Whether it counts against the detection precision."""
        return self.verdict in ("false", "duplicate")

    @property
    def strict_verdict(self) -> Verdict:
        """The verdict, were no lane line allowed to run along the unpainted edge of a road."""
        return "false" if self.beside_edge and self.verdict != "beyond" else self.verdict

    @property
    def strictly_wrong(self) -> bool:
        """Whether it counts against the strict detection precision."""
        return self.strict_verdict in ("false", "duplicate")


@dataclass(frozen=True, eq=False)
class Match:
    """A label and the detection that was found for it.

    `depths` (N,) [m] are the label's samples that the detection covers, `errors` (N,) [m] the lateral
    distances there, always >= 0. `position` and `label_position` [m] are where the detection and the label
    run at 10 m of depth, None where either of them does not reach. `counts`: the label had to be found.
    `in_space` are the lateral distances in the world, without going through the image. `paint` is what label
    and detection tell of kind and colour.
    """

    label: str
    detection: int
    counts: bool
    depths: Floats
    errors: Floats
    position: float | None = None
    label_position: float | None = None
    in_space: LateralErrors = NOT_COMPARED
    paint: PaintComparison | None = None

    @property
    def error(self) -> float:
        """Mean lateral error [m]."""
        return float(np.mean(self.errors))

    @property
    def near(self) -> float | None:
        """Mean lateral error [m] from 6 to 12 m of depth, None where no sample lies there."""
        return LateralErrors(self.depths, self.errors).near

    @property
    def far(self) -> float | None:
        """Mean lateral error [m] beyond 12 m of depth, None where no sample lies there."""
        return LateralErrors(self.depths, self.errors).far


class LineScores:
    """What is counted alike of lane lines and of road edges.

    `labels` are the ids of those that had to be found, `matches` all, also those of other labels.
    """

    detections: tuple[JudgedLine, ...]
    matches: tuple[Match, ...]
    labels: tuple[str, ...]

    @property
    def judged(self) -> tuple[JudgedLine, ...]:
        """The detections, without those beyond what is labelled."""
        return tuple(d for d in self.detections if d.verdict != "beyond")

    @property
    def false_lines(self) -> int:
        """Number of detections that lie on nothing."""
        return sum(d.verdict == "false" for d in self.detections)

    @property
    def duplicates(self) -> int:
        """Number of detections beside one that is nearer to the same label."""
        return sum(d.verdict == "duplicate" for d in self.detections)

    @property
    def found(self) -> tuple[Match, ...]:
        """The matches of labels that had to be found."""
        return tuple(match for match in self.matches if match.counts)

    @property
    def confidences(self) -> tuple[tuple[float, bool], ...]:
        """For each judged line, its confidence and whether it was right (neither false nor a duplicate)."""
        return tuple((d.lane.confidence, not d.wrong) for d in self.judged)


@dataclass(frozen=True, eq=False)
class RoadEdgeScore(LineScores):
    """How the road edges of one frame were judged, by the labels of kind "edge"."""

    detections: tuple[JudgedLine, ...]
    matches: tuple[Match, ...] = ()
    labels: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class FrameScore(LineScores):
    """How one frame was judged.

    `labels`: ids of the lines that had to be found; `ego_labels`: those of them beside the vehicle, of which
    `incorrect` and `missed` were not. `matches` are all, also those of labels that need not be found.
    `unpainted`: there is no painted label. `road_edges` is None where the detector tells of none.
    `latency` [s] is None where it is not known; `tusimple` and `culane` are None for a frame without truth;
    `depth` is None where it is not known what surface was measured, or what the true one is. `truth` are the
    labels, None for a frame that was judged without any; `camera` projects the detections into the left
    image, None where it is not known.
    """

    name: str
    sequence: str
    category: str
    stamp_ns: int | None
    detections: tuple[JudgedLine, ...]
    matches: tuple[Match, ...] = ()
    labels: tuple[str, ...] = ()
    ego_labels: tuple[str, ...] = ()
    incorrect: tuple[str, ...] = ()
    missed: tuple[str, ...] = ()
    unpainted: bool = False
    road_edges: RoadEdgeScore | None = None
    latency: float | None = None
    tusimple: TuSimple | None = None
    culane: CULane | None = None
    depth: DepthErrors | None = None
    truth: LabelledFrame | None = None
    camera: StereoCamera | None = None

    @property
    def false_lanes_strict(self) -> int:
        """Number of detections that lie on nothing, or along the unpainted edge of a road."""
        return sum(d.strict_verdict == "false" for d in self.detections)
