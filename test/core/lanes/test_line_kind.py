# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Solid and dashed lines, on drawn roads whose paint is known row by row."""

import numpy as np
import pytest

from lane_dp_ros.core.lanes.candidate import LaneLine
from lane_dp_ros.core.lanes.line_kind import longest_run, missing_paint, own_kind, paint_along

CENTRE = 1.025  # m
PER_ROW = 0.25  # m
LENGTH = 30.0  # m


def line_at(view, n=CENTRE, first=0.0, last=100.0):
    rows = np.flatnonzero((view.s >= first) & (view.s <= last))[::-1]
    return LaneLine(rows, view.s[rows], np.full(len(rows), float(n)), bend=0.0, score=10.0)


def along(road, **part):
    paint = road.bands()
    (found,) = paint_along([line_at(paint.view, **part)], paint)
    return found


def kind(road, **part):
    found = along(road, **part)
    return own_kind(found.cover, found.s, PER_ROW)


@pytest.mark.parametrize(
    "dash",
    [(4.0, 8.0), (3.0, 6.0), (6.0, 12.0), (3.0, 3.0), (3.0, 9.0), (1.0, 1.0)],
    ids=lambda dash: "{} m, {} m".format(*dash),
)
@pytest.mark.parametrize("first", [0.0, 2.0])
def test_dashes_are_dashed(painted_road, dash, first):
    assert kind(painted_road(length=LENGTH).line(CENTRE, first=first, dash=dash)) == "dashed"


@pytest.mark.parametrize("brightness", [20, 80, 150])
@pytest.mark.parametrize("width", [0.1, 0.15, 0.3])
def test_a_line_without_gaps_is_solid(painted_road, brightness, width):
    assert kind(painted_road(length=LENGTH).line(CENTRE, width, brightness)) == "solid"


def test_a_line_with_few_gaps_is_a_worn_solid_one(painted_road):
    road = painted_road(length=LENGTH).line(CENTRE)
    gap = (road.s > 12) & (road.s < 14.5)
    road.grey[gap] = 90
    assert kind(road) == "solid"


def test_hatching_that_meets_a_line_leaves_it_solid(painted_road):
    """Every 2 m a stripe of 0.5 m comes in from the right: there is no band, but it is bright all along."""
    road = painted_road(length=LENGTH).line(CENTRE)
    stripes = (road.s % 2 < 0.5)[:, None] & (road.n > CENTRE) & (road.n < CENTRE + 1.5)
    road.grey[stripes] = 170
    paint = road.bands()
    line = line_at(paint.view)
    assert paint.feature(line.rows, paint.view.nearest_columns(line.n)).min() == 0
    assert kind(road) == "solid"


def test_what_hides_a_line_says_nothing_of_it(painted_road):
    """5 m of paint, then a dark road, are a dash; with a thing on the road behind it may be a line."""
    road = painted_road(length=LENGTH).line(CENTRE, last=9)
    hidden = road.s > 9
    assert kind(road) == "dashed"
    road.height[hidden] = 1.0
    assert kind(road) == "solid"
    assert along(road).s[-1] == pytest.approx(8.875)


def test_cover_is_the_share_of_the_lines_own_contrast(painted_road):
    """Certain paint adds 80 grey levels, worn paint 20, the gap none."""
    road = painted_road(length=LENGTH).line(CENTRE, last=16).line(CENTRE, brightness=20, first=16, last=24)
    cover, s = (getattr(along(road), name) for name in ("cover", "s"))
    np.testing.assert_allclose(cover[s < 16], 1, atol=0.01)
    np.testing.assert_allclose(cover[(s > 16) & (s < 24)], 0.25, atol=0.01)
    np.testing.assert_allclose(cover[s > 24], 0, atol=0.01)
    assert missing_paint(cover) == pytest.approx((8 * 0.75 + 10) / 30, abs=0.01)


def test_the_longest_run_is_that_of_near_paint():
    """Beyond 20 m the picture has no gaps to show; a line that begins there is told by what there is."""
    s = np.arange(6.125, 40, 0.25)
    cover = np.where((s < 9) | (s > 20), 1.0, 0.0)
    assert longest_run(cover, s, PER_ROW) == 3.0
    far = s > 16
    assert longest_run(cover[far], s[far], PER_ROW) == pytest.approx(24 - 20, abs=0.26)
    assert longest_run(np.zeros(len(s)), s, PER_ROW) == PER_ROW


def test_of_a_line_out_of_sight_nothing_is_known(painted_road):
    road = painted_road().line(CENTRE)
    road.seen[:] = False
    assert along(road) is None
    assert paint_along([], road.bands()) == []


def test_lines_are_told_of_in_their_order_and_by_themselves(painted_road):
    road = painted_road(length=LENGTH).line(CENTRE, dash=(3, 6)).line(-CENTRE)
    road.seen[:, np.abs(road.n) > 3] = False
    paint = road.bands()
    hidden, solid, dashed = paint_along([line_at(paint.view, n) for n in (3.5, -CENTRE, CENTRE)], paint)
    assert hidden is None
    assert [own_kind(each.cover, each.s, PER_ROW) for each in (solid, dashed)] == ["solid", "dashed"]
    np.testing.assert_array_equal(solid.sections, along(road, n=-CENTRE).sections)


@pytest.mark.parametrize("ground", [0, 90, 255])
def test_without_paint_nothing_breaks(painted_road, ground):
    assert kind(painted_road(ground=ground)) in ("solid", "dashed")
