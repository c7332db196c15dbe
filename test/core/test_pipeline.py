# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What a frame is worth in the light of those before it, on rendered frames whose road is known."""

from dataclasses import asdict, replace

import numpy as np
import pytest

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.detector import LaneDetector
from lane_dp_ros.core.geometry.road_axis import RoadAxis
from lane_dp_ros.core.parameter import replaced
from lane_dp_ros.core.pipeline import UNCHECKED, FrameResult, LanePipeline
from lane_dp_ros.core.road.vanishing_point import ArcVanishingPoint, direction_along
from lane_dp_ros.core.types import Prior, StereoFrame
from lane_dp_ros.scenes import CAMERA, render_sequence

START = 1_316_533_000_000_000_000  # ns, a stamp of KITTI's September 2011
TENTH, SECOND = 100_000_000, 1_000_000_000  # ns
MISLED = 3  # the frame whose edges vote for another axis
ASKEW = RoadAxis(0.4, -0.03)
CONFIG = DetectorConfig()
BLIND = replaced(CONFIG, {"lane_selection.paint_width_max": 0.1})  # takes no line for paint


@pytest.fixture(scope="module")
def frames():
    """Six frames of a road, 0.1 s apart."""
    pairs = list(render_sequence(frames=6, rate=10.0, seed=1))
    return [StereoFrame(pair.left, pair.right).grey() for pair in pairs]


@pytest.fixture
def misled(frames, monkeypatch):
    """Let the edges of one frame vote for an axis along which there is no paint."""
    estimate, hatched = ArcVanishingPoint.estimate, frames[MISLED].left

    def voted(self, left, disparity, surface):
        if np.array_equal(left, hatched):
            return direction_along(ASKEW, surface)
        return estimate(self, left, disparity, surface)

    monkeypatch.setattr(ArcVanishingPoint, "estimate", voted)


@pytest.fixture
def priors(monkeypatch):
    """The priors of all frames that the detector is asked for, in order."""
    asked, detect = [], LaneDetector.detect

    def recorded(self, frame, prior=None):
        asked.append(prior)
        return detect(self, frame, prior or Prior())

    monkeypatch.setattr(LaneDetector, "detect", recorded)
    return asked


def follow(drive, pipeline=None, config=CONFIG, camera=CAMERA, unaided=False):
    """Return the results of frames with their stamps [ns]; `unaided`: they were looked at before."""
    pipeline = pipeline or LanePipeline()
    detector = LaneDetector(camera, config)
    return [
        pipeline.process(frame, camera, stamp_ns, config, detector.detect(frame) if unaided else None)
        for stamp_ns, frame in drive
    ]


def tenths(frames, start=START):
    return [(start + i * TENTH, frame) for i, frame in enumerate(frames)]


def left_alone(frame):
    return StereoFrame(frame.left)


def assert_same(one: FrameResult, other: FrameResult, ids: bool = True) -> None:
    assert (one.problem, one.road_profile, one.check) == (other.problem, other.road_profile, other.check)
    assert one.detection.note == other.detection.note
    assert one.detection.score == other.detection.score
    assert one.detection.road_estimate == other.detection.road_estimate
    axes = [each.detection.birds_eye and each.detection.birds_eye.axis for each in (one, other)]
    assert axes[0] == axes[1]
    assert len(one.lanes) == len(other.lanes)
    for a, b in zip(one.lanes, other.lanes, strict=True):
        np.testing.assert_array_equal(a.points, b.points)
        assert asdict(replace(a, points=None, id=0)) == asdict(replace(b, points=None, id=0))
        assert a.id == b.id or not ids


