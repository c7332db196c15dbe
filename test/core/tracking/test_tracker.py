# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The identity of lanes over time."""

import numpy as np
import pytest

from lane_dp_ros.core.parameter import parameters
from lane_dp_ros.core.tracking.tracker import LaneTracker, TrackingConfig
from lane_dp_ros.core.types import Lane

FRAME = 100_000_000  # ns: 10 Hz
START = 1_316_533_000_000_000_000  # ns, a stamp of KITTI's September 2011


def lane(offset):
    points = np.array([[offset, 1.65, 5.0], [offset, 1.65, 5.5]])
    return Lane(points, 0.9, 0.15, "other", 0.0, offset)


def ids(tracker, offsets, stamp_ns):
    return [lane.id for lane in tracker.update([lane(n) for n in offsets], stamp_ns)]


def test_the_first_frame_is_answered():
    lanes = [lane(-1.75), lane(1.75)]
    found = LaneTracker().update(lanes, START)
    assert len({lane.id for lane in found}) == 2
    assert all(lane.id >= 0 for lane in found)
    for before, after in zip(lanes, found, strict=True):
        assert after.points is before.points
        assert after.lateral_offset == before.lateral_offset


def test_ids_persist_while_lines_move_in_a_lane_change():
    """3.5 m to the left in 3 s: every line moves 0.12 m to the right a frame, and keeps its id."""
    tracker = LaneTracker()
    offsets = np.array([-5.25, -1.75, 1.75])
    first = ids(tracker, offsets, START)
    for i in range(1, 31):
        assert ids(tracker, offsets + i * 3.5 / 30, START + i * FRAME) == first


def test_ids_do_not_depend_on_the_order_of_the_lanes():
    tracker = LaneTracker()
    left, right = ids(tracker, [-1.75, 1.75], START)
    assert ids(tracker, [1.8, -1.7], START + FRAME) == [right, left]


def test_lines_close_together_are_not_swapped():
    """Both lines of a double line move aside by 0.12 m, towards where the other one was."""
    tracker = LaneTracker()
    first = ids(tracker, [1.6, 1.9], START)
    assert ids(tracker, [1.72, 2.02], START + FRAME) == first


def test_an_id_is_given_once_a_frame():
    tracker = LaneTracker()
    (known,) = ids(tracker, [1.75], START)
    found = ids(tracker, [1.4, 1.8], START + FRAME)
    assert found[1] == known
    assert found[0] != known


def test_a_new_line_gets_a_new_id():
    tracker = LaneTracker()
    (known,) = ids(tracker, [1.75], START)
    assert ids(tracker, [1.75, 2.3], START + FRAME)[0] == known
    assert len(set(ids(tracker, [-1.75, 1.75, 2.3], START + 2 * FRAME))) == 3


@pytest.mark.parametrize(("moved", "same"), [(0.49, True), (0.51, False)])
def test_a_line_that_leaps_aside_is_another_one(moved, same):
    tracker = LaneTracker()
    first = ids(tracker, [1.0], START)
    assert (ids(tracker, [1.0 + moved], START + FRAME) == first) == same


def far_lane(offset, slope, first=20.0, last=34.0):
    """A line seen from far ahead on: x = offset + slope z."""
    z = np.linspace(first, last, 30)
    points = np.column_stack([offset + slope * z, np.full_like(z, 1.65), z])
    return Lane(points, 0.9, 0.15, "other", 0.0, offset)


def test_a_far_line_keeps_its_id_though_its_offset_beside_the_vehicle_is_a_guess():
    """The slope is off by 2 degrees: at 27 m the same place, beside the vehicle 0.95 m apart."""
    tracker = LaneTracker()
    (first,) = tracker.update([far_lane(1.6, 0.0)], START)
    (again,) = tracker.update([far_lane(1.6 + 27 * 0.035, -0.035, first=12.0)], START + FRAME)
    assert again.id == first.id


def test_a_line_keeps_its_id_while_the_vehicle_turns():
    """By 2 degrees a frame: at 27 m it moves aside by 0.95 m, beside the vehicle it stays."""
    tracker = LaneTracker()
    (first,) = tracker.update([far_lane(1.6, 0.0)], START)
    (again,) = tracker.update([far_lane(1.6, 0.035)], START + FRAME)
    assert again.id == first.id


@pytest.mark.parametrize(("frames", "same"), [(10, True), (11, False)])
def test_a_line_that_is_not_seen_keeps_its_id_for_a_second(frames, same):
    tracker = LaneTracker()
    left, right = ids(tracker, [-1.75, 1.75], START)
    for i in range(1, frames):
        assert ids(tracker, [-1.75], START + i * FRAME) == [left]
    found = ids(tracker, [-1.75, 1.75], START + frames * FRAME)
    assert found[0] == left
    assert (found[1] == right) == same


@pytest.mark.parametrize(
    ("jump", "same"),
    [(0, True), (1_000_000_000, True), (1_000_000_001, False), (-1, False), (-60_000_000_000, False)],
)
def test_everything_is_forgotten_when_stamps_jump_or_run_backwards(jump, same):
    tracker = LaneTracker()
    first = ids(tracker, [-1.75, 1.75], START)
    again = ids(tracker, [-1.75, 1.75], START + jump)
    assert (again == first) == same
    assert same or not set(first) & set(again)  # ids are never given a second time


def test_after_a_jump_tracking_goes_on():
    tracker = LaneTracker()
    ids(tracker, [1.75], START)
    (new,) = ids(tracker, [1.75], START - FRAME)
    assert ids(tracker, [1.75], START) == [new]


def test_a_frame_without_lanes_is_answered_and_remembered_as_one():
    tracker = LaneTracker()
    first = ids(tracker, [1.75], START)
    assert tracker.update([], START + FRAME) == ()
    assert ids(tracker, [1.75], START + 2 * FRAME) == first


def test_a_line_that_coasts_as_long_as_it_may_keeps_some_confidence():
    """However fast a lost line is doubted: a confidence is more than 0."""
    doubted = parameters(TrackingConfig())["confidence_decay"].maximum
    tracker = LaneTracker(TrackingConfig(confidence_decay=doubted, coast_time=0.5))
    both, one = [lane(-1.75), lane(1.75)], [lane(-1.75)]
    for i in range(8):
        tracker.update(both, START + i * FRAME)
    *_, coasted = (tracker.update(one, START + (8 + i) * FRAME) for i in range(5))
    assert [0 < each.confidence < 0.1 for each in coasted] == [False, True]
