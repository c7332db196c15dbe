# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Road coordinates along an arc: hand-made numbers, and every coordinate there and back."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lane_dp_ros.core.geometry.road_axis import RoadAxis

pytestmark = pytest.mark.filterwarnings("error")


def arrays(*numbers):
    return [np.array([number], dtype=float) for number in numbers]


@pytest.mark.parametrize("axis", [RoadAxis(0.1, 0.01), RoadAxis(0.1, 0.0)], ids=["arc", "straight"])
def test_single_precision_stays_single(axis):
    a = np.full(3, 20, np.float32)
    results = [axis.offset(a, a), *axis.to_ground(a, a), *axis.from_ground(a, a)]
    assert {result.dtype for result in results} == {np.dtype(np.float32)}


QUARTER = np.pi / 2 * 10  # m; of a circle of 10 m radius


@pytest.mark.parametrize(
    ("axis", "s", "n", "x", "z"),
    [
        (RoadAxis(), 10, 2, 2, 10),
        (RoadAxis(heading=np.pi / 6), 10, 0, 5, 10 * np.cos(np.pi / 6)),
        (RoadAxis(heading=np.pi / 2), 10, 2, 10, -2),  # to the right; n > 0 is then behind
        (RoadAxis(curvature=0.1), QUARTER, 0, 10, 10),
        (RoadAxis(curvature=0.1), QUARTER, 2, 10, 8),
        (RoadAxis(curvature=-0.1), QUARTER, 0, -10, 10),
        (RoadAxis(curvature=-0.1), QUARTER, 2, -10, 12),
        (RoadAxis(curvature=0.1), 0, 3, 3, 0),
    ],
)
def test_road_coordinates_by_hand(axis, s, n, x, z):
    ground = np.ravel(axis.to_ground(*arrays(s, n)))
    assert ground == pytest.approx((x, z), abs=1e-9)
    assert np.ravel(axis.from_ground(*arrays(x, z))) == pytest.approx((s, n), abs=1e-9)
    assert axis.offset(*arrays(x, z)) == pytest.approx(n, abs=1e-9)


@given(
    heading=st.floats(-0.8, 0.8),
    curvature=st.floats(-0.05, 0.05),
    s=st.floats(0, 50),
    n=st.floats(-15, 15),
)
def test_road_coordinates_come_back_from_the_ground(heading, curvature, s, n):
    axis = RoadAxis(heading, curvature)
    there_and_back = np.ravel(axis.from_ground(*axis.to_ground(*arrays(s, n))))
    assert there_and_back == pytest.approx((s, n), abs=1e-3)  # below 1e-6 1/m an arc is taken for straight


@given(curvature=st.floats(-3e-6, 3e-6), s=st.floats(0, 100), n=st.floats(-10, 10))
def test_an_almost_straight_arc_is_almost_straight(curvature, s, n):
    ground = np.ravel(RoadAxis(0.1, curvature).to_ground(*arrays(s, n)))
    straight = np.ravel(RoadAxis(0.1).to_ground(*arrays(s, n)))
    assert ground == pytest.approx(straight, abs=0.5 * 3e-6 * 100**2 + 0.01)
