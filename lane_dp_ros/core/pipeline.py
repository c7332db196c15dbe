# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Two image messages and two CameraInfo in, lanes with an identity out: convert, detect, follow over time."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from lane_dp_ros.core.axis_memory import AxisMemory
from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.detector import LaneDetection, LaneDetector
from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.geometry.road_surface import RoadSurface
from lane_dp_ros.core.lane import Lane
from lane_dp_ros.core.lanes.mono_fallback import trusted
from lane_dp_ros.core.monitoring.calibration_monitor import (
    UNCHECKED,
    CalibrationMonitor,
    CalibrationStatus,
    Observation,
)
from lane_dp_ros.core.monitoring.vertical_disparity import vertical_disparity
from lane_dp_ros.core.tracking.road_filter import RoadFilter
from lane_dp_ros.core.tracking.tracker import LaneTracker
from lane_dp_ros.messages.camera import camera_from_ros
from lane_dp_ros.messages.image import Image8, left_image_from_ros, stereo_images_from_ros
from lane_dp_ros.messages.stereo_sync import StereoPair

ROWS_PERIOD_NS = 500_000_000  # between comparisons of the rows of left and right: a calibration does not jump
SERVES = {"last": "the last road profile", "nominal": "the camera's nominal height and pitch"}


@dataclass(frozen=True)
class FrameResult:
    """What a pair of readable images gave.

    `left` is the left image, uint8 gray or BGR; `problem` is one line that says what is wrong, or empty;
    `camera` and `detection` are None where the calibration or the pair could not be used. `lanes` are
    the detection's, with their identity once they are tracked. `road_profile` says where the road's surface
    is from: measured, last or nominal. `right` is there while it is of use; `check` is the calibration's.
    """

    left: Image8
    problem: str = ""
    camera: StereoCamera | None = None
    detection: LaneDetection | None = None
    lanes: tuple[Lane, ...] = ()
    road_profile: str = ""
    right: Image8 | None = None
    check: CalibrationStatus = UNCHECKED


class LanePipeline:
    """Answers pair after pair, remembers the road, and gives the lanes their identity."""

    def __init__(self) -> None:
        self._road = RoadFilter()
        self._axis = AxisMemory()
        self._tracker = LaneTracker()
        self._check = CalibrationMonitor()
        self._rows_ns = 0  # when the rows were compared last
        # The lines that the last measured road bore, where they are by now.
        self._known: tuple[Lane, ...] = ()

    def answer(self, pair: StereoPair, infos: tuple[Any, Any], config: DetectorConfig) -> FrameResult:
        """Return what is found in a pair, see `detect_pair`; the pairs must come in order."""
        found = detect_pair(pair, infos, config)
        answer = self.follow(found, pair.stamp_ns, config)
        return replace(answer, check=self._checked(found, answer, pair.stamp_ns, config))

    def follow(self, answer: FrameResult, stamp_ns: int, config: DetectorConfig) -> FrameResult:
        """Return the answer of a pair, detected wherever, in the light of those before.

        Where the pair shows no road, or one that contradicts them, the lanes are those of the left image
        alone, on the last road or the nominal one; of these, doubtful ones only where they were known before.
        """
        if answer.camera is None or answer.detection is None:
            return answer  # nobody can tell where in this picture a line from before would be
        answer = self._on_road(answer, answer.camera, answer.detection, stamp_ns, config)
        measured = answer.road_profile == "measured"
        if measured:
            answer = self._along_known_axis(answer, stamp_ns, config)
        self._tracker.config = config.tracking
        self._tracker.half_width = config.birds_eye.width / 2
        seen = answer.lanes if measured else trusted(answer.lanes, self._known)
        lanes = self._tracker.update(seen, stamp_ns)
        ids = {lane.id for lane in self._known}
        self._known = tuple(lane for lane in lanes if measured or lane.id in ids)
        return replace(answer, lanes=lanes)

    def _checked(
        self, found: FrameResult, answer: FrameResult, stamp_ns: int, config: DetectorConfig
    ) -> CalibrationStatus:
        """Return what the pairs so far say of the calibration; `found` is of this pair, before `follow`."""
        if found.camera is None or found.detection is None or found.right is None:
            return UNCHECKED
        rows = None
        if not 0 <= stamp_ns - self._rows_ns < ROWS_PERIOD_NS:
            self._rows_ns = stamp_ns
            rows = vertical_disparity(found.left, found.right, found.detection.disparity, found.camera)
        road = found.detection.road if answer.road_profile == "measured" else None
        sight = Observation(stamp_ns, road, answer.lanes, rows)
        return self._check.update(sight, _nominal_road(found.camera, config))

    def _along_known_axis(self, answer: FrameResult, stamp_ns: int, config: DetectorConfig) -> FrameResult:
        """Return the answer with the lanes along the axis of the pair before, where that has more paint."""
        camera, detection = answer.camera, answer.detection
        if not config.tracking.enabled or camera is None or detection is None or not detection.birds_eye:
            return answer
        other = self._axis.other_axis(detection.birds_eye.axis, stamp_ns)
        if other is not None:
            detection = LaneDetector(camera, config).detect_along(other, answer.left, answer.right, detection)
        if detection.lanes and detection.birds_eye:
            self._axis.update(detection.birds_eye.axis, stamp_ns)
        return replace(answer, detection=detection, lanes=detection.lanes)

    def _on_road(
        self,
        answer: FrameResult,
        camera: StereoCamera,
        detection: LaneDetection,
        stamp_ns: int,
        config: DetectorConfig,
    ) -> FrameResult:
        road = self._road.update(detection.road, _nominal_road(camera, config), stamp_ns)
        if road.source == "measured":
            return replace(answer, road_profile=road.source)
        reason = f"the road contradicts the one before: {road.reason}" if road.reason else detection.note
        problem = f"{reason}; the left image alone serves, with {SERVES[road.source]}"
        again = _detected(answer.left, None, camera, config, road.surface)
        return replace(again, problem=again.problem or problem, road_profile=road.source)


