# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Lanes over time on drives whose lines are known: what is published lies on them, seen or not."""

from dataclasses import asdict, replace

import numpy as np
import pytest

from lane_dp_ros.core.tracking.tracker import LaneTracker, TrackingConfig
from lane_dp_ros.core.types import Lane, with_roles

FRAME = 100_000_000  # ns: 10 Hz
STEP = 1.5  # m a frame: 15 m/s
AHEAD = np.arange(6.0, 30.0, 0.25)  # m of depth over which lines are seen
HEIGHT = 1.65  # m
LANES = (-5.25, -1.75, 1.75)  # m
NOISE = 0.015  # m


class Drive:
    """A road in the world, x and z [m], and a vehicle on it; `curvature` [1/m] is given for each metre.

    `offsets` are functions of the distance along the road, `aside` [m] and `yaw` [rad] of the frame's number.
    """

    def __init__(self, curvature=lambda s: 0 * s, offsets=LANES, aside=np.zeros_like, yaw=np.zeros_like):
        self.s = np.arange(0.0, 400.0, 0.25)
        self.heading = np.cumsum(curvature(self.s)) * 0.25
        self.x, self.z = np.cumsum(np.sin(self.heading)) * 0.25, np.cumsum(np.cos(self.heading)) * 0.25
        self.offsets = [n if callable(n) else (lambda s, n=n: n + 0 * s) for n in offsets]
        self.aside, self.yaw = aside, yaw

    def line(self, i, frame):
        """Return x [m] at AHEAD of line i as the vehicle sees it."""
        n, along = self.offsets[i](self.s), frame * STEP
        x = self.x + n * np.cos(self.heading)
        z = self.z - n * np.sin(self.heading)
        here = [np.interp(along, self.s, values) for values in (self.x, self.z, self.heading)]
        at_x, at_z = (
            here[0] + self.aside(frame) * np.cos(here[2]),
            here[1] - self.aside(frame) * np.sin(here[2]),
        )
        direction = here[2] + self.yaw(frame)
        right = (x - at_x) * np.cos(direction) - (z - at_z) * np.sin(direction)
        ahead = (x - at_x) * np.sin(direction) + (z - at_z) * np.cos(direction)
        near = np.abs(self.s - along) < 60
        return np.interp(AHEAD, ahead[near], right[near])

    def lane(self, i, frame, rng=None):
        """Return the lane that a detector finds; with `rng` it is off by an offset and a heading."""
        x = self.line(i, frame)
        if rng is not None:
            x = x + rng.normal(0, NOISE) + rng.normal(0, NOISE / 10) * (AHEAD - 15)
        points = np.column_stack([x, np.full_like(x, HEIGHT), AHEAD])
        offset = float(x[0] - (x[1] - x[0]) / 0.25 * AHEAD[0])
        return Lane(points, 0.9, 0.15, "other", 0.0, offset)

    def lanes(self, frame, rng=None):
        return [self.lane(i, frame, rng) for i in range(len(self.offsets))]


def clothoid(s):
    """Straight on, from 30 to 70 m into a bend of 80 m radius."""
    return np.clip((s - 30) / 40, 0, 1) / 80


def lane_change(frame):
    """3.5 m to the left in 3 s."""
    return -3.5 * (1 - np.cos(np.pi * np.clip(frame - 5, 0, 30) / 30)) / 2


def weaving(frame):
    return 0.005 * np.random.default_rng(frame).normal()


DRIVES = {
    "straight": Drive(),
    "curve entry": Drive(clothoid),
    "bend": Drive(lambda s: 1 / 80 + 0 * s),
    "lane change": Drive(aside=lane_change, yaw=lambda k: -0.07 * np.sin(np.pi * np.clip(k - 5, 0, 30) / 30)),
    "camera shake": Drive(yaw=weaving),
    "exit": Drive(offsets=(-1.75, 1.75, lambda s: 1.9 + 0.03 * s)),
}


@pytest.fixture(params=DRIVES, ids=str)
def drive(request):
    return DRIVES[request.param]


