# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Cameras, roads drawn from their geometry, a rendered stereo pair, and input that must not crash a stage."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import product
from typing import Any, NamedTuple

import cv2
import numpy as np
import pytest
from hypothesis import strategies as st

from lane_dp_ros.core.birdseye.birds_eye import BirdsEyeView
from lane_dp_ros.core.birdseye.edge_map import edge_map
from lane_dp_ros.core.birdseye.paint_map import BandsPaintMap, PaintMapConfig
from lane_dp_ros.core.birdseye.paint_profile import PaintProfile
from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.geometry.disparity_map import DisparityMap
from lane_dp_ros.core.geometry.quadratic_surface import QuadraticSurface
from lane_dp_ros.core.geometry.road_axis import RoadAxis
from lane_dp_ros.core.geometry.road_surface import RoadSurface
from lane_dp_ros.core.lanes.candidate import LaneEvidence, LaneLine
from lane_dp_ros.core.lanes.evidence import EvidenceSource, measure_paint
from lane_dp_ros.core.types import StereoFrame
from lane_dp_ros.scenes import Road, ScenePair, render_pair

SHAPE = (300, 640)  # rows, columns of the drawn pictures
ASPHALT, PAINT = 90, 200  # grey levels
PAINT_WIDTH = 0.15  # m
SCENES = {
    "straight": Road(swing=0, pitch=0.03, camera_height=1.5),
    "left": Road(curvature=-0.008, swing=0),
    "right": Road(curvature=0.006, swing=0),
}


@dataclass(frozen=True)
class ParabolicRoad(Road):
    """A road on a parabola of the curvature `bend` [1/m] along it, positive in a sag, negative on a crest."""

    bend: float = 0.0

    @property
    def is_flat(self) -> bool:
        """See `Road`."""
        return False

    def level(self, s: np.ndarray, n: np.ndarray, position: float) -> np.ndarray:
        """See `Road`."""
        return self.bend / 2 * (s - position) ** 2 + np.zeros_like(n)

    def _climb(self, s: Any) -> Any:
        return self.bend * s


class Awkward(NamedTuple):
    """Nothing to be seen, or hardly a picture; no stage may break on it."""

    image: np.ndarray  # (H, W) uint8
    disparity: DisparityMap  # (H, W) float32
    camera: StereoCamera  # whose principal point may lie far outside the image


def _awkward(shape: tuple[int, int], content: str, disparity: float, cy: float) -> Awkward:
    image = {
        "black": np.zeros(shape, np.uint8),
        "white": np.full(shape, 255, np.uint8),
        "noise": np.random.default_rng(0).integers(0, 256, shape, np.uint8),
    }[content]
    camera = StereoCamera(fx=700.0, fy=690.0, cx=200.0, cy=cy, baseline=0.5)
    return Awkward(image, DisparityMap(shape, 0, np.full(shape, disparity, np.float32)), camera)


AWKWARD = product(
    [(1, 1), (2, 3), (7, 200), (400, 5), (30, 300), (150, 400)],
    ["black", "white", "noise"],
    [np.nan, 0.0, -5.0, 20.0, 1e5, np.inf],
    [-1e6, 0.0, 60.0, 1e6],
)


@pytest.fixture(scope="session")
def camera() -> StereoCamera:
    """A camera with nothing equal or zero that might be: fx != fy, an offset, a frame beside the lens."""
    return StereoCamera(
        fx=700.0,
        fy=650.0,
        cx=330.0,
        cy=120.0,
        baseline=0.5,
        disparity_offset=3.5,
        left_translation=(0.06, -0.002, 0.004),
    )


