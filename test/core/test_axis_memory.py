# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The axis of a moment ago is asked for where the road's axis leaps, and forgotten soon."""

import pytest
from lane_dp_ros.core.axis_memory import CURVATURE_LEAP, HEADING_LEAP, MEMORY_NS, AxisMemory

from lane_dp_ros.core.geometry.road_axis import RoadAxis

KNOWN = RoadAxis(0.1, 0.03)
TENTH = 100_000_000  # ns


def remembering(axis=KNOWN, stamp_ns=0):
    memory = AxisMemory()
    memory.update(axis, stamp_ns)
    return memory


def test_without_a_pair_before_there_is_no_other_axis():
    assert AxisMemory().other_axis(KNOWN, 0) is None


@pytest.mark.parametrize(
    ("heading", "curvature", "leaps"),
    [
        (0.0, 0.0, False),
        (0.9 * HEADING_LEAP, -0.9 * CURVATURE_LEAP, False),
        (1.1 * HEADING_LEAP, 0.0, True),
        (0.0, -1.1 * CURVATURE_LEAP, True),
    ],
)
def test_only_a_leap_brings_the_axis_before_back(heading, curvature, leaps):
    axis = RoadAxis(KNOWN.heading + heading, KNOWN.curvature + curvature)
    assert remembering().other_axis(axis, TENTH) == (KNOWN if leaps else None)


@pytest.mark.parametrize(("stamp_ns", "known"), [(MEMORY_NS, True), (MEMORY_NS + 1, False), (-1, False)])
def test_it_forgets_soon_and_when_time_runs_backwards(stamp_ns, known):
    assert (remembering().other_axis(RoadAxis(), stamp_ns) is not None) == known


def test_it_follows_the_road():
    memory = remembering()
    memory.update(RoadAxis(0.0, 0.0), TENTH)
    assert memory.other_axis(RoadAxis(0.01, 0.0), 2 * TENTH) is None
    assert memory.other_axis(KNOWN, 2 * TENTH) == RoadAxis(0.0, 0.0)
