# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The measures of the TuSimple and CULane benchmarks, on lines in the image.

Both count in pixels: TuSimple's refer to images of 1280x720, CULane's to 1640x590. They are used as
published, whatever the size of the images; on smaller ones they are the more lenient.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import cv2
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]

TUSIMPLE_WIDTH = 20.0  # px, measured across the label's line
TUSIMPLE_MIN_ACCURACY = 0.85  # share of the rows in which a detected line lies on the label
TUSIMPLE_ROW_STEP = 10  # px
TUSIMPLE_MAX_LABELS = (
    4  # one label beyond may be missed: there a line is taken by two lanes at a change of lane
)
TUSIMPLE_MAX_SPARE = 2  # with more lines than labels plus these the frame counts as failed
CULANE_WIDTH = 30  # px
CULANE_MIN_IOU = 0.5


@dataclass(frozen=True)
class TuSimple:
    """Sums of the three measures over `frames` frames; they add up."""

    frames: int = 0
    accuracy_sum: float = 0.0
    fp_sum: float = 0.0
    fn_sum: float = 0.0

    def __add__(self, other: TuSimple) -> TuSimple:
        return TuSimple(
            self.frames + other.frames,
            self.accuracy_sum + other.accuracy_sum,
            self.fp_sum + other.fp_sum,
            self.fn_sum + other.fn_sum,
        )

    @property
    def accuracy(self) -> float:
        """Mean over the frames of the share of rows that are right."""
        return self._mean(self.accuracy_sum)

    @property
    def fp(self) -> float:
        """Mean over the frames of the share of detected lines that lie on no label."""
        return self._mean(self.fp_sum)

    @property
    def fn(self) -> float:
        """Mean over the frames of the share of labels that no detected line lies on."""
        return self._mean(self.fn_sum)

    def _mean(self, total: float) -> float:
        return total / self.frames if self.frames else float("nan")


@dataclass(frozen=True)
class CULane:
    """Lines that were rightly found, wrongly found, not found; the counts add up."""

    tp: int = 0
    fp: int = 0
    fn: int = 0

    def __add__(self, other: CULane) -> CULane:
        return CULane(self.tp + other.tp, self.fp + other.fp, self.fn + other.fn)

    @property
    def f1(self) -> float:
        """The harmonic mean of precision and recall; nan without lines and labels."""
        whole = 2 * self.tp + self.fp + self.fn
        return 2 * self.tp / whole if whole else float("nan")


def tusimple_rows(height: int, horizon: float) -> Floats:
    """Return the rows [px] to judge in: every 10 px from the horizon to the bottom of the image."""
    first = int(np.ceil(max(horizon, 0.0) / TUSIMPLE_ROW_STEP)) * TUSIMPLE_ROW_STEP
    return np.arange(first, height, TUSIMPLE_ROW_STEP, dtype=np.float64)


def tusimple(lines: Sequence[Floats], labels: Sequence[Floats], rows: Floats) -> TuSimple:
    """Judge one frame as TuSimple does: `lines`, `labels` are polylines (N, 2) of pixels, `rows` (R,) [px].

    A label's accuracy is the best line's share of rows in which it is nearer than 20 px / cos(angle of the
    label), or where neither is there; from 0.85 on it is found. A frame with more than two lines more than
    labels counts as accuracy 0, FP 0, FN 1. Beyond four labels the worst may be missed. A frame
    without labels is left out: TuSimple has none, and its formula would call an empty answer to it wrong.
    """
    if not labels:
        return TuSimple()
    if len(lines) > len(labels) + TUSIMPLE_MAX_SPARE:
        return TuSimple(1, 0.0, 0.0, 1.0)
    at_rows = [_at_rows(line, rows) for line in lines]
    accuracies = [
        max((_row_accuracy(line, label, rows) for line in at_rows), default=0.0)
        for label in (_at_rows(label, rows) for label in labels)
    ]
    found = sum(accuracy >= TUSIMPLE_MIN_ACCURACY for accuracy in accuracies)
    missed, total = len(labels) - found, sum(accuracies)
    if len(labels) > TUSIMPLE_MAX_LABELS:
        missed, total = max(missed - 1, 0), total - min(accuracies)
    whole = max(min(len(labels), TUSIMPLE_MAX_LABELS), 1)
    return TuSimple(1, total / whole, (len(lines) - found) / max(len(lines), 1), missed / whole)


def _at_rows(polyline: Floats, rows: Floats) -> Floats:
    """Return the u [px] of a polyline in each row, nan where it does not reach."""
    if len(polyline) == 0:
        return np.full(len(rows), np.nan)
    u, v = polyline[np.argsort(polyline[:, 1], kind="stable")].T
    return np.interp(rows, v, u, left=np.nan, right=np.nan)


def _row_accuracy(line: Floats, label: Floats, rows: Floats) -> float:
    """Return the share of rows in which the line lies on the label, or neither is there."""
    seen = np.isfinite(label)
    slope = np.polyfit(rows[seen], label[seen], 1)[0] if seen.sum() > 1 else 0.0
    width = TUSIMPLE_WIDTH / np.cos(np.arctan(slope))
    near = np.abs(line - label) < width
    neither = ~seen & ~np.isfinite(line)
    return float(np.mean(near | neither)) if len(rows) else 0.0


def culane(lines: Sequence[Floats], labels: Sequence[Floats], size: tuple[int, int]) -> CULane:
    """Judge one frame as CULane does: `lines`, `labels` are polylines (N, 2) of pixels, `size` width, height.

    Each is drawn 30 px wide. Lines and labels are paired so that the sum of their IoU is the largest; a pair
    whose IoU is above 0.5 is a true positive.
    """
    drawn_lines, drawn_labels = ([_drawn(p, size) for p in polylines] for polylines in (lines, labels))
    ious = np.array([[_iou(line, label) for line in drawn_lines] for label in drawn_labels])
    tp = sum(ious[pair] > CULANE_MIN_IOU for pair in _best_pairs(ious)) if ious.size else 0
    return CULane(int(tp), len(lines) - int(tp), len(labels) - int(tp))


def _drawn(polyline: Floats, size: tuple[int, int]) -> Mask:
    """Return the pixels (height, width) of a polyline drawn as wide as CULane does."""
    width, height = size
    canvas = np.zeros((height, width), np.uint8)
    # OpenCV draws segments that leave the image wrongly, or for ever, when their ends are far away.
    points = np.rint(np.clip(polyline, -10 * max(size), 10 * max(size))).astype(np.int32)
    cv2.polylines(canvas, [points.reshape(-1, 1, 2)], False, 1, CULANE_WIDTH)
    return canvas > 0


def _iou(a: Mask, b: Mask) -> float:
    union = int(np.count_nonzero(a | b))
    return int(np.count_nonzero(a & b)) / union if union else 0.0


def _best_pairs(values: Floats) -> list[tuple[int, int]]:
    """Return the pairs (row, column), each row and column once at most, with the largest sum of values."""
    candidates = [np.flatnonzero(row > 0).tolist() for row in values]

    @cache
    def best(row: int, taken: frozenset[int]) -> tuple[float, tuple[tuple[int, int], ...]]:
        """Return the largest sum from this row on, and its pairs; few lines overlap, so few are tried."""
        if row == len(values):
            return 0.0, ()
        choices = [best(row + 1, taken)]
        for column in candidates[row]:
            if column not in taken:
                rest, pairs = best(row + 1, taken | {column})
                choices.append((rest + values[row, column], ((row, column), *pairs)))
        return max(choices, key=lambda choice: choice[0])

    return list(best(0, frozenset())[1])
