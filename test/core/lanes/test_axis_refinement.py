# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The road's axis by the paint that lies askew of it, on lines whose course is known."""

from dataclasses import replace

import numpy as np
import pytest

from lane_dp_ros.core.geometry.road_axis import RoadAxis
from lane_dp_ros.core.lanes.axis_refinement import AxisRefinement, AxisRefinementConfig
from lane_dp_ros.core.lanes.candidate import Candidate, LaneEvidence, LaneLine
from lane_dp_ros.core.lanes.scoring import EvidenceScoring
from lane_dp_ros.core.lanes.selection import LaneSelectionConfig

SLOPE_COST, CURVATURE_MAX = 4.0, 0.05
SCORING = EvidenceScoring(LaneSelectionConfig())
REFINEMENT = AxisRefinement(AxisRefinementConfig(), SCORING, SLOPE_COST, CURVATURE_MAX)
PAINT = LaneEvidence(
    length=20.0,
    start=5.0,
    slope=0.3,  # more than a line along the axis may have
    score=15.0,
    paint_width=0.15,
    wide_band_ratio=0.4,
    height=0.0,
    kerb_step=0.0,
    off_paint_fraction=0.02,
    texture=0.05,
    contrast=0.5,
    saturation_contrast=0.5,
    relative_contrast=1.0,
    brightness=0.5,
    painted=0.9,
    rise=0.0,
)
KERB = replace(PAINT, contrast=0.1, saturation_contrast=0.05, relative_contrast=0.3, height=0.08, rise=0.12)
STREAK = replace(PAINT, height=np.nan)
ASKEW = np.tan(np.deg2rad(15))


def line(n, slope=ASKEW, bend=0.0, score=10.0, first=5.0, last=25.0):
    s = np.arange(first, last, 0.25)
    return LaneLine(np.arange(len(s)), s, n + slope * s + bend / 2 * s**2, bend, score)


def turned(*lines, axis=None, refinement=REFINEMENT):
    """Return the axis by lines, each with its evidence."""
    return refinement.refine([Candidate(*each) for each in lines], axis or RoadAxis())


@pytest.mark.parametrize("heading", [-0.1, 0.0, 0.2])
@pytest.mark.parametrize("slope", [-ASKEW, ASKEW, 0.1])
def test_lines_askew_give_the_axis(heading, slope):
    found = turned((line(-2, slope), PAINT), (line(1.5, slope), PAINT), axis=RoadAxis(heading))
    assert found.heading == pytest.approx(heading + np.arctan(slope), abs=1e-4)
    assert found.curvature == pytest.approx(0, abs=1e-4)


def test_their_bend_is_added_to_the_curvature():
    found = turned((line(-2, bend=0.01), PAINT), (line(1.5, bend=0.01), PAINT), axis=RoadAxis(0, -0.004))
    assert found.curvature == pytest.approx(0.006, abs=0.0005)
    assert found.heading == pytest.approx(np.arctan(ASKEW), abs=0.005)


@pytest.mark.parametrize("sign", [-1, 1])
def test_no_axis_bends_more_than_it_may(sign):
    candidate = line(-2, slope=sign * ASKEW, bend=sign * 0.04), PAINT
    found = turned(candidate, axis=RoadAxis(0, sign * 0.03))
    assert found.curvature == sign * 0.05


@pytest.mark.parametrize("axis", [RoadAxis(0.26), RoadAxis(-0.26), RoadAxis(-0.3, 0.01), RoadAxis(0.2, 0.01)])
def test_along_the_turned_axis_the_lines_run_straight_ahead(axis):
    """Concentric lines of a road, looked at straight ahead first."""
    s = np.arange(3.0, 28.0, 0.25)
    offsets = (-3.5, 0.0, 3.5)
    seen = [RoadAxis().from_ground(*axis.to_ground(s, np.full_like(s, n))) for n in offsets]
    lines = [LaneLine(np.arange(len(s)), s0, n0, 0.0, 10.0) for s0, n0 in seen]
    found = turned(*[(each, PAINT) for each in lines])
    for each in lines:
        again, n = found.from_ground(each.n, each.s)
        assert abs(np.polyfit(again, n, 1)[0]) < 0.03
    assert found.heading == pytest.approx(axis.heading, abs=0.03)


@pytest.mark.parametrize("other", [KERB, STREAK], ids=["kerb", "unknown height"])
def test_what_may_be_no_paint_has_no_say(other):
    assert turned((line(-2), other), (line(1.5), other)) is None
    found = turned((line(-2, slope=-0.3, score=30), other), (line(1.5), PAINT))
    assert found.heading == pytest.approx(np.deg2rad(15), abs=1e-4)


def test_weak_lines_have_no_say():
    enough = 2.2 - 4.0 * ASKEW**2 * line(0).length
    assert turned((line(0, score=enough - 0.1), PAINT)) is None
    assert turned((line(0, score=enough + 0.1), PAINT)) is not None


def test_what_the_slope_took_from_a_line_it_gets_back():
    """Askew, the line of less score has more paint: 10 m of it less 1.4 m, against 9 m."""
    lost = 4.0 * ASKEW**2 * line(0).length
    assert turned((line(-2, score=10 - lost), PAINT), (line(1.5, slope=0, score=9.0), PAINT)) is not None


def test_where_most_paint_lies_along_the_axis_it_stays():
    assert turned((line(-2, slope=0, score=30), PAINT), (line(1.5, score=5), PAINT)) is None
    assert turned((line(-2, slope=0, score=5), PAINT), (line(1.5, score=30), PAINT)) is not None


@pytest.mark.parametrize("slope", [-1, 1])
def test_lines_a_little_oblique_turn_nothing(slope):
    assert turned((line(0, slope=slope * 0.075), PAINT)) is None
    assert turned((line(0, slope=slope * 0.085), PAINT)) is not None


def test_a_line_that_leads_somewhere_else_does_not_turn_the_axis():
    other = line(4, slope=ASKEW - 0.20, score=8.0)
    found = turned((line(-2), PAINT), (line(1.5), PAINT), (other, PAINT))
    assert found.heading == pytest.approx(np.deg2rad(15), abs=1e-3)


def test_without_lines_there_is_no_other_axis():
    assert turned() is None


@pytest.mark.parametrize(
    ("config", "turns"),
    [
        ({}, True),
        ({"slope_min": 0.28}, False),
        ({"score_min": 16.0}, False),
    ],
    ids=str,
)
def test_the_limits_are_those_of_the_configuration(config, turns):
    refinement = AxisRefinement(AxisRefinementConfig(**config), SCORING, SLOPE_COST, CURVATURE_MAX)
    assert (turned((line(-2), PAINT), refinement=refinement) is not None) == turns


def test_what_is_refused_for_its_slope_alone_has_a_say():
    """Whatever the refusal that a candidate carries says: it is judged by its evidence, but for the slope."""
    askew = Candidate(line(-2), PAINT, "path", "slope 0.30")
    assert REFINEMENT.refine([askew], RoadAxis()).heading == pytest.approx(np.deg2rad(15), abs=1e-4)
