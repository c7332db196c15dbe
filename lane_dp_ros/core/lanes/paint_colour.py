# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""White or yellow: the colour of a line's paint, beside that of the grey road in the same light."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.birdseye.birds_eye import BirdsEyeView
from lane_dp_ros.core.birdseye.paint_profile import PAINTED
from lane_dp_ros.core.lanes.cross_section import DARK, MIN_PAINTED, SATURATED, row_medians
from lane_dp_ros.core.lanes.line_kind import PaintAlong
from lane_dp_ros.core.types import Image, PaintColour

Floats = NDArray[Any]
Cells = NDArray[np.intp]

ROAD_ASIDE = 0.35  # m from the line's centre, where the road is
YELLOW = 0.35  # log of red and green over blue, less that of the road: below 0.2 for white, 0.5 for yellow
POOR_LIGHT = 25.0  # grey levels; the brightest channel of darker paint is noise


def paint_colour(along: PaintAlong, view: BirdsEyeView, picture: Image) -> PaintColour:
    """Return the colour of a line's paint in the left `picture`, (H, W) grey or (H, W, 3) BGR.

    Empty where the picture shows none: it is grey, too dark, or burnt out on the road, too.
    """
    painted = along.cover > PAINTED
    if picture.ndim == 2 or np.count_nonzero(painted) < MIN_PAINTED:
        return ""
    aside = round(ROAD_ASIDE / view.resolution[1])
    cells = along.cells[painted] + np.array([[0], [-aside], [aside]])
    paint, left, right = _colours(picture, view, along.rows[painted], cells)
    road = np.concatenate([left, right])
    if _is_grey(paint) and _is_grey(road):
        return ""
    if _median(paint.max(axis=1)) < POOR_LIGHT or _median(road.min(axis=1)) > SATURATED:
        return ""
    return "yellow" if _yellowness(paint) - _yellowness(road) > YELLOW else "white"


def _colours(picture: Image, view: BirdsEyeView, rows: Cells, cells: Cells) -> Floats:
    """Return the colours (..., N, 3) BGR of the pixels nearest to cells (..., N) of the view in rows (N,)."""
    cells = np.minimum(np.maximum(cells, 0), len(view.n) - 1)
    u, v = (np.rint(each[rows, cells]).astype(np.intp) for each in (view.map_u, view.map_v))
    return picture[v, u].astype(np.float32)


def _is_grey(colours: Floats) -> bool:
    return bool((colours == colours[:, :1]).all())


def _yellowness(colours: Floats) -> float:
    """Return the median of log (red + green) / 2 over blue of colours (N, 3) BGR."""
    blue, green, red = colours.T
    return _median(np.log(((red + green) / 2 + DARK) / (blue + DARK)))


def _median(values: Floats) -> float:
    return float(row_medians(values[None])[0])
