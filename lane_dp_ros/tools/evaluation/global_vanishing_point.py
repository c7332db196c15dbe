# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Lanes by one global vanishing point: a reading of the detector that the paper compares itself with.

The paper says this much of Wang, Dahnoun, Achim 2012: "(except for tracking step). In this method, lanes are
detected based on VP estimation." No code of it is published. This is a fair attempt at that sentence, not
their program: what it measures is its own.

  1. Straight edge segments of the left image (Canny, Hough).
  2. One vanishing point for the whole image, where most of their length meets; no stereo, no profile.
  3. Lines are straight rays from it: each edge pixel that points to it votes for its ray.
  4. A lane line is a rising and a falling edge with a bright band of a paint's width between them, by support
     and brightness. No dynamic programming, no curve, no memory.

Two things come from the stereo road surface of lane_dp_ros.core, so that the same evaluation can judge the
lines: how wide a band is in metres, and where in space a ray runs over the road.

`lane_dp tables DATA...` prints it beside ours.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.detector import LaneDetector
from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.geometry.road_surface import RoadSurface
from lane_dp_ros.core.types import Image, StereoFrame

Floats = NDArray[Any]

NAME = "a reading of Wang '12"  # in tables

CANNY_LOW, CANNY_HIGH = 60, 120  # grey levels of a 3x3 Sobel after blurring
HOUGH_VOTES, MIN_LENGTH, MAX_GAP = 25, 25, 6  # px
FLATTEST = 0.15  # rise over run of a segment; kerbs of side roads and shadows lie flatter
VP_ROWS, VP_COLUMNS, VP_CELL = 60, 400, 2  # px about the principal point, where the vanishing point may be
VP_BLUR = 3.0  # cells: how far a segment may miss it
BELOW_VP = 12.0  # px; nearer to it rays cannot be told apart
AGREE = 0.12  # rad between an edge and its ray
HALF_WIDTH = 7.0  # m aside
BIN = 0.025  # m aside
WIDTHS = np.arange(0.075, 0.40, BIN)  # m of paint
MIN_SUPPORT = 10.0  # rows with both edges
MIN_BRIGHT = 0.6  # share of those rows where the band is brighter than both flanks
CONTRAST = 6.0  # grey levels
SPACING = 1.0  # m between two lines
MIN_PAINTED, MAX_GAP_AHEAD = 5.0, 12.5  # m; paint along a line, and the gap between two dashes
RANGE = (4.0, 30.0)  # m ahead
STEP = 0.4  # m between two points of a line


@dataclass(frozen=True)
class Edges:
    """Edge pixels that point to the vanishing point: row [px], `Rays.aside` [m], sign (+1 rising)."""

    v: Floats
    aside: Floats
    sign: Floats


@dataclass(frozen=True)
class Rays:
    """The vanishing point (u, v) [px], and the road by which its rays are told in metres."""

    u: float
    v: float
    road: RoadSurface

    def aside(self, u: Floats, v: Floats) -> Floats:
        """Return how far [m] right of the vanishing point's ground line the rays through pixels run."""
        return (u - self.u) / (v - self.v) * self.road.camera_height

    def columns(self, v: Floats, aside: Floats | float) -> Floats:
        """Return u [px] of rays at rows v."""
        return self.u + aside / self.road.camera_height * (v - self.v)


def lanes(left: Image, right: Image, camera: StereoCamera) -> list[Floats]:
    """Return lane lines (N, 3) [m], left optical frame, of a rectified pair, uint8 grey or BGR of equal size.

    Empty where nothing is found.
    """
    frame, detector = StereoFrame(left, right).grey(), LaneDetector(camera)
    road = detector.measure_road(frame, detector.match(frame))
    point = vanishing_point(frame.left, camera)
    if road is None or point is None:
        return []
    rays = Rays(*point, road)
    edges = _edges(frame.left, rays)
    found = [_line(frame.left, edges, rays, aside, width) for aside, width in _bands(edges)]
    return [line for line in found if line is not None]