def test_a_frame_without_any_before_has_the_lanes_of_the_detector(frames):
    (result,) = follow(tenths(frames[:1]))
    alone = LaneDetector(CAMERA).detect(frames[0])
    assert result.frame is frames[0] and result.camera is CAMERA
    assert (result.problem, result.road_profile) == ("", "measured")
    assert len(result.lanes) == len(alone.lanes) == 3
    for lane, found in zip(result.lanes, alone.lanes, strict=True):
        np.testing.assert_array_equal(lane.points, found.points)
        assert lane.id >= 0
    assert len({lane.id for lane in result.lanes}) == 3


def test_lanes_keep_their_ids(frames):
    results = follow(tenths(frames))
    assert {tuple(sorted(lane.id for lane in result.lanes)) for result in results} == {
        tuple(sorted(lane.id for lane in results[0].lanes))
    }


# Stamps [ns] and frames: over a jump of the axis, a lost right image, and jumps of time.
DRIVES = {
    "an axis that jumps": tenths,
    "a right image that is lost": lambda frames: tenths(
        [*frames[:2], left_alone(frames[2]), left_alone(frames[3]), *frames[4:]]
    ),
    "no right image yet": lambda frames: tenths([left_alone(frames[0]), left_alone(frames[1]), *frames[2:4]]),
    "a right image that is wrong": lambda frames: tenths(
        [*frames[:2], StereoFrame(frames[2].left, frames[2].left), *frames[3:]]
    ),
    "time that jumps ahead": lambda frames: [
        *tenths(frames[:3]),
        *tenths([frames[3], left_alone(frames[4]), frames[5]], START + 5 * SECOND),
    ],
    "time that jumps back": lambda frames: [
        *tenths(frames[:3]),
        *tenths([left_alone(frames[3]), *frames[4:]], START - SECOND),
    ],
}


@pytest.mark.usefixtures("misled")
@pytest.mark.parametrize("name", DRIVES)
def test_the_answer_is_the_same_whether_or_not_a_frame_was_looked_at_before(frames, name):
    """Frame by frame, down to the last bit."""
    drive = DRIVES[name](frames)
    for one, other in zip(follow(drive), follow(drive, unaided=True), strict=True):
        assert_same(one, other)


@pytest.mark.usefixtures("misled")
def test_where_the_prior_would_change_nothing_what_was_found_before_serves(frames, priors):
    """It is looked at again only where the axis jumps or another road serves."""
    drive = tenths([*frames[:5], left_alone(frames[5])])
    detector = LaneDetector(CAMERA)
    unaided = [detector.detect(frame) for _, frame in drive]
    priors.clear()
    pipeline = LanePipeline()
    results = [
        pipeline.process(frame, CAMERA, stamp_ns, CONFIG, found)
        for (stamp_ns, frame), found in zip(drive, unaided, strict=True)
    ]
    again = [result.detection is not found for result, found in zip(results, unaided, strict=True)]
    assert again == [False] * MISLED + [True, False, True]
    assert len(priors) == 2


@pytest.mark.usefixtures("misled")
def test_an_axis_that_jumps_is_looked_at_along_the_one_before(frames):
    results = follow(tenths(frames))
    alone = LaneDetector(CAMERA).detect(frames[MISLED])
    held, before = results[MISLED], results[MISLED - 1]
    assert alone.score < held.detection.score
    assert held.detection.birds_eye.axis == before.detection.birds_eye.axis
    assert [lane.id for lane in held.lanes] == [lane.id for lane in before.lanes]


@pytest.mark.usefixtures("misled")
def test_without_tracking_every_frame_stands_for_itself(frames):
    config = replaced(CONFIG, {"tracking.enabled": False})
    detector = LaneDetector(CAMERA, config)
    for result, (_, frame) in zip(follow(tenths(frames), config=config), tenths(frames), strict=True):
        alone = detector.detect(frame)
        assert result.detection.score == alone.score
        assert result.detection.birds_eye.axis == alone.birds_eye.axis
        assert len(result.lanes) == len(alone.lanes)


