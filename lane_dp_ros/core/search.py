# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The lane lines along one axis of the road: propose, measure, score, select."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from lane_dp_ros.core.birdseye.birds_eye import birds_eye_view
from lane_dp_ros.core.birdseye.paint_map import paint_map_builder
from lane_dp_ros.core.birdseye.paint_profile import PaintProfile
from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.geometry.disparity_map import DisparityMap
from lane_dp_ros.core.geometry.road_axis import RoadAxis
from lane_dp_ros.core.geometry.road_surface import RoadSurface
from lane_dp_ros.core.lanes.axis_refinement import AxisRefinement
from lane_dp_ros.core.lanes.candidate import Candidate, LaneEvidence, LaneLine, LanePath, Variant
from lane_dp_ros.core.lanes.evidence import measure
from lane_dp_ros.core.lanes.line_fit import line_fit
from lane_dp_ros.core.lanes.path_search import path_search
from lane_dp_ros.core.lanes.scoring import is_paint_but_for_course, is_pale, needs_height, refusal
from lane_dp_ros.core.lanes.selection import select_lanes
from lane_dp_ros.core.lanes.variants.extension import extend_line
from lane_dp_ros.core.lanes.variants.near_half import near_half
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
    def score(self) -> float:
        """Net metres of paint of all lanes."""
        return sum(candidate.score for candidate in self.lanes)


class LaneSearch:
    """Searches lanes along an axis, by the stages that the configuration names."""

    def __init__(self, config: DetectorConfig) -> None:
        self._config = config
        self._paint_map = paint_map_builder(config.paint_map)
        self._paths = path_search(config.path_search)
        self._fit = line_fit(config.lane_model)
        self._refinement = AxisRefinement(
            config.axis_refinement,
            config.lane_selection,
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
        with watch("lane_selection"):
            measured = self._measured(lines, paint, road.frame, "path")
            candidates = self._selected(measured, paint, road.frame)
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
        fitted = [self._fit.fit(path, paint, rng) for path in paths]
        lines = [line for line in fitted if line is not None]
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

    def _measured(
        self, lines: Sequence[LaneLine], paint: PaintProfile, frame: StereoFrame, variant: Variant
    ) -> list[Candidate]:
        """Return lines with their evidence, refused where that does not speak for paint."""
        selection, bend = self._config.lane_selection, paint.view.axis.curvature

        def needs(line: LaneLine, evidence: LaneEvidence) -> bool:
            """Return whether the line's height would decide, too."""
            return selection.evidence and needs_height(line, evidence, selection)

        measured = measure(lines, paint, frame, self._config.plane_sweep, needs)
        return [
            Candidate(
                line,
                evidence,
                variant,
                refusal(line, evidence, selection, bend) if selection.evidence else "",
            )
            for line, evidence in zip(lines, measured, strict=True)
        ]

    def _selected(
        self, candidates: Sequence[Candidate], paint: PaintProfile, frame: StereoFrame
    ) -> tuple[Candidate, ...]:
        """Return the candidates, near halves and parallels among them, with the lanes first."""
        selection = self._config.lane_selection
        if not selection.evidence:
            return tuple(candidates)
        halves = self._near_halves(candidates, paint, frame)
        painted = [each for each in (*candidates, *halves) if not each.refusal]
        first = select_lanes(painted, selection)
        known = [candidate.line for candidate in first.lanes]
        lines = parallel_lines(known, paint, self._config.parallel, selection)
        parallels = self._measured(lines, paint, frame, "parallel")
        rest = [each for each in painted if each not in first.lanes]
        chosen = select_lanes(
            [*rest, *(each for each in parallels if not each.refusal)], selection, first.lanes
        )
        refused = [each for each in (*candidates, *halves, *parallels) if each.refusal]
        return (*chosen.lanes, *chosen.refused, *refused)

    def _near_halves(
        self, candidates: Sequence[Candidate], paint: PaintProfile, frame: StereoFrame
    ) -> list[Candidate]:
        """Return the nearer halves of candidates that are too steep or stray, but are paint by all else.

        Refused unless they have enough paint for lines by themselves and are brighter than kerbs are.
        """
        selection, blank_cost = self._config.lane_selection, self._config.path_search.blank_cost
        astray = [
            each
            for each in candidates
            if each.refusal and is_paint_but_for_course(each.line, each.evidence, selection)
        ]
        halves = [near_half(each.line, paint, blank_cost) for each in astray]
        long = [half for half in halves if half is not None and half.score >= selection.score_alone]
        return [
            each.refused("as pale as kerbs")
            if not each.refusal and is_pale(each.evidence, selection)
            else each
            for each in self._measured(long, paint, frame, "near half")
        ]
