# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The lane pipeline over time: a prior goes into the detector, its lanes become tracks."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.detector import LaneDetection, LaneDetector
from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.geometry.disparity_map import DisparityMap
from lane_dp_ros.core.geometry.road_axis import RoadAxis
from lane_dp_ros.core.geometry.road_surface import RoadSurface
from lane_dp_ros.core.geometry.vertical_curve import VerticalCurve
from lane_dp_ros.core.monitoring.calibration_monitor import (
    UNCHECKED,
    CalibrationMonitor,
    CalibrationStatus,
    Observation,
)
from lane_dp_ros.core.monitoring.right_delay import right_delay
from lane_dp_ros.core.monitoring.same_picture import is_same_picture
from lane_dp_ros.core.monitoring.vertical_disparity import vertical_disparity
from lane_dp_ros.core.stopwatch import Stopwatch
from lane_dp_ros.core.tracking.road_filter import RoadFilter
from lane_dp_ros.core.tracking.tracker import LaneTracker
from lane_dp_ros.core.types import Image, Lane, Prior, StereoFrame, with_roles

CHECK_PERIOD_NS = 500_000_000  # between comparisons of left and right: a calibration does not jump
BEFORE_NS = 150_000_000  # an older picture shows too little of what the last one shows
COURSE_MEMORY_NS = 500_000_000  # later the road may well lie and run otherwise
VOTE_PERIOD_NS = 300_000_000  # for which the axis goes on from frame to frame; then the edges vote anew
SAME_PLACE = 0.25  # m; a road edge so near to a lane's centre is that lane's paint
MEMORY_NS = 1_000_000_000  # a longer jump of time, or one backwards, and everything is forgotten
SERVES = {"last": "the last road profile", "nominal": "the camera's nominal height and pitch"}


@dataclass(frozen=True, eq=False)
class FrameResult:
    """What a frame gave.

    `problem` is one line that says what is wrong, or empty; `camera` and `detection` are None where the
    calibration or the frame could not be used. `lanes` and `road_edges` are the detection's once they are
    tracked, each with ids of their own, with those that go on unseen. `road_profile` says where the road's
    surface is from: measured, last or nominal; `check` is the calibration's.
    """

    frame: StereoFrame
    camera: StereoCamera | None = None
    detection: LaneDetection | None = None
    lanes: tuple[Lane, ...] = ()
    road_edges: tuple[Lane, ...] = ()
    problem: str = ""
    road_profile: str = ""
    check: CalibrationStatus = UNCHECKED
    seconds: dict[str, float] = field(default_factory=dict)
    """Computing time of each stage, in order."""


@dataclass
class _Memory:
    """What is kept from frame to frame, and forgotten when time jumps or the camera changes."""

    camera: StereoCamera | None = None
    stamp_ns: int = 0
    surface: RoadSurface | None = None
    axis: RoadAxis | None = None
    paint: float = 0.0
    course_ns: int = 0
    """When surface, axis and paint were seen."""
    voted_ns: int = 0
    """When the edges last voted for the axis."""


