# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What lies under a line drawn through the paint map: centres of paint, runs of paint, metres of paint.

What many lines ask for is a map of the whole view, computed once and looked up.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.birdseye.birds_eye import BirdsEyeView
from lane_dp_ros.core.birdseye.paint_map import CENTRE_WINDOW, PaintMap

Floats = NDArray[Any]
Cells = NDArray[np.intp]

NO_PAINT = 1e-3  # squared feature; less is none
PAINTED = 0.5  # feature, or weight of a centre, above which a row shows paint
NEAR_LINE = 0.10  # m to each side of a line, where its paint is looked up
ON_LINE = 0.05  # m; the same, where the line itself has to lie on it


@dataclass(frozen=True, eq=False)
class PaintProfile:
    """A bird's-eye view and its paint map, to be looked up along lines.

    Lines are given by their rows (N,) and columns (N,), or lateral positions n (N,) [m], one a row.
    """

    view: BirdsEyeView
    paint_map: PaintMap

    def centres(self, rows: Cells, columns: Floats) -> tuple[Floats, Floats]:
        """Return the centre n [m] of the paint near cells (rows[i], columns[i]) and its weight in [0, 1].

        The centroid of the squared paint across the line; without paint the cell itself, weight 0.
        """
        total_of, centre_of = self._centroids
        last = len(self.view.n) - 1
        start = np.minimum(np.maximum(np.rint(columns).astype(np.intp), 0), last)
        centre = np.where(total_of[rows, start] > NO_PAINT, centre_of[rows, start], columns)
        # Once more around the centre that was found: no paint is cut off on one side.
        again = np.minimum(np.maximum(np.rint(centre).astype(np.intp), 0), last)
        total = total_of[rows, again]
        centre = np.where(total > NO_PAINT, centre_of[rows, again], columns)
        return self.view.n[0] + centre * self.view.resolution[1], np.minimum(total, 1.0)

    def feature(self, rows: Cells, columns: Cells) -> Floats:
        """Return the highest feature (N,) up to `NEAR_LINE` from each cell (rows[i], columns[i])."""
        return np.asarray(self._near_line[rows, columns])

    def feature_on_line(self, rows: Cells, columns: Cells) -> Floats:
        """Return the highest feature (N,) up to `ON_LINE` from each cell (rows[i], columns[i])."""
        return np.asarray(self._on_line[rows, columns])

    @cached_property
    def _centroids(self) -> tuple[Floats, Floats]:
        """The sum of the squared paint near each cell, and the column of its centroid."""
        width = 2 * round(CENTRE_WINDOW / self.view.resolution[1]) + 1
        power = self.paint_map.paint**2
        columns = np.arange(power.shape[1], dtype=np.float32)
        total, moment = (
            cv2.boxFilter(each, cv2.CV_64F, (width, 1), normalize=False, borderType=cv2.BORDER_REPLICATE)
            for each in (power, power * columns)
        )
        return total, moment / np.maximum(total, NO_PAINT)

    @cached_property
    def _near_line(self) -> Floats:
        return self._highest(NEAR_LINE)

    @cached_property
    def _on_line(self) -> Floats:
        return self._highest(ON_LINE)

    def _highest(self, aside: float) -> Floats:
        """Return the highest feature up to `aside` [m] from each cell of the view."""
        reach = round(aside / self.view.resolution[1])
        return np.asarray(cv2.dilate(self.paint_map.feature, np.ones((1, 2 * reach + 1), np.uint8)))


def paint_gain(paint: Floats, blank_cost: float) -> Floats:
    """Return what a metre of line adds to its score [net metres of paint] where it sees so much `paint`.

    The score of a line is the sum of this over its length. Each proposer has a `paint` in [0, 1] of its own:
    the feature under a path or half a line, whether a dash is there, for parallels an averaged contrast.
    A path pays for its slope and bends on top.
    """
    return np.asarray(paint - blank_cost)


def runs_of(rows: NDArray[np.bool_]) -> Cells:
    """Return the runs (N, 2) of true rows: the first one of each, and the one after its last."""
    padded = np.zeros(len(rows) + 2, bool)
    padded[1:-1] = rows
    return np.flatnonzero(padded[1:] != padded[:-1]).reshape(-1, 2)
