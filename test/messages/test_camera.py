# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""CameraInfo to the stereo camera and back, on rclpy's own messages."""

import numpy as np
import pytest
from sensor_msgs.msg import CameraInfo

from lane_dp_ros.messages.bag_message import bag_message
from lane_dp_ros.messages.camera import camera_from_ros, camera_info_to_ros


def info(t_x=0.0, fx=700.0, size=(1242, 375)):
    P = [fx, 0.0, 600.0, t_x, 0.0, fx, 180.0, 0.0, 0.0, 0.0, 1.0, 0.0]
    return CameraInfo(width=size[0], height=size[1], p=P)


def test_the_baseline_comes_from_both_projections():
    camera = camera_from_ros(info(44.0), info(-340.0))
    assert (camera.fx, camera.cx, camera.baseline) == (700.0, 600.0, pytest.approx(384.0 / 700))


@pytest.mark.parametrize(
    ("left", "right", "match"),
    [
        (info(fx=0.0), info(-378.0, fx=0.0), "fx = 0.*expected > 0"),
        (info(fx=float("nan")), info(-378.0), "fx = nan.*expected > 0"),
        (info(-378.0), info(), "baseline is -0.54 m, expected > 0"),
        (info(), info(-378.0, size=(640, 480)), "CameraInfo is 1242x375 left and 640x480 right"),
    ],
)
def test_calibrations_that_make_no_stereo_camera_are_refused(left, right, match):
    with pytest.raises(ValueError, match=match):
        camera_from_ros(left, right)


def test_a_camera_round_trip():
    left = np.array([[700.0, 0, 600, 44], [0, 700, 180, 0], [0, 0, 1, 0]])
    right = left - [[0, 0, 0, 384], [0] * 4, [0] * 4]
    header = bag_message("std_msgs/msg/Header", frame_id="left_optical")
    infos = [camera_info_to_ros(P, (375, 1242, 3), header, bag_message) for P in (left, right)]
    camera = camera_from_ros(*infos)
    assert (camera.fx, camera.cx, camera.baseline) == (700.0, 600.0, pytest.approx(384.0 / 700))
    assert (infos[0].width, infos[0].height) == (1242, 375)
    np.testing.assert_array_equal(infos[0].k, [700, 0, 600, 0, 700, 180, 0, 0, 1])