def vanishing_point(grey: Image, camera: StereoCamera) -> tuple[float, float] | None:
    """Return the pixel (u, v) where most of the length of straight edges meets, None without any in view."""
    u1, v1, u2, v2 = _segments(grey, camera)
    if not len(u1):
        return None
    rows = camera.cy + np.arange(-VP_ROWS, VP_ROWS + 1, VP_CELL)
    crossing = u1 + (rows[:, None] - v1) * (u2 - u1) / (v2 - v1)
    column = np.floor((crossing - camera.cx + VP_COLUMNS) / VP_CELL).astype(np.intp)
    size = len(rows), 2 * VP_COLUMNS // VP_CELL
    inside = (column >= 0) & (column < size[1])
    if not inside.any():
        return None
    cell = np.arange(size[0])[:, None] * size[1] + column
    length = np.broadcast_to(np.hypot(u2 - u1, v2 - v1), cell.shape)
    votes = np.bincount(cell[inside], length[inside], size[0] * size[1]).reshape(size)
    row, best = divmod(int(cv2.GaussianBlur(votes, (0, 0), VP_BLUR).argmax()), size[1])
    return float(camera.cx - VP_COLUMNS + (best + 0.5) * VP_CELL), float(rows[row])


def _segments(grey: Image, camera: StereoCamera) -> Floats:
    """Return the ends u1, v1, u2, v2 (4, N) [px] of the straight edges below the principal point."""
    first = int(np.clip(camera.cy, 0, grey.shape[0] - 1))
    edges = cv2.Canny(cv2.GaussianBlur(grey[first:], (5, 5), 1.0), CANNY_LOW, CANNY_HIGH, L2gradient=True)
    found = cv2.HoughLinesP(edges, 1, np.pi / 180, HOUGH_VOTES, minLineLength=MIN_LENGTH, maxLineGap=MAX_GAP)
    if found is None:
        return np.empty((4, 0))
    u1, v1, u2, v2 = found.reshape(-1, 4).astype(np.float64).T
    steep = np.abs(v2 - v1) > FLATTEST * np.abs(u2 - u1)
    return np.stack([u1, v1 + first, u2, v2 + first])[:, steep]


def _edges(grey: Image, rays: Rays) -> Edges:
    first = int(np.clip(rays.v + BELOW_VP, 0, grey.shape[0] - 1))
    blurred = cv2.GaussianBlur(grey[first:], (5, 5), 1.0)
    sobel_u, sobel_v = cv2.Sobel(blurred, cv2.CV_16S, 1, 0), cv2.Sobel(blurred, cv2.CV_16S, 0, 1)
    rows, columns = np.nonzero(cv2.Canny(sobel_u, sobel_v, CANNY_LOW, CANNY_HIGH, L2gradient=True))
    g_u, g_v = (sobel[rows, columns].astype(np.float64) for sobel in (sobel_u, sobel_v))
    u, v = columns.astype(np.float64), rows + float(first)
    du, dv = u - rays.u, v - rays.v
    off = np.abs(g_u * du + g_v * dv) / (
        np.hypot(g_u, g_v) * np.hypot(du, dv)
    )  # sine of the angle to the ray
    aside = rays.aside(u, v)
    kept = (off < AGREE) & (np.abs(aside) < HALF_WIDTH)
    return Edges(v[kept], aside[kept], np.sign(g_u * dv - g_v * du)[kept])


