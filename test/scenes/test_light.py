# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Light on a rendered road: shadows bound to the ground, glints, lamps, a wet road's mirror; the sensor."""

import cv2
import numpy as np
import pytest

from lane_dp_ros.scenes import lamps, shadows, specular
from lane_dp_ros.scenes.barriers import GuardRail, Posts
from lane_dp_ros.scenes.condition_categories import CONDITION_CATEGORIES
from lane_dp_ros.scenes.course import Course
from lane_dp_ros.scenes.ground import draw_ground
from lane_dp_ros.scenes.light import Light, shade
from lane_dp_ros.scenes.objects import composite
from lane_dp_ros.scenes.road import Road
from lane_dp_ros.scenes.scene import CAMERA, SIZE
from lane_dp_ros.scenes.sensor import Sensor, expose
from lane_dp_ros.scenes.structures import Bridge, Island
from lane_dp_ros.scenes.surface import Surface
from lane_dp_ros.scenes.vehicles import LORRY, VAN, Vehicle
from lane_dp_ros.scenes.view import Pose, View

pytestmark = pytest.mark.filterwarnings("error")
STRAIGHT = Road(swing=0, pitch=0.0)
HERE = 100.0  # [m] along the road
FLAT = np.full((120, 160, 3), 0.25, np.float32)


def a_view(eye=0.0, road=STRAIGHT, position=HERE):
    return View(CAMERA, SIZE, Course(road, position), Pose(0.0, road.pitch, 0.0), eye, seed=1, time=0.0)


def ground(view, *objects):
    surface = Surface.empty(view.shape)
    draw_ground(surface, view)
    composite(surface, view, objects)
    return surface


def at(view, s, n):
    """The row and column that see the ground at s, n."""
    u, v = view.pixels(view.course.points(s - view.course.position, n))[0]
    return round(v), round(u)


def seen_from(view, other, image, surface):
    """The image of another camera at the places of the road that this one's pixels see."""
    position = surface.position[ROAD_PART]
    u, v = other.pixels(position.reshape(-1, 3) - [0, 0, other.course.position - view.course.position]).T
    u, v = (a.astype(np.float32).reshape(position.shape[:2]) for a in (u, v))
    return cv2.remap(image, u, v, cv2.INTER_LINEAR)


ROAD_PART = np.s_[230:350, 400:800]


@pytest.mark.parametrize(
    "other", [a_view(CAMERA.baseline), a_view(position=HERE + 1.5)], ids=["right", "later"]
)
def test_the_shadows_of_leaves_lie_still_on_the_ground(other):
    view = a_view()
    surface = ground(view)
    here = shadows.through_leaves(surface, view, (-60.0, 60.0))
    there = shadows.through_leaves(ground(other), other, (-60.0, 60.0))
    moved = seen_from(view, other, there, surface)
    assert here[ROAD_PART].std() > 0.1
    assert np.corrcoef(here[ROAD_PART].ravel(), moved.ravel())[0, 1] > 0.9
    assert np.corrcoef(here[ROAD_PART].ravel(), there[ROAD_PART].ravel())[0, 1] < 0.7


def test_leaves_shade_only_the_part_of_the_road_they_stand_over():
    view = a_view()
    surface = ground(view)
    share = shadows.through_leaves(surface, view, (2.0, 60.0))
    assert share[surface.ground & (surface.n < 0) & (surface.n > -20)].min() > 0.9
    assert share[surface.ground & (surface.n > 4) & (surface.n < 20) & (surface.depth < 40)].mean() < 0.7


def test_a_shadow_falls_away_from_the_sun_and_as_far_as_it_should():
    lorry = Vehicle(HERE + 15, 0.0, LORRY)  # 3.65 m high: at 45 deg its shadow reaches 3.65 m beyond its side
    view = a_view()
    light = Light(elevation=45.0, azimuth=90.0)  # the sun on the right
    share = shadows.past_things(ground(view), view, (lorry,), light.towards_sun)
    for n, lit in ((-6.0, 1.0), (-5.2, 1.0), (-4.6, 0.0), (-2.0, 0.0), (1.5, 1.0), (4.0, 1.0)):
        assert share[at(view, HERE + 20, n)] == pytest.approx(lit, abs=0.05), n


@pytest.mark.parametrize(
    ("thing", "n"),
    [
        (GuardRail(3.0), 3.0 - 0.6),
        (Posts(4.0, spacing=110.0, height=3.0, width=0.5), 2.5),
        (Island(110.0, 1.0), 0.17),
    ],
    ids=["rail", "post", "island"],
)
def test_rails_posts_and_islands_throw_shadows_too(thing, n):
    view = a_view()
    light = Light(elevation=45.0, azimuth=90.0)
    share = shadows.past_things(ground(view), view, (thing,), light.towards_sun)
    assert share[at(view, 110.0 if isinstance(thing, Posts) else 111.0, n)] < 0.5
    assert share[at(view, 111.0, n - 3.5)] == 1


