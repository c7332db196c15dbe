# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What speaks for lines being paint: their cross section, their height, the ground beside them.

All lines of a frame are measured at once: their rows stand one after the other in arrays.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.birdseye.birds_eye import BirdsEyeView
from lane_dp_ros.core.birdseye.paint_profile import PAINTED, PaintProfile, runs_of
from lane_dp_ros.core.lanes.candidate import LaneEvidence, LaneLine
from lane_dp_ros.core.lanes.plane_sweep import LineHeights, PlaneSweepConfig, line_heights
from lane_dp_ros.core.lanes.segments import Segments
from lane_dp_ros.core.types import StereoFrame

Floats = NDArray[Any]
Cells = NDArray[np.intp]
NeedsHeight = Callable[[LaneLine, LaneEvidence], bool]

UNPAINTED = 0.35  # feature below which a row shows no paint
MIN_PAINTED = 3  # rows; with fewer the best ones are looked at
SAMPLE = 0.05  # m between the samples of a cross section, whatever the view's resolution
SECTION = 20  # samples to each side of the centre: the cross section that is looked at
RECENTRE = 2  # samples by which a row's cross section may be moved onto its peak
NEAR_PAINT = 10.0  # m of paint, the nearest, that give the cross section; the far ones are blurred
GAP_BRIDGED = 1.0  # m of missing paint inside one segment
ASIDE = 0.6  # m; where the texture beside the line is taken
FLANK = (4, 10)  # samples from the centre; the road beside the paint, behind its blurred border and any crack
WHITE = 255.0  # grey level
SATURATED = 250.0  # grey levels; how bright such ground is nobody knows
TOWARDS_VEHICLE = (0.3, 3.0)  # m; the road on the vehicle's side of the line
DASH = 1.5  # m of paint, at least
DARK = 10.0  # grey levels; keeps ratios of dark pictures sane
REMAP_ROWS = 32_766  # OpenCV samples no more at once


def measure(
    lines: Sequence[LaneLine],
    paint: PaintProfile,
    frame: StereoFrame,
    config: PlaneSweepConfig,
    needs_height: NeedsHeight,
) -> list[LaneEvidence]:
    """Return the evidence for lines in the view of a grey frame.

    Heights are measured, from both images, of the lines alone of which `needs_height` says so by all their
    other evidence; of the others, and without a right image, they are unknown.
    """
    if not lines:
        return []
    measured = _without_heights(lines, paint)
    needed = [i for i, line in enumerate(lines) if needs_height(line, measured[i])]
    heights = line_heights([lines[i] for i in needed], paint.view, frame, config)
    for i, found in zip(needed, heights, strict=True):
        measured[i] = _with_height(measured[i], lines[i], found)
    return measured


def _with_height(evidence: LaneEvidence, line: LaneLine, heights: LineHeights) -> LaneEvidence:
    towards, away = heights.left, heights.right
    if _row_medians(line.n[None])[0] < 0:
        towards, away = away, towards
    ground = next((height for height in (towards, away) if np.isfinite(height)), 0.0)
    step = abs(away - heights.line)
    return replace(evidence, height=heights.line - ground, kerb_step=step if np.isfinite(step) else 0.0)


@dataclass(frozen=True, eq=False)
class _Rows:
    """The rows of all lines, one line after the other: `lines` says where each begins and ends."""

    lines: Segments
    rows: Cells
    column: Floats
    centre: Cells
    """The cell nearest to `column`."""


def _without_heights(lines: Sequence[LaneLine], paint: PaintProfile) -> list[LaneEvidence]:
    view = paint.view
    n = np.concatenate([line.n for line in lines])
    rows = np.concatenate([line.rows for line in lines])
    each = _Rows(Segments([len(line.rows) for line in lines]), rows, view.columns(n), view.nearest_columns(n))
    feature = paint.feature(each.rows, each.centre)
    certain = feature > PAINTED
    off_paint = _off_paint_fraction(each, paint)
    texture = _texture(each, paint)
    at = _painted(feature, certain, each.lines)
    painted = _Rows(each.lines.of_kept(at), each.rows[at], each.column[at], each.centre[at])
    sections = _cross_sections(view, painted)
    means = _BandMeans(sections)
    width = _widths(sections, painted.lines, view.resolution[0])
    ratio = _wide_band_ratio(means, painted.lines)
    contrast, saturation = _contrast(sections, means.paint, painted.lines)
    brightness = _brightness(means.paint, painted, view)
    evidence = []
    for i, line in enumerate(lines):
        runs = runs_of(certain[each.lines.part(i)])
        evidence.append(
            LaneEvidence(
                paint_width=width[i],
                wide_band_ratio=float(ratio[i]),
                height=np.nan,
                kerb_step=0.0,
                slope=float(np.percentile(np.abs(np.gradient(line.n, line.s)), 90)),
                off_paint_fraction=float(off_paint[i]),
                texture=float(texture[i]),
                contrast=float(contrast[i]),
                saturation_contrast=float(saturation[i]),
                brightness=float(brightness[i]),
                longest_segment=_longest_segment(runs, len(line.rows), view.resolution[0]),
                dashes=int(np.count_nonzero(np.diff(runs) * view.resolution[0] >= DASH)),
            )
        )
    return evidence