def error(lane, x):
    """Return the mean distance [m] of a lane from a line."""
    return float(np.mean(np.abs(np.interp(AHEAD, lane.points[:, 2], lane.points[:, 0]) - x)))


def after(drive, frames, config=None):
    """Return a tracker that has seen the frames 0 to `frames` - 1, and the ids that it gave."""
    tracker = LaneTracker(config)
    ids = []
    for k in range(frames):
        ids = [lane.id for lane in tracker.update(drive.lanes(k), k * FRAME)]
    return tracker, ids


def test_what_is_found_exactly_is_left_where_it_is(drive):
    """No lag: neither where the bend begins, nor in a lane change, nor when the camera shakes."""
    tracker = LaneTracker()
    for k in range(40):
        published = tracker.update(drive.lanes(k), k * FRAME)
        assert [lane.id for lane in published] == [0, 1, 2]
        for i, lane in enumerate(published):
            assert error(lane, drive.line(i, k)) < 0.02


def test_smoothing_brings_noisy_lines_nearer_to_the_truth(drive):
    rng, tracker = np.random.default_rng(0), LaneTracker()
    raw, smooth = [], []
    for k in range(60):
        found = drive.lanes(k, rng)
        for i, lane in enumerate(tracker.update(found, k * FRAME)):
            raw.append(error(found[i], drive.line(i, k)))
            smooth.append(error(lane, drive.line(i, k)))
    assert np.mean(smooth) < np.mean(raw)


def jitter(tracks):
    """Return the standard deviation [m] about the straight line over five frames."""
    windows = np.lib.stride_tricks.sliding_window_view(np.array(tracks), 5, axis=0).reshape(-1, 5).T
    t = np.column_stack([np.ones(5), np.arange(5)])
    return float((windows - t @ np.linalg.lstsq(t, windows, rcond=None)[0]).std())


def test_smoothing_takes_jitter_away():
    rng, tracker, drive = np.random.default_rng(1), LaneTracker(), DRIVES["straight"]
    raw, smooth = [], []
    for k in range(60):
        found = drive.lanes(k, rng)
        raw.append([np.interp(10, AHEAD, lane.points[:, 0]) for lane in found])
        lanes = tracker.update(found, k * FRAME)
        smooth.append([np.interp(10, lane.points[:, 2], lane.points[:, 0]) for lane in lanes])
    assert jitter(smooth) < 0.85 * jitter(raw)


@pytest.mark.parametrize("missing", [1, 2, 3, 4, 5])
def test_a_lost_line_is_published_where_it_is(drive, missing):
    tracker, ids = after(drive, 20)
    confidence = [0.9]
    for k in range(20, 20 + missing):
        lanes = tracker.update(drive.lanes(k)[:2], k * FRAME)
        assert [lane.id for lane in lanes] == ids
        assert error(lanes[2], drive.line(2, k)) < 0.1
        confidence.append(lanes[2].confidence)
    assert np.all(np.diff(confidence) < 0)
    assert min(confidence) > 0
    k = 20 + missing
    assert [lane.id for lane in tracker.update(drive.lanes(k), k * FRAME)] == ids


def test_lines_are_bridged_when_all_are_lost():
    tracker, ids = after(DRIVES["bend"], 20)
    for k in range(20, 25):
        lanes = tracker.update([], k * FRAME)
        assert [lane.id for lane in lanes] == ids
        assert all(error(lane, DRIVES["bend"].line(i, k)) < 0.1 for i, lane in enumerate(lanes))
    assert tracker.update([], 25 * FRAME) == ()


def test_the_unseen_line_turns_with_the_seen_ones():
    """The camera turns by 1 degree at once: at 20 m lines move by 0.35 m, the lost one like the others."""
    drive = Drive(yaw=lambda k: np.radians(1.0) * (k >= 20))
    tracker, _ = after(drive, 20)
    lanes = tracker.update(drive.lanes(20)[:2], 20 * FRAME)
    assert error(lanes[2], drive.line(2, 20)) < 0.05
    assert error(lanes[2], drive.line(2, 19)) > 0.2


