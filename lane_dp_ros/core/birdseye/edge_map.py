# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Where the carriageway may end: steps of height and of brightness in the bird's-eye view."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.birdseye.birds_eye import BirdsEyeView
from lane_dp_ros.core.birdseye.paint_map import SENSOR_NOISE, PaintMap, odd_cells

Floats = NDArray[Any]
Singles = NDArray[np.float32]

CELL = (1.0, 0.2)  # m along and across of a cell, as near as whole cells of the view come to it
# Strips of ground beside a border: how far [m] aside their middles lie, how long and broad [m] they are.
NEAR = 0.3, (1.25, 0.3)
FAR = 0.75, (2.0, 0.9)
DARK = 10.0  # grey levels; keeps ratios of dark pictures sane
SURE_RISE = 0.1  # m; a step of height that is a border for certain, next to the vehicle
DISPARITY_NOISE = 0.25  # px, of a strip's mean disparity
SURE = 1.5  # of both together, in units of either
KNOWN = 0.3  # share of a strip whose height is known
SURE_STEP = 3.0  # units of texture and noise; a step of brightness that is a border for certain
CENTRED = 2  # cells to each side of a path, in which the centre of its border is
NO_EDGE = 1e-6  # squared feature; less is none
HIGHEST = 0.3  # m; what stands higher is as certain


