# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Things on a rendered road: in their place in both cameras, and hiding what is behind them."""

import cv2
import numpy as np
import pytest

from lane_dp_ros.scenes.barriers import Grass, GuardRail, Posts
from lane_dp_ros.scenes.course import Course
from lane_dp_ros.scenes.faces import NEAREST, Face, Picture, hides, see
from lane_dp_ros.scenes.light import Light, shade
from lane_dp_ros.scenes.objects import at, composite, hidden, things_in_sight
from lane_dp_ros.scenes.road import Road
from lane_dp_ros.scenes.scene import CAMERA, SIZE
from lane_dp_ros.scenes.sensor import Sensor, expose
from lane_dp_ros.scenes.structures import Bridge, Island
from lane_dp_ros.scenes.surface import Surface
from lane_dp_ros.scenes.vehicles import CAR, LORRY, VAN, Vehicle
from lane_dp_ros.scenes.view import Pose, View

pytestmark = pytest.mark.filterwarnings("error")
STRAIGHT = Road(swing=0, pitch=0.0)
HERE = 100.0  # [m] along the road


def a_view(eye=0.0, road=STRAIGHT, position=HERE, time=0.0):
    pose = Pose(0.0, road.pitch, 0.0)
    return View(CAMERA, SIZE, Course(road, position), pose, eye, seed=1, time=time)


def drawn(view, *objects):
    """What a camera sees of objects on a ground that is all around; nothing else is there."""
    surface = Surface.empty(view.shape)
    down = np.maximum(-view.rays[..., 1], 1e-6)
    depth = np.where(view.rays[..., 1] < -1e-3, view.road.camera_height / down, np.inf).astype(np.float32)
    surface.depth[:] = depth
    surface.ground[:] = np.isfinite(depth)
    surface.paint[:] = surface.ground
    composite(surface, view, objects)
    return surface


@pytest.mark.parametrize("model", [CAR, VAN, LORRY], ids=["car", "van", "lorry"])
@pytest.mark.parametrize("eye", [0.0, CAMERA.baseline], ids=["left", "right"])
def test_a_vehicles_back_is_where_and_as_large_as_it_should_be(model, eye):
    surface = drawn(a_view(eye), Vehicle(HERE + 15, 1.0, model))
    back = ~surface.ground & np.isfinite(surface.depth) & (np.abs(surface.depth - 15) < 0.2)
    columns, rows = np.flatnonzero(back.any(axis=0)), np.flatnonzero(back.any(axis=1))
    scale = CAMERA.fx / 15
    assert columns[[0, -1]].mean() == pytest.approx(CAMERA.cx + (1.0 - eye) * scale, abs=1)
    assert np.ptp(columns) + 1 == pytest.approx(model.width * scale, abs=2)
    assert rows[-1] == pytest.approx(CAMERA.cy + (1.65 - model.profile[0][1]) * scale, abs=2)
    assert np.median(surface.depth[back]) == pytest.approx(15, abs=0.3)


def test_stereo_matching_finds_a_vehicles_back_at_its_distance():
    views = [a_view(eye) for eye in (0.0, CAMERA.baseline)]
    back = (Vehicle(HERE + 14, 0.3, CAR, (120.0, 110.0, 100.0)),)
    surfaces = [drawn(view, *back) for view in views]
    noise = np.random.default_rng(0)
    images = [
        expose(shade(surface, view, Light(), back), view, Sensor(), noise)
        for surface, view in zip(surfaces, views, strict=True)
    ]
    greys = [cv2.cvtColor(image, cv2.COLOR_BGR2GRAY) for image in images]
    matcher = cv2.StereoSGBM_create(0, 96, 7, 8 * 49, 32 * 49, disp12MaxDiff=1, uniquenessRatio=5)
    disparity = matcher.compute(*greys) / 16
    depth = surfaces[0].depth
    part = (np.abs(depth - 14) < 0.5) & ~surfaces[0].ground & (disparity > 0)
    error = disparity[part] - CAMERA.fx * CAMERA.baseline / depth[part]
    assert part.sum() > 2000
    assert abs(np.median(error)) < 0.3
    assert np.median(np.abs(error)) < 0.5


