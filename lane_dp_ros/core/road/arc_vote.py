# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The road's axis from the edges on it: the dense vanishing point as a heading and a curvature."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.geometry.road_axis import RoadAxis
from lane_dp_ros.core.road.edge_pixels import EdgePixels

Floats = NDArray[Any]

HEADING_STEP = np.deg2rad(0.5)
CURVATURE_STEP = 0.002  # 1/m
HEADING_SIGMA, CURVATURE_SIGMA = 0.2, 0.04  # rad, 1/m; a broad prior: roads mostly go straight ahead
PEAKS = 12  # of the vote, to be judged; then the neighbours of the best
PEAK_SHARE = 0.25  # of the highest vote; lower ones are no peaks
AGREEMENT = np.deg2rad(4.0)  # edges within this of the axis count as lines along it
OFFSET_BIN, OFFSET_MAX = 0.10, 9.0  # m; histogram of the lateral offsets of those lines
SHARPNESS = 3  # power of the histogram: one long line beats many short ones
MIN_EDGES = 20


def arc_of_edges(edges: EdgePixels, heading_max: float, curvature_max: float) -> RoadAxis:
    """Return the axis that the edges vote for; straight ahead where there are too few of them.

    For each curvature kappa an edge at (x, z) with heading phi votes for the heading, at the camera's
    foot, of the circle concentric with the one it is tangent to: theta = atan2(sin phi - kappa z, cos phi
    + kappa x). Votes weigh the edge's metric length and a broad prior. Of the vote's peaks the one is
    taken whose agreeing edges pile up highest in the histogram h of their lateral offsets, by sum h^3: a
    long painted line beats hatching, whose many stripes agree in direction but not in place.
    `heading_max` [rad] and `curvature_max` [1/m] bound the vote.
    """
    if len(edges.x) < MIN_EDGES:
        return RoadAxis()
    vote = _Vote(edges, heading_max, curvature_max)
    headings, curvatures = vote.peaks()
    if not len(headings):
        return RoadAxis()
    return vote.sharpest(*_neighbours(vote.sharpest(headings, curvatures)))


class _Vote:
    """The accumulator over curvature and heading, and the judge of its peaks."""

    def __init__(self, edges: EdgePixels, heading_max: float, curvature_max: float) -> None:
        self.x, self.z, self.length = (
            np.asarray(a, dtype=np.float32) for a in (edges.x, edges.z, edges.length)
        )
        self.cos, self.sin = (np.asarray(f(edges.heading), dtype=np.float32) for f in (np.cos, np.sin))
        self.curvatures = _grid(curvature_max, CURVATURE_STEP)
        self.headings = _grid(heading_max, HEADING_STEP)

    def peaks(self) -> tuple[Floats, Floats]:
        """Return headings and curvatures (N,) of the highest local maxima of the smoothed vote."""
        smooth = np.asarray(cv2.GaussianBlur(self._accumulate(), (0, 0), sigmaX=2.0, sigmaY=1.0))
        votes = smooth * self._prior(self.headings[None], self.curvatures[:, None])
        highest = (votes >= cv2.dilate(votes, np.ones((5, 9), np.uint8))) & (votes > PEAK_SHARE * votes.max())
        rows, columns = np.nonzero(highest)
        order = np.argsort(-votes[rows, columns])[:PEAKS]
        return self.headings[columns[order]], self.curvatures[rows[order]]

    def sharpest(self, headings: Floats, curvatures: Floats) -> RoadAxis:
        """Return the sharpest of axes (N,)."""
        best = int(self._sharpness(headings, curvatures).argmax())
        return RoadAxis(float(headings[best]), float(curvatures[best]))

    def _sharpness(self, headings: Floats, curvatures: Floats) -> Floats:
        """Return, of each axis (N,), sum h^3 over the lateral offsets of the edges that run along it."""
        theta, k = (np.asarray(a, np.float32)[:, None] for a in (headings, curvatures))
        cos, sin = np.cos(theta), np.sin(theta)
        along_x, along_z = self.sin - k * self.z, self.cos + k * self.x
        across = along_x * cos - along_z * sin
        agree = across**2 < np.float32(np.sin(AGREEMENT) ** 2) * (along_x**2 + along_z**2)
        # The offset of `RoadAxis`, by its form that has no difference of large radii.
        aside, squared = self.x * cos - self.z * sin, self.x**2 + self.z**2
        root = np.sqrt(np.maximum(1 - 2 * k * aside + k * k * squared, 0))
        offset = (2 * aside - k * squared) / (1 + root)
        axis, edge = np.nonzero(agree & (np.abs(offset) < np.float32(OFFSET_MAX)))
        size = round(2 * OFFSET_MAX / OFFSET_BIN)
        bins = ((offset[axis, edge] + np.float32(OFFSET_MAX)) * np.float32(1 / OFFSET_BIN)).astype(np.intp)
        cells = axis * size + np.minimum(bins, size - 1)
        counted = np.bincount(cells, self.length[edge], len(theta) * size).reshape(-1, size)
        histogram = counted + np.roll(counted, 1, axis=1)  # on the border of two bins it is one line
        return np.asarray((histogram**SHARPNESS).sum(axis=1) * self._prior(theta[:, 0], k[:, 0]))

    def _accumulate(self) -> Floats:
        """Return the votes (curvatures, headings), counted for all directions at once."""
        count, half, full = len(self.curvatures), len(self.headings) // 2, round(2 * np.pi / HEADING_STEP)
        k = self.curvatures.astype(np.float32)[:, None]
        angle: Floats = np.asarray(cv2.phase(self.cos + k * self.x, self.sin - k * self.z))  # 0 to 2 pi
        angle *= np.float32(1 / HEADING_STEP)
        angle += (np.arange(count, dtype=np.float32) * (full + 1))[:, None] + np.float32(0.5)
        weights = np.broadcast_to(self.length.astype(np.float64), angle.shape).ravel()
        counted = np.bincount(angle.astype(np.intp).ravel(), weights, count * (full + 1))
        votes = counted[: count * (full + 1)].reshape(count, full + 1)
        votes[:, 0] += votes[:, full]  # 2 pi is 0
        ahead = np.concatenate([votes[:, full - half : full], votes[:, : half + 1]], axis=1)
        return np.asarray(ahead, dtype=np.float32)

    def _prior(
        self, heading: NDArray[np.floating] | float, curvature: NDArray[np.floating] | float
    ) -> Floats:
        distance = (heading / HEADING_SIGMA) ** 2 + (curvature / CURVATURE_SIGMA) ** 2
        return np.asarray(np.exp(-0.5 * distance), dtype=np.float32)


def _neighbours(axis: RoadAxis) -> tuple[Floats, Floats]:
    """Return headings and curvatures (9,) of an axis and those half a cell of the smoothing around it."""
    dk, dt = (step.ravel() for step in np.mgrid[-1:2, -1:2])
    return axis.heading + dt * HEADING_STEP, axis.curvature + dk * CURVATURE_STEP


def _grid(limit: float, step: float) -> NDArray[np.float64]:
    """Return the multiples of `step` within +-limit."""
    half = int(limit / step + 1e-6)
    return np.asarray(step * np.arange(-half, half + 1), dtype=np.float64)