@dataclass(frozen=True, eq=False)
class EdgeMap:
    """How much each cell (rows, columns) of a view, made coarser, looks like the border of the carriageway.

    `feature` is in [0, 1]. Steps lead away from the vehicle: `rise` [m] is how much higher the ground is
    behind the cell than before it, NaN where that is not known; `grey_step` how much brighter, over
    brightness; `texture_step` by what factor, as a logarithm, rougher.
    """

    feature: Singles
    seen: NDArray[np.bool_]
    rise: Singles
    grey_step: Singles
    texture_step: Singles
    far_rise: Singles
    far_grey_step: Singles
    far_texture_step: Singles
    """The same steps between broader strips, farther aside."""
    ground: Singles
    """Height [m] of the broader strip before the cell, NaN where it is not known."""
    s: NDArray[np.float64]
    n: NDArray[np.float64]
    """Road coordinates [m] of the rows, far to near, and of the columns, left to right."""

    @property
    def resolution(self) -> tuple[float, float]:
        """Metres per row and per column."""
        return float(self.s[0] - self.s[1]), float(self.n[1] - self.n[0])

    def cells(self, s: Floats, n: Floats) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Return rows and columns (N,) of the cells nearest to road coordinates s, n (N,) [m]."""
        per_row, per_column = self.resolution
        rows = np.clip(np.rint((self.s[0] - s) / per_row), 0, len(self.s) - 1)
        columns = np.clip(np.rint((n - self.n[0]) / per_column), 0, len(self.n) - 1)
        return rows.astype(np.intp), columns.astype(np.intp)

    def centres(self, rows: NDArray[np.intp], columns: Floats) -> tuple[Floats, Floats]:
        """Return n (N,) [m] of the border near cells (rows[i], columns[i]) and its weight in [0, 1].

        The centroid of the squared feature across the line; without any the cell itself, weight 0.
        """
        near = np.rint(columns).astype(np.intp)[:, None] + np.arange(-CENTRED, CENTRED + 1)
        near = np.clip(near, 0, len(self.n) - 1)
        power = self.feature[rows[:, None], near] ** 2
        total = power.sum(axis=1)
        centre = np.where(total > 0, (power * near).sum(axis=1) / np.maximum(total, NO_EDGE), columns)
        return self.n[0] + centre * self.resolution[1], np.minimum(total, 1.0)


def edge_map(view: BirdsEyeView, paint_map: PaintMap) -> EdgeMap:
    """Return the map of a view, on a coarser grid; the steps beside what its `paint_map` shows are none."""
    cell = [max(1, round(size / of)) for size, of in zip(CELL, view.resolution, strict=True)]
    rows, columns = view.image.shape[0] // cell[0], view.image.shape[1] // cell[1]
    part = slice(rows * cell[0]), slice(columns * cell[1])
    s = view.s[part[0]].reshape(rows, -1).mean(axis=1)
    n = view.n[part[1]].reshape(columns, -1).mean(axis=1)
    grey, rough, paint, height, known, seen = (
        cv2.resize(values[part].astype(np.float32), (columns, rows), interpolation=cv2.INTER_AREA)
        for values in (view.image, paint_map.texture, paint_map.feature, *_heights(view), view.seen)
    )
    cell_size = float(s[0] - s[1]), float(n[1] - n[0])
    near, far = (_Strips(n, cell_size, *each) for each in (NEAR, FAR))
    greys, roughs = (near.before_and_behind(values) for values in (grey, rough))
    far_greys, far_roughs = (far.before_and_behind(values) for values in (grey, rough))
    _, rise = near.ground_and_rise(height, known)
    ground, far_rise = far.ground_and_rise(height, known)
    step = np.abs(greys[1] - greys[0]) / (roughs[0] + SENSOR_NOISE)
    step *= 1 - cv2.dilate(paint, np.ones((1, 3), np.uint8))
    feature = np.minimum(np.abs(np.nan_to_num(rise)) / _sure_rise(view, s)[:, None], 1)
    feature = (feature + np.minimum(step / SURE_STEP, 1)) / SURE
    return EdgeMap(
        feature=np.where(seen > 0.5, np.minimum(feature, 1), 0).astype(np.float32),
        seen=seen > 0.5,
        rise=rise,
        grey_step=_grey_step(*greys),
        texture_step=_texture_step(*roughs),
        far_rise=far_rise,
        far_grey_step=_grey_step(*far_greys),
        far_texture_step=_texture_step(*far_roughs),
        ground=ground,
        s=s,
        n=n,
    )


class _Strips:
    """The strips of road beside each cell, `aside` [m] to the vehicle's side and to the other one.

    `size` [m] is how far they reach along and across.
    """

    def __init__(self, n: Floats, cell: tuple[float, float], aside: float, size: tuple[float, float]) -> None:
        self._left = n < 0
        self._window = odd_cells(size[1], cell[1]), odd_cells(size[0], cell[0])
        self._aside = max(1, round(aside / cell[1]))

    def before_and_behind(self, values: Floats) -> tuple[Floats, Floats]:
        """Return the mean of the strip before and behind each cell, seen from the vehicle."""
        aside, columns = self._aside, values.shape[1]
        mean = cv2.copyMakeBorder(cv2.blur(values, self._window), 0, 0, aside, aside, cv2.BORDER_REPLICATE)
        to_left, to_right = mean[:, :columns], mean[:, 2 * aside :]
        return np.where(self._left, to_right, to_left), np.where(self._left, to_left, to_right)

    def ground_and_rise(self, height: Floats, known: Floats) -> tuple[Singles, Singles]:
        """Return the height before, and how much more it is behind, by the `known` share of the cells.

        NaN where too few are known.
        """
        sums, shares = self.before_and_behind(height), self.before_and_behind(known)
        with np.errstate(invalid="ignore", divide="ignore"):
            before, behind = (
                np.where(share > KNOWN, total / share, np.nan)
                for total, share in zip(sums, shares, strict=True)
            )
        return np.asarray(before, np.float32), np.asarray(behind - before, np.float32)


def _grey_step(before: Floats, behind: Floats) -> Singles:
    """Return how much brighter it is behind each cell, over brightness."""
    return np.asarray((behind - before) / (before + DARK), np.float32)


def _texture_step(before: Floats, behind: Floats) -> Singles:
    """Return by what factor, as a logarithm, it is rougher behind each cell."""
    return np.asarray(np.log((behind + SENSOR_NOISE) / (before + SENSOR_NOISE)), np.float32)


def _heights(view: BirdsEyeView) -> tuple[Floats, NDArray[np.bool_]]:
    """Return the heights (rows, columns) [m], 0 where they are not known, and where they are."""
    known = np.isfinite(view.height) & view.seen
    return np.where(known, np.clip(view.height, -HIGHEST, HIGHEST), 0), known


def _sure_rise(view: BirdsEyeView, s: Floats) -> Floats:
    """Return how high (rows,) [m] a step is that is a border for certain, by the noise of the disparity."""
    surface = view.road_surface
    per_pixel = surface.camera_height / (surface.camera.fx * surface.camera.baseline) * s
    return np.asarray(SURE_RISE + 2 * DISPARITY_NOISE * per_pixel)