def test_the_shadow_turns_with_the_road():
    bent = Road(curvature=0.01, swing=0, pitch=0.0)
    light = Light(elevation=45.0, azimuth=90.0)
    view = a_view(road=bent, position=50 * np.pi)  # the road has turned by 90 deg: the sun is ahead
    place = 50 * np.pi + 15
    share = shadows.past_things(ground(view), view, (Vehicle(place, 0.0, VAN),), light.towards_sun)
    assert share[at(view, place - 1.0, 0.0)] < 0.1
    assert share[at(view, place + 2.0, -2.4)] > 0.9


def test_a_shadow_behind_a_crest_is_not_seen_on_the_road_before_it():
    road = Road(swing=0, pitch=0.0, hill=5.0, hill_length=100.0)
    view = a_view(road=road, position=25.0)  # the crest is 25 m ahead
    light = Light(elevation=30.0, azimuth=90.0)
    surface = ground(view)
    share = shadows.past_things(surface, view, (Vehicle(75.0, 0.0, LORRY),), light.towards_sun)
    assert share[surface.ground & (surface.depth < 35)].min() == 1
    beside = shadows.past_things(surface, view, (Vehicle(40.0, 0.0, LORRY),), light.towards_sun)
    assert beside[surface.ground & (surface.depth < 35)].min() == 0


def test_it_is_dark_under_vehicles_and_bridges():
    view = a_view()
    things = (Bridge(HERE + 20),)
    surface = ground(view, *things)
    sky = shadows.open_sky(surface, view, things)
    assert sky[at(view, HERE + 24, 0.0)] < 0.4
    assert sky[at(view, HERE + 12, 0.0)] == pytest.approx(1, abs=0.01)
    assert (shadows.open_sky(surface, view, ()) == 1).all()


def test_clear_weather_makes_strong_shadows_and_an_overcast_sky_none():
    view = a_view()
    lorry = (Vehicle(HERE + 15, -3.0, LORRY),)
    surface = ground(view, *lorry)
    contrast = []
    clear = Light(sky=0.22, sun=1.9, elevation=40.0, azimuth=-90.0, haze_length=1e6)
    for light in (clear, Light(haze_length=1e6)):
        seen = shade(surface, view, light, lorry)[..., 1] / np.maximum(surface.albedo[..., 1], 1e-3)
        contrast.append(seen[at(view, HERE + 20, 4.5)] / seen[at(view, HERE + 20, 0.0)])
    assert contrast[0] == pytest.approx((0.22 + 1.9 * np.sin(np.deg2rad(40))) / 0.22, rel=0.04)
    assert contrast[1] == pytest.approx(1, abs=0.01)


def test_a_glint_lies_under_the_sun_in_both_cameras():
    """The sun is infinitely far: unlike all else on the ground its glint has next to no disparity."""
    columns = []
    wide = Road(swing=0, pitch=0.0, shoulder=20.0)
    for view in (a_view(road=wide), a_view(CAMERA.baseline, wide)):
        towards = Light(elevation=15.0, azimuth=8.0).towards_sun(0.0).astype(np.float32)
        share = specular.sun_glint(ground(view), view, slice(200, 300), towards, 0.3)
        columns.append(cv2.GaussianBlur(share, (0, 0), 40).sum(axis=0).argmax())
    assert columns[0] == pytest.approx(CAMERA.cx + CAMERA.fx * np.tan(np.deg2rad(8)), abs=30)
    assert columns[1] == pytest.approx(columns[0], abs=12)  # the ground's disparity is up to 40 px here


def test_glare_takes_the_contrast_of_paint():
    view = a_view()
    surface = ground(view)
    lit = {}
    for roughness in (0.0, 0.4):
        light = Light(sky=0.2, sun=1.2, elevation=15.0, azimuth=0.0, roughness=roughness)
        seen = shade(surface, view, light, ())[..., 1]
        part = surface.ground & (np.abs(surface.n) < 2) & (surface.depth > 10) & (surface.depth < 25)
        paint, asphalt = (
            np.median(seen[part & where]) for where in (surface.paint > 0.9, surface.paint == 0)
        )
        lit[roughness] = paint / asphalt
    assert lit[0.4] < 0.75 * lit[0.0]


def test_ones_own_lamps_light_the_road_ahead_and_nothing_above_the_cut_off():
    view = a_view()
    light = lamps.own_lamps(ground(view), view)
    near, far = (light[at(view, HERE + z, 0.0)] for z in (10.0, 25.0))
    assert near == pytest.approx(0.6, abs=0.15)
    assert 0.05 < far < 0.5 * near
    surface = ground(view)
    surface.position[100] = (0.0, 4.0, 20.0)
    assert lamps.own_lamps(surface, view)[100].max() < 0.01


def test_paint_throws_ones_own_light_back_more_than_asphalt_does():
    view = a_view()
    surface = ground(view)
    seen = shade(surface, view, Light(sky=0.0, head_lamps=1.0), ())[..., 1] / np.maximum(
        surface.albedo[..., 1], 0.01
    )
    row = at(view, HERE + 12, 0.0)[0]
    painted, bare = surface.paint[row] > 0.9, (surface.paint[row] == 0) & (np.abs(surface.n[row]) < 2)
    assert seen[row][painted].max() > 3 * seen[row][bare].max()


