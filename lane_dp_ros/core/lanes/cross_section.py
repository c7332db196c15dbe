# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The grey values across lines, and what they tell: width, breadth, contrast of the bright band.

Cross sections (rows, samples) are of all lines, one line after the other: `Segments` says where each begins.
"""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.birdseye.birds_eye import BirdsEyeView
from lane_dp_ros.core.lanes.segments import Segments

Floats = NDArray[Any]
Cells = NDArray[np.intp]

MIN_PAINTED = 3  # rows; with fewer the best ones are looked at
SAMPLE = 0.05  # m between the samples of a cross section, whatever the view's resolution
SECTION = 20  # samples to each side of the centre: the cross section that is looked at
RECENTRE = 2  # samples by which a row's cross section may be moved onto its peak
NEAR_PAINT = 10.0  # m of paint, the nearest, that give the cross section; the far ones are blurred
FLANK = (4, 10)  # samples from the centre; the road beside the paint, behind its blurred border and any crack
WHITE = 255.0  # grey level
SATURATED = 250.0  # grey levels; how bright such ground is nobody knows
FAINT = 0.02  # Weber contrast of paint; less is noise
DARK = 10.0  # grey levels; keeps ratios of dark pictures sane
REMAP_ROWS = 32_766  # OpenCV samples no more at once


def cross_sections(
    view: BirdsEyeView, rows: Cells, columns: Floats, half: int = SECTION
) -> NDArray[np.float32]:
    """Return the grey values across the lines (rows, 2 half + 1), each row's peak moved to the middle."""
    move = RECENTRE
    offset = np.arange(-half - move - 1, half + move + 2) * (SAMPLE / view.resolution[1])
    map_u = columns.astype(np.float32)[:, None] + offset.astype(np.float32)
    map_v = np.broadcast_to(rows.astype(np.float32)[:, None], map_u.shape)
    pieces = [slice(i, i + REMAP_ROWS) for i in range(0, len(map_u), REMAP_ROWS)]
    sampled = [
        cv2.remap(view.image, map_u[i], map_v[i], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        for i in pieces
    ]
    grey = np.concatenate(sampled, dtype=np.float32)
    middle = len(offset) // 2
    near = grey[:, middle - move - 1 : middle + move + 2]
    peak = middle - move + (near[:, :-2] + near[:, 1:-1] + near[:, 2:]).argmax(axis=1)
    return np.take_along_axis(grey, peak[:, None] + np.arange(-half, half + 1), axis=1)


class BandMeans:
    """Means over bands of cross sections (rows, samples), each by one difference of sums."""

    def __init__(self, sections: Floats) -> None:
        self._sums = np.zeros((len(sections), sections.shape[1] + 1))
        np.cumsum(sections, axis=1, out=self._sums[:, 1:])
        self._middle = sections.shape[1] // 2

    def between(self, first: int, last: int) -> Floats:
        """Return the mean (rows,) of the samples first .. last, counted from the middle."""
        first, stop = self._middle + first, self._middle + last + 1
        return np.asarray((self._sums[:, stop] - self._sums[:, first]) / (stop - first))

    @property
    def paint(self) -> Floats:
        """The mean (rows,) of the three samples in the middle."""
        return self.between(-1, 1)

    def contrast(self, half: int, flank: int) -> Floats:
        """Return that (rows,) of a band of 2 half + 1 samples against the brighter flank, one between."""
        left = self.between(-half - 1 - flank, -half - 2)
        right = self.between(half + 2, half + 1 + flank)
        return np.asarray(self.between(-half, half) - np.maximum(left, right))


def band_widths(sections: Floats, lines: Segments, per_row: float) -> list[float]:
    """Return the width [m] at half contrast of each line's median cross section near the vehicle."""
    most = max(MIN_PAINTED, round(NEAR_PAINT / per_row))
    scaled = sections / (sections.mean(axis=1, keepdims=True) + DARK)
    return [_width(row_medians(scaled[lines.part(i)][:most].T)) for i in range(len(lines))]


def _width(profile: Floats) -> float:
    """Return the width [m] at half contrast of a cross section (samples,)."""
    middle = len(profile) // 2
    peak = profile[middle - 1 : middle + 2].max()
    sides = profile[middle:], profile[middle::-1]
    width = sum(_crossing(side, 0.5 * (peak + side[3:8].min())) for side in sides)
    return max(width, 1.0) * SAMPLE


def _crossing(profile: Floats, level: float) -> float:
    """Return after how many samples a profile, from the middle outwards, falls below `level`."""
    if profile[0] < level:
        return 0.0  # no band is there
    below = np.flatnonzero(profile[1:] < level)
    if not len(below):
        return float(len(profile))
    i = int(below[0])
    return i + float((profile[i] - level) / max(float(profile[i] - profile[i + 1]), 1e-6))


def wide_band_ratios(means: BandMeans, lines: Segments) -> Floats:
    """Return `wide_band_ratio` of each line."""
    # The longer flank for broad lines, the shorter one for double lines: it ends before the other line.
    narrow = np.max([means.contrast(half, flank) for half in (1, 2) for flank in (2, 3)], axis=0)
    return np.asarray(lines.median(means.contrast(4, 4)) / np.maximum(lines.median(narrow), 1.0))


def contrasts(sections: Floats, paint: Floats, lines: Segments) -> tuple[Floats, Floats]:
    """Return `contrast` and `saturation_contrast` of each line."""
    middle = sections.shape[1] // 2
    near, far = FLANK
    left = row_medians(sections[:, middle - far + 1 : middle - near + 1])
    right = row_medians(sections[:, middle + near : middle + far])
    left, right = np.where(left > SATURATED, right, left), np.where(right > SATURATED, left, right)
    road = np.maximum(left, right)
    known = road <= SATURATED
    # Where both sides are burnt out all along, the right image alone may show the paint.
    known |= (lines.count(known) == 0)[lines.index]
    lines = lines.of_kept(known)
    rise, road = (paint - road)[known], road[known]
    return lines.median(rise / (road + DARK)), lines.median(rise / (WHITE + DARK - road))


def row_medians(values: Floats) -> Floats:
    """Return the median of each row; one sort takes a fraction of the time of `np.median`."""
    ordered, count = np.sort(values, axis=1), values.shape[1]
    return np.asarray((ordered[:, (count - 1) // 2] + ordered[:, count // 2]) / 2)
