# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Is the confidence right? Of the lines published with confidence p, about p should be right."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lane_dp_ros.tools.evaluation.scores import FrameScore, LineScores, RoadEdgeScore

Floats = NDArray[np.float64]
Counts = NDArray[np.int64]

CONFIDENCE_BINS = np.arange(0, 11) / 10
Z_95 = 1.96  # standard deviations of a normal distribution on either side of 95 %


@dataclass(frozen=True, eq=False)
class Reliability:
    """By bin of confidence: its mean, the share of lines that are right, how many there are.

    `low` and `high` hold the share with 95 % confidence (Wilson's interval).
    """

    confidence: Floats
    share: Floats
    low: Floats
    high: Floats
    counts: Counts

    @property
    def error(self) -> float:
        """The expected calibration error: how far confidence and share lie apart, averaged over the lines.

        nan without lines.
        """
        used = self.counts > 0
        if not used.any():
            return float("nan")
        apart = np.abs(self.confidence[used] - self.share[used])
        return float(np.average(apart, weights=self.counts[used]))

    @property
    def right(self) -> Counts:
        """How many lines of each bin are right."""
        return np.rint(np.where(self.counts > 0, self.share, 0) * self.counts).astype(np.int64)


def road_edge_scores(results: Iterable[FrameScore]) -> list[RoadEdgeScore]:
    """Return how the road edges of each frame were judged, where they were."""
    return [result.road_edges for result in results if result.road_edges is not None]


def confidences(results: Iterable[LineScores]) -> tuple[Floats, NDArray[np.bool_]]:
    """Return the confidence of each published line (N,), and whether it is right (no false, no duplicate)."""
    pairs = [pair for result in results for pair in result.confidences]
    return np.array([c for c, _ in pairs], dtype=np.float64), np.array([r for _, r in pairs], dtype=bool)


def reliability(confidence: ArrayLike, right: ArrayLike) -> Reliability:
    """Return, for bins of confidence (N,), which share of the lines published with it is right (N,)."""
    confidence = np.asarray(confidence, dtype=np.float64)
    last = len(CONFIDENCE_BINS) - 2
    index = np.clip(np.digitize(confidence, CONFIDENCE_BINS) - 1, 0, last)  # confidence 1 is in the last bin
    counts = np.bincount(index, minlength=last + 1)
    part = share(np.bincount(index, np.asarray(right, dtype=np.float64), last + 1), counts)
    mean = share(np.bincount(index, confidence, last + 1), counts)
    return Reliability(mean, part, *_wilson(part, counts), counts)


def share(part: NDArray, whole: NDArray) -> Floats:
    """Return part / whole, nan where there is nothing."""
    return np.divide(part, whole, out=np.full(len(whole), np.nan), where=whole > 0)


def _wilson(share: Floats, counts: Counts) -> tuple[Floats, Floats]:
    """Return the bounds of a share that was seen in `counts` trials; nan without trials."""
    n = np.where(counts > 0, counts, np.nan)
    centre = (share + Z_95**2 / (2 * n)) / (1 + Z_95**2 / n)
    half = Z_95 / (1 + Z_95**2 / n) * np.sqrt(share * (1 - share) / n + (Z_95 / (2 * n)) ** 2)
    return centre - half, centre + half
