# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Which lines of a rendered picture a careful person sees, and how far."""

from dataclasses import replace

import numpy as np
import pytest

from lane_dp_ros.scenes import CAMERA, SIZE, Road
from lane_dp_ros.scenes.course import Course
from lane_dp_ros.scenes.lane_truth import lane_labels
from lane_dp_ros.scenes.light import Light
from lane_dp_ros.scenes.rendering import render
from lane_dp_ros.scenes.road import SOLID, UNPAINTED, Line
from lane_dp_ros.scenes.sensor import Sensor, expose
from lane_dp_ros.scenes.vehicles import Vehicle
from lane_dp_ros.scenes.view import Pose, View
from lane_dp_ros.scenes.visibility import visible_paint

ROAD = Road(swing=0, pitch=0.0, lines=(UNPAINTED, UNPAINTED, SOLID))
VIEW = View(CAMERA, SIZE, Course(ROAD, 0.0), Pose(), 0.0, 1, 0.0)
S = np.arange(5.0, 30.0, 0.5)
DEPTHS = CAMERA.fy * 1.65 / np.maximum(np.arange(SIZE[1]) - CAMERA.cy, 1)  # [m] of the picture's rows


def seen(road_grey, paint_grey, noise=0.0, line=SOLID):
    """At which of S a line 1.75 m to the right is visible, of these grey levels (by row, if arrays)."""
    picture = np.empty((SIZE[1], SIZE[0]))
    picture[:] = np.reshape(road_grey, (-1, 1))
    edges = CAMERA.cx + CAMERA.fx * np.array([[1.75 - line.width / 2], [1.75 + line.width / 2]]) / DEPTHS
    u = np.arange(SIZE[0])
    paint = (u >= edges[0][:, None]) & (u <= edges[1][:, None])
    picture = np.where(paint, np.reshape(paint_grey, (-1, 1)), picture)
    picture += noise * np.random.default_rng(0).standard_normal(picture.shape)
    image = np.repeat(np.rint(np.clip(picture, 0, 255)).astype(np.uint8)[..., None], 3, axis=2)
    return visible_paint(image, VIEW, (1.75, line), S, np.ones(len(S), bool))


@pytest.mark.parametrize(
    ("road", "paint", "noise", "expected"),
    [
        (100, 200, 2.0, True),
        (100, 106, 1.0, True),  # light goes with the square: 12 %
        (100, 101, 0.0, False),  # 2 %
        (255, 255, 0.0, False),  # burnt out
        (240, 255, 0.0, True),
        (180, 150, 2.0, True),  # dark paint on a road that mirrors the sky is seen as well
        (100, 106, 40.0, False),  # lost in noise
        (5, 30, 3.0, True),  # at night
        (1, 2, 0.0, False),  # black on a screen
    ],
)
def test_paint_is_seen_by_its_contrast_and_certain_over_noise(road, paint, noise, expected):
    assert np.mean(seen(road, paint, noise) == expected) > 0.95


def test_a_line_is_seen_until_the_glare():
    paint = np.where(DEPTHS < 15, 200, 255)
    road = np.where(DEPTHS < 15, 110, 255)
    mask = seen(road, paint)
    assert mask[S < 13].all() and not mask[S > 17].any()


def test_an_edge_is_no_line():
    """As bright as the ground on its right, paint is the border of that ground only."""
    picture = np.full((SIZE[1], SIZE[0], 3), 100, np.uint8)
    picture[:, :, :] = np.where(
        np.arange(SIZE[0])[None, :, None] >= (CAMERA.cx + CAMERA.fx * 1.675 / DEPTHS)[:, None, None], 200, 100
    )
    assert not visible_paint(picture, VIEW, (1.75, SOLID), S, np.ones(len(S), bool)).any()


def test_what_is_hidden_is_not_seen():
    picture = np.full((SIZE[1], SIZE[0], 3), 100, np.uint8)
    assert not visible_paint(picture, VIEW, (1.75, SOLID), S, np.zeros(len(S), bool)).any()


def labels_of(road, light=None, things=(), sensor=None):
    view = replace(VIEW, course=Course(road, 100.0))
    seen_light, surface = render(view, light or Light(), things)
    picture = expose(seen_light, view, sensor or Sensor(), np.random.default_rng(0))
    return lane_labels(view, surface, picture)[0]


def test_a_line_that_is_burnt_out_is_labelled_but_not_sure():
    (label,) = labels_of(ROAD, sensor=Sensor(exposure=8.0))
    assert not label.sure
    assert label.xz[-1, 1] > 40  # a detection of it is none of nothing


def test_nobody_sees_through_a_van():
    """Dashes from 8 m to 12 m and from 20 m on, a van over all from 12 m to 30 m."""
    dashed = replace(ROAD, lines=(UNPAINTED, UNPAINTED, Line("dashed", begin=108.0)))
    open_road = labels_of(dashed)[0]
    behind_van = labels_of(dashed, things=(Vehicle(113.0, 1.75),))[0]
    assert open_road.xz[-1, 1] > 40
    assert behind_van.sure
    assert behind_van.xz[-1, 1] == pytest.approx(12.0, abs=0.6)
