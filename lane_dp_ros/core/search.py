# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The lane lines along one axis of the road: propose, measure, score, select."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from lane_dp_ros.core.birdseye.birds_eye import birds_eye_view
from lane_dp_ros.core.birdseye.edge_map import edge_map
from lane_dp_ros.core.birdseye.paint_map import paint_map_builder
from lane_dp_ros.core.birdseye.paint_profile import PaintProfile
from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.geometry.disparity_map import DisparityMap
from lane_dp_ros.core.geometry.road_axis import RoadAxis
from lane_dp_ros.core.geometry.road_surface import RoadSurface
from lane_dp_ros.core.lanes.axis_refinement import AxisRefinement
from lane_dp_ros.core.lanes.candidate import Candidate, LaneEvidence, LaneLine, LanePath, Variant
from lane_dp_ros.core.lanes.edge_lines import EdgeLineSearch
from lane_dp_ros.core.lanes.evidence import EvidenceSource, courses, measure_border, measure_paint
from lane_dp_ros.core.lanes.line_fit import line_fit
from lane_dp_ros.core.lanes.path_search import path_search
from lane_dp_ros.core.lanes.scoring import EvidenceScoring
from lane_dp_ros.core.lanes.variants.extension import extend_line
from lane_dp_ros.core.lanes.variants.near_half import leads_astray, near_half
from lane_dp_ros.core.lanes.variants.parallel import parallel_lines
from lane_dp_ros.core.lanes.variants.stop_line import end_at_stop_line
from lane_dp_ros.core.stopwatch import Stopwatch
from lane_dp_ros.core.types import StereoFrame


@dataclass(frozen=True, eq=False)
class RoadView:
    """What is looked at: a grey frame, its disparity, and the road's surface."""

    frame: StereoFrame
    disparity: DisparityMap
    surface: RoadSurface


@dataclass(frozen=True, eq=False)
class SearchResult:
    """What was found along one axis: every candidate, refused ones with the reason, and the lanes of them."""

    paint: PaintProfile
    paths: tuple[LanePath, ...]
    candidates: tuple[Candidate, ...]

    @property
    def lanes(self) -> tuple[Candidate, ...]:
        """The candidates that are lanes, strongest first."""
        return tuple(candidate for candidate in self.candidates if not candidate.refusal)

    @property
    def road_edges(self) -> tuple[Candidate, ...]:
        """The candidates that are borders of the carriageway."""
        return tuple(candidate for candidate in self.candidates if candidate.is_edge)

    @property
    def score(self) -> float:
        """Net metres of paint of all lanes."""
        return sum(candidate.score for candidate in self.lanes)


class LaneSearch:
    """Searches lanes along an axis, by the stages that the configuration names."""

    def __init__(self, config: DetectorConfig) -> None:
        self._config = config
        self._paint_map = paint_map_builder(config.paint_map)
        self._paths = path_search(config.path_search)
        self._edge_lines = EdgeLineSearch(config.path_search)
        self._fit = line_fit(config.lane_model)
        self._scoring = EvidenceScoring(config.lane_selection)
        self._refinement = AxisRefinement(
            config.axis_refinement,
            self._scoring,
            config.path_search.slope_cost,
            config.vanishing_point.curvature_max,
        )

    def along(
        self,
        axis: RoadAxis,
        ipm_plane: RoadSurface,
        road: RoadView,
        rng: np.random.Generator,
        watch: Stopwatch,
    ) -> SearchResult:
        """Return the lane lines along `axis`, `ipm_plane` maps the road; `watch` takes each step's time."""
        with watch("birds_eye"):
            view = birds_eye_view(
                road.frame.left,
                road.disparity,
                road.surface,
                axis,
                self._config.birds_eye,
                ipm_plane,
            )
        with watch("paint_map"):
            paint = PaintProfile(view, self._paint_map.build(view, road.frame.right))
        with watch("path_search"):
            paths = tuple(self._paths.find(paint.paint_map, view.resolution))
        with watch("lane_model"):
            lines = self._lines(paths, paint, rng)
        if not self._config.lane_selection.evidence:
            nothing = LaneEvidence(length=0.0, start=0.0, slope=0.0)
            return SearchResult(paint, paths, tuple(Candidate(line, nothing) for line in lines))
        with watch("road_edges"):
            edges = edge_map(view, paint.paint_map)
            borders = self._edge_lines.find(edges, view)
        with watch("lane_selection"):
            source = EvidenceSource(paint, edges, road.frame)
            candidates = self._selected(self._proposed(lines, borders, source), source)
        return SearchResult(paint, paths, candidates)

    def refined_axis(self, found: SearchResult) -> RoadAxis | None:
        """Return the axis along which the paint that was found runs, None where that is the one searched."""
        if not self._config.lane_selection.evidence:
            return None
        proposed = [candidate for candidate in found.candidates if candidate.variant == "path"]
        return self._refinement.refine(proposed, found.paint.view.axis)

    def _lines(
        self, paths: Sequence[LanePath], paint: PaintProfile, rng: np.random.Generator
    ) -> list[LaneLine]:
        """Return lines through paths; those with free ends go on to further dashes, and end at stop lines."""
        lines = self._fit.fit(paths, paint, rng)
        if self._config.path_search.free_ends:
            config, blank_cost = self._config, self._config.path_search.blank_cost
            lines = [
                extend_line(
                    line, paint, blank_cost, config.extension, [each for each in lines if each is not line]
                )
                for line in lines
            ]
            lines = [end_at_stop_line(line, paint, blank_cost, config.stop_line) for line in lines]
        return lines

    def _proposed(
        self, lines: Sequence[LaneLine], borders: Sequence[LaneLine], source: EvidenceSource
    ) -> list[Candidate]:
        """Return lines, the near halves of those that lead astray, and borders, with their evidence."""
        blank_cost = self._config.path_search.blank_cost
        halves = [
            half
            for line, course in zip(lines, courses(lines, source.paint), strict=True)
            if leads_astray(*course) and (half := near_half(line, source.paint, blank_cost))
        ]
        paint = measure_paint(lines, source, self._scoring.needs_height, halves)
        candidates = [
            *_candidates(lines, paint[: len(lines)], "path"),
            *_candidates(halves, paint[len(lines) :], "near half"),
            *_candidates(borders, measure_border(borders, source), "border"),
        ]
        return self._scoring.scored(candidates)

    def _selected(self, proposed: Sequence[Candidate], source: EvidenceSource) -> tuple[Candidate, ...]:
        """Return all candidates, parallels to the lanes among them, with the lanes first."""
        chosen = self._scoring.selected(proposed)
        known = [each.line for each in chosen if not each.refusal]
        lines = parallel_lines(known, source.paint, self._config.parallel)
        if lines:
            paths = [each.evidence for each in proposed if each.variant == "path"]
            evidence = measure_paint(lines, source, self._scoring.needs_height, among=paths)
            parallels = self._scoring.scored(_candidates(lines, evidence, "parallel"))
            chosen = self._scoring.selected([*proposed, *parallels])
        return tuple(sorted(chosen, key=lambda each: (bool(each.refusal), -each.score)))


def _candidates(
    lines: Sequence[LaneLine], evidence: Sequence[LaneEvidence], variant: Variant
) -> list[Candidate]:
    return [Candidate(*each, variant) for each in zip(lines, evidence, strict=True)]
