# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""How the node is doing: one sentence, a level, and the numbers behind it. Plain Python, times are given."""

from __future__ import annotations

import math
import threading
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum

import numpy as np

from lane_dp_ros.core.monitoring.calibration_monitor import UNCHECKED, CalibrationStatus

WINDOW = 5.0  # s; rate, latency and seconds per stage are those of the last frames, not of the whole run
SILENT_AFTER = 2.0  # s without a message
MAX_FRAMES = 500  # kept at most, whatever the frame rate


class Level(Enum):
    """diagnostic_msgs/DiagnosticStatus.level, which is of type byte."""

    OK = b"\x00"
    WARN = b"\x01"
    ERROR = b"\x02"


@dataclass(frozen=True)
class FrameReport:
    """What became of one pair.

    `time` [s] is when it was answered; `latency` [s] from its arrival to the published lanes; `seconds` per
    stage; `road_profile` where the road is from; `depth_deviation` [m] the standard deviation of its depth at
    25 m; `problem` one line that says what is wrong, or empty; `note` what the detector has to say; `failed`
    when the pair gave no detection at all; `check` is that of the calibration.
    """

    time: float
    latency: float
    lanes: int = 0
    seconds: Mapping[str, float] = field(default_factory=dict)
    camera_height: float | None = None
    pitch: float | None = None
    depth_deviation: float | None = None
    road_profile: str = ""
    problem: str = ""
    note: str = ""
    failed: bool = False
    check: CalibrationStatus = UNCHECKED
    road_edges: int = 0


@dataclass(frozen=True)
class Counts:
    """What was counted since the start."""

    matched: int
    dropped: int
    unpaired_left: int
    unpaired_right: int
    alone: int = 0

    @property
    def unpaired(self) -> int:
        """Return how many images found no partner."""
        return self.unpaired_left + self.unpaired_right


@dataclass(frozen=True)
class Topics:
    """What is listened to: images must keep coming, camera infos need to come once."""

    images: tuple[str, ...]
    infos: tuple[str, ...]


class Health:
    """Collects what happens (from any thread) and sums it up."""

    def __init__(self) -> None:
        self._heard: dict[str, float] = {}
        self._frames: deque[FrameReport] = deque(maxlen=MAX_FRAMES)
        self._news: deque[FrameReport] = deque(maxlen=MAX_FRAMES)  # since the last summary
        self._failed = 0
        self._last_problem = ""
        self._last_counts = Counts(0, 0, 0, 0)
        self._lock = threading.Lock()

    def heard(self, topic: str, now: float) -> None:
        """Note that a message came."""
        self._heard[topic] = now

    def answered(self, report: FrameReport) -> None:
        """Note what became of a pair."""
        with self._lock:
            self._frames.append(report)
            self._news.append(report)
            self._failed += report.failed
            self._last_problem = report.problem or self._last_problem

    def summary(self, now: float, counts: Counts, topics: Topics) -> tuple[Level, str, dict[str, str]]:
        """Return level, message and key values of a report; its level judges the time since the last one."""
        with self._lock:
            frames = [frame for frame in self._frames if now - frame.time <= WINDOW]
            news = list(self._news)
            self._news.clear()
        missing = self._missing(now, topics)
        level, message = self._verdict(frames, news, counts, missing)
        self._last_counts = counts
        return level, message, self._values(frames, counts) | {"silent topics": ", ".join(missing)}

    def _verdict(
        self, frames: list[FrameReport], news: list[FrameReport], counts: Counts, missing: list[str]
    ) -> tuple[Level, str]:
        """Return the worst that holds of the `news` since the last summary."""
        failures = [frame.problem for frame in news if frame.failed]
        if failures:
            return Level.ERROR, f"A frame failed: {failures[-1]}"
        troubles = self._troubles(news, counts, missing)
        if troubles:
            return Level.WARN, troubles[0]
        return Level.OK, f"{_rate(frames):.1f} frames/s, {_last(frames).lanes} lanes in the last frame"

    def _troubles(self, news: list[FrameReport], counts: Counts, missing: list[str]) -> list[str]:
        before = self._last_counts
        problems = [frame.problem for frame in news if frame.problem]
        lonely = counts.unpaired > before.unpaired
        doubt = news[-1].check.complaint if news else ""
        problem = ". ".join(filter(None, [*problems[-1:], doubt if problems else ""]))
        silence = f"Nothing comes on {' and '.join(missing)}"
        said = {
            f"{silence}: {problem}" if problem else silence: bool(missing),
            f"Degraded stereo: {problem}": bool(problem),
            doubt: bool(doubt),
            "Images come, but no pairs: do the stamps of left and right agree?": lonely
            and counts.matched == before.matched,
            "Images come faster than they can be worked on: pairs are dropped": counts.dropped
            > before.dropped,
            "Images without a partner are dropped": lonely,
        }
        return [sentence for sentence, holds in said.items() if holds]

    def _missing(self, now: float, topics: Topics) -> list[str]:
        silent = [name for name in topics.images if now - self._heard.get(name, -math.inf) > SILENT_AFTER]
        return silent + [name for name in topics.infos if name not in self._heard]

    def _values(self, frames: list[FrameReport], counts: Counts) -> dict[str, str]:
        latencies = [1000 * frame.latency for frame in frames] or [float("nan")]
        last = _last(frames)
        return {
            "rate [1/s]": f"{_rate(frames):.2f}",
            "latency mean [ms]": f"{np.mean(latencies):.1f}",
            "latency p95 [ms]": f"{np.percentile(latencies, 95):.1f}",
            **{f"stage {stage} [ms]": f"{1000 * mean:.2f}" for stage, mean in _stage_means(frames).items()},
            "pairs matched": str(counts.matched),
            "pairs dropped": str(counts.dropped),
            "unpaired left images": str(counts.unpaired_left),
            "unpaired right images": str(counts.unpaired_right),
            "left images alone": str(counts.alone),
            "frames failed": str(self._failed),
            "lanes": str(last.lanes),
            "road edges": str(last.road_edges),
            "note": last.note,
            "road profile": last.road_profile,
            "camera height [m]": _number(last.camera_height, 2),
            "camera pitch [rad]": _number(last.pitch, 4),
            "depth deviation at 25 m [m]": _number(last.depth_deviation, 2),
            **_calibration_values(last.check),
            "last problem": self._last_problem,
        }


def _calibration_values(check: CalibrationStatus) -> dict[str, str]:
    change = None if check.width_change is None else 1000 * check.width_change
    return {
        "lane width [m]": _number(check.lane_width, 2),
        "lane width change [%/10 m]": _number(change, 1),
        "disparity error [px]": _number(check.disparity_error, 1),
        "row shift [px]": _number(check.row_shift, 2),
        "row turn [px]": _number(check.row_turn, 2),
        "right picture older by [ms]": _number(
            None if check.right_delay is None else 1e3 * check.right_delay, 0
        ),
    }


def _last(frames: list[FrameReport]) -> FrameReport:
    return frames[-1] if frames else FrameReport(0.0, 0.0)


def _rate(frames: list[FrameReport]) -> float:
    span = frames[-1].time - frames[0].time if frames else 0.0
    return (len(frames) - 1) / span if span > 0 else 0.0


def _stage_means(frames: list[FrameReport]) -> dict[str, float]:
    stages = dict.fromkeys(stage for frame in frames for stage in frame.seconds)
    return {s: float(np.mean([f.seconds[s] for f in frames if s in f.seconds])) for s in stages}


def _number(value: float | None, digits: int) -> str:
    return "unknown" if value is None else f"{value:.{digits}f}"