@pytest.mark.parametrize(("coast_time", "frames"), [(0.5, 5), (0.3, 3), (0.0, 0)])
def test_no_line_is_bridged_for_longer_than_the_bridge_time(coast_time, frames):
    tracker, _ = after(DRIVES["straight"], 20, TrackingConfig(coast_time=coast_time))
    found = [len(tracker.update(DRIVES["straight"].lanes(k)[:2], k * FRAME)) for k in range(20, 30)]
    assert found == [3] * frames + [2] * (10 - frames)


@pytest.mark.parametrize(("frames", "bridged"), [(1, False), (2, False), (4, False), (5, True)])
def test_only_what_was_seen_often_is_bridged(frames, bridged):
    drive, tracker = DRIVES["straight"], LaneTracker()
    for k in range(10):
        tracker.update(drive.lanes(k)[: 3 if k >= 10 - frames else 2], k * FRAME)
    assert len(tracker.update(drive.lanes(10)[:2], 10 * FRAME)) == 2 + bridged


@pytest.mark.parametrize(("half_width", "bridged"), [(5.6, True), (5.4, False)])
def test_a_line_that_leaves_the_view_sideways_is_not_bridged(half_width, bridged):
    drive = DRIVES["straight"]
    tracker, ids = after(drive, 20)
    tracker.half_width = half_width
    found = {lane.id for lane in tracker.update(drive.lanes(20)[1:], 20 * FRAME)}
    assert found == (set(ids) if bridged else set(ids[1:]))


@pytest.mark.parametrize("jump", [1.1, -0.1, -100.0])
def test_nothing_is_bridged_across_a_jump_of_time(jump):
    tracker, ids = after(DRIVES["straight"], 20)
    lanes = tracker.update(DRIVES["straight"].lanes(20)[:2], 19 * FRAME + int(jump * 1e9))
    assert len(lanes) == 2
    assert not {lane.id for lane in lanes} & set(ids)


def test_a_line_that_merged_is_not_bridged():
    """The third line runs into the second one, where only one is found."""
    drive = Drive(offsets=(-1.75, 1.75, lambda s: np.maximum(1.75, 3.6 - 0.03 * s)))
    tracker = LaneTracker()
    for k in range(30):
        apart = drive.line(2, k) - drive.line(1, k)
        lanes = tracker.update(drive.lanes(k)[: 3 if apart.min() > 0.2 else 2], k * FRAME)
        assert len(lanes) == (3 if apart.min() > 0.2 else 2)
    assert apart.min() < 0.1


def test_a_new_line_takes_the_place_of_a_lost_one():
    tracker, ids = after(DRIVES["straight"], 20)
    *kept, lost = DRIVES["straight"].lanes(20)
    points = lost.points + np.array([0.7, 0, 0])
    aside = replace(lost, points=points, lateral_offset=lost.lateral_offset + 0.7)
    lanes = tracker.update([*kept, aside], 20 * FRAME)
    assert len(lanes) == 3
    assert ids[2] not in [lane.id for lane in lanes]


@pytest.mark.parametrize("side", [-1, 1])
def test_what_runs_off_a_line_does_not_take_its_id(side):
    """It leaves the line at 10 m; beside the vehicle, the two are one."""
    drive = DRIVES["straight"]
    tracker, ids = after(drive, 3)
    lane = drive.lane(2, 3)
    points = lane.points + np.column_stack([side * 0.1 * np.maximum(AHEAD - 10, 0), 0 * AHEAD, 0 * AHEAD])
    stray = replace(lane, points=points)
    seen = replace(lane, lateral_offset=lane.lateral_offset + 0.05)
    lanes = tracker.update([*drive.lanes(3)[:2], stray, seen], 3 * FRAME)
    assert [lane.id for lane in lanes] == [*ids[:2], 3, ids[2]]


TWO_YELLOW_OFFSETS = (-1.75, -1.45, 1.75)  # m
TWO_YELLOW = Drive(offsets=TWO_YELLOW_OFFSETS)


