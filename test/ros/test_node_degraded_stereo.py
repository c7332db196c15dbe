# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""One camera fails, or both see nothing of the road: lanes go on, and the diagnostics say on what road."""

import time

import numpy as np
import pytest
from rclpy.parameter import Parameter

OK, WARN = b"\x00", b"\x01"
PERIOD = 0.1  # s
FAST_NS = 200_000_000  # between pairs whose stamps pass twice as fast as time


def stamps(rig):
    return [m.markers[0].header.stamp.sec * 10**9 + m.markers[0].header.stamp.nanosec for m in rig.arrays]


def send_left(rig, scene_pair):
    """Publish a left image alone, in the camera's time."""
    time.sleep(PERIOD)
    stamp_ns = rig.next_stamp()
    rig.image_publishers["left"].publish(rig.image(scene_pair[0], stamp_ns))
    return stamp_ns


def profile(status):
    return next(entry.value for entry in status.values if entry.key == "road profile")


def roles(lanes):
    return {lane.role for lane in lanes}


def test_a_right_camera_that_falls_silent_and_comes_back(rig, scene_pair):
    rig.assert_lives()
    with_both = rig.answer(rig.send())
    sent = [send_left(rig, scene_pair) for _ in range(10)]
    lanes = rig.answer(sent[-1])
    assert {"ego_left", "ego_right"} <= roles(lanes)
    for role in ("ego_left", "ego_right"):
        before, after = ([lane for lane in found if lane.role == role] for found in (with_both, lanes))
        assert after[0].points[0, 0] == pytest.approx(before[0].points[0, 0], abs=0.05)
    values = rig.diagnosis("no right image; the left image alone serves, with the last road profile", WARN)
    assert values["road profile"] == "last"
    assert int(values["left images alone"]) > 0
    assert rig.answers(sent[0]) == []  # the right one might still have come
    degraded = len(rig.statuses)

    def all_is_well_again():
        assert {"ego_left", "ego_right"} <= roles(rig.answer(rig.send()))
        return any((s.level, profile(s)) == (OK, "measured") for s in rig.statuses[degraded:])

    rig.wait(all_is_well_again)
    assert stamps(rig) == sorted(set(stamps(rig)))


def test_a_silent_camera_is_named_and_the_nominal_road_serves_after_a_while(rig, scene_pair):
    rig.assert_lives()
    rig.frame_ns = FAST_NS

    def nominal():
        send_left(rig, scene_pair)
        return any("nominal height and pitch" in status.message for status in rig.statuses)

    rig.wait(nominal)
    assert any("Nothing comes on /right/image_rect: no right image" in s.message for s in rig.statuses)
    values = rig.diagnosis("the left image alone serves, with the camera's nominal height and pitch", WARN)
    assert values["road profile"] == "nominal"
    assert values["silent topics"] == "/right/image_rect"
    assert float(values["camera height [m]"]) == 1.65


def test_the_left_camera_silent_leaves_nothing_to_work_on(rig, scene_pair):
    rig.assert_lives()
    answered = len(rig.arrays)
    right = rig.image(scene_pair[1])

    def only_the_left_one_is_silent():
        right.header = rig.header(rig.next_stamp())
        rig.image_publishers["right"].publish(right)
        return next((s for s in rig.statuses if s.message == "Nothing comes on /left/image_rect"), None)

    status = rig.wait(only_the_left_one_is_silent)
    assert status.level == WARN
    assert ("silent topics", "/left/image_rect") in [(entry.key, entry.value) for entry in status.values]
    assert len(rig.arrays) == answered
    rig.assert_lives()


@pytest.mark.parametrize("right", ["black", "upside down", "12 px too low"])
def test_a_useless_right_image(rig, scene_pair, right):
    useless = {
        "black": np.zeros_like(scene_pair[1]),
        "upside down": scene_pair[1][::-1],
        "12 px too low": np.roll(scene_pair[1], 12, axis=0),
    }[right]
    rig.assert_lives()
    lanes = rig.answer(rig.send(right=np.ascontiguousarray(useless)))
    assert {"ego_left", "ego_right"} <= roles(lanes)
    values = rig.diagnosis("Degraded stereo: ", WARN)
    assert values["road profile"] == "last"
    assert values["lanes"] != "0"
    rig.assert_lives()


def test_without_any_pair_before_the_parameters_serve(make_rig, scene_pair):
    rig = make_rig(parameter_overrides=[Parameter("road_profile.camera_height", value=1.7)])
    rig.send_infos()
    assert {"ego_left", "ego_right"} <= roles(rig.answer(rig.send(right=np.zeros_like(scene_pair[1]))))
    values = rig.diagnosis("Degraded stereo: no road surface in the disparity 1.2 to 2.4 m", WARN)
    assert values["road profile"] == "nominal"
    assert float(values["camera height [m]"]) == 1.7
