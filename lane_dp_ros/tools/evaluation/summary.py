# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The sum of judged frames: of any set of them, by sequence, by category."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, fields

import numpy as np

from lane_dp_ros.tools.evaluation.depth import DepthSummary
from lane_dp_ros.tools.evaluation.lateral import LateralSummary
from lane_dp_ros.tools.evaluation.paint_kinds import PaintSummary
from lane_dp_ros.tools.evaluation.road_edges import RoadEdgeSummary
from lane_dp_ros.tools.evaluation.scores import FrameScore
from lane_dp_ros.tools.evaluation.stability import JITTER_FRAMES, id_switches, jitters
from lane_dp_ros.tools.evaluation.tusimple_culane import CULane, TuSimple


@dataclass(frozen=True)
class Summary:
    """Counts and sums over any number of frames; summaries add up.

    `false_lanes_strict` counts lines along unpainted edges, too, and `wrong_strict` duplicates besides. What
    begins with `unpainted` is of the frames without a painted label alone. `id_chances` is how often an id
    could have switched. Ratios and means are nan where there is nothing to count.
    """

    frames: int = 0
    ego_labels: int = 0
    incorrect: int = 0
    missed: int = 0
    labels: int = 0
    matched: int = 0
    detections: int = 0
    false_lanes: int = 0
    duplicates: int = 0
    false_lanes_strict: int = 0
    wrong_strict: int = 0
    unpainted_frames: int = 0
    unpainted_false_lanes: int = 0
    unpainted_false_lanes_strict: int = 0
    error_sum: float = 0.0
    near_sum: float = 0.0
    near_matches: int = 0
    far_sum: float = 0.0
    far_matches: int = 0
    id_switches: int = 0
    id_chances: int = 0
    jitter_sum: float = 0.0
    label_jitter_sum: float = 0.0
    jitter_windows: int = 0
    latencies: tuple[float, ...] = ()
    tusimple: TuSimple = field(default_factory=TuSimple)
    culane: CULane = field(default_factory=CULane)
    depth: DepthSummary = field(default_factory=DepthSummary)
    in_space: LateralSummary = field(default_factory=LateralSummary)
    road_edges: RoadEdgeSummary = field(default_factory=RoadEdgeSummary)
    paint: PaintSummary = field(default_factory=PaintSummary)

    def __add__(self, other: Summary) -> Summary:
        names = [each.name for each in fields(self)]
        return Summary(*(getattr(self, name) + getattr(other, name) for name in names))

    @property
    def paper_precision(self) -> float:
        """(N - incorrect - missed) / N over the painted, sure ego lines: the paper's Tables II and III."""
        return _ratio(self.ego_labels - self.incorrect - self.missed, self.ego_labels)

    @property
    def lane_recall(self) -> float:
        """Share of the painted, sure labels that were found."""
        return _ratio(self.matched, self.labels)

    @property
    def detection_precision(self) -> float:
        """Share of the detections that are neither false lanes nor duplicates."""
        return _ratio(self.detections - self.false_lanes - self.duplicates, self.detections)

    @property
    def strict_detection_precision(self) -> float:
        """The same, were no lane line allowed to run along the unpainted edge of a road."""
        return _ratio(self.detections - self.wrong_strict, self.detections)

    @property
    def false_lanes_per_frame(self) -> float:
        """False lanes per frame."""
        return _ratio(self.false_lanes, self.frames)

    @property
    def strict_false_lanes_per_frame(self) -> float:
        """False lanes per frame, with lines along the unpainted edge of a road among them."""
        return _ratio(self.false_lanes_strict, self.frames)

    @property
    def localisation_error(self) -> float:
        """Mean lateral error [m] of the matches."""
        return _ratio(self.error_sum, self.matched)

    @property
    def near_error(self) -> float:
        """Mean lateral error [m] of the matches from 6 to 12 m of depth."""
        return _ratio(self.near_sum, self.near_matches)

    @property
    def far_error(self) -> float:
        """Mean lateral error [m] of the matches from 12 to 25 m of depth."""
        return _ratio(self.far_sum, self.far_matches)

    @property
    def jitter(self) -> float:
        """Mean standard deviation [m] of the lateral position at 10 m about a straight line over 5 frames."""
        return _ratio(self.jitter_sum, self.jitter_windows)

    @property
    def label_jitter(self) -> float:
        """The same of the labels themselves: what a perfect detector's jitter would be."""
        return _ratio(self.label_jitter_sum, self.jitter_windows)

    @property
    def latency(self) -> float:
        """Mean latency [s] of the frames whose latency is known."""
        return _ratio(sum(self.latencies), len(self.latencies))

    @property
    def latency_95(self) -> float:
        """95th percentile [s] of the latencies that are known."""
        return float(np.percentile(self.latencies, 95)) if self.latencies else float("nan")


