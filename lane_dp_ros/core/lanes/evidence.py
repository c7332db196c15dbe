# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What speaks for lines being paint or borders: their cross section, their height, the ground beside them.

All lines of a frame are measured at once: their rows stand one after the other in arrays.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.birdseye.birds_eye import BirdsEyeView
from lane_dp_ros.core.birdseye.edge_map import EdgeMap
from lane_dp_ros.core.birdseye.paint_profile import PAINTED, PaintProfile
from lane_dp_ros.core.lanes.candidate import LaneEvidence, LaneLine
from lane_dp_ros.core.lanes.cross_section import (
    DARK,
    FAINT,
    MIN_PAINTED,
    BandMeans,
    band_widths,
    contrasts,
    cross_sections,
    row_medians,
    wide_band_ratios,
)
from lane_dp_ros.core.lanes.plane_sweep import LineHeights, line_heights
from lane_dp_ros.core.lanes.segments import Segments
from lane_dp_ros.core.types import StereoFrame

Floats = NDArray[Any]
Cells = NDArray[np.intp]
Columns = dict[str, Floats]  # of all lines, by the name of the measurement
NeedsHeight = Callable[[Sequence[LaneEvidence]], NDArray[np.bool_]]

STEPS = (  # maps of `EdgeMap` that are looked up along lines
    "rise",
    "grey_step",
    "texture_step",
    "far_rise",
    "far_grey_step",
    "far_texture_step",
    "ground",
)
COMPARED = ("score", "contrast", "saturation_contrast")
STEEPEST = 0.9  # share of a line that is less steep than what is told of it
UNPAINTED = 0.35  # feature below which a row shows no paint
ASIDE = 0.6  # m; where the texture beside the line is taken
TOWARDS_VEHICLE = (0.3, 3.0)  # m; the road on the vehicle's side of the line
SMOOTHED = 2.0  # m along a line, over which the noise of where its paint lies is averaged
LONG = 0.5  # share of the longest line's paint; shorter ones may be anything


@dataclass(frozen=True, eq=False)
class EvidenceSource:
    """Where the evidence for lines is looked up: what looks like paint, like borders, and the grey frame."""

    paint: PaintProfile
    edges: EdgeMap
    frame: StereoFrame


def measure_paint(
    lines: Sequence[LaneLine],
    source: EvidenceSource,
    needs_height: NeedsHeight,
    variants: Sequence[LaneLine] = (),
    among: Sequence[LaneEvidence] = (),
) -> list[LaneEvidence]:
    """Return all evidence for lines, and for variants of them, compared `among` others or to the lines.

    Heights are measured, from both images, of those alone of which `needs_height` says so by all their
    other evidence; of the others, and without a right image, they are unknown.
    """
    each = [*lines, *variants]
    if not each:
        return []
    rows = _rows_of(each, source.paint)
    columns = {**_of_borders(rows, source), **_of_paint(rows, source.paint)}
    columns["score"] = np.array([line.score for line in each])
    if among:
        compared = {name: np.array([getattr(other, name) for other in among]) for name in COMPARED}
    else:
        compared = {name: columns[name][: len(lines)] for name in COMPARED}
    columns["relative_contrast"] = _relative_contrast(columns, compared)
    measured = _as_evidence(columns)
    needed = np.flatnonzero(needs_height(measured)).tolist()
    heights = line_heights([each[i] for i in needed], source.paint.view, source.frame)
    for i, found in zip(needed, heights, strict=True):
        measured[i] = _with_height(measured[i], each[i], found)
    return measured


def measure_border(lines: Sequence[LaneLine], source: EvidenceSource) -> list[LaneEvidence]:
    """Return the evidence for lines being borders of the carriageway."""
    return _as_evidence(_of_borders(_rows_of(lines, source.paint), source)) if lines else []


def courses(lines: Sequence[LaneLine], paint: PaintProfile) -> list[tuple[float, float]]:
    """Return `slope` and `off_paint_fraction` of lines, as their evidence has them."""
    if not lines:
        return []
    rows = _rows_of(lines, paint)
    return list(zip(_steepest(rows).tolist(), _off_paint_fraction(rows, paint).tolist(), strict=True))


@dataclass(frozen=True, eq=False)
class _Rows:
    """The rows of all lines, one line after the other: `lines` says where each begins and ends."""

    lines: Segments
    rows: Cells
    s: Floats
    n: Floats
    column: Floats
    centre: Cells
    """The cell nearest to `column`."""

    def kept(self, at: NDArray[np.bool_]) -> _Rows:
        """Return those rows that are true, at least one a line."""
        columns = self.column[at], self.centre[at]
        return _Rows(self.lines.of_kept(at), self.rows[at], self.s[at], self.n[at], *columns)


def _rows_of(lines: Sequence[LaneLine], paint: PaintProfile) -> _Rows:
    rows, s, n = (np.concatenate([getattr(line, name) for line in lines]) for name in ("rows", "s", "n"))
    segments = Segments([len(line.rows) for line in lines])
    return _Rows(segments, rows, s, n, paint.view.columns(n), paint.view.nearest_columns(n))


