# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What the curves of the report show, as numbers: precision and recall, error over distance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.tools.evaluation.annotations import JUDGED_DEPTHS
from lane_dp_ros.tools.evaluation.reliability import confidences, share
from lane_dp_ros.tools.evaluation.scores import FrameScore

Floats = NDArray[np.float64]
Counts = NDArray[np.int64]

THRESHOLDS = np.arange(0, 51) / 50
DISTANCE_STEP = 2.0  # m


@dataclass(frozen=True, eq=False)
class ThresholdCurve:
    """Precision and recall, were only lines of at least each of the `thresholds` published; nan without."""

    thresholds: Floats
    precision: Floats
    recall: Floats


@dataclass(frozen=True, eq=False)
class DistanceErrors:
    """By bin of depth, from `edges[i]` to before `edges[i + 1]` [m]: lateral errors [m] and their number."""

    edges: Floats
    mean: Floats
    percentile_90: Floats
    counts: Counts


def threshold_curve(results: Sequence[FrameScore]) -> ThresholdCurve:
    """Return detection precision and lane recall over a threshold of the confidence.

    The matching stays that of all lines; at threshold 0 both are the summary's.
    """
    confidence, right = confidences(results)
    matched = [r.detections[m.detection].lane.confidence for r in results for m in r.found]
    labels = sum(len(result.labels) for result in results)
    kept = confidence[None] >= THRESHOLDS[:, None]
    found = np.asarray(matched, dtype=np.float64)[None] >= THRESHOLDS[:, None]
    precision = share((kept & right).sum(axis=1), kept.sum(axis=1))
    return ThresholdCurve(THRESHOLDS, precision, share(found.sum(axis=1), np.full(len(THRESHOLDS), labels)))


def error_over_distance(results: Sequence[FrameScore]) -> DistanceErrors:
    """Return the lateral error of the matches, in bins of 2 m of depth over the depths that are judged."""
    near, far = JUDGED_DEPTHS
    edges = np.append(np.arange(near, far, DISTANCE_STEP), far)
    matches = [match for result in results for match in result.found]
    depths = np.concatenate([match.depths for match in matches] or [np.empty(0)])
    errors = np.concatenate([match.errors for match in matches] or [np.empty(0)])
    index = np.clip(np.digitize(depths, edges) - 1, 0, len(edges) - 2)
    bins = [errors[index == i] for i in range(len(edges) - 1)]
    nan = float("nan")
    return DistanceErrors(
        edges,
        np.array([np.mean(each) if each.size else nan for each in bins]),
        np.array([np.percentile(each, 90) if each.size else nan for each in bins]),
        np.array([each.size for each in bins]),
    )
