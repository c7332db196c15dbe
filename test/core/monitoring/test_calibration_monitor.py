# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What the road says of the calibration: lanes drawn by hand, rendered roads seen through wrong cameras."""

from dataclasses import replace

import numpy as np
import pytest

from lane_dp_ros.core.detector import LaneDetector
from lane_dp_ros.core.geometry.road_axis import RoadAxis
from lane_dp_ros.core.geometry.vertical_curve import VerticalCurve
from lane_dp_ros.core.monitoring.calibration_monitor import CalibrationMonitor, Observation, lane_gaps
from lane_dp_ros.core.monitoring.vertical_disparity import VerticalDisparity
from lane_dp_ros.core.types import Lane, StereoFrame
from lane_dp_ros.scenes import CAMERA, Road, render_pair

pytestmark = pytest.mark.filterwarnings("error")

NOMINAL = VerticalCurve.plane(CAMERA, 1.65, 0.0)
STEP = 100_000_000  # ns between pairs


def lane(offset, opening=0.0, last=30.0, axis=None, first=6.0):
    """A line `offset` metres aside, which the width of lanes opens by that share a metre."""
    s = np.arange(first, last, 0.25)
    x, z = (axis or RoadAxis()).to_ground(s, offset * (1 + opening * (s - 18)))
    return Lane(np.stack([x, np.full_like(x, 1.65), z], axis=1), 0.9, 0.15, "other", 0.0, offset)


def road(height=1.65, pitch=0.0, curvature=0.0):
    return VerticalCurve.of_geometry(CAMERA, np.array([height, pitch, curvature, 0.0]))


def sight(*lanes, surface=None, rows=None):
    return Observation(
        0, surface or road(), lanes or (lane(-1.75), lane(1.75)), rows and VerticalDisparity(*rows)
    )


def watch(sights, seconds=4.0, check=None, start=0, nominal=NOMINAL):
    """Return the verdict on a sight, seen again and again, or on what a function of the number returns."""
    check = check or CalibrationMonitor()
    for i in range(round(seconds * 10) + 1):
        seen = sights(i) if callable(sights) else sights
        verdict = check.update(replace(seen, stamp_ns=start + i * STEP), nominal)
    return verdict


def test_parallel_lines_keep_their_distance():
    (gap,) = lane_gaps([lane(1.6), lane(-1.9)])
    assert gap == pytest.approx((3.5, 0.0), abs=1e-6)


@pytest.mark.parametrize("axis", [RoadAxis(0.1), RoadAxis(-0.2, 0.015), RoadAxis(0.1, -0.01)], ids=str)
def test_concentric_lines_keep_their_distance(axis):
    gaps = lane_gaps([lane(n, axis=axis) for n in (-5.25, -1.75, 1.75)])
    assert len(gaps) == 2
    for gap in gaps:
        assert gap == pytest.approx((3.5, 0.0), abs=2e-3)


@pytest.mark.parametrize("opening", [-0.01, 0.01])
def test_lines_that_open_are_measured(opening):
    (gap,) = lane_gaps([lane(-1.75, opening), lane(1.75, opening)])
    assert gap.change == pytest.approx(opening, rel=0.05)


def test_what_is_no_lane_is_left_out():
    assert lane_gaps([lane(-1.75)]) == ()
    assert lane_gaps([lane(-1.0), lane(0.5)]) == ()  # too narrow
    assert lane_gaps([lane(-4.0), lane(4.0)]) == ()  # too wide
    assert lane_gaps([lane(-1.75, last=12.0), lane(1.75, first=12.0)]) == ()  # not side by side
    assert lane_gaps([lane(-1.75, last=12.0), lane(1.75)]) == ()  # hardly side by side


def test_a_sound_calibration_gives_no_cause_for_complaint():
    verdict = watch(sight(rows=(0.1, 0.3)))
    assert verdict.complaint == ""
    assert verdict.lane_width == pytest.approx(3.5)
    assert (verdict.width_change, verdict.disparity_error) == pytest.approx((0, 0), abs=1e-6)
    assert (verdict.row_shift, verdict.row_turn) == (0.1, 0.3)


ACROSS = "are the cameras rotated against each other?"
HEIGHT = "is the baseline, the focal length or road_profile.camera_height wrong?"
PITCH = "is cy or road_profile.camera_pitch wrong?"
WIDTHS = "is a principal point wrong, or a camera turned sideways?"


@pytest.mark.parametrize(
    ("wrong", "complaint"),
    [
        (sight(rows=(0.5, 0.2)), f"The rows of left and right miss each other by 0.7 px or more: {ACROSS}"),
        (sight(rows=(0.1, -0.9)), f"The rows of left and right miss each other by 1.0 px or more: {ACROSS}"),
        (
            sight(surface=road(height=1.9)),
            f"The road lies 1.90 m below the camera, expected 1.65 m: {HEIGHT}",
        ),
        (
            sight(surface=road(height=1.4)),
            f"The road lies 1.40 m below the camera, expected 1.65 m: {HEIGHT}",
        ),
        (
            sight(lane(-1.75, -0.012), lane(1.75, -0.012)),
            f"Lanes become narrower by 12% in 10 m, as with a disparity +4.7 px wrong: {WIDTHS}",
        ),
        (
            sight(lane(-1.75, 0.012), lane(1.75, 0.012)),
            f"Lanes become wider by 12% in 10 m, as with a disparity -4.7 px wrong: {WIDTHS}",
        ),
        (
            sight(surface=road(pitch=0.08)),
            f"The camera looks down on the road by 0.080 rad, expected 0.000 rad: {PITCH}",
        ),
        (
            Observation(0),
            "Are left and right swapped, a camera covered, or the cameras rotated against each other?",
        ),
    ],
)
def test_a_wrong_calibration_is_named(wrong, complaint):
    assert watch(wrong).complaint == complaint