def test_both_cameras_see_the_same_face_of_a_thing():
    left, right = (drawn(a_view(eye), Vehicle(HERE + 12, -1.0, VAN)) for eye in (0.0, CAMERA.baseline))
    v, u = np.nonzero(~left.ground & (np.abs(left.depth - 12) < 0.1))
    shifted = u - CAMERA.fx * CAMERA.baseline / left.depth[v, u]
    there = cv2.remap(right.albedo, shifted.astype(np.float32)[:, None], v.astype(np.float32)[:, None], 1)
    assert np.median(np.abs(there[:, 0] - left.albedo[v, u])) < 0.01
    assert np.std(left.albedo[v, u]) > 0.02


def test_what_is_nearer_hides_what_is_farther_whatever_their_order():
    near, far = Vehicle(HERE + 10, 0.5, CAR, (20.0, 20.0, 220.0)), Vehicle(HERE + 20, 0.0, LORRY)
    one, other = drawn(a_view(), near, far), drawn(a_view(), far, near)
    np.testing.assert_array_equal(one.albedo, other.albedo)
    alone = drawn(a_view(), near)
    covered = np.abs(alone.depth - 10) < 0.6
    np.testing.assert_array_equal(one.depth[covered], alone.depth[covered])


def test_a_thing_behind_what_the_surface_holds_is_not_drawn():
    view = a_view()
    wall = Surface.empty(view.shape)
    wall.depth[:] = 8.0
    composite(wall, view, (Vehicle(HERE + 12, 0.0),))
    assert (wall.depth == 8.0).all()
    assert not wall.albedo.any()


def test_what_is_drawn_is_no_ground_and_has_no_paint():
    surface = drawn(a_view(), Vehicle(HERE + 10, 0.0))
    body = np.abs(surface.depth - 10.5) < 0.8
    body &= ~surface.ground
    assert body.sum() > 5000
    assert surface.paint[body].max() < 0.5
    np.testing.assert_allclose(np.linalg.norm(surface.normal[body], axis=1), 1, atol=1e-5)


OBJECTS = {
    "car": Vehicle(HERE + 9, -0.5),
    "oncoming": Vehicle(HERE + 14, -3.0, VAN, oncoming=True),
    "rail": GuardRail(2.5),
    "island": Island(HERE + 9, -2.0),
    "posts": Posts(1.5, spacing=6.0, width=0.3),
    "grass": Grass(1.8),
}


@pytest.mark.parametrize("name", OBJECTS)
def test_hidden_tells_what_the_picture_shows(name):
    view, item = a_view(), OBJECTS[name]
    surface = drawn(view, item)
    clear = drawn(view)
    v, u = (a.ravel() for a in np.mgrid[180:375:3, 5:1240:5])
    points = view.origin + view.rays[v, u] * clear.depth[v, u, None]
    told = hidden(view, (item,), points)
    shown = ~surface.ground[v, u]
    assert shown.sum() > 10
    least = 0.95 if name == "grass" else 0.99  # a blade is often narrower than a pixel
    assert np.mean(told == shown) > least
    assert np.mean(told[shown]) > 0.6


def test_nothing_hides_a_point_before_it():
    points = a_view().course.points([5.0, 30.0], 0.0)
    assert hidden(a_view(), (Vehicle(HERE + 10, 0.0, LORRY),), points).tolist() == [False, True]
    assert hidden(a_view(), (), points).tolist() == [False, False]


def test_vehicles_drive_and_other_things_stand():
    rail, car = GuardRail(3.0), Vehicle(50.0, 0.0, speed=-12.0)
    assert at((rail, car), 0.5) == (rail, Vehicle(44.0, 0.0, speed=-12.0))
    before, after = (drawn(a_view(time=t), Vehicle(HERE + 12, 0.0, speed=6.0)) for t in (0.0, 1.0))
    for surface, distance in ((before, 12), (after, 18)):
        assert np.median(surface.depth[~surface.ground & (surface.depth < 25)]) == pytest.approx(
            distance, abs=1
        )


