# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The graph in which lanes are searched: how much each cell of the bird's-eye view looks like paint."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.birdseye.birds_eye import right_view
from lane_dp_ros.core.config import PaintMapConfig
from lane_dp_ros.core.types import CENTRE_WINDOW, BirdsEyeView, PaintMap

Floats = NDArray[Any]

CANNY_LOW, CANNY_HIGH = 50, 150  # grey levels, on the bird's-eye view
PAINT_SURROUNDINGS = 0.6  # m; paint is brighter than the mean of this
PAINT_WIDTHS = (0.15, 0.25)  # m; narrow and broad lines, with the blur of the bird's-eye view
GAP = 0.05  # m between band and flank: the blurred border of the paint
FLANK = 0.10  # m on each side that is compared with
TEXTURE_LAG = 0.5  # m; texture is the change along the road over twice this
TEXTURE_WINDOW = (3.25, 1.05)  # m along and across; the neighbourhood whose texture counts
TEXTURE_ASIDE = 0.6  # m; a band is measured by the texture beside it, not its own
TEXTURE_MAX = 30.0  # grey levels; a stronger change is another object, not texture
SENSOR_NOISE = 3.0  # grey levels


def build_paint_map(
    view: BirdsEyeView, config: PaintMapConfig, right: NDArray[np.uint8] | None = None
) -> PaintMap:
    """Return the graph of a bird's-eye view, by the feature that `config` names.

    Bands are looked for in the grey `right` image (H, W), too; the paper's feature is the left image's.
    """
    if config.feature == "bands":
        return band_graph(view, config, right)
    return edge_graph(view, config)


def edge_graph(view: BirdsEyeView, config: PaintMapConfig) -> PaintMap:
    """Return the paper's graph: f = w_e f_e + w_g f_g, w_e + w_g = 1 (eq. 9).

    f_e is 1 on Canny edges, f_g the grey value stretched to [0, 1] over the cells that show road.
    """
    edges = cv2.Canny(view.image, CANNY_LOW, CANNY_HIGH) > 0
    grey = view.image.astype(np.float32)
    seen = grey[view.on_road]
    low, high = (float(seen.min()), float(seen.max())) if seen.size else (0.0, 1.0)
    grey = (grey - low) / max(high - low, 1.0)
    weighted = config.edge_weight * edges + (1 - config.edge_weight) * grey
    feature = np.where(view.on_road, weighted, 0).astype(np.float32)
    surroundings = cv2.blur(grey, (_cells(PAINT_SURROUNDINGS, view.resolution[1]), 1))
    nothing = np.zeros(grey.shape, np.float32)
    paint = np.asarray(np.maximum(grey - surroundings, 0), dtype=np.float32)
    return PaintMap(feature, view.on_road, paint, nothing, nothing)


def band_graph(
    view: BirdsEyeView, config: PaintMapConfig, right: NDArray[np.uint8] | None = None
) -> PaintMap:
    """Return the graph of bright bands of a paint's width.

    The contrast of a band is that against its left or right flank, whichever is less, each in units of
    the texture on that side along the road: on rough ground it takes more to be paint. f rises from 0 at
    `config.contrast_min` to 1 at `config.contrast_max`. Of the left and the grey `right` image (H, W) the
    one counts that shows a cell's band better: glare and noise lie elsewhere for the other camera. Where
    the left image shows paint nearby, `paint` is its own: lanes are told in the left camera's frame.
    """
    texture = road_texture(view)
    contrast = band_contrast(view, texture)
    paint = _share_of_certain_paint(contrast, view, config)
    if right is not None:
        other = right_view(right, view)
        contrast_there = band_contrast(other, road_texture(other))
        np.maximum(contrast, contrast_there, out=contrast, where=other.on_road)
    share = _share_of_certain_paint(contrast, view, config)
    width = 2 * round(CENTRE_WINDOW / view.resolution[1]) + 1
    shown_by_left = cv2.dilate(paint, np.ones((1, width), np.uint8)) > 0
    return PaintMap(
        np.minimum(share, 1), view.on_road, np.where(shown_by_left, paint, share), contrast, texture
    )


def _share_of_certain_paint(contrast: Floats, view: BirdsEyeView, config: PaintMapConfig) -> Floats:
    """Return what part of certain paint's contrast there is, above no paint's; 0 off the road."""
    share = (contrast - config.contrast_min) / (config.contrast_max - config.contrast_min)
    return np.where(view.on_road, np.maximum(share, 0), 0).astype(np.float32)


def road_texture(view: BirdsEyeView) -> Floats:
    """Return the RMS change of the grey value along the road, (rows, columns) [grey levels].

    Paint runs along the road and adds little to it; grass, leaves and gravel do.
    """
    per_row, per_column = view.resolution
    grey = cv2.blur(view.image.astype(np.float32), (3, 1))
    lag = max(1, round(TEXTURE_LAG / per_row))
    change = shifted(grey.T, lag).T - shifted(grey.T, -lag).T
    power = np.minimum(change**2 / 2, TEXTURE_MAX**2)
    power[~view.on_road] = 0
    window = _cells(TEXTURE_WINDOW[1], per_column), _cells(TEXTURE_WINDOW[0], per_row)
    share = cv2.blur(view.on_road.astype(np.float32), window)
    mean = cv2.blur(power, window) / np.maximum(share, 0.02)
    return np.asarray(np.sqrt(np.maximum(mean, 0)), dtype=np.float32)


def band_contrast(view: BirdsEyeView, texture: Floats) -> Floats:
    """Return how much each cell is the centre of a bright band, in units of the texture beside it."""
    per_column = view.resolution[1]
    grey = view.image.astype(np.float32)
    flank_width = max(1, round(FLANK / per_column))
    aside = round(TEXTURE_ASIDE / per_column)
    unit_left = 1 / (shifted(texture, -aside) + SENSOR_NOISE)
    unit_right = 1 / (shifted(texture, aside) + SENSOR_NOISE)
    best = np.full_like(grey, -np.inf)
    for width in PAINT_WIDTHS:
        half = max(1, round((width / per_column - 1) / 2))
        band = cv2.blur(grey, (2 * half + 1, 1))
        offset = half + max(1, round(GAP / per_column)) + 1
        left = _mean_from(grey, -offset - flank_width + 1, flank_width)
        right = _mean_from(grey, offset, flank_width)
        np.maximum(best, np.minimum((band - left) * unit_left, (band - right) * unit_right), out=best)
    return best


def shifted(array: Floats, columns: int) -> Floats:
    """Return a[:, i + columns] at column i, the border repeated."""
    index = np.clip(np.arange(array.shape[1]) + columns, 0, array.shape[1] - 1)
    return array[:, index]


def _mean_from(array: Floats, first: int, width: int) -> Floats:
    """Return, at column i, the mean of columns i + first .. i + first + width - 1."""
    return sum((shifted(array, first + k) for k in range(width)), np.zeros_like(array)) / np.float32(width)


def _cells(length: float, resolution: float) -> int:
    """Return an odd number of cells of about `length`."""
    return 2 * int(length / resolution / 2) + 1
