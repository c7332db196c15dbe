# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Rendered crests of which another curvature is known, and roads that have none."""

from dataclasses import replace

import numpy as np
import pytest

from lane_dp_ros.core.geometry.vertical_curve import VerticalCurve
from lane_dp_ros.core.road import direct_alignment
from lane_dp_ros.core.road.crest_search import search_crest
from lane_dp_ros.core.road.direct_alignment import aligned
from lane_dp_ros.core.road.disparity import DisparityConfig, dense_disparity
from lane_dp_ros.core.road.road_bands import road_bands
from lane_dp_ros.core.types import StereoFrame
from lane_dp_ros.scenes import CAMERA

pytestmark = pytest.mark.filterwarnings("error")

STEP = 3e-4  # 1/m between the curvatures that are tried
LEVEL = VerticalCurve.plane(CAMERA, 1.65, 0.012)


def road_with(curvature):
    """Return the surface of a rendered hill: the tangent at the camera is that of the flat road."""
    foot, slope, _, _ = LEVEL.coefficients
    return VerticalCurve.of_foot(CAMERA, foot, slope, curvature)


def wrong(surface, more):
    """Return the surface with another curvature; the road 10 m ahead stays."""
    return surface.with_coefficients(surface.coefficients + np.array([0, 0, more, 0]))


def seen(pair):
    """Return the pair and its disparity."""
    frame = StereoFrame(pair.left, pair.right)
    return frame, dense_disparity(frame, CAMERA, DisparityConfig(), 103.0)


def searched(surface, frame, disparity):
    return search_crest(surface, road_bands(frame, disparity, surface)[0], disparity)


@pytest.mark.parametrize("more", [-0.0015, 0.0015])
@pytest.mark.parametrize("curvature", [-0.004, -0.003])
def test_a_crest_of_another_curvature_is_found(hill_of, curvature, more):
    truth = road_with(curvature)
    frame, disparity = seen(hill_of(curvature))
    found = searched(wrong(truth, more), frame, disparity)
    assert found.vertical_curvature == pytest.approx(curvature, abs=1.5 * STEP)
    assert found.coefficients[:2] == truth.coefficients[:2]  # the near road stays
    registered = aligned(wrong(truth, more), frame, disparity).surface
    assert registered.vertical_curvature == pytest.approx(curvature, abs=4e-4)
    assert registered.camera_height == pytest.approx(truth.camera_height, rel=0.01)
    assert registered.covariance is not None


def test_a_known_crest_stays_within_a_step(hill_of):
    truth = road_with(-0.003)
    found = searched(truth, *seen(hill_of(-0.003)))
    assert found.vertical_curvature == pytest.approx(-0.003, abs=1.1 * STEP)


@pytest.mark.parametrize("bend", [0.0, 0.004], ids=["flat", "sag"])
def test_where_no_crest_hides_the_road_none_is_searched(hill_of, monkeypatch, bend):
    def search_crest(*_):
        raise AssertionError("searched")

    monkeypatch.setattr(direct_alignment, "search_crest", search_crest)
    frame, disparity = seen(hill_of(bend))
    found = aligned(road_with(bend), frame, disparity).surface
    assert found.vertical_curvature == pytest.approx(bend, abs=3e-4)


def test_a_flat_road_that_is_searched_stays_flat(hill_of):
    found = searched(LEVEL, *seen(hill_of(0.0)))
    assert found.vertical_curvature == pytest.approx(0, abs=1.1 * STEP)


def test_without_texture_what_is_known_stays(hill_of):
    frame, disparity = seen(hill_of(-0.003))
    blank = StereoFrame(*(np.full_like(frame.left, 90) for _ in range(2)))
    crest = road_with(-0.0025)
    assert searched(crest, blank, disparity) is crest


def test_of_a_crest_that_a_vehicle_hides_what_is_known_stays(hill_of):
    frame, disparity = seen(hill_of(-0.003))
    hidden = replace(disparity, matched=np.full_like(disparity.matched, 60.0))  # 6.5 m ahead
    crest = road_with(-0.0025)
    assert searched(crest, frame, hidden) is crest
