# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The straightened course of a line."""

import numpy as np
import pytest

from lane_dp_ros.core.geometry.road_axis import RoadAxis
from lane_dp_ros.core.tracking.frenet_line import FrenetLine, common_axis, first_axis, surface_change

AXES = {
    "ahead": RoadAxis(),
    "turned": RoadAxis(0.3),
    "left": RoadAxis(-0.1, -0.012),
    "ramp": RoadAxis(0.25, 1 / 30),
}
S = np.arange(5.0, 25.0, 0.25)


@pytest.fixture(params=AXES, ids=str)
def axis(request):
    return AXES[request.param]


def line(axis, n, s=S, down=1.65):
    x, z = axis.to_ground(s, np.full_like(s, n))
    return np.column_stack([x, np.full_like(s, down), z])


def test_points_come_back(axis):
    points = line(axis, -3.5)
    assert FrenetLine.of(points, axis).points(axis) == pytest.approx(points, abs=1e-9)
    other = RoadAxis(axis.heading + 0.05, axis.curvature + 0.005)
    assert FrenetLine.of(points, other).points(other) == pytest.approx(points, abs=1e-9)


@pytest.mark.parametrize("n", [-5.25, 0.0, 3.5])
def test_a_concentric_line_has_the_axis_direction(axis, n):
    course = FrenetLine.of(line(axis, n), axis)
    assert course.offsets(axis) == pytest.approx(n)
    assert course.place(axis) == pytest.approx(n)
    assert course.strays(axis) == pytest.approx(0, abs=1e-9)


def test_the_place_is_that_in_most_rows_of_the_picture():
    """Half of the rows from 5 to 24.75 m are those up to 8.3 m."""
    half = 2 / (1 / S[0] + 1 / S[-1])
    course = FrenetLine(S, np.where(half > S, 1.0, 3.0), S)
    assert course.place(RoadAxis()) == pytest.approx(2.0, abs=0.1)


def test_the_axis_is_found_from_concentric_lines(axis):
    found = first_axis([line(axis, n) for n in (-5.25, -1.75, 1.75)])
    assert found.heading == pytest.approx(axis.heading, abs=0.01)
    assert found.curvature == pytest.approx(axis.curvature, abs=0.001)


@pytest.mark.parametrize("lines", [[], [np.array([[1.0, 1.6, 8.0]])]], ids=["none", "point"])
def test_the_axis_of_next_to_nothing_is_straight_ahead(lines):
    found = first_axis(lines)
    assert abs(found.heading) < 0.2
    assert abs(found.curvature) < 0.01


def test_an_axis_bends_no_more_than_a_road():
    """A line that runs off at right angles."""
    z = np.linspace(5, 6, 20)
    found = common_axis([FrenetLine(z, 30 * (z - 5), np.ones(20))])
    assert abs(found.heading) <= 0.8
    assert abs(found.curvature) <= 0.06


def test_side():
    a, b = FrenetLine(S, 0.1 * S + 1, S), FrenetLine(S[40:], 0.1 * S[40:] + 1.4, S[40:])
    assert a.aside(b) == pytest.approx(-0.4)
    assert b.aside(a) == pytest.approx(0.4)


def test_a_part_of_less_than_3_m_is_not_compared():
    near, far = FrenetLine(S[:40], S[:40], S[:40]), FrenetLine(S[30:], S[30:], S[30:])
    assert len(near.aside(far)) > 0
    assert len(FrenetLine(S[:10], S[:10], S[:10]).aside(FrenetLine(S[50:], S[50:], S[50:]))) == 0
    assert near.within(far) is None


def test_moving_onto_another_line_keeps_the_bend():
    wave = 0.05 * np.sin(S / 2)
    seen = FrenetLine(S, wave, np.ones_like(S))
    moved = seen.onto(FrenetLine(S[8:], 0.3 + 0.01 * S[8:] + wave[8:], np.ones_like(S[8:])))
    assert moved.y[8:] == pytest.approx(0.3 + 0.01 * S[8:] + wave[8:], abs=0.01)
    assert moved.y[:8] - wave[:8] == pytest.approx(
        moved.y[8] - wave[8], abs=0.005
    )  # beyond it, as at its end
    assert seen.onto(FrenetLine(S + 100, S, S)) is seen


@pytest.mark.parametrize("slide", [(0.01, 0.0), (0.0, 0.001), (-0.01, 0.0005)])
def test_points_slide_along_their_rays(axis, slide):
    """Where every point is farther off by a part of its distance, that of s ahead being larger."""
    points = line(axis, -3.5)
    farther = points * (1 + slide[0] + slide[1] * S)[:, None]
    expected, slid = FrenetLine.of(farther, axis), FrenetLine.of(points, axis).slid(np.array(slide), axis)
    assert np.interp(slid.s[5:-5], expected.s, expected.offsets(axis)) == pytest.approx(
        slid.offsets(axis)[5:-5], abs=0.01
    )


def test_the_surface_moves_as_under_the_lines():
    before = [FrenetLine(S, np.full_like(S, y), np.full_like(S, 1.65)) for y in (-2.0, 2.0)]
    now = [FrenetLine(c.s, c.y, c.down - 0.03 + 0.004 * c.s + 0.002 * c.y) for c in before]
    change = surface_change(zip(before, now, strict=True))
    assert change == pytest.approx([-0.03, 0.004, 0.002], abs=0.01)
    lowered = before[0].lowered(change)
    assert lowered.down == pytest.approx(now[0].down, abs=0.01)


def test_the_surface_stays_where_no_line_is_seen():
    assert surface_change([]) == pytest.approx(0)
