# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The heights of a line and of the ground beside it, on drawn roads whose numbers are known."""

import numpy as np
import pytest

from lane_dp_ros.core import lane_evidence
from lane_dp_ros.core.config import LaneSelectionConfig

CENTRE = 1.025  # m
LIMITS = LaneSelectionConfig()


@pytest.mark.parametrize("height", [-0.1, 0.0, 0.09])
def test_height_is_that_of_the_paint_above_the_road(painted_road, evidence_of, height):
    road = painted_road().line(CENTRE)
    road.height[:, np.abs(road.n - CENTRE) < 0.2] = height
    assert evidence_of(road).height == pytest.approx(height)


@pytest.mark.parametrize(("ground", "height"), [(0.015, 0.03), (0.02, 0.025), (0.2, 0.025), (-0.2, 0.045)])
def test_where_the_road_bulges_paint_is_no_higher(painted_road, evidence_of, ground, height):
    """By a little more than a quadratic follows; not by a pavement or a ditch on both sides."""
    road = painted_road().line(CENTRE)
    road.height[:] = ground
    road.height[:, np.abs(road.n - CENTRE) < 0.2] = 0.045
    assert evidence_of(road).height == pytest.approx(height)


@pytest.mark.parametrize("other", [0.0, np.nan])
def test_a_road_that_is_higher_on_one_side_alone_is_no_bulge(painted_road, evidence_of, other):
    road = painted_road().line(CENTRE)
    road.height[:, road.n > CENTRE] = other
    road.height[:, road.n < CENTRE] = 0.02
    road.height[:, np.abs(road.n - CENTRE) < 0.2] = 0.045
    assert evidence_of(road).height == pytest.approx(0.045)


def test_a_railing_stands_above_the_road(painted_road, evidence_of):
    road = painted_road().line(CENTRE)
    road.height[:, np.abs(road.n - CENTRE) < 0.2] = 0.11  # not enough to be masked
    assert evidence_of(road).height > LIMITS.height_max


def test_without_disparity_neither_height_nor_step_is_known(painted_road, evidence_of):
    road = painted_road().line(CENTRE)
    road.height[:] = np.nan
    found = evidence_of(road)
    assert np.isnan(found.height)
    assert found.step == 0


@pytest.mark.parametrize(("cells", "known"), [(5, False), (6, True)])
def test_a_few_cells_do_not_tell_a_height(painted_road, evidence_of, cells, known):
    road = painted_road().line(CENTRE)
    road.height[:] = np.nan
    road.height[10 : 10 + cells, np.abs(road.n - CENTRE).argmin()] = 0.03
    assert np.isfinite(evidence_of(road).height) == known


@pytest.mark.parametrize(("factor", "known"), [(0.9, True), (1.1, False)])
def test_heights_that_scatter_are_not_known(painted_road, evidence_of, factor, known):
    """A fence before a far background: half of the cells lie on it, half far below."""
    road = painted_road().line(CENTRE)
    road.height[::2] = factor * lane_evidence.HEIGHT_SPREAD
    assert np.isfinite(evidence_of(road).height) == known


def test_a_few_wrong_heights_change_nothing(painted_road, evidence_of):
    road = painted_road().line(CENTRE)
    road.height[:, np.abs(road.n - CENTRE) < 0.2] = 0.02
    road.height[::5] = -3.0
    assert evidence_of(road).height == pytest.approx(0.02)


def test_heights_far_off_are_not_looked_at(painted_road, evidence_of):
    """There a pixel of disparity is decimetres."""
    road = painted_road()
    road.s = road.s + 10  # 14 m to 34 m
    road.line(CENTRE)
    road.height[road.s > lane_evidence.HEIGHT_DEPTH] = 5.0
    assert evidence_of(road).height == 0
    road.height[road.s < lane_evidence.HEIGHT_DEPTH] = np.nan
    assert np.isnan(evidence_of(road).height)


@pytest.mark.parametrize("side", [-1, 1])
@pytest.mark.parametrize("height", [0.04, 0.15])
def test_a_step_is_how_much_higher_the_ground_beside_the_line_is(painted_road, evidence_of, side, height):
    """The kerb beside a gutter; a ditch on the other side does not hide it."""
    road = painted_road().line(CENTRE)
    aside = side * (road.n - CENTRE)
    road.height[:] = -0.01
    road.height[:, aside > 0.3] = height - 0.01
    road.height[:, aside < -0.3] = -0.11
    assert evidence_of(road).step == pytest.approx(height)


def test_where_one_side_is_not_matched_the_other_one_tells_the_step(painted_road, evidence_of):
    road = painted_road().line(CENTRE)
    road.height[:, road.n < CENTRE - 0.3] = np.nan
    assert evidence_of(road).step == 0
    road.height[:, road.n > CENTRE + 0.3] = 0.12
    assert evidence_of(road).step == pytest.approx(0.12)


def test_a_ditch_is_no_step(painted_road, evidence_of):
    road = painted_road().line(CENTRE)
    road.height[:, np.abs(road.n - CENTRE) > 0.3] = -0.2
    assert evidence_of(road).step == pytest.approx(-0.2)