def test_a_wet_road_mirrors_lamps_below_where_they_are():
    car = (Vehicle(HERE + 20, 0.0, oncoming=True, lamps=1.0),)
    view = a_view()
    surface = ground(view, *car)
    dry, wet = (shade(surface, view, Light(sky=0.05, wetness=w), car).sum(axis=-1) for w in (0.0, 0.9))
    v, u = at(view, HERE + 20, -0.6)
    below = round(CAMERA.cy + CAMERA.fy * (1.65 + 0.69) / 20)  # lamps 0.69 m high, mirrored under the road
    part = np.s_[below - 6 : below + 7, u - 8 : u + 9]
    assert below > v + 10
    assert wet[part].max() > 3 * dry[part].max()


def test_a_damp_road_is_darker():
    view = a_view()
    surface = ground(view)
    dry, damp = (shade(surface, view, Light(wetness=w), ()) for w in (0.0, 0.15))
    near = surface.ground & (np.abs(surface.n) < 1.5) & (surface.depth < 10)
    assert damp[near].mean() < 0.97 * dry[near].mean()


def test_the_right_camera_may_take_more_light():
    sensor = Sensor(right_gain=1.5, vignette=0.0)
    left, right = (
        expose(FLAT, a_view(eye), sensor, np.random.default_rng(0)).astype(float) for eye in (0.0, 0.54)
    )
    assert left.mean() == pytest.approx(127.5, abs=0.5)
    assert np.mean(right**2) / np.mean(left**2) == pytest.approx(1.5, abs=0.01)


@pytest.mark.parametrize("level", [0.02, 0.5])
def test_noise_is_that_of_counted_electrons(level):
    sensor = Sensor(vignette=0.0, blur=0.0, full_well=2000.0, dark=10.0)
    light = np.full((200, 300, 3), level, np.float32)
    image = expose(light, a_view(), sensor, np.random.default_rng(0)) / 255.0
    electrons = 2000 * level
    assert np.std(image**2) * 2000 == pytest.approx(np.sqrt(electrons + 100), rel=0.06)


def test_metering_sets_the_mean_of_the_lower_picture():
    sensor = Sensor(metering=0.2, vignette=0.0, blur=0.0)
    image = expose(4 * FLAT, a_view(), sensor, np.random.default_rng(0)) / 255.0
    assert np.mean(image**2) == pytest.approx(0.2, abs=0.005)


def test_lens_vignette_flare_and_compression():
    spot = np.zeros((120, 160, 3), np.float32)
    spot[60, 80] = 1000.0
    noiseless = {"full_well": 1e9, "dark": 0.0}
    clean, flared = (
        expose(spot, a_view(), Sensor(flare=f, **noiseless), np.random.default_rng(0)) for f in (0.0, 0.3)
    )
    assert not clean[60, 95].any()
    assert flared[60, 95].min() > 10
    dim = expose(FLAT, a_view(), Sensor(vignette=0.4, **noiseless), np.random.default_rng(0)).astype(float)
    assert (dim[0, 0, 0] / dim[60, 80, 0]) ** 2 == pytest.approx(0.6, abs=0.02)
    shaken = expose(spot, a_view(), Sensor(shake=4.0, **noiseless), np.random.default_rng(0))
    assert np.count_nonzero(shaken[:, 80, 0]) > np.count_nonzero(clean[:, 80, 0]) + 2
    noisy = np.random.default_rng(1).uniform(0, 1, FLAT.shape).astype(np.float32)
    whole, packed = (
        expose(noisy, a_view(), Sensor(jpeg=j, **noiseless), np.random.default_rng(0)) for j in (None, 30)
    )
    assert 2 < np.abs(whole.astype(int) - packed).mean() < 60


@pytest.mark.parametrize("category", CONDITION_CATEGORIES)
def test_every_category_makes_the_same_scene_again(category):
    one, same, other = (CONDITION_CATEGORIES[category](np.random.default_rng(i)) for i in (3, 3, 4))
    assert one == same
    assert one != other


def test_over_exposure_burns_the_road_out_and_night_does_not_show_it():
    bright, dark, again = (road_of(category) for category in ("over_exposure", "wet_night", "wet_night"))
    assert np.mean(bright.min(axis=-1) > 250) > 0.2
    assert np.median(dark) < 70
    np.testing.assert_array_equal(dark, again)


def road_of(category):
    """The road before the left camera, without what stands beside it."""
    scene = CONDITION_CATEGORIES[category](np.random.default_rng(3))
    view = a_view(road=scene.road, position=scene.motion.start)
    seen = shade(ground(view, *scene.objects), view, scene.light, scene.objects)
    return expose(seen, view, scene.sensor, np.random.default_rng(0))[230:, 350:850]
