# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The lane lines along one axis of the road: view from above, graph, paths, lines, evidence, choice."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from lane_dp_ros.core.birdseye.birds_eye import birds_eye_view
from lane_dp_ros.core.birdseye.paint_map import build_paint_map
from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.geometry.road_axis import RoadAxis
from lane_dp_ros.core.lanes.evidence import line_evidence
from lane_dp_ros.core.lanes.line_fit import fit_line
from lane_dp_ros.core.lanes.path_search import find_paths
from lane_dp_ros.core.lanes.selection import is_paint, is_pale, select_lanes
from lane_dp_ros.core.lanes.variants.cut import end_at_stop_line
from lane_dp_ros.core.lanes.variants.extended import extend_line
from lane_dp_ros.core.lanes.variants.near_half import near_half
from lane_dp_ros.core.lanes.variants.parallel import parallel_lines
from lane_dp_ros.core.stopwatch import Stopwatch
from lane_dp_ros.core.types import BirdsEyeView, LaneEvidence, LaneLine, LanePath, PaintMap, StereoFrame

Judged = tuple[LaneLine, LaneEvidence]


@dataclass(frozen=True)
class LaneSearch:
    """What was found along one axis: all candidates, each with its evidence, and the lanes."""

    view: BirdsEyeView
    graph: PaintMap
    paths: tuple[LanePath, ...]
    candidates: tuple[Judged, ...]
    lanes: tuple[Judged, ...]

    @property
    def score(self) -> float:
        """Net metres of paint of all lanes."""
        return sum(line.score for line, _ in self.lanes)


def search_lanes(
    picture: StereoFrame, axis: RoadAxis, config: DetectorConfig, rng: np.random.Generator, watch: Stopwatch
) -> LaneSearch:
    """Return the lane lines along `axis`; `watch` takes the time of each step."""
    with watch("birds_eye"):
        view = birds_eye_view(
            picture.left, picture.disparity, picture.surface, axis, config.birds_eye, picture.ground
        )
    with watch("paint_map"):
        graph = build_paint_map(view, config.paint_map, picture.right)
    with watch("path_search"):
        paths = tuple(find_paths(graph, view.resolution, config.path_search))
    with watch("lane_model"):
        fitted = [fit_line(path, view, graph, config.lane_model, rng) for path in paths]
        lines = [line for line in fitted if line is not None]
        if config.path_search.free_ends:
            blank_cost = config.path_search.blank_cost
            lines = [extend_line(line, view, graph, blank_cost) for line in lines]
            lines = [end_at_stop_line(line, view, graph, blank_cost) for line in lines]
    with watch("lane_selection"):
        candidates = tuple((line, line_evidence(line, view, graph, picture)) for line in lines)
        chosen = config.lane_selection.evidence
        lanes = _chosen(candidates, view, graph, picture, config) if chosen else candidates
    return LaneSearch(view, graph, paths, candidates, lanes)


def _chosen(
    candidates: Sequence[Judged],
    view: BirdsEyeView,
    graph: PaintMap,
    picture: StereoFrame,
    config: DetectorConfig,
) -> tuple[Judged, ...]:
    """Return the candidates that are lanes, or halves of them, and faint lines that a second look finds."""
    selection, bend = config.lane_selection, view.axis.curvature
    found_paint = (_as_paint(each, view, graph, picture, config) for each in candidates)
    painted = [each for each in found_paint if each is not None]
    lines, evidence = [line for line, _ in painted], [evidence for _, evidence in painted]
    kept = select_lanes(lines, evidence, selection)
    for line in parallel_lines([lines[i] for i in kept], view, graph, selection):
        found = line_evidence(line, view, graph, picture)
        if is_paint(line, found, selection, bend):
            lines.append(line)
            evidence.append(found)
    kept = select_lanes(lines, evidence, selection, kept)
    return tuple((lines[i], evidence[i]) for i in kept)


def _as_paint(
    candidate: Judged, view: BirdsEyeView, graph: PaintMap, picture: StereoFrame, config: DetectorConfig
) -> Judged | None:
    """Return a candidate with the evidence of paint, None without.

    Of one that is too steep or strays from its paint, but is paint by all else, the nearer half, if that has
    enough paint for a line by itself and is brighter than kerbs are.
    """
    (line, evidence), selection, bend = candidate, config.lane_selection, view.axis.curvature
    if is_paint(line, evidence, selection, bend):
        return candidate
    if not is_paint(line, replace(evidence, slope=0.0, off_paint_fraction=0.0), selection, bend):
        return None
    half = near_half(line, view, graph, config.path_search.blank_cost)
    if half is None or half.score < selection.score_alone:
        return None
    found = line_evidence(half, view, graph, picture)
    return (half, found) if is_paint(half, found, selection, bend) and not is_pale(found) else None
