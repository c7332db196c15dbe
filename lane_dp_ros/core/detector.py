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
from lane_dp_ros.core.geometry.road_surface import RoadSurface
from lane_dp_ros.core.geometry.vertical_curve import VerticalCurve
from lane_dp_ros.core.lanes.candidate import Candidate, LanePath
from lane_dp_ros.core.lanes.lifting import to_lanes, to_road_edges
from lane_dp_ros.core.lanes.markings import with_markings
from lane_dp_ros.core.monitoring.same_picture import is_same_picture
from lane_dp_ros.core.road.disparity import dense_disparity
from lane_dp_ros.core.road.road_profile import largest_disparity, plausible_heights, road_profile
from lane_dp_ros.core.road.vanishing_point import RoadDirection, direction_along, direction_estimator
from lane_dp_ros.core.search import LaneSearch, RoadView, SearchResult
from lane_dp_ros.core.stopwatch import Stopwatch
from lane_dp_ros.core.types import Image, Lane, Prior, RoadEstimate, StereoFrame

EXPLAINED = 0.8  # of the paint of a moment ago; with less along its axis the road may have turned away
NO_PRIOR = Prior()


@dataclass(frozen=True, eq=False)
class LaneDetection:
    """The lanes of one frame and all that led to them; what was not reached is None or empty."""

    lanes: tuple[Lane, ...] = ()
    road_edges: tuple[Lane, ...] = ()
    """Unpainted borders of the carriageway: kerbs, verges, gutters."""
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
    voted: bool = False
    """Whether the edges voted for the road's direction; else the prior's explains the frame."""
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
        self._profile = road_profile(self.config.road_profile)
        self._direction = direction_estimator(self.config.vanishing_point)
        self._search = LaneSearch(self.config)
        profile = self.config.road_profile
        self._nominal = VerticalCurve.plane(camera, profile.camera_height, profile.camera_pitch)

    def match(self, frame: StereoFrame) -> DisparityMap:
        """Return the disparity of a frame: the part of `detect` that needs no prior."""
        frame = frame.grey()
        largest = largest_disparity(self.camera, len(frame.left), self.config.road_profile)
        return dense_disparity(frame, self.camera, self.config.disparity, largest)

    def measure_road(
        self, frame: StereoFrame, disparity: DisparityMap, known: RoadSurface | None = None
    ) -> RoadSurface | None:
        """Return the road's surface in a frame with its disparity, None where no road is to be seen.

        `known` is the surface of a moment ago.
        """
        rng = np.random.default_rng(self.config.seed)
        return self._profile.measure(frame.grey(), disparity, self.camera, rng, known)

    def detect(
        self, frame: StereoFrame, prior: Prior = NO_PRIOR, disparity: DisparityMap | None = None
    ) -> LaneDetection:
        """Return the lanes of a frame, in the light of the frames before where a `prior` tells of them.

        `disparity` is what `match` gave for the frame, in another process for example.

        Where the frame shows no road, or a road without lanes, the detection has no lanes and `note` says
        why. Where a prior has another surface serve than the one that was measured, the left image is looked
        at alone: heights are not known.
        """
        watch, rng, picture = Stopwatch(), np.random.default_rng(self.config.seed), frame.left
        frame = frame.grey()
        with watch("disparity"):
            disparity = self.match(frame) if disparity is None else disparity
        with watch("road_profile"):
            measured = self.measure_road(frame, disparity, prior.surface)
            road = prior.road(measured)
        detection = LaneDetection(
            (), (), disparity, measured, road, seconds=watch.seconds, note=self._note(frame, road)
        )
        if road.surface is None:
            return detection
        if road.source != "measured":
            frame, disparity = StereoFrame(frame.left), DisparityMap.unknown(disparity.shape)
        view = RoadView(frame, disparity, road.surface)
        direction, found = self._found(view, prior if road.source == "measured" else NO_PRIOR, rng, watch)
        with watch("markings"):
            found = self._with_markings(found, picture)
        lanes = to_lanes(found.lanes, found.paint.view)
        return replace(
            detection,
            lanes=lanes,
            road_edges=to_road_edges(found.road_edges, found.paint.view),
            direction=self._seen_along(found, direction, road.surface),
            birds_eye=found.paint.view,
            paint_map=found.paint.paint_map,
            paths=found.paths,
            candidates=found.candidates,
            voted="vanishing_point" in watch.seconds,
            note=detection.note or ("" if lanes else f"no lanes among {len(found.paths)} paths"),
        )

    def _found(
        self, road: RoadView, prior: Prior, rng: np.random.Generator, watch: Stopwatch
    ) -> tuple[RoadDirection, SearchResult]:
        """Return what lies along the axis of a moment ago where that explains the pair, else the edges'."""
        known = None if prior.axis is None else self._direction.follow(prior.axis, road.surface)
        best = None if known is None else (known, self._along(known, road, rng, watch))
        if best is not None and prior.paint is not None and best[1].score >= EXPLAINED * prior.paint:
            return best
        with watch("vanishing_point"):
            voted = self._direction.estimate(road.frame.left, road.disparity, road.surface)
        found = voted, self._along(voted, road, rng, watch)
        return found if best is None else max(found, best, key=lambda each: each[1].score)

    def _along(
        self, direction: RoadDirection, road: RoadView, rng: np.random.Generator, watch: Stopwatch
    ) -> SearchResult:
        """Return what has most paint along a direction or, turned, along the paint that lies there."""
        found = self._search.along(direction.axis, direction.ipm_plane, road, rng, watch)
        refined = self._search.refined_axis(found)
        if refined is None:
            return found
        again = self._search.along(refined, direction.ipm_plane, road, rng, watch)
        return max(found, again, key=lambda each: each.score)

    def _with_markings(self, found: SearchResult, picture: Image) -> SearchResult:
        """Return what was found, the lanes with kind and colour; `picture` is the left one as it came."""
        marked = with_markings(found.lanes, found.paint, picture)
        refused = (each for each in found.candidates if each.refusal)
        return replace(found, candidates=(*marked, *refused))

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
        if frame.right is not None and is_same_picture(frame.left, frame.right, self._nominal):
            return "left and right show the same picture"
        if road.reason:
            return f"the road contradicts the one before: {road.reason}"
        if frame.right is None:
            return "no right image"
        heights = "{:.1f} to {:.1f}".format(*plausible_heights(self.config.road_profile))
        return f"no road surface in the disparity {heights} m below the camera"
