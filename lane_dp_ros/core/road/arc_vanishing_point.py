# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The road's axis from the edges on it: the dense vanishing point as a heading and a curvature."""

from __future__ import annotations

import math
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.config import VanishingPointConfig
from lane_dp_ros.core.geometry.road_axis import RoadAxis
from lane_dp_ros.core.types import RoadEdges

Floats = NDArray[Any]

HEADING_STEP = np.deg2rad(0.5)
CURVATURE_STEP = 0.002  # 1/m
HEADING_SIGMA, CURVATURE_SIGMA = 0.2, 0.04  # rad, 1/m; a broad prior: roads mostly go straight ahead
PEAKS = 12  # of the vote, to be judged
PEAK_SHARE = 0.25  # of the highest vote; lower ones are no peaks
AGREEMENT = np.deg2rad(4.0)  # edges within this of the axis count as lines along it
OFFSET_BIN, OFFSET_MAX = 0.10, 9.0  # m; histogram of the lateral offsets of those lines
SHARPNESS = 3  # power of the histogram: one long line beats many short ones
MIN_EDGES = 20


def road_axis(edges: RoadEdges, config: VanishingPointConfig) -> RoadAxis:
    """Return the axis that the edges vote for; straight ahead where there are too few of them.

    For each curvature kappa an edge at (x, z) with heading phi votes for the heading, at the camera's
    foot, of the circle concentric with the one it is tangent to: theta = atan2(sin phi - kappa z, cos phi
    + kappa x). Votes weigh the edge's metric length and a broad prior. Of the vote's peaks the one is
    taken whose agreeing edges pile up highest in the histogram h of their lateral offsets, by sum h^3: a
    long painted line beats hatching, whose many stripes agree in direction but not in place.
    """
    if len(edges.x) < MIN_EDGES:
        return RoadAxis()
    vote = _Vote(edges, config)
    peaks = vote.peaks()
    return max(peaks, key=vote.sharpness) if peaks else RoadAxis()


class _Vote:
    """The accumulator over curvature and heading, and the judge of its peaks."""

    def __init__(self, edges: RoadEdges, config: VanishingPointConfig) -> None:
        self.config = config
        self.x, self.z, self.length = (
            np.asarray(a, dtype=np.float32) for a in (edges.x, edges.z, edges.length)
        )
        self.cos, self.sin = (np.asarray(f(edges.heading), dtype=np.float32) for f in (np.cos, np.sin))
        self.curvatures = _grid(config.curvature_max, CURVATURE_STEP)
        self.headings = _grid(config.heading_max, HEADING_STEP)

    def peaks(self) -> list[RoadAxis]:
        """Return the highest local maxima of the smoothed vote, each with its neighbours half around it."""
        smooth = np.asarray(cv2.GaussianBlur(self._accumulate(), (0, 0), sigmaX=2.0, sigmaY=1.0))
        votes = smooth * self._prior(self.headings[None], self.curvatures[:, None])
        highest = (votes >= cv2.dilate(votes, np.ones((5, 9), np.uint8))) & (votes > PEAK_SHARE * votes.max())
        rows, columns = np.nonzero(highest)
        order = np.argsort(-votes[rows, columns])[:PEAKS]
        return [
            RoadAxis(
                float(self.headings[column] + dt * HEADING_STEP),
                float(self.curvatures[row] + dk * CURVATURE_STEP),
            )
            for row, column in zip(rows[order], columns[order], strict=True)
            for dk in (-1, 0, 1)
            for dt in (-1, 0, 1)
        ]

    def sharpness(self, axis: RoadAxis) -> float:
        """Return sum h^3 over the lateral offsets of the edges that run along the axis."""
        along_x = self.sin - axis.curvature * self.z
        along_z = self.cos + axis.curvature * self.x
        across = along_x * math.cos(axis.heading) - along_z * math.sin(axis.heading)
        agree = np.flatnonzero(across**2 < np.sin(AGREEMENT) ** 2 * (along_x**2 + along_z**2))
        offset = axis.offset(self.x[agree], self.z[agree])
        bins = ((offset + OFFSET_MAX) / OFFSET_BIN).astype(np.intp)
        inside = np.abs(offset) < OFFSET_MAX
        size = round(2 * OFFSET_MAX / OFFSET_BIN)
        histogram = np.bincount(bins[inside], self.length[agree][inside], size)[:size]
        histogram += np.roll(histogram, 1)  # a line on the border of two bins is one line
        return float((histogram**SHARPNESS).sum() * self._prior(axis.heading, axis.curvature))

    def _accumulate(self) -> Floats:
        votes = np.zeros((len(self.curvatures), len(self.headings)), np.float32)
        half, half_turn = len(self.headings) // 2, round(np.pi / HEADING_STEP)
        middle = slice(half_turn - half, half_turn + half + 1)
        length = self.length.astype(np.float64)  # what bincount makes of it, once
        for row, curvature in enumerate(self.curvatures.astype(np.float32)):
            heading = np.arctan2(self.sin - curvature * self.z, self.cos + curvature * self.x)
            column = np.rint(heading / np.float32(HEADING_STEP)).astype(np.intp) + half_turn
            # Counting every direction takes half the time of choosing the edges within heading_max first.
            votes[row] = np.bincount(column, length, 2 * half_turn + 1)[middle]
        return votes

    def _prior(
        self, heading: NDArray[np.floating] | float, curvature: NDArray[np.floating] | float
    ) -> Floats:
        distance = (heading / HEADING_SIGMA) ** 2 + (curvature / CURVATURE_SIGMA) ** 2
        return np.asarray(np.exp(-0.5 * distance), dtype=np.float32)


def _grid(limit: float, step: float) -> NDArray[np.float64]:
    """Return the multiples of `step` within +-limit."""
    half = int(limit / step + 1e-6)
    return np.asarray(step * np.arange(-half, half + 1), dtype=np.float64)