@pytest.mark.parametrize(
    ("later_ns", "known"),
    [(TENTH, True), (0, True), (500_000_000, True), (500_000_001, False), (-1, False)],
)
def test_the_axis_of_a_moment_ago_is_forgotten_soon(frames, priors, later_ns, known):
    first, _ = follow([(START, frames[0]), (START + later_ns, frames[1])])
    assert priors[0].axis is None
    assert priors[1].axis == (first.detection.birds_eye.axis if known else None)


def test_the_axis_of_a_moment_ago_is_that_of_the_last_frame(frames, priors):
    results = follow(tenths(frames[:4]))
    axes = [result.detection.birds_eye.axis for result in results]
    assert [prior.axis for prior in priors] == [None, *axes[:-1]]
    assert len(set(axes)) > 1


def test_an_axis_that_nobody_measured_is_not_remembered(frames, priors):
    """Of the left image alone, of a frame that shows no road, or of a road without lanes."""
    blank = StereoFrame(np.full_like(frames[0].left, 90), frames[0].right)
    pipeline = LanePipeline()
    results = follow(tenths([frames[0], left_alone(frames[1]), blank]), pipeline)
    results += follow([(START + 3 * TENTH, frames[3])], pipeline, BLIND)
    follow([(START + 4 * TENTH, frames[4])], pipeline)
    axis = results[0].detection.birds_eye.axis
    assert axis not in [results[i].detection.birds_eye.axis for i in (1, 3)]
    assert results[3].road_profile == "measured"
    assert [prior.axis for prior in priors] == [None, axis, axis, axis, axis]


def test_without_a_right_image_the_last_road_serves_and_a_line_says_so(frames):
    *_, before, result = follow(tenths([*frames[:3], left_alone(frames[3])]))
    assert result.road_profile == "last"
    assert result.problem == "no right image; the left image alone serves, with the last road profile"
    assert result.detection.road is None
    assert {lane.id for lane in result.lanes} == {lane.id for lane in before.lanes}
    assert result.check == UNCHECKED


def test_without_any_right_image_the_nominal_road_serves(frames):
    (result,) = follow(tenths([left_alone(frames[0])]))
    assert result.road_profile == "nominal"
    assert result.problem == (
        "no right image; the left image alone serves, with the camera's nominal height and pitch"
    )


def test_a_road_that_contradicts_the_ones_before_does_not_serve(frames):
    """The right camera looks 12 px aside: every disparity is larger, and the horizon higher, by 0.05 rad."""
    wrong = StereoFrame(frames[2].left, np.roll(frames[2].right, -12, axis=1))
    *_, result = follow(tenths([*frames[:2], wrong]))
    assert result.road_profile == "last"
    assert result.problem.startswith("the road contradicts the one before: pitch ")
    assert result.problem.endswith("; the left image alone serves, with the last road profile")
    assert result.detection.road is not None


@pytest.mark.parametrize(
    "jump_ns", [SECOND + 1, -1, 60 * SECOND], ids=["just ahead", "just back", "far ahead"]
)
@pytest.mark.parametrize("alone", [False, True], ids=["pair", "left image alone"])
@pytest.mark.usefixtures("misled")
def test_after_a_jump_of_time_nothing_at_all_is_remembered(frames, jump_ns, alone):
    """Not the road, nor the axis, nor the lines that doubtful ones could go on with."""
    pipeline = LanePipeline()
    follow(tenths(frames[:MISLED]), pipeline)
    last = START + (MISLED - 1) * TENTH
    frame = left_alone(frames[MISLED]) if alone else frames[MISLED]
    (after,) = follow([(last + jump_ns, frame)], pipeline)
    (fresh,) = follow([(last + jump_ns, frame)])
    assert_same(after, fresh, ids=False)


@pytest.mark.parametrize("later_ns", [0, SECOND])
def test_a_second_at_most_is_no_jump_of_time(frames, later_ns):
    pipeline = LanePipeline()
    (before,) = follow([(START, frames[0])], pipeline)
    (after,) = follow([(START + later_ns, left_alone(frames[0]))], pipeline)
    assert after.road_profile == "last"
    assert {lane.id for lane in after.lanes} & {lane.id for lane in before.lanes}