def _nominal_road(camera: StereoCamera, config: DetectorConfig) -> RoadSurface:
    return RoadSurface.plane(camera, config.road_profile.camera_height, config.road_profile.camera_pitch)


def detect_pair(pair: StereoPair, infos: tuple[Any, Any], config: DetectorConfig) -> FrameResult:
    """Return what is found in a pair of sensor_msgs/Image or CompressedImage, with its CameraInfo.

    It depends on no pair before; the lanes have no identity yet. A left image alone shows no road, hence no
    lanes. Raises ValueError when an image cannot be read. All else that goes wrong is the answer's `problem`.
    """
    if pair.right is None:
        left, right = left_image_from_ros(pair.left), None
    else:
        left, right = stereo_images_from_ros(pair.left, pair.right)
    try:
        camera = _camera_for(infos, left, right)
    except Exception as error:  # noqa: BLE001 - one bad frame, whatever is wrong with it, must not end the node
        return FrameResult(left, problem=one_line(error))
    if right is None:
        return FrameResult(left, camera=camera, detection=LaneDetection(note="no right image"))
    return _detected(left, right, camera, config)


def _detected(
    left: Image8,
    right: Image8 | None,
    camera: StereoCamera,
    config: DetectorConfig,
    road: RoadSurface | None = None,
) -> FrameResult:
    try:
        detection = LaneDetector(camera, config).detect(left, right, road)
    except Exception as error:  # noqa: BLE001 - as above
        return FrameResult(left, problem=one_line(error))
    # Lanes may well be missing from a road; a road may not be missing from the picture.
    problem = detection.note if detection.road is None else ""
    return FrameResult(left, problem, camera, detection, detection.lanes, right=right)


def _camera_for(infos: tuple[Any, Any], left: Image8, right: Image8 | None) -> StereoCamera:
    """Return the camera; raise ValueError where the images' sizes contradict each other or the CameraInfo."""
    left_size = _size(left)
    if right is not None and _size(right) != left_size:
        raise ValueError(f"images are {left_size} left and {_size(right)} right, expected equal sizes")
    camera = camera_from_ros(*infos)
    info_size = f"{infos[0].width}x{infos[0].height}"
    if left_size != info_size:
        raise ValueError(f"images are {left_size}, their CameraInfo says {info_size}, expected equal sizes")
    return camera


def _size(image: Image8) -> str:
    return f"{image.shape[1]}x{image.shape[0]}"


def one_line(error: BaseException) -> str:
    """Return an error's message in one line; with its type, unless it is one of the expected ValueErrors."""
    text = " ".join(str(error).split())
    return text if type(error) is ValueError else f"{type(error).__name__}: {text}"