@pytest.fixture(scope="session")
def disparity_of() -> Callable[..., DisparityMap]:
    """Return a function: the disparity of a road without anything on it, NaN above the horizon.

    It is matched in cells of `cell` px, by default at full resolution: `matched` is to be drawn on.
    """

    def disparity_of(surface: RoadSurface, shape: tuple[int, int] = SHAPE, cell: int = 1) -> DisparityMap:
        empty = DisparityMap(shape, 0, np.zeros((shape[0] // cell, shape[1] // cell), np.float32), cell)
        u, v = np.meshgrid(*empty.centres)
        disparity = surface.disparity(u, v)
        return replace(empty, matched=np.where(disparity > 0, disparity, np.nan).astype(np.float32))

    return disparity_of


@pytest.fixture(scope="session")
def picture_of() -> Callable[..., np.ndarray]:
    """Return a function: the grey picture of painted lines at `offsets` n [m] along a road's axis."""

    def picture_of(surface: RoadSurface, axis: RoadAxis, offsets: tuple[float, ...]) -> np.ndarray:
        picture = np.full(SHAPE, ASPHALT, np.uint8)
        s = np.arange(2.0, 60.0, 0.25)
        for n in offsets:
            sides = [(s, n - PAINT_WIDTH / 2), (s[::-1], n + PAINT_WIDTH / 2)]
            ground = np.hstack([axis.to_ground(s, np.full_like(s, n)) for s, n in sides])
            pixels = np.column_stack(surface.ground_to_pixel(*ground))
            fixed_point = np.rint(pixels * 16).astype(np.int32)
            cv2.fillPoly(picture, [fixed_point], PAINT, lineType=cv2.LINE_AA, shift=4)
        return picture

    return picture_of


@pytest.fixture(scope="session")
def right_of() -> Callable[..., np.ndarray]:
    """Return a function: the right camera's picture of what the left one shows of a surface without roll."""

    def right_of(left: np.ndarray, surface: RoadSurface) -> np.ndarray:
        v, u = np.indices(left.shape, dtype=np.float32)
        shift = surface.disparity(u, v) + surface.camera.disparity_offset
        return cv2.remap(left, (u + shift).astype(np.float32), v, cv2.INTER_LINEAR, borderValue=ASPHALT)

    return right_of


@pytest.fixture(scope="session")
def hill_of(rendered) -> Callable[[float], ScenePair]:
    """Return a function: the rendered pair, grey, of a road 1.65 m below the camera on a parabola."""

    def hill_of(bend: float) -> ScenePair:
        return _grey(rendered(render_pair, ParabolicRoad(swing=0, bend=bend), 50.0, 3))

    return hill_of


@pytest.fixture(scope="session", params=SCENES, ids=str)
def scene(request, rendered) -> tuple[Road, ScenePair]:
    """A rendered stereo pair, grey, and the road in it: all is known exactly."""
    road = SCENES[request.param]
    return road, _grey(rendered(render_pair, road, 50.0, 3))


def _grey(pair: ScenePair) -> ScenePair:
    left, right = (cv2.cvtColor(image, cv2.COLOR_BGR2GRAY) for image in (pair.left, pair.right))
    return replace(pair, left=left, right=right)


@pytest.fixture(scope="session")
def awkward() -> st.SearchStrategy[Awkward]:
    """Return the strategy that draws `Awkward` input, all alike often."""
    return st.sampled_from(list(AWKWARD)).map(lambda values: _awkward(*values))


PAINTED_CAMERA = StereoCamera(fx=721.5, fy=721.5, cx=609.6, cy=172.9, baseline=0.54)  # much like KITTI's
ADDED = 80.0  # grey levels that paint adds
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

    def line(self, n, width=0.15, brightness=ADDED, first=0.0, last=100.0, dash=(1.0, 0.0)):
        """Add a line with its centre at n [m] (a number, or a function of s) from s = first to last.

        `dash`: metres of paint and of gap. Cells that are covered in part get their share.
        """
        centre = np.broadcast_to(n(self.s) if callable(n) else n, self.s.shape)
        aside = np.abs(self.n - centre[:, None]) / RESOLUTION[1]
        covered = np.clip(width / RESOLUTION[1] / 2 + 0.5 - aside, 0, min(1, width / RESOLUTION[1]))
        along = (self.s >= first) & (self.s <= last) & ((self.s - first) % sum(dash) < dash[0])
        self.grey += brightness * covered * along[:, None]
        return self

    def step(self, n, brightness=ADDED):
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
        surface = QuadraticSurface.plane(PAINTED_CAMERA, height=1.65, pitch=0.0)
        x, z = self.axis.to_ground(self.s[:, None], self.n[None])
        u, v = (a.astype(np.float32) for a in surface.ground_to_pixel(x, z))
        image = np.clip(np.rint(self.grey), 0, 255).astype(np.uint8)
        on_road = self.seen & ~(self.height > 0.12)
        return BirdsEyeView(
            image, self.seen, on_road, self.height, u, v, self.s, self.n, self.axis, surface, surface
        )

    def bands(self) -> PaintProfile:
        """Return the view with its map of bright bands."""
        view = self.view()
        return PaintProfile(view, BandsPaintMap(PaintMapConfig()).build(view))


@pytest.fixture(scope="session")
def painted_road() -> Callable[..., PaintedRoad]:
    """Return the maker of roads to paint on."""
    return PaintedRoad


@pytest.fixture
def evidence_of() -> Callable[..., LaneEvidence]:
    """Return a function: the evidence for a line on a road at n [m], from s = first to last."""

    def evidence_of(road, course=1.025, first=0.0, last=100.0):
        paint = road.bands()
        rows = np.flatnonzero((paint.view.s >= first) & (paint.view.s <= last))[::-1]
        s = paint.view.s[rows]
        n = course(s) if callable(course) else np.full(len(s), course)
        line, mono = LaneLine(rows, s, n, bend=0.0, score=10.0), StereoFrame(paint.view.image)
        source = EvidenceSource(paint, edge_map(paint.view, paint.paint_map), mono)
        (found,) = measure_paint([line], source, lambda *_: True)
        return found

    return evidence_of
