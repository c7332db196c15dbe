# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What the stages of the pipeline hand to one another."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import ArrayLike, NDArray

from lane_dp_ros.core.geometry.road_axis import RoadAxis
from lane_dp_ros.core.geometry.road_surface import RoadSurface

Floats = NDArray[Any]

CENTRE_WINDOW = 0.15  # m to each side of a path; where the centre of its paint is
NO_PAINT = 1e-3  # squared feature; less is none


@dataclass(frozen=True)
class RoadEdges:
    """Edge pixels on the road, N of them.

    `u, v` [px]; `gradient_u, gradient_v` (3x3 Sobel, grey levels); on the ground `x, z` [m], the edge's
    `heading` [rad], positive to the right, and the `length` [m] of ground that the pixel stands for.
    """

    u: Floats
    v: Floats
    gradient_u: Floats
    gradient_v: Floats
    x: Floats
    z: Floats
    heading: Floats
    length: Floats


@dataclass(frozen=True)
class VanishingPoint:
    """Where the road's direction near the vehicle vanishes, in pixels of the left image.

    `u_of_row` are the coefficients, constant first, of the quartic u_vp(v) along the road ahead; empty
    where only the direction at the vehicle was estimated.
    """

    u: float
    v: float
    u_of_row: tuple[float, ...] = ()


@dataclass(frozen=True)
class StereoFrame:
    """The grey images (H, W), the right one where it is of use, and the left one's disparity (H, W) [px].

    For the others see `BirdsEyeView`.
    """

    left: NDArray[np.uint8]
    right: NDArray[np.uint8] | None
    disparity: NDArray[np.float32]
    surface: RoadSurface
    ground: RoadSurface


@dataclass(frozen=True)
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

    @property
    def cost(self) -> NDArray[np.float32]:
        """F = 1 - f, in [0, 1] (paper, section V-A)."""
        return 1 - self.feature


