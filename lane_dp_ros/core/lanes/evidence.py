# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What speaks for a line being paint: its cross section, its height, the ground beside it."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.birdseye.paint_profile import runs_of
from lane_dp_ros.core.lanes.plane_sweep import line_heights
from lane_dp_ros.core.types import BirdsEyeView, LaneEvidence, LaneLine, PaintMap, StereoFrame

Floats = NDArray[np.float32]

PAINTED = 0.5  # feature, or weight of a centre, above which a row shows paint
UNPAINTED = 0.35  # feature below which it shows none
MIN_PAINTED = 3  # rows; with fewer the best ones are looked at
SAMPLE = 0.05  # m between the samples of a cross section, whatever the view's resolution
SECTION = 20  # samples to each side of the centre: the cross section that is looked at
RECENTRE = 2  # samples by which a row's cross section may be moved onto its peak
NEAR_LINE = 0.10  # m to each side of a line, where its paint is looked up
ON_LINE = 0.05  # m; the same, where the line itself has to lie on it
NEAR_PAINT = 10.0  # m of paint, the nearest, that give the cross section; the far ones are blurred
GAP_BRIDGED = 1.0  # m of missing paint inside one run
ASIDE = 0.6  # m; where the texture beside the line is taken
FLANK = (4, 10)  # samples from the centre; the road beside the paint, behind its blurred border and any crack
WHITE = 255.0  # grey level
SATURATED = 250.0  # grey levels; how bright such ground is nobody knows
TOWARDS_VEHICLE = (0.3, 3.0)  # m; the road on the vehicle's side of the line
DASH = 1.5  # m of paint, at least
DARK = 10.0  # grey levels; keeps ratios of dark pictures sane


def line_evidence(line: LaneLine, view: BirdsEyeView, graph: PaintMap, picture: StereoFrame) -> LaneEvidence:
    """Return the evidence for a line in a bird's-eye view; without a right image no heights are known."""
    column = view.columns(line.n).astype(np.float32)
    centre = view.nearest_columns(line.n)
    feature = feature_along(line.rows, centre, view, graph)
    painted = _painted(feature)
    sections = _cross_sections(view, line.rows[painted], column[painted])
    width, wide_band_ratio = _band_shape(sections, view.resolution[0])
    contrast, saturation_contrast = _contrast(sections)
    height, step = _height_and_step(line, view, picture)
    return LaneEvidence(
        paint_width=width,
        wide_band_ratio=wide_band_ratio,
        height=height,
        step=step,
        slope=float(np.percentile(np.abs(np.gradient(line.n, line.s)), 90)),
        off_paint_fraction=_astray(line, centre, view, graph),
        roughness=_roughness(line.rows, centre, view, graph),
        contrast=contrast,
        saturation_contrast=saturation_contrast,
        brightness=_brightness(sections, line.rows[painted], centre[painted], view),
        run=_longest_run(feature > PAINTED, view.resolution[0]),
        dashes=_dashes(feature > PAINTED, view.resolution[0]),
    )


def feature_along(
    rows: NDArray[np.intp],
    columns: NDArray[np.intp],
    view: BirdsEyeView,
    graph: PaintMap,
    aside: float = NEAR_LINE,
) -> Floats:
    """Return the highest feature (N,) up to `aside` [m] from each cell (rows[i], columns[i]) of a line."""
    reach = round(aside / view.resolution[1])
    around = np.clip(columns[:, None] + np.arange(-reach, reach + 1), 0, len(view.n) - 1)
    return np.asarray(graph.feature[rows[:, None], around].max(axis=1))


def _painted(feature: Floats) -> NDArray[np.bool_]:
    painted = feature > PAINTED
    if np.count_nonzero(painted) < MIN_PAINTED:
        painted = feature >= np.sort(feature)[-min(MIN_PAINTED, len(feature))]
    return np.asarray(painted)


def _cross_sections(view: BirdsEyeView, rows: NDArray[np.intp], column: Floats) -> Floats:
    """Return the grey values across the line (rows, samples), the peak of each row moved to the middle."""
    half, move = SECTION, RECENTRE
    offset = np.arange(-half - move - 1, half + move + 2) * (SAMPLE / view.resolution[1])
    map_u = column[:, None] + offset.astype(np.float32)
    map_v = np.repeat(rows.astype(np.float32)[:, None], len(offset), axis=1)
    grey = cv2.remap(view.image, map_u, map_v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE).astype(
        np.float32
    )
    grey = grey.reshape(map_u.shape)
    middle = len(offset) // 2
    candidates = middle + np.arange(-move, move + 1)
    peak = candidates[
        (grey[:, candidates - 1] + grey[:, candidates] + grey[:, candidates + 1]).argmax(axis=1)
    ]
    return np.take_along_axis(grey, peak[:, None] + np.arange(-half, half + 1), axis=1)


