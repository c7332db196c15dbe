# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The contrast of paint, of cracks, and of the light on the road."""

import numpy as np
import pytest

CENTRE = 1.025  # m
NONE = 0.1  # of contrast; paint has more


def test_contrast_is_that_over_the_road_on_both_sides(painted_road, evidence_of):
    """Asphalt of 90 levels, paint of 170: (170 - 90) / (90 + 10)."""
    assert evidence_of(painted_road().line(CENTRE)).contrast == pytest.approx(0.8, abs=0.01)
    assert evidence_of(painted_road().line(CENTRE, brightness=20)).contrast == pytest.approx(0.2, abs=0.01)


@pytest.mark.parametrize(
    ("ground", "paint", "contrast", "saturation_contrast"),
    [(90, 80, 80 / 100, 80 / 175), (200, 40, 40 / 210, 40 / 65), (20, 6, 6 / 30, 6 / 245)],
    ids=["day", "glare", "night"],
)
def test_saturation_contrast_is_the_share_of_what_is_left_up_to_white(
    painted_road, evidence_of, ground, paint, contrast, saturation_contrast
):
    """In glare paint takes much of it, however little contrast it has; by night the other way round."""
    found = evidence_of(painted_road(ground=ground).line(CENTRE, brightness=paint))
    assert found.contrast == pytest.approx(contrast, abs=0.01)
    assert found.saturation_contrast == pytest.approx(saturation_contrast, abs=0.01)


@pytest.mark.parametrize("side", [-1, 1])
def test_contrast_is_that_against_the_brighter_side(painted_road, evidence_of, side):
    """A kerb's top: (170 - 150) / (150 + 10)."""
    road = painted_road().line(CENTRE)
    road.grey[:, side * (road.n - CENTRE) > 0.1] = 150
    assert evidence_of(road).contrast == pytest.approx(20 / 160, abs=0.01)


def test_road_between_two_cracks_has_no_contrast(painted_road, evidence_of):
    """It is as bright as the road behind the cracks, although it is a bright band between them."""
    road = painted_road()
    for crack in (CENTRE - 0.125, CENTRE + 0.125):
        road.line(crack, width=0.1, brightness=-50)
    found = evidence_of(road)
    assert 0.09 <= found.paint_width <= 0.4  # nothing else tells it
    assert found.contrast < NONE


def test_paint_between_two_cracks_keeps_its_contrast(painted_road, evidence_of):
    road = painted_road().line(CENTRE)
    for crack in (CENTRE - 0.15, CENTRE + 0.15):
        road.line(crack, width=0.05, brightness=-50)
    assert evidence_of(road).contrast == pytest.approx(0.8, abs=0.02)


@pytest.mark.parametrize("side", [-1, 1])
def test_ground_that_is_blown_out_on_one_side_tells_nothing(painted_road, evidence_of, side):
    """The sun on the verge: brighter than the paint, but how the line was painted tells the other side."""
    road = painted_road().line(CENTRE)
    road.grey[:, side * (road.n - CENTRE) > 0.19] = 255
    assert evidence_of(road).contrast == pytest.approx(0.8, abs=0.01)
    road.grey[:, -side * (road.n - CENTRE) > 0.19] = 255
    assert evidence_of(road).contrast < 0  # both sides


@pytest.mark.parametrize("per_metre", [-40, 40])
def test_a_gradient_of_light_is_no_contrast_and_takes_little_of_it(painted_road, evidence_of, per_metre):
    light = per_metre * (np.arange(200) * 0.05 + 0.025 - 5 - CENTRE)[None]
    bare, line = painted_road(), painted_road().line(CENTRE)
    for road in (bare, line):
        road.grey += light
    assert evidence_of(bare).contrast < NONE
    brighter = 90 + 40 * 0.325  # levels; the flank is 0.2 m to 0.45 m aside
    assert evidence_of(line).contrast == pytest.approx((170 - brighter) / (brighter + 10), abs=0.03)


def test_the_border_of_a_shadow_has_no_contrast(painted_road, evidence_of):
    assert evidence_of(painted_road().step(CENTRE, brightness=60)).contrast < NONE