@dataclass
class LanePipeline:
    """Answers frame after frame, which must come in order; remembers the road, gives lines identities.

    `monitored`: what is seen is used to judge the calibration, too.
    """

    monitored: bool = True
    _road: RoadFilter = field(default_factory=RoadFilter, init=False)
    _tracker: LaneTracker = field(default_factory=LaneTracker, init=False)
    _edge_tracker: LaneTracker = field(default_factory=LaneTracker, init=False)
    _monitor: CalibrationMonitor = field(default_factory=CalibrationMonitor, init=False)
    _memory: _Memory = field(default_factory=_Memory, init=False)
    _detector: LaneDetector | None = field(default=None, init=False)
    _checked_ns: int = field(default=0, init=False)  # when left and right were compared last
    _before: tuple[int, Image] | None = field(default=None, init=False)  # the last left picture and its stamp

    def process(
        self,
        frame: StereoFrame,
        camera: StereoCamera,
        stamp_ns: int,
        config: DetectorConfig,
        disparity: DisparityMap | None = None,
    ) -> FrameResult:
        """Return the lanes of the frame of `stamp_ns`, in the light of those before.

        `disparity` is what `LaneDetector.match` gave for this frame, in another process for example.
        """
        prior = self._predict(_nominal_road(camera, config), stamp_ns, config)
        detection = self._detector_for(camera, config).detect(frame, prior, disparity)
        watch = Stopwatch(detection.seconds)
        with watch("tracking"):
            self._road.update(detection.road)
            self._configure_trackers(config)
            lanes = self._tracked(detection, stamp_ns)
            tracked_edges = self._edge_tracker.update(detection.road_edges, stamp_ns)
            road_edges = with_roles([edge for edge in tracked_edges if not _lies_on_paint(edge, lanes)])
        road = detection.road_estimate
        problem = ""
        if road.source != "measured":
            problem = f"{detection.note}; the left image alone serves, with {SERVES[road.source]}"
        check = UNCHECKED
        if self.monitored:
            with watch("calibration_monitor"):
                check = self._checked(frame, camera, detection, lanes, config)
        return FrameResult(
            frame,
            camera,
            detection,
            lanes,
            road_edges,
            problem,
            road.source,
            check,
            watch.seconds,
        )

    def _predict(self, nominal: RoadSurface, stamp_ns: int, config: DetectorConfig) -> Prior:
        """Return what the frames before say of the one of `stamp_ns`."""
        if nominal.camera != self._memory.camera:
            self._tracker.reset()
            self._edge_tracker.reset()
        if nominal.camera != self._memory.camera or not 0 <= stamp_ns - self._memory.stamp_ns <= MEMORY_NS:
            self._memory = _Memory(nominal.camera)
        memory = self._memory
        memory.stamp_ns = stamp_ns
        gate = self._road.predict(nominal, stamp_ns)
        if not config.tracking.enabled or stamp_ns - memory.course_ns > COURSE_MEMORY_NS:
            return Prior(gate)
        due = stamp_ns - memory.voted_ns >= VOTE_PERIOD_NS
        return Prior(gate, memory.surface, memory.axis, None if due else memory.paint)

    def _detector_for(self, camera: StereoCamera, config: DetectorConfig) -> LaneDetector:
        detector = self._detector
        if detector is None or detector.camera != camera or detector.config != config:
            detector = self._detector = LaneDetector(camera, config)
        return detector

    def _configure_trackers(self, config: DetectorConfig) -> None:
        for tracker in (self._tracker, self._edge_tracker):
            tracker.config = config.tracking
            tracker.half_width = config.birds_eye.width / 2

    def _tracked(self, detection: LaneDetection, stamp_ns: int) -> tuple[Lane, ...]:
        """Return the lanes of a detection with identities, and remember what the next prior needs."""
        memory = self._memory
        if detection.road_estimate.source == "measured":
            seen = detection.birds_eye if detection.lanes else None
            memory.surface, memory.course_ns = detection.road, stamp_ns
            memory.axis, memory.paint = None if seen is None else seen.axis, detection.score
            memory.voted_ns = stamp_ns if detection.voted else memory.voted_ns
        return self._tracker.update(detection.lanes, stamp_ns)

    def _checked(
        self,
        frame: StereoFrame,
        camera: StereoCamera,
        detection: LaneDetection,
        lanes: tuple[Lane, ...],
        config: DetectorConfig,
    ) -> CalibrationStatus:
        """Return what the frames so far say of the calibration."""
        if frame.right is None:
            return UNCHECKED
        nominal = _nominal_road(camera, config)
        sight = self._compared(frame, detection, nominal)
        road = detection.road if detection.road_estimate.source == "measured" else None
        return self._monitor.update(replace(sight, road=road, lanes=lanes), nominal)

    def _compared(self, frame: StereoFrame, detection: LaneDetection, nominal: RoadSurface) -> Observation:
        """Return what a comparison of left and right gives, where one is due."""
        stamp_ns, before = self._memory.stamp_ns, self._before
        self._before = stamp_ns, frame.left
        if frame.right is None or 0 <= stamp_ns - self._checked_ns < CHECK_PERIOD_NS:
            return Observation(stamp_ns)
        self._checked_ns = stamp_ns
        rows = vertical_disparity(frame.left, frame.right, detection.disparity, nominal.camera)
        left, right = (StereoFrame(image).grey().left for image in (frame.left, frame.right))
        same, delay = detection.road is None and is_same_picture(left, right, nominal), None
        if before is not None and 0 < stamp_ns - before[0] <= BEFORE_NS and not same:
            share = right_delay(left, StereoFrame(before[1]).grey().left, right, nominal)
            delay = None if share is None else share * (stamp_ns - before[0]) / 1e9
        return Observation(stamp_ns, vertical_disparity=rows, same_picture=same, right_delay=delay)


def _lies_on_paint(edge: Lane, lanes: tuple[Lane, ...]) -> bool:
    """Whether most of a road edge runs along a lane: an edge from before, where paint is seen now."""
    for lane in lanes:
        apart = np.linalg.norm(edge.points[:, None, [0, 2]] - lane.points[:, [0, 2]], axis=2).min(axis=1)
        if np.median(apart) < SAME_PLACE:
            return True
    return False


def _nominal_road(camera: StereoCamera, config: DetectorConfig) -> RoadSurface:
    return VerticalCurve.plane(camera, config.road_profile.camera_height, config.road_profile.camera_pitch)
