# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Cameras, roads drawn from their geometry, a rendered stereo pair, and input that must not crash a stage."""

from collections.abc import Callable
from dataclasses import replace

import cv2
import numpy as np
import pytest

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.geometry.road_surface import RoadAxis, RoadSurface
from lane_dp_ros.scenes import Road, ScenePair, render_pair

SHAPE = (300, 640)  # rows, columns of the drawn pictures
ASPHALT, PAINT = 90, 200  # grey levels
PAINT_WIDTH = 0.15  # m
SCENES = {
    "straight": Road(swing=0, pitch=0.03, camera_height=1.5),
    "left": Road(curvature=-0.008, swing=0),
    "right": Road(curvature=0.006, swing=0),
}
NOISE = np.random.default_rng(0)
AWKWARD_IMAGES = {
    f"{name}-{rows}x{columns}": image
    for rows, columns in [(1, 1), (2, 3), (7, 200), (400, 5), (30, 300), (150, 400)]
    for name, image in {
        "black": np.zeros((rows, columns), np.uint8),
        "white": np.full((rows, columns), 255, np.uint8),
        "noise": NOISE.integers(0, 256, (rows, columns), np.uint8),
    }.items()
}


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
def disparity_of() -> Callable[..., np.ndarray]:
    """Return a function: the disparity picture of a road without anything on it, NaN above the horizon."""

    def disparity_of(surface: RoadSurface, shape: tuple[int, int] = SHAPE) -> np.ndarray:
        v, u = np.mgrid[: shape[0], : shape[1]].astype(np.float32)
        disparity = surface.disparity(u, v)
        return np.where(disparity > 0, disparity, np.nan).astype(np.float32)

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


@pytest.fixture(scope="session", params=SCENES, ids=str)
def scene(request) -> tuple[Road, ScenePair]:
    """A rendered stereo pair, grey, and the road in it: all is known exactly."""
    road = SCENES[request.param]
    pair = render_pair(road, 50.0, 3)
    left, right = (cv2.cvtColor(image, cv2.COLOR_BGR2GRAY) for image in (pair.left, pair.right))
    return road, replace(pair, left=left, right=right)


@pytest.fixture(params=AWKWARD_IMAGES, ids=str)
def awkward_image(request) -> np.ndarray:
    """Nothing to be seen, or hardly a picture."""
    return AWKWARD_IMAGES[request.param]


@pytest.fixture(params=[np.nan, 0.0, -5.0, 20.0, 1e5, np.inf], ids=str)
def awkward_disparity(request) -> float:
    """What a whole disparity picture may hold, in pixels."""
    return request.param


@pytest.fixture(params=[-1e6, 0.0, 60.0, 1e6], ids=lambda cy: f"cy={cy:g}")
def awkward_camera(request) -> StereoCamera:
    """A camera whose principal point may lie far outside the image."""
    return StereoCamera(fx=700.0, fy=690.0, cx=200.0, cy=request.param, baseline=0.5)