def _ratio(part: float, whole: float) -> float:
    return part / whole if whole else float("nan")


def summarise(results: Iterable[FrameScore]) -> Summary:
    """Add frames up: counts and sums of each, and what is seen from frame to frame along each sequence."""
    results = tuple(results)
    sequences = [[r for r in results if r.sequence == name] for name in sorted({r.sequence for r in results})]
    return sum((*map(_of_frame, results), *map(_of_sequence, sequences)), Summary())


def by_sequence(results: Sequence[FrameScore]) -> dict[str, Summary]:
    """Return the summary of each sequence in order of name, and "total" as the last."""
    return _grouped(results, lambda result: result.sequence)


def by_category(results: Sequence[FrameScore]) -> dict[str, Summary]:
    """Return the summary of each category in order of name, and "total"; frames without one are in none."""
    return _grouped(results, lambda result: result.category)


def _grouped(results: Sequence[FrameScore], key: Callable[[FrameScore], str]) -> dict[str, Summary]:
    names = sorted({name for result in results if (name := key(result))})
    groups = {name: summarise(r for r in results if key(r) == name) for name in names}
    return {**groups, "total": summarise(results)}


def _of_frame(result: FrameScore) -> Summary:
    found = result.found
    false, false_strict = result.false_lines, result.false_lanes_strict
    bare = result.unpainted
    near = [match.near for match in found if match.near is not None]
    far = [match.far for match in found if match.far is not None]
    return Summary(
        frames=1,
        ego_labels=len(result.ego_labels),
        incorrect=len(result.incorrect),
        missed=len(result.missed),
        labels=len(result.labels),
        matched=len(found),
        detections=len(result.judged),
        false_lanes=false,
        duplicates=result.duplicates,
        false_lanes_strict=false_strict,
        wrong_strict=sum(d.strictly_wrong for d in result.detections),
        unpainted_frames=int(bare),
        unpainted_false_lanes=false if bare else 0,
        unpainted_false_lanes_strict=false_strict if bare else 0,
        error_sum=sum(match.error for match in found),
        near_sum=sum(near),
        near_matches=len(near),
        far_sum=sum(far),
        far_matches=len(far),
        latencies=() if result.latency is None else (result.latency,),
        tusimple=result.tusimple or TuSimple(),
        culane=result.culane or CULane(),
        depth=DepthSummary.of(result.depth),
        in_space=sum((LateralSummary.of(match.in_space) for match in found), LateralSummary()),
        road_edges=RoadEdgeSummary.of(result.road_edges),
        paint=PaintSummary.of(match.paint for match in found if match.paint is not None),
    )


def _of_sequence(results: Iterable[FrameScore]) -> Summary:
    """Return what a sequence shows from frame to frame: id switches and jitter. Frames need stamps for it."""
    frames = sorted((r for r in results if r.stamp_ns is not None), key=lambda r: r.stamp_ns or 0)
    windows = [frames[i : i + JITTER_FRAMES] for i in range(len(frames) - JITTER_FRAMES + 1)]
    switches = id_switches(frames)
    jitter = [pair for window in windows for pair in jitters(window)]
    return Summary(
        id_switches=sum(switches),
        id_chances=len(switches),
        jitter_sum=sum(detected for detected, _ in jitter),
        label_jitter_sum=sum(true for _, true in jitter),
        jitter_windows=len(jitter),
    )
