# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The status report, on times given by hand."""

import pytest

from lane_dp_ros.core.monitoring.calibration_monitor import CalibrationStatus
from lane_dp_ros.ros.diagnostics import Counts, FrameReport, Health, Level, Topics

TOPICS = Topics(images=("/l", "/r"), infos=("/li", "/ri"))
NOTHING = Counts(0, 0, 0, 0)


def health_that_heard(*topics, now):
    health = Health()
    for topic in topics:
        health.heard(topic, now)
    return health


def counts(matched=0, dropped=0, left=0, right=0, alone=0):
    return Counts(matched, dropped, left, right, alone)


def test_before_anything_comes_all_topics_are_missing():
    level, message, values = Health().summary(1.0, NOTHING, TOPICS)
    assert (level, message) == (Level.WARN, "Nothing comes on /l and /r and /li and /ri")
    assert values["silent topics"] == "/l, /r, /li, /ri"
    assert (values["rate [1/s]"], values["latency mean [ms]"]) == ("0.00", "nan")
    assert values["camera height [m]"] == "unknown"


def test_images_must_keep_coming_but_camera_infos_need_not():
    health = health_that_heard("/l", "/r", "/li", "/ri", now=0.0)
    health.heard("/l", 3.0)
    assert health.summary(4.0, NOTHING, TOPICS)[:2] == (Level.WARN, "Nothing comes on /r")
    health.heard("/r", 4.0)
    assert health.summary(5.0, NOTHING, TOPICS)[0] is Level.OK


def test_rate_latency_and_stages_are_those_of_the_last_seconds():
    health = health_that_heard("/l", "/r", "/li", "/ri", now=20.0)
    health.answered(FrameReport(1.0, latency=9.0, seconds={"disparity": 9.0}))
    for i in range(21):
        report = FrameReport(
            18.0 + 0.1 * i,
            0.04 if i < 20 else 0.08,
            3,
            {"disparity": 0.01},
            1.65,
            0.02,
            road_profile="measured",
            note="fine",
            road_edges=2,
        )
        health.answered(report)
    level, message, values = health.summary(20.1, counts(matched=22), TOPICS)
    assert (level, message) == (Level.OK, "10.0 frames/s, 3 lanes in the last frame")
    assert values["rate [1/s]"] == "10.00"
    assert values["latency mean [ms]"] == f"{(20 * 40 + 80) / 21:.1f}"
    assert values["latency p95 [ms]"] == "40.0"
    assert values["stage disparity [ms]"] == "10.00"
    assert (values["camera height [m]"], values["camera pitch [rad]"]) == ("1.65", "0.0200")
    assert (values["lanes"], values["road edges"], values["note"]) == ("3", "2", "fine")
    assert values["road profile"] == "measured"


def test_a_failed_frame_is_an_error_until_the_next_report():
    health = health_that_heard("/l", "/r", "/li", "/ri", now=1.0)
    health.answered(FrameReport(1.0, 0.01, problem="left image: broken", failed=True))
    health.answered(FrameReport(1.1, 0.01, lanes=2))
    level, message, values = health.summary(1.2, counts(matched=2), TOPICS)
    assert (level, message) == (Level.ERROR, "A frame failed: left image: broken")
    assert (values["frames failed"], values["last problem"]) == ("1", "left image: broken")
    level, _, values = health.summary(2.2, counts(matched=2), TOPICS)
    assert level is Level.OK
    assert (values["frames failed"], values["last problem"]) == ("1", "left image: broken")


@pytest.mark.parametrize(
    ("before", "after", "message"),
    [
        (counts(5), counts(9, dropped=1), "Images come faster than they can be worked on: pairs are dropped"),
        (counts(5), counts(9, left=1), "Images without a partner are dropped"),
        (counts(5), counts(5, 0, 3, 3), "Images come, but no pairs: do the stamps of left and right agree?"),
    ],
)
def test_what_was_counted_since_the_last_report_is_said(before, after, message):
    health = health_that_heard("/l", "/r", "/li", "/ri", now=1.0)
    health.summary(1.0, before, TOPICS)
    level, said, values = health.summary(2.0, after, TOPICS)
    assert (level, said) == (Level.WARN, message)
    assert values["pairs dropped"] == str(after.dropped)
    assert values["unpaired left images"] == str(after.unpaired_left)
    assert values["left images alone"] == str(after.alone)
    assert health.summary(2.5, after, TOPICS)[0] is Level.OK


def test_a_frame_on_another_road_than_its_own_is_a_warning_until_the_next_report():
    health = health_that_heard("/l", "/r", "/li", "/ri", now=1.0)
    health.answered(FrameReport(1.0, 0.01, lanes=2, road_profile="last", problem="no road seen"))
    level, message, values = health.summary(1.1, counts(matched=1), TOPICS)
    assert (level, message) == (Level.WARN, "Degraded stereo: no road seen")
    assert values["road profile"] == "last"
    assert health.summary(2.1, counts(matched=1), TOPICS)[0] is Level.OK


def test_a_silent_camera_and_what_serves_instead_are_one_sentence():
    health = health_that_heard("/l", "/li", "/ri", now=1.0)
    health.answered(FrameReport(1.0, 0.01, lanes=2, road_profile="last", problem="no right image"))
    _, message, _ = health.summary(1.1, counts(alone=1), TOPICS)
    assert message == "Nothing comes on /r: no right image"


DOUBT = CalibrationStatus(3.51, 0.0071, -2.74, 0.12, -0.31, "Is the calibration wrong?")


def test_a_doubtful_calibration_is_a_warning_with_its_numbers():
    health = health_that_heard("/l", "/r", "/li", "/ri", now=1.0)
    health.answered(FrameReport(1.0, 0.01, lanes=2, road_profile="measured", check=DOUBT))
    level, message, values = health.summary(1.1, counts(matched=1), TOPICS)
    assert (level, message) == (Level.WARN, "Is the calibration wrong?")
    assert (values["lane width [m]"], values["lane width change [%/10 m]"]) == ("3.51", "7.1")
    assert values["disparity error [px]"] == "-2.7"
    assert (values["row shift [px]"], values["row turn [px]"]) == ("0.12", "-0.31")


def test_a_calibration_of_which_nothing_is_known_yet_is_no_warning():
    health = health_that_heard("/l", "/r", "/li", "/ri", now=1.0)
    health.answered(FrameReport(1.0, 0.01, lanes=2, road_profile="measured"))
    level, _, values = health.summary(1.1, counts(matched=1), TOPICS)
    assert level is Level.OK
    assert values["lane width change [%/10 m]"] == values["row shift [px]"] == "unknown"


def test_what_may_be_the_cause_follows_what_serves_instead():
    health = health_that_heard("/l", "/r", "/li", "/ri", now=1.0)
    health.answered(FrameReport(1.0, 0.01, problem="no road seen", check=DOUBT))
    _, message, _ = health.summary(1.1, counts(matched=1), TOPICS)
    assert message == "Degraded stereo: no road seen. Is the calibration wrong?"
