# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What judging gives for each frame: the FrameScore, with the verdict on every detected line."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.types import Lane
from lane_dp_ros.tools.evaluation.depth import DepthErrors
from lane_dp_ros.tools.evaluation.lateral import NOT_COMPARED, LateralErrors
from lane_dp_ros.tools.evaluation.tusimple_culane import CULane, TuSimple

Floats = NDArray[np.float64]
Verdict = Literal["match", "false", "duplicate", "ignored"]


@dataclass(frozen=True)
class JudgedLine:
    """A detected line and its verdict.

    "match" of a label; "false"; "duplicate", beside a label that a better one matches; "ignored", beside any
    other label (unsure, unpainted, or not matched by anything).

    `label` is the id of the label that it matches, None for all but matches.
    """

    lane: Lane
    verdict: Verdict
    label: str | None = None

    @property
    def wrong(self) -> bool:
        """Whether it counts against the detection precision."""
        return self.verdict in ("false", "duplicate")


@dataclass(frozen=True, eq=False)
class Match:
    """A label and the detection that was found for it.

    `depths` (N,) [m] are the label's samples that the detection covers, `errors` (N,) [m] the lateral
    distances there, always >= 0. `position` and `label_position` [m] are where the detection and the label
    run at 10 m of depth, None where either of them does not reach. `counts`: the label had to be found.
    `in_space` are the lateral distances in the world, without going through the image.
    """

    label: str
    detection: int
    counts: bool
    depths: Floats
    errors: Floats
    position: float | None = None
    label_position: float | None = None
    in_space: LateralErrors = NOT_COMPARED

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


@dataclass(frozen=True, eq=False)
class FrameScore:
    """How one frame was judged.

    `labels`: ids of the lines that had to be found; `ego_labels`: those of them beside the vehicle, of which
    `incorrect` and `missed` were not. `matches` are all, also those of labels that need not be found.
    `latency` [s] is None where it is not known; `tusimple` and `culane` are None for a frame without truth;
    `depth` is None where it is not known what surface was measured, or what the true one is.
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
    latency: float | None = None
    tusimple: TuSimple | None = None
    culane: CULane | None = None
    depth: DepthErrors | None = None

    @property
    def false_lanes(self) -> int:
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
        """For each detection, its confidence and whether it was right (neither false nor a duplicate)."""
        return tuple((d.lane.confidence, not d.wrong) for d in self.detections)
