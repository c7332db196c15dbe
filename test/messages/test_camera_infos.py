# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Left and right CameraInfo that belong together, with messages of real ROS types."""

import pytest
from builtin_interfaces.msg import Time
from sensor_msgs.msg import CameraInfo
from std_msgs.msg import Header

from lane_dp_ros.messages.camera_infos import CameraInfos


def info(fx, stamp=0):
    header = Header(stamp=Time(sec=stamp, nanosec=0))
    return CameraInfo(header=header, width=4, height=3, p=[fx, *[0.0] * 11])


@pytest.fixture
def infos():
    """Both sides have said 700."""
    infos = CameraInfos()
    for side in ("left", "right"):
        infos.hear(side, info(700.0), now=0.0)
    assert in_use(infos, 0.0) == (700, 700)
    return infos


def in_use(infos, now):
    both = infos.both(now)
    return both and tuple(msg.p[0] for msg in both)


def test_both_sides_are_needed():
    infos = CameraInfos()
    assert infos.both(0.0) is None
    infos.hear("left", info(700.0), now=0.0)
    assert infos.both(5.0) is None
    infos.hear("right", info(700.0), now=6.0)
    assert in_use(infos, 6.0) == (700, 700)


@pytest.mark.parametrize(("first", "second"), [("left", "right"), ("right", "left")])
def test_between_the_two_halves_of_a_new_calibration_the_old_one_holds(infos, first, second):
    infos.hear(first, info(800.0), now=1.0)
    assert in_use(infos, 1.0) == (700, 700)
    infos.hear(second, info(800.0), now=1.1)
    assert in_use(infos, 1.1) == (800, 800)


def test_the_other_sides_old_message_that_was_still_on_its_way_does_not_count(infos):
    infos.hear("left", info(800.0, stamp=5), now=1.0)
    infos.hear("right", info(700.0, stamp=4), now=1.0)
    assert in_use(infos, 1.0) == (700, 700)
    infos.hear("right", info(800.0, stamp=5), now=1.0)
    assert in_use(infos, 1.0) == (800, 800)


def test_a_side_that_changes_alone_is_taken_over_when_the_other_one_speaks(infos):
    infos.hear("left", info(800.0), now=1.0)
    infos.hear("right", info(700.0), now=1.1)
    assert in_use(infos, 1.1) == (800, 700)


def test_a_side_that_changes_alone_is_taken_over_after_a_second(infos):
    infos.hear("left", info(800.0), now=1.0)
    infos.hear("left", info(800.0), now=1.9)
    assert in_use(infos, 1.9) == (700, 700)
    assert in_use(infos, 2.1) == (800, 700)


def test_the_same_again_changes_nothing(infos):
    infos.hear("left", info(700.0, stamp=9), now=1.0)
    infos.hear("right", info(800.0, stamp=9), now=1.0)
    assert in_use(infos, 1.0) == (700, 700)


def test_one_calibration_after_the_other(infos):
    for number, fx in enumerate((800.0, 900.0, 1000.0), start=1):
        for side in ("left", "right"):
            assert in_use(infos, float(number)) == (fx - 100, fx - 100)
            infos.hear(side, info(fx, stamp=number), now=float(number))
        assert in_use(infos, float(number)) == (fx, fx)
