# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The detector's time beside that of a full-resolution stereo matcher, pair by pair on the same core.

Milliseconds differ by a factor of two between machines and hours; ratios of what ran in turn hold.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.detector import LaneDetector
from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.road.disparity import DisparityConfig, stereo_matcher
from lane_dp_ros.core.types import StereoFrame
from lane_dp_ros.tools.progress import progress

DISPARITIES = 128
WINDOW, SPECKLES = 7, 100  # px, of the matcher at full resolution
BLOCK = 15  # px, of StereoBM
WARM_UP = 3  # pairs
DETECTOR, STEREO, SGBM, BM = "detector", "stereo stage", "SGBM 3WAY", "StereoBM"

Floats = NDArray[np.float64]
CameraPair = tuple[StereoCamera, StereoFrame]


@dataclass(frozen=True, eq=False)
class Timings:
    """Seconds of the core's time (rounds, pairs), of the detector and of each matcher."""

    seconds: Mapping[str, Floats]

    def ratio(self, matcher: str, part: str = DETECTOR) -> float:
        """Return the median of detector, or a part of it, / matcher over all pairs and rounds."""
        return float(np.median(self.seconds[part] / self.seconds[matcher]))

    @property
    def slowest(self) -> float:
        """The slowest pair over the median one; a pair's time is the median of its rounds."""
        of_pairs = np.median(self.seconds[DETECTOR], axis=0)
        return float(of_pairs.max() / np.median(of_pairs))

    def lines(self) -> list[str]:
        """Return what was measured as a table in Markdown."""
        rows = [
            (f"median time of {name} [ms]", f"{1e3 * float(np.median(seconds)):.1f}")
            for name, seconds in self.seconds.items()
        ]
        rows += [(f"**detector / {name}**", f"**{self.ratio(name):.2f}**") for name in (SGBM, BM)]
        rows += [(f"**{STEREO} / {SGBM}**", f"**{self.ratio(SGBM, STEREO):.3f}**")]
        rows += [("**slowest pair / median pair**", f"**{self.slowest:.2f}**")]
        return ["| | |", "|---|---|", *(f"| {what} | {number} |" for what, number in rows)]


def measure(pairs: Sequence[CameraPair], rounds: int) -> Timings:
    """Return the times of detecting and of matching each pair, one right after the other.

    The pairs are grey; OpenCV must have been set to one thread. What other processes take of the core does
    not count.
    """
    config = DetectorConfig()
    detectors = [LaneDetector(camera, config) for camera, _ in pairs]
    matchers: dict[str, cv2.StereoMatcher] = {
        SGBM: sgbm(config.disparity),
        BM: cv2.StereoBM.create(DISPARITIES, BLOCK),
    }
    seconds = {name: np.zeros((rounds, len(pairs))) for name in (DETECTOR, STEREO, *matchers)}
    for detector, (_, frame) in list(zip(detectors, pairs, strict=True))[:WARM_UP]:
        detector.detect(frame)
    order = [(i, j) for i in range(rounds) for j in range(len(pairs))]
    for i, j in progress(order, len(order), "pair"):
        frame, detector = pairs[j][1], detectors[j]
        assert frame.right is not None
        seconds[DETECTOR][i, j] = _seconds(detector.detect, frame)
        seconds[STEREO][i, j] = _seconds(_stereo_stage, detector, frame)
        for name, matcher in matchers.items():
            seconds[name][i, j] = _seconds(matcher.compute, frame.left, frame.right)
    return Timings(seconds)


def sgbm(config: DisparityConfig) -> cv2.StereoSGBM:
    """Return the matcher of a configuration, but as one takes it at full resolution."""
    full = replace(config, correlation_window_size=WINDOW, speckle_size=SPECKLES)
    return stereo_matcher(full, DISPARITIES)


def _stereo_stage(detector: LaneDetector, frame: StereoFrame) -> None:
    """Match, and measure the road's surface: what a detector does before it looks for lanes."""
    detector.measure_road(frame, detector.match(frame))


def _seconds(work: Callable[..., object], *arguments: object) -> float:
    start = time.process_time()
    work(*arguments)
    return time.process_time() - start
