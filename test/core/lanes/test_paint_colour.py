# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""White and yellow paint in light of any colour, on drawn pictures."""

import cv2
import numpy as np
import pytest

from lane_dp_ros.core.lanes.candidate import LaneLine
from lane_dp_ros.core.lanes.line_kind import paint_along
from lane_dp_ros.core.lanes.paint_colour import paint_colour

CENTRE = 1.025  # m
ASPHALT = (0.19, 0.18, 0.17)  # share of the light that is reflected, BGR
PAINT = {"white": (0.7, 0.7, 0.7), "yellow": (0.12, 0.45, 0.6)}
LIGHTS = {"day": (1, 1, 1), "low sun": (0.55, 0.8, 1), "shade": (1, 0.85, 0.75), "lamps": (0.4, 0.75, 1)}
WHITE_LIGHT = LIGHTS["day"]


def along_and_view(road):
    paint = road.bands()
    rows = np.arange(len(paint.view.s))[::-1]
    line = LaneLine(rows, paint.view.s[rows], np.full(len(rows), CENTRE), bend=0.0, score=10.0)
    return paint_along([line], paint)[0], paint.view


@pytest.fixture(scope="module")
def seen(painted_road):
    """The paint along a line at CENTRE, and the view of it."""
    return along_and_view(painted_road(length=30).line(CENTRE))


@pytest.fixture
def picture_of(seen, colour_picture):
    """Return a function: the picture of paint in some light, as a camera with a gamma of 2 takes it."""

    def picture_of(paint, light=WHITE_LIGHT, exposure=1.0):
        levels = [np.sqrt(exposure * np.multiply(each, light)) for each in (paint, ASPHALT)]
        paint, road = (np.rint(np.minimum(255 * each, 255)) for each in levels)
        return colour_picture(seen[1], [(CENTRE, paint)], road)

    return picture_of


@pytest.mark.parametrize("exposure", [0.1, 1.0])
@pytest.mark.parametrize("light", LIGHTS.values(), ids=LIGHTS)
@pytest.mark.parametrize("colour", PAINT)
def test_the_colour_is_that_beside_the_road_in_the_same_light(seen, picture_of, colour, light, exposure):
    assert paint_colour(*seen, picture_of(PAINT[colour], light, exposure)) == colour


def test_burnt_out_paint_on_a_road_that_is_not_is_white(seen, picture_of):
    """Yellow paint reflects no more blue than asphalt does: it could not be burnt out."""
    picture = picture_of(PAINT["white"], exposure=2)
    assert np.count_nonzero(np.all(picture == 255, axis=2)) > 1000
    assert paint_colour(*seen, picture) == "white"


@pytest.mark.parametrize("paint", PAINT.values(), ids=PAINT)
def test_a_grey_picture_has_no_colour(seen, picture_of, paint):
    grey = cv2.cvtColor(picture_of(paint), cv2.COLOR_BGR2GRAY)
    assert paint_colour(*seen, grey) == ""
    assert paint_colour(*seen, cv2.cvtColor(grey, cv2.COLOR_GRAY2BGR)) == ""


@pytest.mark.parametrize("exposure", [0.008, 5.75], ids=["night", "glare"])
@pytest.mark.parametrize("paint", PAINT.values(), ids=PAINT)
def test_where_the_light_is_too_poor_nothing_is_told(seen, picture_of, paint, exposure):
    picture = picture_of(paint, exposure=exposure)
    assert len(np.unique(picture[-1, 0])) > 1  # the road is not grey
    assert paint_colour(*seen, picture) == ""


def test_a_line_without_paint_has_no_colour(painted_road, picture_of):
    assert paint_colour(*along_and_view(painted_road(length=30)), picture_of(PAINT["yellow"])) == ""
