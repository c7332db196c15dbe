# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The pictures show each lane beside its paint, never over it, and leave the input as it is."""

import dataclasses

import numpy as np
import pytest

from lane_dp_ros.core.birdseye.birds_eye import BirdsEyeConfig, birds_eye_view
from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.geometry.disparity_map import DisparityMap
from lane_dp_ros.core.geometry.quadratic_surface import QuadraticSurface
from lane_dp_ros.core.geometry.road_axis import RoadAxis
from lane_dp_ros.core.types import Lane
from lane_dp_ros.messages.pictures import PIXELS_PER_METRE, draw_birds_eye, draw_overlay

HEIGHT = 1.65  # m, the camera above the road
CAMERA = StereoCamera(fx=720.0, fy=720.0, cx=620.0, cy=180.0, baseline=0.54)
SHAPE = (376, 1241)
Z = np.arange(7.0, 30.0, 0.5)


def lane(x: float, role: str, **changes: object) -> Lane:
    points = np.column_stack([np.full_like(Z, x), np.full_like(Z, HEIGHT), Z])
    return dataclasses.replace(Lane(points, 0.9, 0.15, role, 0.0, x, id=4), **changes)


def birds_eye(image: np.ndarray):
    surface = QuadraticSurface.plane(CAMERA, HEIGHT, pitch=0.0)
    config = BirdsEyeConfig(near=4.0, length=30.0, width=12.0)
    return birds_eye_view(image, DisparityMap.unknown(SHAPE), surface, RoadAxis(), config)


@pytest.mark.parametrize("shape", [SHAPE, (*SHAPE, 3)])
def test_overlay_outlines_the_paint_and_leaves_it_visible(shape: tuple[int, ...]) -> None:
    image = np.full(shape, 80, np.uint8)
    picture = draw_overlay(image, [lane(1.8, "ego_right")], CAMERA)
    assert picture.shape == (*SHAPE, 3)
    assert picture.dtype == np.uint8
    assert np.all(image == 80)
    at_12_m = round(float(CAMERA.project([[1.8, HEIGHT, 12.0]])[0, 1]))
    changed = np.flatnonzero((picture[at_12_m] != 80).any(axis=1))
    centre = CAMERA.project([[1.8, HEIGHT, 12.0]])[0, 0]
    half_paint = 0.075 * CAMERA.fx / 12.0
    assert np.all(np.abs(changed - centre) > half_paint - 0.5)  # the paint is free,
    assert np.all(np.abs(changed - centre) < half_paint + 6)  # the outline is close to it
    assert (changed < centre).any()
    assert (changed > centre).any()


def test_roles_have_their_own_colours() -> None:
    image = np.zeros(SHAPE, np.uint8)
    pictures = [draw_overlay(image, [lane(0.0, role)], CAMERA) for role in ("ego_left", "ego_right", "other")]
    rows = [picture[190:240].reshape(-1, 3).max(axis=0).argmax() for picture in pictures]
    assert rows[0] == 1  # green
    assert rows[1] == 0  # blue
    assert rows[2] == 2  # yellow, red strongest


def violet(picture: np.ndarray) -> np.ndarray:
    """Where a picture has the colour of road edges, on black or grey."""
    blue, green, red = np.moveaxis(picture.astype(int), 2, 0)
    return (blue - green > 60) & (red - green > 50)


def road_edge(x: float, role: str) -> Lane:
    return lane(x, role, kind="edge", paint_width=0.0)