def test_a_rail_beside_the_camera_reaches_out_of_the_picture():
    surface = drawn(a_view(), GuardRail(4.0))
    assert not surface.ground[200:, -1].all()
    assert surface.depth[~surface.ground & np.isfinite(surface.depth)].min() > NEAREST


def test_things_follow_a_bend_and_a_hill():
    road = Road(curvature=0.01, swing=0, pitch=0.0)
    view = a_view(road=road)
    surface = drawn(view, Posts(0.0, spacing=30.0, height=2.0, width=0.6))  # one at 120 m along the road
    u = np.nonzero(~surface.ground & (np.abs(surface.depth - 20) < 1.5))[1]
    x, z = (1 - np.cos(0.2)) / 0.01, np.sin(0.2) / 0.01
    assert np.median(u) == pytest.approx(CAMERA.cx + CAMERA.fx * x / z, abs=2)


def test_a_bridge_is_over_the_road_and_its_walls_beside_it():
    surface = drawn(a_view(), Bridge(HERE + 25))
    deck = np.isfinite(surface.depth) & ~surface.ground
    middle = int(CAMERA.cx)
    lowest = np.flatnonzero(deck[:, middle])[-1]
    assert lowest == pytest.approx(CAMERA.cy - CAMERA.fy * (4.8 - 1.65) / (25 + 9), abs=3)
    assert deck[150, int(CAMERA.cx + CAMERA.fx * 14 / 25)]
    assert not deck[165, middle]


def test_a_face_is_seen_from_before_only_unless_it_has_two_sides():
    corners = np.array([(110, -1, 1), (110, 1, 1), (110, 1, 0), (110, -1, 0)], float)
    front = Face(corners, Picture.plain((255, 255, 255)))
    back = Face(corners[[1, 0, 3, 2]], front.picture)
    both = Face(back.corners, front.picture, both=True)
    assert [len(see(a_view(), [face])) for face in (front, back, both)] == [1, 0, 1]
    (seen,) = see(a_view(), [front])
    np.testing.assert_allclose(seen.normal, [0, 0, -1], atol=1e-6)
    pixels = CAMERA.project(np.array([[0, 1.0, 12], [0, 1.0, 9], [3, 1.0, 12]]))
    assert hides(seen, pixels, np.array([12.0, 9.0, 12.0])).tolist() == [True, False, False]


def test_a_face_is_cut_where_it_comes_too_near():
    corners = np.array([(HERE - 5, 2, 1), (HERE + 5, 2, 1), (HERE + 5, 2, 0), (HERE - 5, 2, 0)], float)
    (seen,) = see(a_view(), [Face(corners, Picture.plain((9, 9, 9)), both=True)])
    assert seen.face.corners[:, 0].min() == pytest.approx(HERE + NEAREST)
    assert see(a_view(position=HERE + 6), [Face(corners, Picture.plain((9, 9, 9)), both=True)]) == []


def test_a_picture_keeps_its_light_at_every_size():
    image = np.zeros((64, 64, 4), np.float32)
    image[:32] = (255, 0, 0, 1)
    picture = Picture.of(image)
    for texels in picture.pyramid:
        np.testing.assert_allclose(texels.mean(axis=(0, 1)), (0.5, 0, 0, 0.5), atol=1e-6)
    assert picture.for_size(20, 10).shape[:2] == (32, 32)
    assert picture.for_size(500, 10) is picture.pyramid[0]


def test_grass_grows_where_it_grew_in_the_frame_before():
    things = [things_in_sight(a_view(position=p), (Grass(2.0),)) for p in (HERE, HERE + 1.0)]
    places = [{tuple(face.corners.ravel()) for thing in some for face in thing} for some in things]
    assert len(places[0] & places[1]) > 0.7 * len(places[0])


def test_shading_leaves_the_surface_as_it_was():
    view = a_view()
    surface = drawn(view, Vehicle(HERE + 10, 0.0))
    before = surface.albedo.copy()
    shade(surface, view, Light(sun=1.0, wetness=0.5, roughness=0.3), (Vehicle(HERE + 10, 0.0),))
    np.testing.assert_array_equal(surface.albedo, before)
