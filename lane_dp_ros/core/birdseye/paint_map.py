# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The graph in which lanes are searched: how much each cell of the bird's-eye view looks like paint."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.birdseye.birds_eye import BirdsEyeView, right_view
from lane_dp_ros.core.parameter import Parameters, check_order, parameter

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
CENTRE_WINDOW = 0.15  # m to each side of a path; where the centre of its paint is


@dataclass(frozen=True)
class PaintMapConfig(Parameters):
    """How much each cell of the bird's-eye view looks like paint, f in [0, 1]; its cost is 1 - f."""

    feature: str = parameter(
        "bands",
        "bands: contrast of a bright band against both sides; edges_and_grey: the paper's w_e f_e + w_g f_g.",
        choices=("bands", "edges_and_grey"),
    )
    edge_weight: float = parameter(
        0.6,
        "w_e, the share of the edges in f; the rest, w_g, is grey; for edges_and_grey.",
        limits=(0.0, 1.0),
    )
    contrast_min: float = parameter(
        0.35, "Contrast of no paint, in units of the road's texture; for bands.", limits=(0.0, 10.0)
    )
    contrast_max: float = parameter(
        2.8, "Contrast of certain paint, in units of the road's texture; for bands.", limits=(0.1, 20.0)
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        check_order(self, "paint_map", "contrast_min", "contrast_max")


@dataclass(frozen=True, eq=False)
class PaintMap:
    """The graph in which lanes are searched: a node for each cell (rows, columns) of a bird's-eye view.

    `feature` f is in [0, 1], 0 where no road is `seen`; a node costs 1 - f. `paint` >= 0 has its peak on
    the centre of a painted line (f peaks on the edges when it is made of edges, and is flat across a
    bright line when it is made of bands). `contrast` [units of texture] is that of the image that shows it
    better, `texture` [grey levels] the left image's; both are zero for the paper's feature.
    """

    feature: NDArray[np.float32]
    seen: NDArray[np.bool_]
    paint: NDArray[np.float32]
    contrast: NDArray[np.float32]
    texture: NDArray[np.float32]

    @cached_property
    def cost(self) -> NDArray[np.float32]:
        """F = 1 - f, in [0, 1] (paper, section V-A)."""
        return 1 - self.feature


class PaintMapBuilder(Protocol):
    """Tells how much the cells of a view look like paint."""

    def build(self, view: BirdsEyeView, right: NDArray[np.uint8] | None = None) -> PaintMap:
        """Return the map of a view; the grey `right` image (H, W) may show the paint better."""


class EdgesPaintMap:
    """The paper's graph: f = w_e f_e + w_g f_g, w_e + w_g = 1 (eq. 9), of the left image alone."""

    def __init__(self, config: PaintMapConfig) -> None:
        self._config = config

    def build(self, view: BirdsEyeView, right: NDArray[np.uint8] | None = None) -> PaintMap:  # noqa: ARG002
        """See `PaintMapBuilder`. f_e is 1 on Canny edges, f_g the grey value stretched over the road."""
        edges = cv2.Canny(view.image, CANNY_LOW, CANNY_HIGH) > 0
        grey = view.image.astype(np.float32)
        seen = grey[view.on_road]
        low, high = (float(seen.min()), float(seen.max())) if seen.size else (0.0, 1.0)
        grey = (grey - low) / max(high - low, 1.0)
        weighted = self._config.edge_weight * edges + (1 - self._config.edge_weight) * grey
        feature = np.where(view.on_road, weighted, 0).astype(np.float32)
        surroundings = cv2.blur(grey, (odd_cells(PAINT_SURROUNDINGS, view.resolution[1]), 1))
        nothing = np.zeros(grey.shape, np.float32)
        paint = np.asarray(np.maximum(grey - surroundings, 0), dtype=np.float32)
        return PaintMap(feature, view.on_road, paint, nothing, nothing)


class BandsPaintMap:
    """Bright bands of a paint's width, in either image.

    The contrast of a band is that against its left or right flank, whichever is less, each in units of
    the texture on that side along the road: on rough ground it takes more to be paint. f rises from 0 at
    `contrast_min` to 1 at `contrast_max`. Of the left and the right image the one counts that shows a
    cell's band better: glare and noise lie elsewhere for the other camera. Where the left image shows paint
    nearby, `paint` is its own: lanes are told in the left camera's frame.
    """

    def __init__(self, config: PaintMapConfig) -> None:
        self._config = config

    def build(self, view: BirdsEyeView, right: NDArray[np.uint8] | None = None) -> PaintMap:
        """See `PaintMapBuilder`."""
        views = [view] if right is None else [view, right_view(right, view)]
        textures = [road_texture(each) for each in views]
        # Both images in one stack: half as many calls on arrays twice as large.
        stacked = np.concatenate([each.image for each in views]), np.concatenate(textures)
        contrasts = band_contrast(*stacked, view.resolution[1])
        contrast = contrasts[: len(view.s)]
        paint = self._share_of_certain_paint(contrast, view)
        if right is None:
            return PaintMap(np.minimum(paint, 1), view.on_road, paint, contrast, textures[0])
        contrast = contrast.copy()
        np.maximum(contrast, contrasts[len(view.s) :], out=contrast, where=views[1].on_road)
        share = self._share_of_certain_paint(contrast, view)
        width = 2 * round(CENTRE_WINDOW / view.resolution[1]) + 1
        shown_by_left = cv2.dilate(paint, np.ones((1, width), np.uint8)) > 0
        paint = np.where(shown_by_left, paint, share)
        return PaintMap(np.minimum(share, 1), view.on_road, paint, contrast, textures[0])

    def _share_of_certain_paint(self, contrast: Floats, view: BirdsEyeView) -> Floats:
        """Return what part of certain paint's contrast there is, above no paint's; 0 off the road."""
        share = contrast - np.float32(self._config.contrast_min)
        share *= np.float32(1 / (self._config.contrast_max - self._config.contrast_min))
        np.maximum(share, 0, out=share)
        share *= view.on_road
        return share


def paint_map_builder(config: PaintMapConfig) -> PaintMapBuilder:
    """Return the builder of the feature that `config.feature` names."""
    return BandsPaintMap(config) if config.feature == "bands" else EdgesPaintMap(config)


def road_texture(view: BirdsEyeView) -> NDArray[np.float32]:
    """Return the RMS change of the grey value along the road, (rows, columns) [grey levels].

    Paint runs along the road and adds little to it; grass, leaves and gravel do.
    """
    per_row, per_column = view.resolution
    grey = cv2.boxFilter(view.image, cv2.CV_32F, (3, 1))
    lag = max(1, round(TEXTURE_LAG / per_row))
    padded = cv2.copyMakeBorder(grey, lag, lag, 0, 0, cv2.BORDER_REPLICATE)
    change = cv2.subtract(padded[2 * lag :], padded[: -2 * lag])
    power = cv2.multiply(change, change, scale=0.5)
    _, power = cv2.threshold(power, TEXTURE_MAX**2, 0.0, cv2.THRESH_TRUNC)
    on_road = view.on_road.view(np.uint8)
    window = odd_cells(TEXTURE_WINDOW[1], per_column), odd_cells(TEXTURE_WINDOW[0], per_row)
    total = cv2.blur(cv2.multiply(power, on_road, dtype=cv2.CV_32F), window)
    share = cv2.boxFilter(on_road, cv2.CV_32F, window)
    mean = cv2.divide(np.maximum(total, 0), np.maximum(share, np.float32(0.02)))
    return np.asarray(cv2.sqrt(mean), dtype=np.float32)


def band_contrast(image: NDArray[np.uint8], texture: Floats, per_column: float) -> NDArray[np.float32]:
    """Return how much each cell is the centre of a bright band, in units of the texture beside it.

    `image` and `texture` (rows, columns) are of a bird's-eye view with `per_column` metres a column.
    """
    columns = image.shape[1]
    flank = max(1, round(FLANK / per_column))
    gap = max(1, round(GAP / per_column))
    halves = [max(1, round((width / per_column - 1) / 2)) for width in PAINT_WIDTHS]
    reach = max(halves) + gap + flank
    grey = cv2.copyMakeBorder(image, 0, 0, reach, reach, cv2.BORDER_REPLICATE)
    aside = round(TEXTURE_ASIDE / per_column)
    around = cv2.copyMakeBorder(texture, 0, 0, aside, aside, cv2.BORDER_REPLICATE)
    unit = 1 / (around + np.float32(SENSOR_NOISE))

    def means(width: int) -> Floats:
        """Return, at each padded column, the mean of `width` columns from there on."""
        return np.asarray(cv2.boxFilter(grey, cv2.CV_32F, (width, 1), anchor=(0, 0)))

    def at(values: Floats, first: int) -> Floats:
        """Return what the padded `values` are `first` columns aside of each column."""
        return values[:, reach + first : reach + first + columns]

    flanks = means(flank)
    best: Floats | None = None
    for half in halves:
        offset = half + gap + 1
        band = at(means(2 * half + 1), -half)
        left = cv2.multiply(cv2.subtract(band, at(flanks, -offset - flank + 1)), unit[:, :columns])
        right = cv2.multiply(cv2.subtract(band, at(flanks, offset)), unit[:, 2 * aside :])
        contrast = cv2.min(left, right)
        best = contrast if best is None else cv2.max(best, contrast)
    return np.asarray(best, dtype=np.float32)


def odd_cells(length: float, resolution: float) -> int:
    """Return an odd number of cells of about `length`."""
    return 2 * int(length / resolution / 2) + 1