def test_one_picture_on_both_sides_is_named_before_all_else():
    compared = Observation(0, same_picture=True), Observation(0, same_picture=None)
    said = "Left and right show the same picture: does one camera's topic serve as both?"
    assert watch(lambda i: compared[i % 5 > 0]).complaint == said
    assert "swapped" in watch(Observation(0, same_picture=False)).complaint
    now_and_then = [replace(sight(), same_picture=i % 3 == 0) for i in range(50)]
    assert watch(now_and_then.__getitem__).complaint == ""


@pytest.mark.parametrize(("delay", "word"), [(0.1, "older"), (-0.033, "newer"), (0.017, "older")])
def test_a_right_picture_of_another_time_is_named(delay, word):
    """Whatever road is seen then: it is a wrong one."""
    measured = [delay + 0.001 * (-1) ** i if i % 5 == 0 else None for i in range(41)]
    for surface in (None, road(height=1.9)):
        seen = Observation(0, surface)
        verdict = watch(lambda i, seen=seen: replace(seen, right_delay=measured[i]))
        assert verdict.right_delay == pytest.approx(delay, abs=0.002)
        assert verdict.complaint.startswith("The right picture seems to be of another time, ")
        assert f" ms {word} than the left one (half of 9 comparisons are within 1 ms)" in verdict.complaint


def test_small_delays_few_and_scattered_ones_are_no_cause_for_complaint():
    for delays in ([0.008] * 41, [0.1] * 4 + [None] * 37, [0.03 * (-1) ** i for i in range(41)]):
        verdict = watch(lambda i, delays=delays: replace(sight(), right_delay=delays[i]))
        assert verdict.complaint == ""


def test_three_seconds_are_needed():
    wrong = sight(surface=road(height=2.0))
    assert watch(wrong, seconds=2.9).complaint == ""
    assert watch(wrong, seconds=3.0).complaint


def test_a_merge_that_is_passed_is_no_wrong_calibration():
    merge, parallel = sight(lane(-1.75, 0.02), lane(1.75, 0.02)), sight()
    assert watch(lambda i: merge if 20 <= i < 50 else parallel, seconds=8.0).complaint == ""


def test_a_merge_beside_two_parallel_lanes_is_no_wrong_calibration():
    lanes = (lane(-1.75), lane(1.75), lane(5.25), lane(8.75, 0.02))
    assert watch(sight(*lanes)).complaint == ""


def test_hills_say_nothing_of_heights_and_widths():
    verdict = watch(sight(lane(-1.75, 0.02), lane(1.75, 0.02), surface=road(height=1.9, curvature=2e-3)))
    assert verdict.complaint == ""
    assert verdict.lane_width is verdict.width_change is verdict.disparity_error is None


def test_another_calibration_begins_anew():
    check = CalibrationMonitor()
    assert watch(sight(surface=road(height=2.0)), check=check).complaint
    other = VerticalCurve.plane(replace(CAMERA, baseline=0.5), 1.65, 0.0)
    assert watch(sight(surface=road(height=2.0)), 1.0, check, 41 * STEP, other).complaint == ""


@pytest.mark.parametrize("start", [0, 60 * STEP])
def test_a_jump_of_time_begins_anew(start):
    check = CalibrationMonitor()
    assert watch(sight(surface=road(height=2.0)), check=check).complaint
    assert watch(sight(surface=road(height=2.0)), 1.0, check, start).complaint == ""


def test_a_calibration_that_is_mended_is_no_longer_complained_of():
    wrong, right = sight(surface=road(height=2.0)), sight()
    assert watch(lambda i: wrong if i < 40 else right, seconds=8.5).complaint == ""
    assert watch(lambda i: wrong if i < 100 else right, seconds=18.5).complaint == ""


@pytest.fixture(scope="module")
def pair(rendered):
    return rendered(render_pair, Road(swing=0), 20.0, 4)


@pytest.mark.parametrize(
    ("wrong", "complaint"),
    [
        ({}, ""),
        ({"baseline": 1.2 * CAMERA.baseline}, "The road lies 1.9"),
        ({"baseline": 0.8 * CAMERA.baseline}, "The road lies 1.3"),
        ({"disparity_offset": -4.0}, "Lanes become narrower"),
        ({"disparity_offset": 4.0}, "Lanes become wider"),
        ({"cy": CAMERA.cy + 60}, "The camera looks down"),
    ],
    ids=str,
)
def test_a_rendered_road_seen_through_a_wrong_camera(pair, wrong, complaint):
    camera = replace(CAMERA, **wrong)
    found = LaneDetector(camera).detect(StereoFrame(pair.left, pair.right))
    verdict = watch(Observation(0, found.road, found.lanes), nominal=VerticalCurve.plane(camera, 1.65, 0.0))
    assert verdict.complaint.startswith(complaint)
    assert bool(verdict.complaint) == bool(complaint)