def _painted(feature: Floats, certain: NDArray[np.bool_], lines: Segments) -> NDArray[np.bool_]:
    """Return the rows that show paint; of a line with too few of them, the best ones."""
    painted = certain.copy()
    for i in np.flatnonzero(lines.count(certain) < MIN_PAINTED):
        own = feature[lines.part(i)]
        painted[lines.part(i)] = own >= np.sort(own)[-min(MIN_PAINTED, len(own))]
    return painted


def _cross_sections(view: BirdsEyeView, each: _Rows) -> NDArray[np.float32]:
    """Return the grey values across the lines (rows, samples), the peak of each row moved to the middle."""
    half, move = SECTION, RECENTRE
    offset = np.arange(-half - move - 1, half + move + 2) * (SAMPLE / view.resolution[1])
    map_u = each.column.astype(np.float32)[:, None] + offset.astype(np.float32)
    map_v = np.broadcast_to(each.rows.astype(np.float32)[:, None], map_u.shape)
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


class _BandMeans:
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


def _widths(sections: Floats, lines: Segments, per_row: float) -> list[float]:
    """Return the width [m] at half contrast of each line's median cross section near the vehicle."""
    most = max(MIN_PAINTED, round(NEAR_PAINT / per_row))
    scaled = sections / (sections.mean(axis=1, keepdims=True) + DARK)
    return [_width(_row_medians(scaled[lines.part(i)][:most].T)) for i in range(len(lines))]


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


def _wide_band_ratio(means: _BandMeans, lines: Segments) -> Floats:
    # The longer flank for broad lines, the shorter one for double lines: it ends before the other line.
    narrow = np.max([means.contrast(half, flank) for half in (1, 2) for flank in (2, 3)], axis=0)
    return np.asarray(lines.median(means.contrast(4, 4)) / np.maximum(lines.median(narrow), 1.0))


def _contrast(sections: Floats, paint: Floats, lines: Segments) -> tuple[Floats, Floats]:
    """Return `contrast` and `saturation_contrast` of each line."""
    middle = sections.shape[1] // 2
    near, far = FLANK
    left = _row_medians(sections[:, middle - far + 1 : middle - near + 1])
    right = _row_medians(sections[:, middle + near : middle + far])
    left, right = np.where(left > SATURATED, right, left), np.where(right > SATURATED, left, right)
    road = np.maximum(left, right)
    known = road <= SATURATED
    # Where both sides are burnt out all along, the right image alone may show the paint.
    known |= (lines.count(known) == 0)[lines.index]
    lines = lines.of_kept(known)
    rise, road = (paint - road)[known], road[known]
    return lines.median(rise / (road + DARK)), lines.median(rise / (WHITE + DARK - road))


def _brightness(paint: Floats, each: _Rows, view: BirdsEyeView) -> Floats:
    side = np.where(each.lines.median(view.n[each.centre]) < 0, 1, -1)[each.lines.index]
    nearest, farthest = (round(d / view.resolution[1]) for d in TOWARDS_VEHICLE)
    columns = each.centre[:, None] + side[:, None] * np.arange(nearest, farthest, 3)
    columns = np.minimum(np.maximum(columns, 0), len(view.n) - 1)
    road = _row_medians(view.image[each.rows[:, None], columns].astype(np.float32))
    return each.lines.median((paint - road) / (road + DARK))


def _row_medians(values: Floats) -> Floats:
    """Return the median of each row; one sort takes a fraction of the time of `np.median`."""
    ordered, count = np.sort(values, axis=1), values.shape[1]
    return np.asarray((ordered[:, (count - 1) // 2] + ordered[:, count // 2]) / 2)


def _off_paint_fraction(each: _Rows, paint: PaintProfile) -> Floats:
    nearby = paint.centres(each.rows, each.column)[1] > PAINTED
    beside = paint.feature_on_line(each.rows, each.centre) < UNPAINTED
    return np.asarray(each.lines.count(nearby & beside) / np.maximum(each.lines.count(nearby), 1))


def _texture(each: _Rows, paint: PaintProfile) -> Floats:
    """Return the texture over brightness beside each line, on its smoother side."""
    view = paint.view
    aside = round(ASIDE / view.resolution[1])
    sides = np.stack([each.centre - aside, each.centre + aside])
    sides = np.minimum(np.maximum(sides, 0), len(view.n) - 1)
    share = paint.paint_map.texture[each.rows, sides] / (view.image[each.rows, sides] + DARK)
    return each.lines.median(share.min(axis=0))


def _longest_segment(runs: Cells, count: int, per_row: float) -> float:
    """Return the length [m] of the longest of runs (N, 2) of painted rows, short gaps bridged.

    So are those at the ends of the line, of `count` rows, of half the length.
    """
    window = round(GAP_BRIDGED / per_row) | 1
    longest, start, end = 0, 0, -count
    for first, last in runs.tolist():
        if first - end >= window:
            start = 0 if first <= window // 2 else first
        end = count if last >= count - window // 2 else last
        longest = max(longest, end - start)
    return float(longest * per_row)
