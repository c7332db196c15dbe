# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The lane lines along one axis of the road: view from above, graph, paths, lines, evidence, choice."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from lane_dp_ros.core.birds_eye import birds_eye_view
from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.data import BirdsEyeView, LaneEvidence, LaneGraph, LaneLine, LanePath, RoadPicture
from lane_dp_ros.core.lane_evidence import line_evidence
from lane_dp_ros.core.lane_graph import build_graph
from lane_dp_ros.core.lane_model import fit_line
from lane_dp_ros.core.lane_selection import is_paint, is_pale, select_lanes
from lane_dp_ros.core.line_extension import extend_line
from lane_dp_ros.core.near_half import near_half
from lane_dp_ros.core.parallel_lines import parallel_lines
from lane_dp_ros.core.path_search import find_paths
from lane_dp_ros.core.road import RoadAxis
from lane_dp_ros.core.stop_lines import end_at_stop_line
from lane_dp_ros.core.stopwatch import Stopwatch

Judged = tuple[LaneLine, LaneEvidence]


@dataclass(frozen=True)
class LaneSearch:
    """What was found along one axis: all candidates, each with its evidence, and the lanes."""

    view: BirdsEyeView
    graph: LaneGraph
    paths: tuple[LanePath, ...]
    candidates: tuple[Judged, ...]
    lanes: tuple[Judged, ...]

    @property
    def score(self) -> float:
        """Net metres of paint of all lanes."""
        return sum(line.score for line, _ in self.lanes)


def search_lanes(
    picture: RoadPicture, axis: RoadAxis, config: DetectorConfig, rng: np.random.Generator, watch: Stopwatch
) -> LaneSearch:
    """Return the lane lines along `axis`; `watch` takes the time of each step."""
    with watch("birds_eye"):
        view = birds_eye_view(
            picture.left, picture.disparity, picture.surface, axis, config.birds_eye, picture.ground
        )
    with watch("lane_graph"):
        graph = build_graph(view, config.lane_graph, picture.right)
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
    graph: LaneGraph,
    picture: RoadPicture,
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
    candidate: Judged, view: BirdsEyeView, graph: LaneGraph, picture: RoadPicture, config: DetectorConfig
) -> Judged | None:
    """Return a candidate with the evidence of paint, None without.

    Of one that is too steep or strays from its paint, but is paint by all else, the nearer half, if that has
    enough paint for a line by itself and is brighter than kerbs are.
    """
    (line, evidence), selection, bend = candidate, config.lane_selection, view.axis.curvature
    if is_paint(line, evidence, selection, bend):
        return candidate
    if not is_paint(line, replace(evidence, slope=0.0, astray=0.0), selection, bend):
        return None
    half = near_half(line, view, graph, config.path_search.blank_cost)
    if half is None or half.score < selection.score_alone:
        return None
    found = line_evidence(half, view, graph, picture)
    return (half, found) if is_paint(half, found, selection, bend) and not is_pale(found) else None