@pytest.mark.parametrize("role", ["ego_left", "ego_right", "other"])
def test_a_road_edge_is_a_violet_line_on_the_border_with_gaps(role: str) -> None:
    picture = draw_overlay(np.zeros(SHAPE, np.uint8), [road_edge(4.0, role)], CAMERA)
    near, far = (round(float(CAMERA.project([[4.0, HEIGHT, z]])[0, 1])) for z in (8.0, 20.0))
    drawn = violet(picture)
    rows = np.arange(far, near)
    has_line = np.array([drawn[row, row_column(row) - 2 : row_column(row) + 3].any() for row in rows])
    assert 0.3 < has_line.mean() < 0.8  # it is dotted
    beside = np.array([drawn[row, row_column(row) + 6 : row_column(row) + 30].any() for row in rows])
    assert not beside[: len(rows) // 2].any()  # and thin; the label comes where the line begins


def row_column(row: int) -> int:
    """The column of the overlay in which a line 4 m right of the camera is in a row."""
    z = CAMERA.fy * HEIGHT / (row - CAMERA.cy)
    return round(CAMERA.cx + CAMERA.fx * 4.0 / z)


def test_road_edges_and_lanes_are_told_apart_from_above() -> None:
    image = np.full(SHAPE, 80, np.uint8)
    view = birds_eye(image)
    lanes = [lane(-1.8, "ego_left"), lane(1.8, "ego_right")]
    assert not violet(draw_birds_eye(view, image, lanes)).any()
    picture = draw_birds_eye(view, image, [*lanes, road_edge(-4.0, "ego_left")])
    margin = picture.shape[1] - round(12 * PIXELS_PER_METRE)
    columns = np.flatnonzero(violet(picture)[: picture.shape[0] // 2].any(axis=0))
    offsets = (columns + 0.5 - margin) / PIXELS_PER_METRE - 6.0
    assert len(offsets) and np.all(np.abs(offsets + 4.0) < 0.15)


def test_a_lane_is_drawn_above_a_road_edge_whichever_comes_first() -> None:
    both = [lane(1.8, "ego_right"), road_edge(1.85, "ego_right")]
    image = np.zeros(SHAPE, np.uint8)
    pictures = [draw_overlay(image, lines, CAMERA) for lines in (both, both[::-1], both[:1])]
    np.testing.assert_array_equal(pictures[0], pictures[1])
    blue = (pictures[2][..., 0] > 200) & ~violet(pictures[2])
    assert not violet(pictures[0])[blue].any()


def test_no_lanes_no_marks() -> None:
    image = np.full((*SHAPE, 3), 80, np.uint8)
    np.testing.assert_array_equal(draw_overlay(image, [], CAMERA), image)


@pytest.mark.parametrize("shape", [(1, 1), (2, 5, 3), (40, 30)])
def test_tiny_pictures_and_points_that_project_to_nowhere(shape: tuple[int, ...]) -> None:
    behind = lane(0.0, "other", points=np.array([[0, 1.6, -3], [0, 1.6, 0], [0, 1.6, 1e-3], [0, 1.6, 2]]))
    aside = lane(1e7, "other")
    empty = lane(0.0, "other", points=np.empty((0, 3)))
    picture = draw_overlay(np.zeros(shape, np.uint8), [behind, aside, empty, lane(0, "other")], CAMERA)
    assert picture.shape == (*shape[:2], 3)


def test_birds_eye_is_metric_and_shows_the_lane_beside_its_paint() -> None:
    image = np.full(SHAPE, 80, np.uint8)
    view = birds_eye(image)
    without = draw_birds_eye(view, image, [])
    picture = draw_birds_eye(view, image, [lane(1.8, "ego_right")])
    rows = round(30 * PIXELS_PER_METRE)
    assert picture.shape[0] == rows
    margin = picture.shape[1] - round(12 * PIXELS_PER_METRE)
    row_at_15_m = rows - round((15.5 - 4.0) * PIXELS_PER_METRE)
    changed = np.flatnonzero((picture[row_at_15_m] != without[row_at_15_m]).any(axis=1))
    offsets = (changed + 0.5 - margin) / PIXELS_PER_METRE - 6.0 - 1.8  # m from the lane
    assert np.all(np.abs(offsets) > 0.075 - 0.03)
    assert np.all(np.abs(offsets) < 0.075 + 0.15)
    assert offsets.min() < 0 < offsets.max()


def test_birds_eye_of_a_lane_outside_the_view_is_unlabelled() -> None:
    image = np.full(SHAPE, 80, np.uint8)
    view = birds_eye(image)
    picture = draw_birds_eye(view, image, [lane(30.0, "other")])
    np.testing.assert_array_equal(picture, draw_birds_eye(view, image, []))
