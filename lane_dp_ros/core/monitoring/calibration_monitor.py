# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Whether the calibration can be right, told from what is seen of the road: no labels are needed."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from lane_dp_ros.core.geometry.road_surface import RoadSurface
from lane_dp_ros.core.monitoring.vertical_disparity import VerticalDisparity
from lane_dp_ros.core.types import Lane

NS_PER_S = 1_000_000_000
WINDOW_NS = 8 * NS_PER_S  # a merge or a ramp is over by then
MIN_SPAN_NS = 3 * NS_PER_S  # less says nothing
JUMP_NS = NS_PER_S  # a longer jump of time, or one backwards, and everything is forgotten
MIN_VALUES = 5

HILL = 1e-3  # 1/m; on stronger vertical curvature height and widths are less sure
LANE_WIDTH = (2.4, 5.0)  # m; other pairs of lines are no lane
MIN_LENGTH = 8.0  # m, side by side

# What sound calibrations stay within, KITTI's among them.
HEIGHT_TOLERANCE = 0.1  # of the nominal camera height
PITCH_TOLERANCE = 0.05  # rad about the nominal pitch
WIDTH_CHANGE_MAX = 6e-3  # 1/m; lanes that become wider by 6 % in 10 m
ROW_SHIFT_MAX, ROW_TURN_MAX = 0.35, 0.7  # px
ROADS_MIN = 0.5  # of the pairs
DELAY_MAX = 0.015  # s; of sound pairs 0.005 are measured, at 60 Hz a frame is 0.017
SAME_MIN = 0.5  # of the pairs whose pictures were compared


class Gap(NamedTuple):
    """Two neighbouring lines: their distance [m], and its change [1/m] ahead, as a share of it."""

    width: float
    change: float


@dataclass(frozen=True, eq=False)
class Observation:
    """What one pair showed: its measured road (None for none), its lanes, its row offset where known.

    `same_picture` is whether left and right are one picture, None where they were not compared; `right_delay`
    [s] how much older the right one is, where known.
    """

    stamp_ns: int
    road: RoadSurface | None = None
    lanes: tuple[Lane, ...] = ()
    vertical_disparity: VerticalDisparity | None = None
    same_picture: bool | None = None
    right_delay: float | None = None


@dataclass(frozen=True)
class CalibrationStatus:
    """Medians over the last seconds, None where too little was seen, and what must be wrong, or empty.

    `lane_width` [m]; `width_change` [1/m] is the relative change of the lanes' width per metre ahead: zero
    for parallel lines; `disparity_error` [px] is what explains it; `row_shift` and `row_turn` [px] are those
    of the `VerticalDisparity`; `right_delay` [s] is by how much the right pictures are older than the left
    ones, negative where they are newer.
    """

    lane_width: float | None = None
    width_change: float | None = None
    disparity_error: float | None = None
    row_shift: float | None = None
    row_turn: float | None = None
    complaint: str = ""
    right_delay: float | None = None


UNCHECKED = CalibrationStatus()


class CalibrationMonitor:
    """Collects what the pairs show and judges the calibration by it, over some seconds."""

    def __init__(self) -> None:
        self._sights: deque[tuple[Observation, tuple[Gap, ...]]] = deque()
        self._camera: object = None

    def update(self, sight: Observation, nominal: RoadSurface) -> CalibrationStatus:
        """Take in what a pair showed and return the verdict; the pairs must come in order.

        `nominal` is the road by the nominal height and pitch of the camera.
        """
        last_ns = self._sights[-1][0].stamp_ns if self._sights else sight.stamp_ns
        if nominal.camera != self._camera or not 0 <= sight.stamp_ns - last_ns <= JUMP_NS:
            self._sights.clear()
        self._camera = nominal.camera
        gaps = () if sight.road is None or is_hilly(sight.road) else lane_gaps(sight.lanes)
        self._sights.append((sight, gaps))
        while sight.stamp_ns - self._sights[0][0].stamp_ns > WINDOW_NS:
            self._sights.popleft()
        return self._verdict(nominal)

    def _verdict(self, nominal: RoadSurface) -> CalibrationStatus:
        sights = [sight for sight, _ in self._sights]
        gaps = [gap for _, found in self._sights for gap in found]
        change = _median(gap.change for gap in gaps)
        scale = nominal.camera.fx * nominal.camera.baseline
        verdict = CalibrationStatus(
            lane_width=_median(gap.width for gap in gaps),
            width_change=change,
            disparity_error=None if change is None else -change * scale,
            row_shift=_median(s.vertical_disparity.shift for s in sights if s.vertical_disparity is not None),
            row_turn=_median(s.vertical_disparity.turn for s in sights if s.vertical_disparity is not None),
            right_delay=_median(s.right_delay for s in sights if s.right_delay is not None),
        )
        if sights[-1].stamp_ns - sights[0].stamp_ns < MIN_SPAN_NS:
            return verdict
        return replace(verdict, complaint=_complaint(verdict, sights, nominal))