def _bands(edges: Edges) -> list[tuple[float, float]]:
    """Return metres aside and width [m] of the bands between a rising and a falling edge, the best first."""
    rising, falling = (_histogram(edges, sign) for sign in (1, -1))
    shifts = np.rint(WIDTHS / BIN).astype(np.intp)
    bins = len(rising) - shifts[-1]
    support = np.stack([np.minimum(rising[:bins], falling[shift : shift + bins]) for shift in shifts])
    best, width = support.max(axis=0), WIDTHS[support.argmax(axis=0)]
    aside = -HALF_WIDTH + (np.arange(bins) + 0.5) * BIN + width / 2
    bands = []
    while best.max() >= MIN_SUPPORT:
        i = int(best.argmax())
        bands.append((float(aside[i]), float(width[i])))
        best[np.abs(aside - aside[i]) < SPACING] = 0
    return bands


def _histogram(edges: Edges, sign: int) -> Floats:
    """Return how many edges of a sign lie at each distance aside, smoothed over neighbouring bins."""
    chosen = edges.aside[edges.sign == sign]
    counts, _ = np.histogram(chosen, round(2 * HALF_WIDTH / BIN), (-HALF_WIDTH, HALF_WIDTH))
    return np.convolve(counts, [0.5, 1, 0.5], "same")


def _line(grey: Image, edges: Edges, rays: Rays, aside: float, width: float) -> Floats | None:
    """Return a ray as a line (N, 3) over all the road that is seen, None where its paint is dark or short."""
    rows = _rows(edges, rays, aside, width)
    if len(rows) < MIN_SUPPORT or _bright(grey, rays, rows, aside, width).mean() < MIN_BRIGHT:
        return None
    v = np.arange(rays.v + BELOW_VP, grey.shape[0] - 1, 0.25)
    u = rays.columns(v, aside)
    _, depth = rays.road.pixel_to_ground(u, v)
    seen = (u >= 0) & (u < grey.shape[1]) & (depth > RANGE[0]) & (depth < RANGE[1])
    if not seen.any():
        return None
    z = np.arange(depth[seen].min(), depth[seen].max(), STEP)
    v = np.interp(z, depth[seen][::-1], v[seen][::-1])
    if _painted_length(z, _bright(grey, rays, v, aside, width)) < MIN_PAINTED:
        return None
    return rays.road.camera.back_project(np.column_stack([rays.columns(v, aside), v]), z)


def _painted_length(z: Floats, bright: NDArray[np.bool_]) -> float:
    """Return the length [m] of the longest stretch of paint, the gaps between dashes bridged."""
    painted = z[np.convolve(bright, np.ones(5) / 5, "same") > 0.5]
    stretches = np.split(painted, np.flatnonzero(np.diff(painted) > MAX_GAP_AHEAD) + 1)
    return max(float(np.ptp(stretch)) if len(stretch) else 0.0 for stretch in stretches)


def _rows(edges: Edges, rays: Rays, aside: float, width: float) -> Floats:
    """Return the rows that have an edge on either side of a band."""
    pixel = rays.road.camera_height / (edges.v - rays.v)
    tolerance = np.maximum(1.5 * BIN, 1.2 * pixel)
    near_side = [np.abs(edges.aside - aside + sign * width / 2) < tolerance for sign in (1, -1)]
    rising, falling = near_side[0] & (edges.sign == 1), near_side[1] & (edges.sign == -1)
    return np.asarray(np.intersect1d(edges.v[rising], edges.v[falling]))


def _bright(grey: Image, rays: Rays, v: Floats, aside: float, width: float) -> NDArray[np.bool_]:
    """Return for each row whether a band is brighter than the road on both its sides."""
    pixels = (v - rays.v) * width / rays.road.camera_height
    centre, flank = rays.columns(v, aside), np.maximum(1.2 * pixels, 2.5)
    paint, left, right = (_at(grey, v, centre + shift * flank) for shift in (0, -1, 1))
    return (paint - left > CONTRAST) & (paint - right > CONTRAST)


def _at(grey: Image, v: Floats, u: Floats) -> Floats:
    """Return the grey levels at pixels, between them linearly."""
    found = cv2.remap(grey, u.astype(np.float32), v.astype(np.float32), cv2.INTER_LINEAR)
    return found.ravel().astype(np.float64)