def begins_on_the_next(frame):
    """Return the lanes of TWO_YELLOW, but the second begins on the first, and leaves it at 10 to 14 m."""
    left, lane, right = TWO_YELLOW.lanes(frame)
    share = np.clip((AHEAD - 10) / 4, 0, 1)[:, None]
    points = share * lane.points + (1 - share) * left.points
    return [left, replace(lane, points=points, lateral_offset=left.lateral_offset), right]


@pytest.mark.parametrize("frames", [1, 5])
def test_a_line_found_on_the_paint_of_another_stays_where_it_is(frames):
    tracker, ids = after(TWO_YELLOW, 3)
    for k in range(3, 3 + frames):
        lanes = tracker.update(begins_on_the_next(k), k * FRAME)
        assert [lane.id for lane in lanes] == ids
        assert all(error(lane, TWO_YELLOW.line(i, k)) < 0.01 for i, lane in enumerate(lanes))
    assert lanes[1].confidence < lanes[0].confidence
    lanes = tracker.update(TWO_YELLOW.lanes(9), 9 * FRAME)
    assert [lane.id for lane in lanes] == ids
    assert error(lanes[1], TWO_YELLOW.line(1, 9)) < 0.01


@pytest.mark.parametrize(("coast_time", "frames"), [(0.5, 5), (0.2, 2), (0.0, 0)])
def test_what_is_found_long_enough_is_believed(coast_time, frames):
    """Where the paint of the second line now joins the first, it is published there at last."""
    tracker, _ = after(TWO_YELLOW, 3, TrackingConfig(coast_time=coast_time))
    stays = []
    for k in range(3, 12):
        found = begins_on_the_next(k)
        lane = tracker.update(found, k * FRAME)[1]
        stays.append(error(lane, TWO_YELLOW.line(1, k)) < 0.5 * error(found[1], TWO_YELLOW.line(1, k)))
    assert stays == [True] * frames + [False] * (9 - frames)


def test_lines_found_crossing_keep_their_ids():
    """For one frame the second and the third change places at 10 to 14 m; a part of the third is hidden."""
    drive = Drive(offsets=(-1.75, 1.45, 1.95))
    tracker, ids = after(drive, 3)
    first, left, right = drive.lanes(3)
    share = np.clip((AHEAD - 10) / 4, 0, 1)[:, None]
    crossing_right = replace(left, points=(1 - share) * left.points + share * right.points)
    crossing_left = replace(right, points=((1 - share) * right.points + share * left.points)[8:])
    lanes = tracker.update([first, crossing_right, crossing_left], 3 * FRAME)
    assert [lane.id for lane in lanes] == ids
    assert [lane.id for lane in tracker.update(drive.lanes(4), 4 * FRAME)] == ids


def test_lines_side_by_side_turn_with_the_camera():
    """By 1 degree at once: at 10 m each is now nearer to where its neighbour was."""
    drive = Drive(offsets=TWO_YELLOW_OFFSETS, yaw=lambda k: np.radians(1.0) * (k >= 5))
    tracker, ids = after(drive, 5)
    for k in range(5, 8):
        lanes = tracker.update(drive.lanes(k), k * FRAME)
        assert [lane.id for lane in lanes] == ids
        assert all(error(lane, drive.line(i, k)) < 0.02 for i, lane in enumerate(lanes))


def test_a_line_that_leaps_does_not_drift_on():
    """Lost, it stays where it leapt to: 0.3 m aside in one frame is no speed of 3 m/s."""
    drive, tracker = DRIVES["straight"], LaneTracker()
    aside = np.column_stack([np.full_like(AHEAD, 0.3), 0 * AHEAD, 0 * AHEAD])
    for k in range(20):
        *others, lane = drive.lanes(k)
        if k >= 18:
            lane = replace(lane, points=lane.points + aside, lateral_offset=lane.lateral_offset + 0.3)
        tracker.update([*others, lane], k * FRAME)
    for k in range(20, 25):
        lanes = tracker.update(drive.lanes(k)[:2], k * FRAME)
        assert error(lanes[2], drive.line(2, k) + 0.3) < 0.05


