# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What is seen only from frame to frame: lines that change their id, and jitter."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.tools.evaluation.scores import FrameScore, Match

MEMORY_NS = (
    1_000_000_000  # after a longer gap the node has forgotten its lines: nothing is compared across it
)
JITTER_FRAMES = 5

Floats = NDArray[np.floating[Any]]


def id_switches(frames: Iterable[FrameScore]) -> list[bool]:
    """Return, for each time that a label is found again within 1 s, whether it is under another id."""
    last: dict[str, tuple[int, int]] = {}
    switches = []
    for frame in frames:
        for match in frame.found:
            identity, stamp_ns = frame.detections[match.detection].lane.id, frame.stamp_ns or 0
            if match.label in last and stamp_ns - last[match.label][1] <= MEMORY_NS:
                switches.append(last[match.label][0] != identity)
            last[match.label] = identity, stamp_ns
    return switches


def jitters(window: Sequence[FrameScore]) -> list[tuple[float, float]]:
    """Return, for each label found at 10 m in all frames of the window, the jitter of detection and label."""
    stamps = np.array([frame.stamp_ns for frame in window], dtype=np.int64)
    if stamps[-1] - stamps[0] > MEMORY_NS:
        return []
    matches = [{m.label: m for m in frame.found if m.position is not None} for frame in window]
    common = sorted(set(matches[0]).intersection(*matches[1:]))
    seconds = (stamps - stamps[0]) / 1e9
    return [_jitter([by_label[label] for by_label in matches], seconds) for label in common]


def _jitter(matches: Sequence[Match], seconds: Floats) -> tuple[float, float]:
    """Return the standard deviations [m] of detection and label at 10 m about their straight lines."""
    positions = np.array([[m.position, m.label_position] for m in matches], dtype=np.float64)
    detected, true = deviations(positions, seconds)
    return float(detected), float(true)


def deviations(positions: Floats, seconds: Floats) -> Floats:
    """Return the standard deviations (M,) [m] of positions (N, M) [m] about straight lines over N seconds."""
    line = np.column_stack([np.ones_like(seconds), seconds])
    residuals = positions - line @ np.linalg.lstsq(line, positions, rcond=None)[0]
    return residuals.std(axis=0)
