# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The whole detector where kerbs, seams, rails and shade run beside the paint, or in its place."""

from dataclasses import replace

import numpy as np
import pytest

from lane_dp_ros.core.detector import LaneDetector
from lane_dp_ros.core.geometry.quadratic_surface import QuadraticSurface
from lane_dp_ros.core.road.vanishing_point import ArcVanishingPoint, VanishingPointConfig
from lane_dp_ros.core.types import StereoFrame
from lane_dp_ros.scenes import CAMERA, Road
from lane_dp_ros.scenes.light import Light
from lane_dp_ros.scenes.road import SOLID, UNPAINTED, Line
from lane_dp_ros.scenes.scene import Motion, Scene, render_frame

pytestmark = pytest.mark.filterwarnings("error")

ASKEW = np.deg2rad(15)
TAR, GUTTER = Line(width=0.08, colour="tar"), Line(width=0.3, colour="concrete")
GROOVE, STEEL = Line(width=0.13, colour="tar"), Line(width=0.065, colour="steel")
TRACK = 1.435  # m between the rails
START = 4.0  # m along the road


def detected(road, seed, light=None):
    """Return the pair and what is found in it."""
    pair = render_frame(Scene(road, light or Light(), motion=Motion(start=START)), 0, seed)
    return pair, LaneDetector(CAMERA).detect(StereoFrame(pair.left, pair.right))


def errors(road, lane, truth):
    """Return the mean |x - true x| [m] of a lane on the rendered road, both taken there from the picture."""
    ground = QuadraticSurface.plane(CAMERA, road.camera_height, road.pitch)
    (x, z), (true_x, true_z) = (
        ground.pixel_to_ground(*CAMERA.project(line).T) for line in (lane.points, truth)
    )
    inside = (z >= true_z[0]) & (z <= true_z[-1])
    assert inside.mean() > 0.8
    return np.abs(x - np.interp(z, true_z, true_x))[inside].mean()


def assert_found_where_painted(road, pair, found):
    assert len(found.lanes) == len(pair.lanes)
    for lane, truth in zip(found.lanes, pair.lanes, strict=True):
        assert errors(road, lane, truth) < 0.02


def crossing(side, *strips):
    """Return a road between kerbs along which `strips` run, and two lines 15 degrees askew of it."""
    over = 120.0  # m; in the middle of it a line is as good as straight, 1.45 times as steep as on the whole
    bend = side * np.tan(ASKEW) / 1.45 * over
    place = {"bend": bend, "bend_at": START + 14 - over / 2, "bend_over": over}
    return Road(
        swing=0,
        lane_widths=(9.0,),
        lines=(UNPAINTED, UNPAINTED),
        driven=0,
        kerb=0.14,
        shoulder=0.3,
        more_lines=tuple((n - bend / 2, Line(**place)) for n in (-1.75, 1.75)),
        strips=strips,
    )


@pytest.mark.parametrize("seed", [2, 3])
@pytest.mark.parametrize("side", [-1, 1], ids=["to the left", "to the right"])
def test_lines_askew_of_the_kerbs_that_outvote_them_are_found(side, seed):
    road = crossing(side, *((n, TAR) for n in (-4, -3.2, -2.5, -1, 0.2, 1, 2.5, 3.2, 4)))
    pair, found = detected(road, seed)
    edges = ArcVanishingPoint(VanishingPointConfig())
    voted = edges.estimate(pair.left[:, :, 1], found.disparity, found.road)
    assert abs(voted.axis.heading) < np.deg2rad(2)  # along the kerbs
    assert found.birds_eye.axis.heading == pytest.approx(side * ASKEW, abs=0.02)
    assert len(found.lanes) == 2
    assert_found_where_painted(road, pair, found)


@pytest.mark.parametrize("seed", range(3))
def test_gutter_stones_are_no_lines(seed):
    road = Road(
        swing=0,
        lane_widths=(3.2, 3.2),
        lines=(UNPAINTED,) * 3,
        strips=((-4.95, GUTTER), (1.75, GUTTER)),
        kerb=0.14,
        shoulder=0.3,
        verge="town",
    )
    assert detected(road, seed)[1].lanes == ()


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("apart", [0.2, 0.3])
def test_asphalt_between_two_cracks_is_no_line(seed, apart):
    cracks = tuple((n + aside, TAR) for n in (-1.8, 1.7) for aside in (-apart / 2, apart / 2))
    road = Road(swing=0, lines=(UNPAINTED,) * 3, strips=cracks)
    assert detected(road, seed)[1].lanes == ()


@pytest.mark.parametrize("seed", range(3))
def test_rails_are_no_lines_and_the_lines_beside_them_are(seed):
    rails = [(n, kind) for n in (0.2 - TRACK / 2, 0.2 + TRACK / 2) for kind in (GROOVE, STEEL)]
    bed = 0.2, Line(width=2.3, colour="patch")
    road = Road(swing=0, lane_widths=(3.8,), lines=(SOLID, SOLID), driven=0, strips=(bed, *rails))
    pair, found = detected(road, seed)
    assert_found_where_painted(road, pair, found)


SHADED = Road(swing=0, lane_widths=(3.5,), lines=(SOLID, SOLID), driven=0, shoulder=2.0)


def in_shade(border):
    return detected(SHADED, 1, Light(sky=0.35, sun=1.2, azimuth=120.0, leaves=(border, 14.0)))


@pytest.mark.parametrize("border", [-1.75, -0.4, 0.5, 1.6, 1.75])
def test_shade_along_a_line_hides_none_and_makes_none(border):
    pair, found = in_shade(border)
    on_asphalt = [lane for lane in found.lanes if abs(lane.lateral_offset) < 1.75 + SHADED.shoulder]
    assert_found_where_painted(SHADED, pair, replace(found, lanes=tuple(on_asphalt)))


def test_a_post_on_the_verge_is_no_line():
    pair, found = in_shade(-0.4)
    assert len(found.lanes) == len(pair.lanes)


@pytest.mark.parametrize("border", [-1.2, 1.0, 1.75])
def test_the_border_of_shade_is_no_line(border):
    light = Light(sky=0.35, sun=1.2, azimuth=120.0, leaves=(border, 14.0))
    road = Road(swing=0, lines=(UNPAINTED,) * 3, shoulder=2.0)
    assert detected(road, 1, light)[1].lanes == ()
