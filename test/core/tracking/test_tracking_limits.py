# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Whatever comes in, tracking answers, and with numbers."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lane_dp_ros.core.tracking.tracker import LaneTracker
from lane_dp_ros.core.types import Lane

FRAME = 100_000_000  # ns


def lane(points, offset=0.0):
    return Lane(np.reshape(np.asarray(points, dtype=np.float64), (-1, 3)), 0.8, 0.15, "other", 0.0, offset)


coordinates = st.floats(-60, 60)
point = st.tuples(coordinates, st.floats(-3, 3), coordinates)
curved = st.builds(
    lambda x, slope, bend, first, length: [
        (x + slope * z + bend * z * z, 1.65, z) for z in np.linspace(first, first + length, 30)
    ],
    st.floats(-9, 9), st.floats(-1, 1), st.floats(-0.03, 0.03), st.floats(2, 30), st.floats(0, 30),
)  # fmt: skip
lanes = st.lists(
    st.builds(lane, st.one_of(curved, st.lists(point, min_size=1, max_size=4)), st.floats(-9, 9)), max_size=5
)


@settings(max_examples=60, deadline=None)
@given(st.lists(st.tuples(lanes, st.integers(0, 6)), min_size=1, max_size=10))
def test_every_answer_is_numbers_with_an_id_of_its_own(frames):
    tracker, stamp_ns = LaneTracker(), 0
    for found, steps in frames:
        for repeat in range(2):  # seen again, lines are smoothed, and at last bridged
            stamp_ns += steps * FRAME // 2
            published = tracker.update(found, stamp_ns)
            assert len({lane.id for lane in published}) == len(published), repeat
            assert all(np.all(np.isfinite(lane.points)) for lane in published)
            assert all(0 < lane.confidence <= 1 and np.isfinite(lane.lateral_offset) for lane in published)


@pytest.mark.parametrize(
    "broken",
    [
        lane(np.empty((0, 3))),
        lane([[1.0, 1.6, np.nan]]),
        lane([[1.0, 1.6, np.inf]]),
        lane([[1.0, 1.6, 8.0], [1.0, 1.6, 1e300]]),
        lane([[1.0, 1.6, 8.0]], offset=np.nan),
    ],
    ids=["empty", "nan", "inf", "huge", "offset"],
)
def test_a_lane_that_is_none_is_dropped(broken):
    tracker = LaneTracker()
    whole = lane([[1.0, 1.6, z] for z in np.arange(6.0, 20.0, 0.5)], offset=1.0)
    for k in range(6):
        assert [lane.id for lane in tracker.update([broken, whole], k * FRAME)] == [0]


def test_lines_of_one_point_keep_their_ids():
    tracker = LaneTracker()
    for k in range(10):
        found = [lane([[x, 1.65, 8.0]], offset=x) for x in (-1.75, 1.75)]
        assert [lane.id for lane in tracker.update(found, k * FRAME)] == [0, 1]
    assert len(tracker.update([], 10 * FRAME)) == 2


def test_equal_stamps_are_no_jump():
    tracker = LaneTracker()
    found = [lane([[1.0, 1.6, z] for z in np.arange(6.0, 20.0, 0.5)], offset=1.0)]
    for _ in range(20):
        (again,) = tracker.update(found, 5)
        assert again.id == 0
        assert again.points == pytest.approx(found[0].points, abs=1e-6)
