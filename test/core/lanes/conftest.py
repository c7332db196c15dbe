# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Painted roads: hand-made bird's-eye views of a flat, straight road with lines of known place and width."""

from collections.abc import Callable

import numpy as np
import pytest

from lane_dp_ros.core.birdseye.paint_map import band_graph
from lane_dp_ros.core.config import PaintMapConfig
from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.geometry.road_surface import RoadAxis, RoadSurface
from lane_dp_ros.core.lanes.evidence import line_evidence
from lane_dp_ros.core.types import BirdsEyeView, LaneEvidence, LaneLine, PaintMap, StereoFrame

CAMERA = StereoCamera(fx=721.5, fy=721.5, cx=609.6, cy=172.9, baseline=0.54)  # much like KITTI's
ASPHALT, PAINT = 90.0, 80.0  # grey levels; the paint's are added
RESOLUTION = (0.25, 0.05)  # metres a row and a column, the detector's default
NEAR, LENGTH, WIDTH = 4.0, 20.0, 10.0  # m: 80 rows, 200 columns


class PaintedRoad:
    """Grey values (rows, columns) to draw on, and the view of them."""

    def __init__(self, ground: float = ASPHALT, axis: RoadAxis | None = None, length: float = LENGTH) -> None:
        rows, columns = round(length / RESOLUTION[0]), round(WIDTH / RESOLUTION[1])
        self.s = NEAR + (np.arange(rows)[::-1] + 0.5) * RESOLUTION[0]
        self.n = (np.arange(columns) + 0.5) * RESOLUTION[1] - WIDTH / 2
        self.grey = np.full((rows, columns), float(ground))
        self.seen = np.ones((rows, columns), bool)
        self.height = np.zeros((rows, columns), np.float32)
        self.axis = RoadAxis() if axis is None else axis

    def line(self, n, width=0.15, brightness=PAINT, first=0.0, last=100.0, dash=(1.0, 0.0)):
        """Add a line with its centre at n [m] (a number, or a function of s) from s = first to last.

        `dash`: metres of paint and of gap. Cells that are covered in part get their share.
        """
        centre = np.broadcast_to(n(self.s) if callable(n) else n, self.s.shape)
        aside = np.abs(self.n - centre[:, None]) / RESOLUTION[1]
        covered = np.clip(width / RESOLUTION[1] / 2 + 0.5 - aside, 0, min(1, width / RESOLUTION[1]))
        along = (self.s >= first) & (self.s <= last) & ((self.s - first) % sum(dash) < dash[0])
        self.grey += brightness * covered * along[:, None]
        return self

    def step(self, n, brightness=PAINT):
        """Brighten everything right of n [m]."""
        self.grey[:, self.n > n] += brightness
        return self

    def grass(self, first, last, roughness, seed=0):
        """Roughen the ground between two n [m] by noise of that standard deviation [grey levels]."""
        noise = np.random.default_rng(seed).normal(0, roughness, self.grey.shape)
        self.grey += noise * ((self.n > first) & (self.n < last))
        return self

    def view(self) -> BirdsEyeView:
        """Return the bird's-eye view, 1.65 m below a camera that looks straight ahead."""
        surface = RoadSurface.plane(CAMERA, height=1.65, pitch=0.0)
        x, z = self.axis.to_ground(self.s[:, None], self.n[None])
        u, v = (a.astype(np.float32) for a in surface.ground_to_pixel(x, z))
        image = np.clip(np.rint(self.grey), 0, 255).astype(np.uint8)
        on_road = self.seen & ~(self.height > 0.12)
        return BirdsEyeView(
            image, self.seen, on_road, self.height, u, v, self.s, self.n, self.axis, surface, surface
        )

    def bands(self) -> tuple[BirdsEyeView, PaintMap]:
        """Return the view and its graph of bright bands."""
        view = self.view()
        return view, band_graph(view, PaintMapConfig())


@pytest.fixture(scope="session")
def painted_road() -> Callable[..., PaintedRoad]:
    """Return the maker of roads to paint on."""
    return PaintedRoad


@pytest.fixture
def evidence_of() -> Callable[..., LaneEvidence]:
    """Return a function: the evidence for a line on a road at n [m], from s = first to last."""

    def evidence_of(road, course=1.025, first=0.0, last=100.0):
        view, graph = road.bands()
        rows = np.flatnonzero((view.s >= first) & (view.s <= last))[::-1]
        s = view.s[rows]
        n = course(s) if callable(course) else np.full(len(s), course)
        mono = StereoFrame(view.image, None, view.height, view.surface, view.ground)
        return line_evidence(LaneLine(rows, s, n, bend=0.0, score=10.0), view, graph, mono)

    return evidence_of