@dataclass(frozen=True)
class BirdsEyeView:
    """The left image seen from above.

    Cell (row, column) shows the ground at road coordinates s[row], n[column] [m] (see `RoadAxis`): row 0
    is the farthest, columns go from left to right. `ground` maps road to image; `surface` gives depth.
    They are the same but for the paper's formulas, whose flat `ground` is a little off the road.
    """

    image: NDArray[np.uint8]
    """(rows, columns), grey; beyond the left image its border repeated."""
    seen: NDArray[np.bool_]
    """Cells that the camera sees."""
    on_road: NDArray[np.bool_]
    """Cells that are seen and do not stand above the road."""
    height: NDArray[np.float32]
    """Height [m] above the road's surface, NaN where there is no disparity."""
    map_u: NDArray[np.float32]
    map_v: NDArray[np.float32]
    s: NDArray[np.float64]
    n: NDArray[np.float64]
    axis: RoadAxis
    ground: RoadSurface
    surface: RoadSurface

    @property
    def resolution(self) -> tuple[float, float]:
        """Metres per row and per column."""
        return float(self.s[0] - self.s[1]), float(self.n[1] - self.n[0])

    def warp(self, image: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """Return this view of any image of the left camera's size, grey or BGR; black where unseen."""
        warped = cv2.remap(image, self.map_u, self.map_v, cv2.INTER_LINEAR)
        warped[~self.seen] = 0
        return np.asarray(warped, dtype=np.uint8)

    def to_pixels(self, s: ArrayLike, n: ArrayLike) -> NDArray[np.float64]:
        """Return the pixels (N, 2) of the left image at road coordinates s, n (N,) [m]."""
        x, z = self.axis.to_ground(np.asarray(s, dtype=np.float64), np.asarray(n, dtype=np.float64))
        return np.column_stack(self.ground.ground_to_pixel(x, z))

    def to_points(self, s: ArrayLike, n: ArrayLike) -> NDArray[np.float64]:
        """Return points (N, 3) [m] of the road's surface, left optical frame, at road coordinates."""
        pixels = self.to_pixels(s, n)
        _, depth = self.surface.pixel_to_ground(pixels[:, 0], pixels[:, 1])
        return self.surface.camera.back_project(pixels, depth)

    def to_road(self, points: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return road coordinates s, n (N,) [m] of points (N, 3) [m] in the left optical frame."""
        u, v = self.surface.camera.project(points).T
        s, n = self.axis.from_ground(*self.ground.pixel_to_ground(u, v))
        return np.asarray(s), np.asarray(n)

    def columns(self, n: ArrayLike) -> NDArray[np.float64]:
        """Return the columns (N,), with fractions, of lateral positions n (N,) [m]."""
        return np.asarray((np.asarray(n) - self.n[0]) / self.resolution[1])

    def nearest_columns(self, n: ArrayLike) -> NDArray[np.intp]:
        """Return the columns (N,) of lateral positions n (N,) [m]; beyond the view those of its border."""
        return np.clip(np.rint(self.columns(n)).astype(np.intp), 0, len(self.n) - 1)

    def cells(self, points: ArrayLike) -> NDArray[np.float64]:
        """Return column and row (N, 2), with fractions, of points (N, 3) [m] in the left optical frame."""
        s, n = self.to_road(points)
        return np.column_stack([self.columns(n), (self.s[0] - s) / self.resolution[0]])

    def paint_centres(self, graph: PaintMap, rows: NDArray[Any], columns: Floats) -> tuple[Floats, Floats]:
        """Return the centre n [m] of the paint near cells (rows[i], columns[i]) and its weight in [0, 1].

        The centroid of the squared paint across the line; without paint the cell itself, weight 0.
        """
        half = round(CENTRE_WINDOW / self.resolution[1])
        centre, total = columns, np.zeros(len(columns))
        for _ in range(2):  # once more around the centre that was found: no paint is cut off on one side
            window = np.rint(centre).astype(int)[:, None] + np.arange(-half, half + 1)
            window = np.clip(window, 0, len(self.n) - 1)
            power = graph.paint[rows[:, None], window].astype(np.float64) ** 2
            total = power.sum(axis=1)
            centroid = (power * window).sum(axis=1) / np.maximum(total, NO_PAINT)
            centre = np.where(total > NO_PAINT, centroid, columns)
        return self.n[0] + centre * self.resolution[1], np.minimum(total, 1.0)


@dataclass(frozen=True)
class LanePath:
    """A path through the graph that may be a lane: cells (rows[i], columns[i]), from near to far, one a row.

    `columns` may have fractions; `score` is the evidence along it [m]: net metres of paint.
    """

    rows: NDArray[np.intp]
    columns: Floats
    score: float


@dataclass(frozen=True)
class LaneLine:
    """A smooth line n(s) through a path, in road coordinates [m], from near to far, one point a row."""

    rows: NDArray[np.intp]
    s: Floats
    n: Floats
    bend: float
    """Its curvature [1/m] against the road's axis."""
    score: float
    """Net metres of paint along it."""

    @property
    def length(self) -> float:
        """Length along the road [m]."""
        return float(self.s[-1] - self.s[0])


@dataclass(frozen=True)
class LaneEvidence:
    """What speaks for and against a line being paint, each in physical units."""

    paint_width: float
    """Width [m] of the bright band at half its contrast."""
    wide_band_ratio: float
    """Contrast of a 0.45 m band over that of a 0.15 m one: small for a line, near 1 for a verge."""
    height: float
    """Height [m] of the paint above the ground on the vehicle's side of it, NaN where it is not known.

    Where that ground is not known, above the one on the other side, else above the road's surface.
    """
    step: float
    """How much higher or lower [m] the ground on the other side is: a kerb's; 0 where it is not known."""
    slope: float
    """Steepest lateral over forward, against the road's axis."""
    off_paint_fraction: float
    """Share of the paint that it passes beside: that of one line lies on one smooth curve."""
    roughness: float
    """Texture beside the line, over brightness: asphalt is smooth, grass is not."""
    contrast: float
    """Weber contrast of the paint against the road on both sides of it."""
    saturation_contrast: float
    """The same rise as a share of that up to white: in glare even fresh paint has little contrast."""
    brightness: float
    """Brightness of the paint over that of the road towards the vehicle, less 1."""
    run: float
    """Longest piece of paint [m], short gaps bridged."""
    dashes: int
    """Number of pieces of paint that are long enough to be dashes."""
