# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Add judged frames up: by sequence, by category, and what is seen only from frame to frame."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.tools.evaluation.scores import FrameScore, Match, Summary
from lane_dp_ros.tools.evaluation.tusimple_culane import CULane, TuSimple

MEMORY_NS = (
    1_000_000_000  # after a longer gap the node has forgotten its lines: nothing is compared across it
)
JITTER_FRAMES = 5

Floats = NDArray[np.floating[Any]]


def summarise(results: Iterable[FrameScore]) -> Summary:
    """Add frames up: counts and sums of each, and what is seen from frame to frame along each sequence."""
    results = tuple(results)
    sequences = [[r for r in results if r.sequence == name] for name in sorted({r.sequence for r in results})]
    return sum((*map(_of_frame, results), *map(_of_sequence, sequences)), Summary())


def by_sequence(results: Sequence[FrameScore]) -> dict[str, Summary]:
    """Return the summary of each sequence in order of name, and "total" as the last."""
    return _grouped(results, lambda result: result.sequence)


def by_category(results: Sequence[FrameScore]) -> dict[str, Summary]:
    """Return the summary of each category in order of name, and "total"; frames without one are in none."""
    return _grouped(results, lambda result: result.category)


def _grouped(results: Sequence[FrameScore], key: Callable[[FrameScore], str]) -> dict[str, Summary]:
    names = sorted({name for result in results if (name := key(result))})
    groups = {name: summarise(r for r in results if key(r) == name) for name in names}
    return {**groups, "total": summarise(results)}


def _of_frame(result: FrameScore) -> Summary:
    found = result.found
    near = [match.near for match in found if match.near is not None]
    far = [match.far for match in found if match.far is not None]
    return Summary(
        frames=1,
        ego_labels=len(result.ego_labels),
        incorrect=len(result.incorrect),
        missed=len(result.missed),
        labels=len(result.labels),
        matched=len(found),
        detections=len(result.detections),
        false_lanes=result.false_lanes,
        duplicates=result.duplicates,
        error_sum=sum(match.error for match in found),
        near_sum=sum(near),
        near_matches=len(near),
        far_sum=sum(far),
        far_matches=len(far),
        latencies=() if result.latency is None else (result.latency,),
        tusimple=result.tusimple or TuSimple(),
        culane=result.culane or CULane(),
    )


def _of_sequence(results: Iterable[FrameScore]) -> Summary:
    """Return what a sequence shows from frame to frame: id switches and jitter. Frames need stamps for it."""
    frames = sorted((r for r in results if r.stamp_ns is not None), key=lambda r: r.stamp_ns or 0)
    windows = [frames[i : i + JITTER_FRAMES] for i in range(len(frames) - JITTER_FRAMES + 1)]
    switches = _id_switches(frames)
    jitter = [pair for window in windows for pair in _jitters(window)]
    return Summary(
        id_switches=sum(switches),
        id_chances=len(switches),
        jitter_sum=sum(detected for detected, _ in jitter),
        label_jitter_sum=sum(true for _, true in jitter),
        jitter_windows=len(jitter),
    )


def _id_switches(frames: Iterable[FrameScore]) -> list[bool]:
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


def _jitters(window: Sequence[FrameScore]) -> list[tuple[float, float]]:
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
