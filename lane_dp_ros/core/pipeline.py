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
from lane_dp_ros.core.types import Lane, Prior, StereoFrame, as_measured, with_roles

CHECK_PERIOD_NS = 500_000_000  # left and right are compared once in each: a calibration does not jump
BEFORE_NS = 150_000_000  # an older picture shows too little of what the last one shows
COURSE_MEMORY_NS = 500_000_000  # later the road may well lie and run otherwise
VOTE_PERIOD_NS = 300_000_000  # the edges vote for the axis once in each; between it goes on by itself
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


@dataclass(frozen=True, eq=False)
class Finding:
    """What was found in a frame of `camera` in the light of a `prior`: all for which its pictures are needed.

    `prior` is without its gate. `sight` is what the monitor is told, None of a left image alone and of what
    is not monitored; `seconds` is the computing time of each stage.
    """

    camera: StereoCamera
    prior: Prior
    detection: LaneDetection
    sight: Observation | None
    seconds: dict[str, float]

    def holds(self, prior: Prior) -> bool:
        """Whether the same would be found in the light of another prior."""
        own, detection = self.prior, self.detection
        same = (own.surface, own.axis, own.paint) == (prior.surface, prior.axis, prior.paint)
        return same and prior.road(detection.road) == detection.road_estimate

    def without_arrays(self) -> Finding:
        """Return it without what is as large as pictures and serves nothing that follows."""
        chosen = tuple(each for each in self.detection.candidates if not each.refusal)
        slim = replace(
            self.detection,
            disparity=DisparityMap.unknown((0, 0)),
            birds_eye=None,
            paint_map=None,
            paths=(),
            candidates=chosen,
        )
        return replace(self, detection=slim)


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
    _before: tuple[int, StereoFrame] | None = field(default=None, init=False)  # the last pair and its stamp

    def process(
        self,
        frame: StereoFrame,
        camera: StereoCamera,
        stamp_ns: int,
        config: DetectorConfig,
        speculative: Finding | None = None,
    ) -> FrameResult:
        """Return the lanes of the frame of `stamp_ns`, in the light of those before.

        `speculative` is what another pipeline found in this frame, see `find`.
        """
        found = self.find(frame, camera, stamp_ns, config, speculative)
        detection, watch = found.detection, Stopwatch(found.seconds)
        with watch("tracking"):
            self._configure_trackers(config)
            lanes = self._tracker.update(detection.lanes, stamp_ns)
            tracked_edges = self._edge_tracker.update(detection.road_edges, stamp_ns)
            road_edges = with_roles([edge for edge in tracked_edges if not _lies_on_paint(edge, lanes)])
        road = detection.road_estimate
        problem = ""
        if road.source != "measured":
            problem = f"{detection.note}; the left image alone serves, with {SERVES[road.source]}"
        check = UNCHECKED
        if found.sight is not None:
            with watch("calibration_monitor"):
                measured = detection.road if road.source == "measured" else None
                sight = replace(found.sight, road=measured, lanes=lanes)
                check = self._monitor.update(sight, _nominal_road(camera, config))
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

    def find(
        self,
        frame: StereoFrame,
        camera: StereoCamera,
        stamp_ns: int,
        config: DetectorConfig,
        speculative: Finding | None = None,
    ) -> Finding:
        """Return what is found in a frame, in the light of those before, without identities.

        `speculative` is what a pipeline found that began with a later frame: it is returned where the same
        would be found here, without a look at the pictures.
        """
        prior = self._predict(_nominal_road(camera, config), stamp_ns, config)
        found = speculative
        if found is None or not found.holds(prior):
            found = self._found(frame, camera, prior, config)
        if found.sight is not None:
            self._before = stamp_ns, frame
        self._road.update(found.detection.road)
        self._remember(found.detection, stamp_ns)
        return found

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
        due = _is_passed(VOTE_PERIOD_NS, memory.course_ns, stamp_ns)
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

    def _found(
        self, frame: StereoFrame, camera: StereoCamera, prior: Prior, config: DetectorConfig
    ) -> Finding:
        detection = self._detector_for(camera, config).detect(frame, prior)
        watch, sight = Stopwatch(detection.seconds), None
        if self.monitored and frame.right is not None:
            with watch("calibration_monitor"):
                sight = self._compared(frame, detection, _nominal_road(camera, config))
        return Finding(camera, replace(prior, road=as_measured), detection, sight, watch.seconds)

    def _remember(self, detection: LaneDetection, stamp_ns: int) -> None:
        """Remember what the next prior needs."""
        if detection.road_estimate.source == "measured":
            memory, seen = self._memory, detection.direction if detection.lanes else None
            memory.surface, memory.course_ns = detection.road, stamp_ns
            memory.axis, memory.paint = None if seen is None else seen.axis, detection.score

    def _compared(self, frame: StereoFrame, detection: LaneDetection, nominal: RoadSurface) -> Observation:
        """Return what a comparison of left and right gives, where one is due."""
        stamp_ns, before = self._memory.stamp_ns, self._before
        if frame.right is None or (before and not _is_passed(CHECK_PERIOD_NS, before[0], stamp_ns)):
            return Observation(stamp_ns)
        rows = vertical_disparity(frame.left, frame.right, detection.disparity, nominal.camera)
        left, right = (StereoFrame(image).grey().left for image in (frame.left, frame.right))
        same, delay = detection.road is None and is_same_picture(left, right, nominal), None
        if before is not None and 0 < stamp_ns - before[0] <= BEFORE_NS and not same:
            earlier = StereoFrame(before[1].left).grey().left
            share = right_delay(left, earlier, right, nominal)
            delay = None if share is None else share * (stamp_ns - before[0]) / 1e9
        return Observation(stamp_ns, vertical_disparity=rows, same_picture=same, right_delay=delay)


def _is_passed(period_ns: int, before_ns: int, stamp_ns: int) -> bool:
    """Whether a whole multiple of a period lies between two stamps.

    So what is due is told by the stamps alone, wherever in a drive the pipeline began.
    """
    return before_ns // period_ns != stamp_ns // period_ns


def _lies_on_paint(edge: Lane, lanes: tuple[Lane, ...]) -> bool:
    """Whether most of a road edge runs along a lane: an edge from before, where paint is seen now."""
    for lane in lanes:
        apart = np.linalg.norm(edge.points[:, None, [0, 2]] - lane.points[:, [0, 2]], axis=2).min(axis=1)
        if np.median(apart) < SAME_PLACE:
            return True
    return False


def _nominal_road(camera: StereoCamera, config: DetectorConfig) -> RoadSurface:
    return VerticalCurve.plane(camera, config.road_profile.camera_height, config.road_profile.camera_pitch)
