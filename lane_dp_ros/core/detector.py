# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The lane detector: the paper's method section, one call a step."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from lane_dp_ros.core.birdseye.birds_eye import BirdsEyeView
from lane_dp_ros.core.birdseye.paint_map import PaintMap
from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.geometry.disparity_map import DisparityMap
from lane_dp_ros.core.geometry.road_axis import RoadAxis
from lane_dp_ros.core.geometry.road_surface import RoadSurface
from lane_dp_ros.core.lanes.candidate import Candidate, LanePath
from lane_dp_ros.core.lanes.lifting import to_lanes
from lane_dp_ros.core.lanes.mono_fallback import mono_lanes
from lane_dp_ros.core.road.disparity import dense_disparity
from lane_dp_ros.core.road.road_profile import fit_road_surface, plausible_heights
from lane_dp_ros.core.road.vanishing_point import RoadDirection, direction_along, direction_estimator
from lane_dp_ros.core.search import LaneSearch, RoadView, SearchResult
from lane_dp_ros.core.stopwatch import Stopwatch
from lane_dp_ros.core.types import Lane, Prior, RoadEstimate, StereoFrame

HEADING_JUMP, CURVATURE_JUMP = 0.05, 0.01  # rad, 1/m; less from frame to frame is the road or the vehicle
NO_PRIOR = Prior()


@dataclass(frozen=True, eq=False)
class LaneDetection:
    """The lanes of one frame and all that led to them; what was not reached is None or empty."""

    lanes: tuple[Lane, ...] = ()
    disparity: DisparityMap = field(default_factory=lambda: DisparityMap.unknown((0, 0)))
    road: RoadSurface | None = None
    """The road's surface as measured in this frame."""
    road_estimate: RoadEstimate = field(default_factory=lambda: RoadEstimate(None))
    """The surface that served."""
    direction: RoadDirection | None = None
    birds_eye: BirdsEyeView | None = None
    paint_map: PaintMap | None = None
    paths: tuple[LanePath, ...] = ()
    candidates: tuple[Candidate, ...] = ()
    """Every line that was measured; those that are no lanes with the reason."""
    seconds: dict[str, float] = field(default_factory=dict)
    """Computing time of each stage, in order."""
    note: str = ""
    """One line that says why the road that was measured did not serve, or why there are no lanes."""

    @property
    def score(self) -> float:
        """Net metres of paint of all lanes."""
        return sum(candidate.score for candidate in self.candidates if not candidate.refusal)


class LaneDetector:
    """Finds the painted lane lines in rectified stereo frames.

    `camera` is that of the frames; `config` see `lane_dp_ros.core.config`, where `preset("paper")` gives the
    paper as written.
    """

    def __init__(self, camera: StereoCamera, config: DetectorConfig | None = None) -> None:
        self.camera = camera
        self.config = config or DetectorConfig()
        self._direction = direction_estimator(self.config.vanishing_point)
        self._search = LaneSearch(self.config)

    def detect(self, frame: StereoFrame, prior: Prior = NO_PRIOR) -> LaneDetection:
        """Return the lanes of a frame, in the light of the frames before where a `prior` tells of them.

        Where the frame shows no road, or a road without lanes, the detection has no lanes and `note` says
        why. Where a prior has another surface serve than the one that was measured, the left image is looked
        at alone: heights are not known.
        """
        watch, rng, frame = Stopwatch(), np.random.default_rng(self.config.seed), frame.grey()
        with watch("disparity"):
            disparity = dense_disparity(frame, self.camera, self.config.disparity)
        with watch("road_profile"):
            measured = fit_road_surface(disparity, self.camera, self.config.road_profile, rng)
            road = prior.road(measured)
        detection = LaneDetection(
            (), disparity, measured, road, seconds=watch.seconds, note=self._note(frame, road)
        )
        if road.surface is None:
            return detection
        if road.source != "measured":
            frame, disparity = StereoFrame(frame.left), DisparityMap.unknown(disparity.shape)
        with watch("vanishing_point"):
            direction = self._direction.estimate(frame.left, disparity, road.surface)
        view = RoadView(frame, disparity, road.surface, direction.ipm_plane)
        found = self._search.along(direction.axis, view, rng, watch)
        known_axis = prior.axis if road.source == "measured" else None
        found = self._along_other_axes(found, view, known_axis, rng, watch)
        lanes, candidates = self._lanes(found, road, prior)
        return replace(
            detection,
            lanes=lanes,
            direction=self._seen_along(found, direction, road.surface),
            birds_eye=found.paint.view,
            paint_map=found.paint.paint_map,
            paths=found.paths,
            candidates=candidates,
            note=detection.note or ("" if lanes else f"no lanes among {len(found.paths)} paths"),
        )

    def _along_other_axes(
        self,
        found: SearchResult,
        view: RoadView,
        known: RoadAxis | None,
        rng: np.random.Generator,
        watch: Stopwatch,
    ) -> SearchResult:
        """Return what has most paint along the axis of the edges, that of its paint, or one known before."""
        refined = self._search.refined_axis(found)
        if refined is not None:
            found = max(found, self._search.along(refined, view, rng, watch), key=lambda each: each.score)
        if known is not None and jumps(found.paint.view.axis, known):
            found = max(found, self._search.along(known, view, rng, watch), key=lambda each: each.score)
        return found

    def _lanes(
        self, found: SearchResult, road: RoadEstimate, prior: Prior
    ) -> tuple[tuple[Lane, ...], tuple[Candidate, ...]]:
        """Return the lanes of what was found, and all candidates, refused ones with the reason."""
        view = found.paint.view
        if road.source == "measured":
            return to_lanes(found.lanes, view), found.candidates
        lanes, doubted = mono_lanes(found.lanes, view, prior.lanes, self.config.mono_fallback)
        refused = {id(each.line): each for each in doubted}
        return lanes, tuple(refused.get(id(each.line), each) for each in found.candidates)

    def _seen_along(
        self, found: SearchResult, direction: RoadDirection, surface: RoadSurface
    ) -> RoadDirection:
        view = found.paint.view
        if view.axis == direction.axis:
            return direction
        return replace(direction_along(view.axis, surface), ipm_plane=view.ipm_plane)

    def _note(self, frame: StereoFrame, road: RoadEstimate) -> str:
        """Return why the road that was measured in a frame does not serve, empty where it does."""
        if road.source == "measured":
            return ""
        if road.reason:
            return f"the road contradicts the one before: {road.reason}"
        if frame.right is None:
            return "no right image"
        heights = "{:.1f} to {:.1f}".format(*plausible_heights(self.config.road_profile))
        return f"no road surface in the disparity {heights} m below the camera"


def jumps(axis: RoadAxis, before: RoadAxis) -> bool:
    """Return whether the road's axis changes more from one frame to the next than roads and vehicles do."""
    turned = abs(axis.heading - before.heading) > HEADING_JUMP
    return turned or abs(axis.curvature - before.curvature) > CURVATURE_JUMP