def _band_shape(sections: Floats, per_row: float) -> tuple[float, float]:
    """Return `paint_width` and `wide_band_ratio` (see `LaneEvidence`) of the band in cross sections."""
    middle = sections.shape[1] // 2
    near = sections[: max(MIN_PAINTED, round(NEAR_PAINT / per_row))]
    profile = np.median(near / (near.mean(axis=1, keepdims=True) + DARK), axis=0)
    peak = profile[middle - 1 : middle + 2].max()
    sides = profile[middle:], profile[middle::-1]
    width = sum(_crossing(side, 0.5 * (peak + side[3:8].min())) for side in sides)

    def contrast(half: int, flank: int) -> Floats:
        """Band of 2 half + 1 samples against the brighter flank, one sample between."""
        band = sections[:, middle - half : middle + half + 1].mean(axis=1)
        left = sections[:, middle - half - 1 - flank : middle - half - 1].mean(axis=1)
        right = sections[:, middle + half + 2 : middle + half + 2 + flank].mean(axis=1)
        return np.asarray(band - np.maximum(left, right))

    # The longer flank for broad lines, the shorter one for double lines: it ends before the other line.
    narrow = np.median(np.max([contrast(half, flank) for half in (1, 2) for flank in (2, 3)], axis=0))
    return max(width, 1.0) * SAMPLE, float(np.median(contrast(4, 4)) / max(narrow, 1.0))


def _crossing(profile: Floats, level: float) -> float:
    """Return after how many samples a profile, from the middle outwards, falls below `level`."""
    if profile[0] < level:
        return 0.0  # no band is there
    below = np.flatnonzero(profile[1:] < level)
    if not len(below):
        return float(len(profile))
    i = int(below[0])
    return i + float((profile[i] - level) / max(float(profile[i] - profile[i + 1]), 1e-6))


def _contrast(sections: Floats) -> tuple[float, float]:
    """Return `contrast` and `saturation_contrast` (see `LaneEvidence`) in cross sections."""
    middle = sections.shape[1] // 2
    near, far = FLANK
    paint = sections[:, middle - 1 : middle + 2].mean(axis=1)
    left = np.median(sections[:, middle - far + 1 : middle - near + 1], axis=1)
    right = np.median(sections[:, middle + near : middle + far], axis=1)
    left, right = np.where(left > SATURATED, right, left), np.where(right > SATURATED, left, right)
    road = np.maximum(left, right)
    known = road <= SATURATED
    if known.any():  # where both sides are burnt out, the right image alone may show the paint
        paint, road = paint[known], road[known]
    rise = paint - road
    return float(np.median(rise / (road + DARK))), float(np.median(rise / (WHITE + DARK - road)))


def _brightness(
    sections: Floats, rows: NDArray[np.intp], centre: NDArray[np.intp], view: BirdsEyeView
) -> float:
    middle = sections.shape[1] // 2
    paint = sections[:, middle - 1 : middle + 2].mean(axis=1)
    side = 1 if np.median(view.n[centre]) < 0 else -1
    nearest, farthest = (round(d / view.resolution[1]) for d in TOWARDS_VEHICLE)
    columns = np.clip(centre[:, None] + side * np.arange(nearest, farthest, 3), 0, len(view.n) - 1)
    road = np.median(view.image[rows[:, None], columns], axis=1)
    return float(np.median((paint - road) / (road + DARK)))


def _height_and_step(line: LaneLine, view: BirdsEyeView, picture: StereoFrame) -> tuple[float, float]:
    """Return `LaneEvidence.height` and `step`."""
    heights = line_heights(line, view, picture)
    towards, away = heights.left, heights.right
    if np.median(line.n) < 0:
        towards, away = away, towards
    ground = next((height for height in (towards, away) if np.isfinite(height)), 0.0)
    step = abs(away - heights.line)
    return heights.line - ground, float(step) if np.isfinite(step) else 0.0


def _astray(line: LaneLine, centre: NDArray[np.intp], view: BirdsEyeView, graph: PaintMap) -> float:
    """Return the share of the rows with paint nearby in which the line itself lies on none."""
    nearby = view.paint_centres(graph, line.rows, view.columns(line.n))[1] > PAINTED
    beside = feature_along(line.rows, centre, view, graph, ON_LINE) < UNPAINTED
    return float(beside[nearby].mean()) if nearby.any() else 0.0


def _roughness(
    rows: NDArray[np.intp], centre: NDArray[np.intp], view: BirdsEyeView, graph: PaintMap
) -> float:
    """Return the texture over brightness beside the line, on its smoother side."""
    aside = round(ASIDE / view.resolution[1])
    sides = np.clip(np.stack([centre - aside, centre + aside]), 0, len(view.n) - 1)
    share = graph.texture[rows, sides] / (view.image[rows, sides] + DARK)
    return float(np.median(share.min(axis=0)))


def _dashes(painted: NDArray[np.bool_], per_row: float) -> int:
    """Return the number of pieces of paint that are long enough to be dashes."""
    return int(np.count_nonzero(np.diff(runs_of(painted)) * per_row >= DASH))


def _longest_run(painted: NDArray[np.bool_], per_row: float) -> float:
    """Return the length [m] of the longest run of painted rows, gaps of up to `GAP_BRIDGED` bridged."""
    kernel = np.ones((round(GAP_BRIDGED / per_row) | 1, 1), np.uint8)
    closed = cv2.morphologyEx(painted.astype(np.uint8)[:, None].copy(), cv2.MORPH_CLOSE, kernel).ravel()
    return float(np.diff(runs_of(closed > 0)).max(initial=0) * per_row)