def _complaint(verdict: CalibrationStatus, sights: Sequence[Observation], nominal: RoadSurface) -> str:
    """Return one sentence on what must be wrong, empty where all may be right; the worst first."""
    if complaint := _of_pictures(sights):
        return complaint
    seen = [sight.road for sight in sights if sight.road is not None]
    if len(seen) < ROADS_MIN * len(sights):
        return "Are left and right swapped, a camera covered, or the cameras rotated against each other?"
    height = _median(road.camera_height for road in seen if not is_hilly(road))
    complaints = [
        _of_rows(verdict.row_shift, verdict.row_turn),
        _of_height(height, nominal.camera_height),
        _of_widths(verdict.width_change, verdict.disparity_error),
        _of_pitch(_median(road.pitch for road in seen), nominal.pitch),
    ]
    return next(filter(None, complaints), "")


def _of_pictures(sights: Sequence[Observation]) -> str:
    """Return what is wrong with the pictures themselves: nothing else that they say is to be trusted then."""
    compared = [sight.same_picture for sight in sights if sight.same_picture is not None]
    if compared and sum(compared) > SAME_MIN * len(compared):
        return "Left and right show the same picture: does one camera's topic serve as both?"
    return _of_delays([sight.right_delay for sight in sights if sight.right_delay is not None])


def _of_delays(delays: Sequence[float]) -> str:
    """Return a sentence where three of four delays [s] agree on one that is no measuring error."""
    if len(delays) < MIN_VALUES:
        return ""
    low, middle, high = np.percentile(1e3 * np.array(delays), (25, 50, 75))
    if low <= 1e3 * DELAY_MAX and high >= -1e3 * DELAY_MAX:
        return ""
    return (
        f"The right picture seems to be of another time, {abs(middle):.0f} ms "
        f"{'older' if middle > 0 else 'newer'} than the left one (half of {len(delays)} comparisons are "
        f"within {max(1.0, (high - low) / 2):.0f} ms): "
        "are the cameras triggered together, with the stamps of that?"
    )


def _of_rows(shift: float | None, turn: float | None) -> str:
    if shift is None or turn is None or (abs(shift) <= ROW_SHIFT_MAX and abs(turn) <= ROW_TURN_MAX):
        return ""
    return (
        f"The rows of left and right miss each other by {abs(shift) + abs(turn):.1f} px or more: "
        "are the cameras rotated against each other?"
    )


def _of_height(height: float | None, expected: float) -> str:
    if height is None or abs(height / expected - 1) <= HEIGHT_TOLERANCE:
        return ""
    return (
        f"The road lies {height:.2f} m below the camera, expected {expected:.2f} m: "
        "is the baseline, the focal length or road_profile.camera_height wrong?"
    )


def _of_widths(change: float | None, disparity_error: float | None) -> str:
    if change is None or abs(change) <= WIDTH_CHANGE_MAX:
        return ""
    return (
        f"Lanes become {'wider' if change > 0 else 'narrower'} by {10 * abs(change):.0%} in 10 m, "
        f"as with a disparity {disparity_error:+.1f} px wrong: "
        "is a principal point wrong, or a camera turned sideways?"
    )


def _of_pitch(pitch: float | None, expected: float) -> str:
    if pitch is None or abs(pitch - expected) <= PITCH_TOLERANCE:
        return ""
    return (
        f"The camera looks down on the road by {pitch:.3f} rad, expected {expected:.3f} rad: "
        "is cy or road_profile.camera_pitch wrong?"
    )


def lane_gaps(lanes: Iterable[Lane]) -> tuple[Gap, ...]:
    """Return the gaps between neighbouring lanes that are side by side and as far apart as a lane is wide."""
    ordered = sorted(lanes, key=lambda lane: lane.lateral_offset)
    gaps = [_gap(left, right) for left, right in pairwise(ordered)]
    return tuple(gap for gap in gaps if gap is not None and LANE_WIDTH[0] <= gap.width <= LANE_WIDTH[1])


def _gap(left: Lane, right: Lane) -> Gap | None:
    """Return the gap, measured square to the left line, None where the lines are not side by side."""
    a, b = left.points[:, [0, 2]], right.points[:, [0, 2]]
    to_b = b[None] - a[:, None]
    nearest = np.hypot(to_b[..., 0], to_b[..., 1]).argmin(axis=1)
    beside = (nearest > 0) & (nearest < len(b) - 1)
    s = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(a, axis=0), axis=1))])
    if not beside.any() or np.ptp(s[beside]) < MIN_LENGTH:
        return None
    along = np.gradient(a, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    across = to_b[np.arange(len(a)), nearest]
    width = np.abs(across[:, 0] * along[:, 1] - across[:, 1] * along[:, 0])[beside]
    slope, mean = np.polyfit(s[beside] - s[beside].mean(), width, 1)
    return Gap(float(mean), float(slope / max(mean, 1e-6)))


def is_hilly(road: RoadSurface) -> bool:
    """Return whether a road climbs or falls away too much to tell height and widths by."""
    return bool(abs(road.vertical_curvature) > HILL)


def _median(values: Iterable[float]) -> float | None:
    """Return the median, None of too few values."""
    array = np.array(list(values))
    return float(np.median(array)) if len(array) >= MIN_VALUES else None