def test_the_lines_that_are_known_are_those_that_a_measured_road_bore(frames, priors):
    """New lines of the left image alone do not make others trustworthy."""
    results = follow(tenths([*frames[:2], left_alone(frames[2]), left_alone(frames[3])]))
    known = [{lane.id for lane in prior.lanes} for prior in priors]
    assert known[0] == set()
    assert known[1] == {lane.id for lane in results[0].lanes}
    assert known[3] <= known[2] == {lane.id for lane in results[1].lanes}


def test_lines_that_no_measured_road_bore_are_not_known(frames, priors):
    """Before the first right image nobody can tell whether a line is a kerb."""
    results = follow(tenths([left_alone(frames[0]), left_alone(frames[1]), frames[2], frames[3]]))
    assert results[0].lanes and results[1].lanes
    assert priors[1].lanes == priors[2].lanes == ()
    assert {lane.id for lane in priors[3].lanes} == {lane.id for lane in results[2].lanes}


@pytest.mark.parametrize(("width", "goes_on"), [(16.0, True), (9.0, False)])
def test_a_lost_line_goes_on_only_within_the_view(frames, width, goes_on):
    """The outermost line is 5 m left of the camera."""
    pipeline, lost = LanePipeline(), replaced(BLIND, {"birds_eye.width": width})
    *_, before = follow(tenths(frames[:5]), pipeline)
    (after,) = follow([(START + 5 * TENTH, frames[5])], pipeline, lost)
    outermost, *inner = sorted(before.lanes, key=lambda lane: lane.lateral_offset)
    assert -6 < outermost.lateral_offset < -4.6
    found = {lane.id for lane in after.lanes}
    assert (outermost.id in found) == goes_on
    assert found >= {lane.id for lane in inner}


def test_once_tracking_is_off_no_axis_is_remembered(frames, priors):
    pipeline, off = LanePipeline(), replaced(CONFIG, {"tracking.enabled": False})
    follow([(START, frames[0])], pipeline)
    follow([(START + TENTH, frames[1])], pipeline, off)
    follow([(START + 2 * TENTH, frames[2])], pipeline)
    assert [prior.axis is None for prior in priors] == [True, True, False]


def test_a_lost_line_that_the_view_does_not_reach_is_not_published(frames):
    """The left border of the road, 5 m aside, is beyond a view of 4 m."""
    pipeline, narrow = LanePipeline(), replaced(CONFIG, {"birds_eye.width": 4.0})
    *_, before = follow(tenths(frames[:5]), pipeline)
    (after,) = follow([(START + 5 * TENTH, frames[5])], pipeline, narrow)
    assert max(abs(lane.lateral_offset) for lane in before.lanes) > 4.0
    assert max(abs(lane.lateral_offset) for lane in after.lanes) < 2.0


def test_another_camera_or_configuration_is_taken_at_once(frames):
    pipeline = LanePipeline()
    follow(tenths(frames[:2]), pipeline)
    nearer = replace(CAMERA, baseline=0.9 * CAMERA.baseline)
    (other,) = follow([(START + 2 * TENTH, frames[2])], pipeline, camera=nearer)
    assert other.detection.road.camera is nearer
    assert other.detection.score == LaneDetector(nearer).detect(frames[2]).score
    (blind,) = follow([(START + 3 * TENTH, frames[3])], pipeline, config=BLIND, camera=nearer)
    assert blind.detection.lanes == ()


def test_the_calibration_is_judged_unless_nobody_asks(frames):
    drive = tenths(frames)
    watched, unwatched = follow(drive)[-1].check, follow(drive, LanePipeline(monitored=False))[-1].check
    assert watched.lane_width == pytest.approx(3.5, abs=0.1)
    assert watched.complaint == ""
    assert unwatched == UNCHECKED