def _as_evidence(columns: Columns) -> list[LaneEvidence]:
    values = np.stack(list(columns.values()), axis=1).tolist()
    return [LaneEvidence(**dict(zip(columns, each, strict=True))) for each in values]


def _of_borders(each: _Rows, source: EvidenceSource) -> Columns:
    """Return the measurements that both borders and paint have."""
    lines, edges = each.lines, source.edges
    cells = edges.cells(each.s, each.n)
    steps = lines.median_of_known(np.stack([getattr(edges, name)[cells] for name in STEPS]))
    first, last = lines.ends
    return {
        "length": each.s[last] - each.s[first],
        "start": each.s[first],
        "slope": _steepest(each),
        "painted": lines.count(source.paint.feature(each.rows, each.centre) > PAINTED) / lines.lengths,
        "border": lines.sum(edges.feature[cells]) / lines.lengths,
        **dict(zip(STEPS, steps, strict=True)),
    }


def _steepest(each: _Rows) -> Floats:
    """Return the slope of each line, lateral over forward, that a tenth of it exceeds."""
    return each.lines.quantile(np.abs(each.lines.slopes(each.s, each.n)), STEEPEST)


def _with_height(evidence: LaneEvidence, line: LaneLine, heights: LineHeights) -> LaneEvidence:
    towards, away = heights.left, heights.right
    if row_medians(line.n[None])[0] < 0:
        towards, away = away, towards
    ground = next((height for height in (towards, away) if np.isfinite(height)), 0.0)
    return replace(evidence, height=heights.line - ground, kerb_step=abs(away - heights.line))


def _of_paint(each: _Rows, paint: PaintProfile) -> Columns:
    """Return all the measurements of paint by itself, but for the heights."""
    view = paint.view
    feature = paint.feature(each.rows, each.centre)
    painted = each.kept(_painted(feature, feature > PAINTED, each.lines))
    sections = cross_sections(view, painted.rows, painted.column)
    means = BandMeans(sections)
    contrast, saturation = contrasts(sections, means.paint, painted.lines)
    return {
        "paint_width": np.array(band_widths(sections, painted.lines, view.resolution[0])),
        "wide_band_ratio": wide_band_ratios(means, painted.lines),
        "off_paint_fraction": _off_paint_fraction(each, paint),
        "texture": _texture(each, paint),
        "contrast": contrast,
        "saturation_contrast": saturation,
        "wander": _wander(each, paint),
        "brightness": _brightness(means.paint, painted, view),
    }


def _painted(feature: Floats, certain: NDArray[np.bool_], lines: Segments) -> NDArray[np.bool_]:
    """Return the rows that show paint; of a line with too few of them, the best ones."""
    painted = certain.copy()
    for i in np.flatnonzero(lines.count(certain) < MIN_PAINTED):
        own = feature[lines.part(i)]
        painted[lines.part(i)] = own >= np.sort(own)[-min(MIN_PAINTED, len(own))]
    return painted


def _wander(each: _Rows, paint: PaintProfile) -> Floats:
    """Return how far aside [m] of each line its paint lies, RMS; NaN where there is too little."""
    view = paint.view
    centre, weight = paint.centres(each.rows, each.column)
    aside = weight * ((centre - view.n[0]) - each.column * view.resolution[1])
    window = max(1, round(SMOOTHED / view.resolution[0]))
    total, moment = each.lines.moving_sum(np.stack([weight, aside]), window)
    known = total > window / 2
    power = np.where(known, moment / np.where(known, total, 1), 0) ** 2
    count = each.lines.count(known)
    return np.where(count > 0, np.sqrt(each.lines.sum(power) / np.maximum(count, 1)), np.nan)


def _relative_contrast(columns: Columns, among: Columns) -> Floats:
    """Return the contrast of lines over that of the most striking of the long ones `among`, at most 1.

    Of the two ways to tell contrast the one counts in which a line compares better: paint in the shade is as
    much brighter than its road as that in the sun, in glare it rises as far up to white.
    """
    long = among["score"] >= LONG * among["score"].max()
    shares = [
        columns[name] / max(float(among[name][long].max()), FAINT)
        for name in ("contrast", "saturation_contrast")
    ]
    return np.asarray(np.minimum(np.maximum(*shares), 1.0))


def _brightness(paint: Floats, each: _Rows, view: BirdsEyeView) -> Floats:
    side = np.where(each.lines.median(view.n[each.centre]) < 0, 1, -1)[each.lines.index]
    nearest, farthest = (round(d / view.resolution[1]) for d in TOWARDS_VEHICLE)
    columns = each.centre[:, None] + side[:, None] * np.arange(nearest, farthest, 3)
    columns = np.minimum(np.maximum(columns, 0), len(view.n) - 1)
    road = row_medians(view.image[each.rows[:, None], columns].astype(np.float32))
    return each.lines.median((paint - road) / (road + DARK))


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