def crossing(slope):
    """Return a lane that runs off to the right, in between the known ones."""
    points = np.column_stack([0.2 + slope * (AHEAD - 6), np.full_like(AHEAD, HEIGHT), AHEAD])
    return Lane(points, 0.9, 0.15, "ego_right", 0.0, 0.2 - 6 * slope)


@pytest.mark.parametrize(("slope", "believed"), [(0.05, True), (0.4, False)])
def test_lines_astray_are_dropped_where_the_known_ones_are_lost(slope, believed):
    """The detector took arrows or hatching for the road's direction."""
    tracker, ids = after(DRIVES["straight"], 20)
    found = {lane.id for lane in tracker.update([crossing(slope)], 20 * FRAME)}
    assert bool(found - set(ids)) == believed
    assert ids[0] in found  # the outer line is bridged in any case


def test_lines_astray_are_believed_once_nothing_else_is_left():
    tracker, _ = after(DRIVES["straight"], 20)
    found = [len(tracker.update([crossing(0.4)], k * FRAME)) for k in range(20, 27)]
    assert found == [3] * 5 + [1] * 2


def test_a_bridged_line_beside_the_vehicle_is_an_ego_line():
    drive = DRIVES["straight"]
    tracker, ids = after(drive, 20)
    found = [replace(drive.lane(0, 20), role="ego_left"), replace(drive.lane(2, 20), role="ego_right")]
    roles = {lane.id: lane.role for lane in tracker.update(found, 20 * FRAME)}
    assert [roles[i] for i in ids] == ["other", "ego_left", "ego_right"]


def test_a_bridged_line_stays_on_the_surface():
    """The road's surface comes up by 5 cm and 1 %, as measured on the other lines."""
    drive = DRIVES["straight"]
    tracker, ids = after(drive, 20)
    rise = np.column_stack([0 * AHEAD, -0.05 - 0.01 * AHEAD, 0 * AHEAD])
    found = [replace(lane, points=lane.points + rise) for lane in drive.lanes(20)[:2]]
    bridged = tracker.update(found, 20 * FRAME)[2]
    assert bridged.id == ids[2]
    assert bridged.points[:, 1] == pytest.approx(HEIGHT - 0.05 - 0.01 * AHEAD, abs=0.03)


@pytest.mark.parametrize("name", ["straight", "bend"])
def test_where_the_surface_is_measured_wrong_lines_stay_in_the_picture(name):
    """All points of one frame lie 2 % too far off, on their rays: that is no motion to smooth away."""
    drive = DRIVES[name]
    tracker, _ = after(drive, 20)
    found = [replace(lane, points=1.02 * lane.points) for lane in drive.lanes(20)]
    for lane, was in zip(tracker.update(found, 20 * FRAME), found, strict=True):
        rays, true_rays = (points[:, 0] / points[:, 2] for points in (lane.points, was.points))
        assert np.max(np.abs(rays - true_rays) * AHEAD) < 0.02  # m aside; 2 % of 5.25 m would be 0.1 m


def test_switched_off_it_gives_ids_only():
    drive, tracker = DRIVES["curve entry"], LaneTracker(TrackingConfig(enabled=False))
    rng = np.random.default_rng(0)
    for k in range(20):
        found = drive.lanes(k, rng)
        published = tracker.update(found, k * FRAME)
        assert [lane.id for lane in published] == [0, 1, 2]
        assert all(lane.points is was.points for lane, was in zip(published, found, strict=True))
    assert tracker.update([], 20 * FRAME) == ()


def test_a_line_that_comes_back_within_a_second_keeps_its_id(drive):
    tracker, ids = after(drive, 20)
    for k in range(20, 29):
        tracker.update(drive.lanes(k)[:2], k * FRAME)
    assert [lane.id for lane in tracker.update(drive.lanes(29), 29 * FRAME)] == ids


def test_the_frame_after_nothing_is_left_as_it_is(drive):
    found = with_roles(drive.lanes(0))
    for lane, was in zip(LaneTracker().update(found, 0), found, strict=True):
        np.testing.assert_array_equal(lane.points, was.points)
        assert asdict(replace(lane, points=None)) == asdict(replace(was, points=None, id=lane.id))
