# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The lane detector: the paper's method section, one call a step."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.geometry.road_axis import RoadAxis
from lane_dp_ros.core.geometry.road_surface import RoadSurface
from lane_dp_ros.core.lane import Lane
from lane_dp_ros.core.lanes.axis_refinement import turned_axis
from lane_dp_ros.core.lanes.lifting import to_lanes
from lane_dp_ros.core.lanes.mono_fallback import without_heights
from lane_dp_ros.core.lanes.search import LaneSearch, search_lanes
from lane_dp_ros.core.road.arc_vanishing_point import road_axis
from lane_dp_ros.core.road.disparity import dense_disparity
from lane_dp_ros.core.road.edge_pixels import road_edges
from lane_dp_ros.core.road.road_profile import fit_road_surface, plausible_heights
from lane_dp_ros.core.road.vanishing_point import dense_vanishing_point, pitch_and_yaw, vanishing_point_of
from lane_dp_ros.core.stopwatch import Stopwatch
from lane_dp_ros.core.types import BirdsEyeView, LanePath, PaintMap, StereoFrame, VanishingPoint

Image = NDArray[np.uint8]


@dataclass(frozen=True)
class LaneDetection:
    """The lanes of one pair and what led to them; what was not reached is None or empty."""

    lanes: tuple[Lane, ...] = ()
    disparity: NDArray[np.float32] = field(default_factory=lambda: np.empty((0, 0), np.float32))
    road: RoadSurface | None = None
    vanishing_point: VanishingPoint | None = None
    birds_eye: BirdsEyeView | None = None
    graph: PaintMap | None = None
    paths: tuple[LanePath, ...] = ()
    score: float = 0.0
    """Net metres of paint of all lanes."""
    seconds: dict[str, float] = field(default_factory=dict)
    """Computing time of each stage, in order."""
    note: str = ""
    """One line that says why there is no answer, empty otherwise."""


class LaneDetector:
    """Finds the painted lane lines in rectified stereo pairs, each pair by itself.

    `camera` is that of the pairs; `config` see `lane_dp_ros.core.config`, where `preset("paper")` gives the
    paper as written.
    """

    def __init__(self, camera: StereoCamera, config: DetectorConfig | None = None) -> None:
        self.camera = camera
        self.config = config or DetectorConfig()

    def detect(self, left: Image, right: Image | None, road: RoadSurface | None = None) -> LaneDetection:
        """Return the lanes of a rectified pair, uint8 images (H, W) grey or (H, W, 3) BGR of equal size.

        `road` is taken for the road's surface instead of the one that the disparity shows; then `right` may
        be None: the left image alone, and nothing is known of heights.
        Where the pair shows no road, or a road without lanes, the detection has no lanes and `note` says why.
        Raises ValueError for images of different size or of another shape or type.
        """
        config, watch = self.config, Stopwatch()
        rng = np.random.default_rng(config.seed)
        left = _grey(left, "left")
        right = None if right is None and road is not None else _grey(right, "right")
        if right is not None:
            _check_equal_size(left, right)
        with watch("disparity"):
            disparity = dense_disparity(left, right, self.camera, config.disparity)
        with watch("road_profile"):
            road = road or fit_road_surface(disparity, self.camera, config.road_profile, rng)
        if road is None:
            heights = "{:.1f} to {:.1f}".format(*plausible_heights(config.road_profile))
            note = f"no road surface in the disparity {heights} m below the camera"
            return LaneDetection(disparity=disparity, seconds=watch.seconds, note=note)
        with watch("vanishing_point"):
            vanishing_point, axis, ground = self._direction(left, disparity, road)
        picture = StereoFrame(left, right, disparity, road, ground)
        found = search_lanes(picture, axis, config, rng, watch)
        if config.lane_selection.evidence:
            turned = turned_axis(found.candidates, axis, config.lane_selection, config.vanishing_point)
            if turned is not None:
                again = search_lanes(picture, turned, config, rng, watch)
                found = max(found, again, key=lambda search: search.score)
        detection = LaneDetection((), disparity, road, vanishing_point, seconds=watch.seconds)
        return _with_lanes(detection, found, heights=right is not None)

    def detect_along(
        self, axis: RoadAxis, left: Image, right: Image | None, detection: LaneDetection
    ) -> LaneDetection:
        """Return the lanes of a pair along `axis`, or its `detection` where that has more paint.

        `detection` is what `detect` returned for the same images. Raises ValueError as `detect` does.
        """
        view = detection.birds_eye
        if view is None:
            return detection
        watch = Stopwatch(detection.seconds)
        left, right = _grey(left, "left"), None if right is None else _grey(right, "right")
        if right is not None:
            _check_equal_size(left, right)
        picture = StereoFrame(left, right, detection.disparity, view.surface, view.ground)
        rng = np.random.default_rng(self.config.seed)
        found = search_lanes(picture, axis, self.config, rng, watch)
        if found.score <= detection.score:
            return replace(detection, seconds=watch.seconds)
        point = vanishing_point_of(axis, view.surface)
        return _with_lanes(replace(detection, vanishing_point=point, seconds=watch.seconds), found)

    def _direction(
        self, left: Image, disparity: NDArray[np.float32], road: RoadSurface
    ) -> tuple[VanishingPoint, RoadAxis, RoadSurface]:
        """Return the vanishing point, the road's axis, and the ground to look at from above."""
        config = self.config.vanishing_point
        edges = road_edges(left, disparity, road)
        if config.method == "arc":
            axis = road_axis(edges, config)
            return vanishing_point_of(axis, road), axis, road
        point = dense_vanishing_point(edges, road, left.shape)
        pitch, yaw = pitch_and_yaw(point, self.camera, left.shape, config.centred_principal_point)
        return point, RoadAxis(yaw), RoadSurface.plane(self.camera, road.camera_height, pitch)


def _with_lanes(detection: LaneDetection, found: LaneSearch, heights: bool = True) -> LaneDetection:
    """Return the detection with what was found; lines whose heights nobody knows are doubted."""
    lines, evidence = [line for line, _ in found.lanes], [evidence for _, evidence in found.lanes]
    lanes = to_lanes(lines, evidence, found.view)
    return replace(
        detection,
        lanes=lanes if heights else without_heights(lanes, lines, evidence),
        birds_eye=found.view,
        graph=found.graph,
        paths=found.paths,
        score=found.score,
        note="" if lanes else f"no lanes among {len(found.paths)} paths",
    )


def _grey(image: Image | None, side: str) -> Image:
    if not isinstance(image, np.ndarray):  # None, when cv2.imread finds no picture
        raise ValueError(f"the {side} image is {type(image).__name__}, expected an array (picture not read?)")
    if image.dtype != np.uint8 or image.ndim not in (2, 3) or (image.ndim == 3 and image.shape[2] != 3):
        raise ValueError(
            f"the {side} image is {image.dtype} {image.shape}, expected uint8 (H, W) or (H, W, 3)"
        )
    if image.size == 0:
        raise ValueError(f"the {side} image is empty: {image.shape}")
    grey = cv2.cvtColor(image, cv2.COLOR_BGR2GRAY) if image.ndim == 3 else image
    return np.ascontiguousarray(grey)


def _check_equal_size(left: Image, right: Image) -> None:
    if left.shape != right.shape:
        raise ValueError(
            f"the images differ in size: left {left.shape[1]}x{left.shape[0]}, "
            f"right {right.shape[1]}x{right.shape[0]}, expected equal"
        )
