# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Whatever comes in: one clear message, empty lanes where the pair could be read, and the node lives on."""

import array
import time

import cv2
import numpy as np
import pytest
from rcl_interfaces.msg import Log
from rclpy.parameter import Parameter

from lane_dp_ros.scenes import CAMERA, SIZE

OK, WARN, ERROR = b"\x00", b"\x01", b"\x02"


def projection(fx=CAMERA.fx, t_x=0.0):
    return [fx, 0.0, CAMERA.cx, t_x, 0.0, fx, CAMERA.cy, 0.0, 0.0, 0.0, 1.0, 0.0]


RIGHT = projection(t_x=-CAMERA.fx * CAMERA.baseline)


def test_without_camera_info_the_newest_pair_waits(rig):
    rig.send()
    values = rig.diagnosis("Nothing comes on /left/camera_info and /right/camera_info", WARN)
    assert values["silent topics"] == "/left/camera_info, /right/camera_info"
    waiting = rig.send()
    time.sleep(0.2)
    assert rig.arrays == []
    rig.send_infos()
    assert rig.answer(waiting)
    assert len(rig.arrays) == 1
    rig.assert_lives()


def test_a_pair_long_before_the_first_camera_info_is_stale(rig):
    early = rig.send()
    rig.diagnosis("Nothing comes on /left/camera_info and /right/camera_info", WARN)
    time.sleep(1.5)
    rig.send_infos()
    rig.answer(rig.send())
    assert rig.answers(early) == []


@pytest.mark.parametrize(
    ("left", "right", "message"),
    [
        (projection(fx=0.0), RIGHT, "fx = 0"),
        (projection(fx=float("nan")), RIGHT, "fx = nan"),
        (RIGHT, projection(), "left and right swapped?"),
    ],
)
def test_a_calibration_that_makes_no_stereo_camera(rig, left, right, message):
    rig.assert_lives()
    rig.send_infos(left, right)
    stamp_ns = rig.send()
    assert rig.answer(stamp_ns) == ()
    assert len(rig.edge_answer(stamp_ns).markers) == 1
    rig.diagnosis(message, ERROR)
    rig.assert_lives()


def test_left_and_right_of_different_size(rig, scene_pair):
    rig.send_infos()
    assert rig.answer(rig.send(right=scene_pair[1][:-1])) == ()
    rig.diagnosis("images are 1242x375 left and 1242x374 right, expected equal sizes", ERROR)
    rig.assert_lives()


def test_a_camera_info_of_another_size(rig):
    rig.send_infos(size=(640, 480))
    assert rig.answer(rig.send()) == ()
    rig.diagnosis("images are 1242x375, their CameraInfo says 640x480, expected equal sizes", ERROR)
    rig.assert_lives()


@pytest.mark.parametrize(
    ("field", "value", "message"),
    [
        ("encoding", "32FC1", "right image: encoding is '32FC1', expected one of mono8, bgr8"),
        ("data", array.array("B", [1, 2, 3]), "right image: data has 3 bytes, expected 1397250"),
        ("width", 0, "right image: size is 0x375, expected at least 1x1"),
        ("step", 0, "right image: step is 0 bytes, expected >= 3726"),
    ],
)
def test_an_image_that_cannot_be_read_gets_no_answer(rig, scene_pair, field, value, message):
    rig.send_infos()
    broken = rig.image(scene_pair[1])
    setattr(broken, field, value)
    stamp_ns = rig.send(right=broken)
    values = rig.diagnosis(message, ERROR)
    assert values["frames failed"] == "1"
    assert rig.answers(stamp_ns) == rig.answers(stamp_ns, rig.edge_arrays) == []
    rig.assert_lives()


@pytest.fixture
def untracked_rig(make_rig):
    """Each frame by itself: equal pictures give equal lanes."""
    return make_rig(parameter_overrides=[Parameter("tracking.enabled", value=False)])


def test_step_with_padding(untracked_rig, scene_pair):
    rig = untracked_rig

    def padded(pixels):
        message = rig.image(pixels)
        rows = np.frombuffer(message.data, np.uint8).reshape(message.height, -1)
        rows = np.pad(rows, ((0, 0), (0, 10)), constant_values=255)
        message.step, message.data = rows.shape[1], array.array("B", rows.tobytes())
        return message

    rig.send_infos()
    plain = rig.answer(rig.send())
    with_padding = rig.answer(rig.send(*map(padded, scene_pair)))
    assert len(plain) == len(with_padding) > 0
    np.testing.assert_array_equal(plain[0].points, with_padding[0].points)


def test_big_endian_mono16(untracked_rig, scene_pair):
    rig = untracked_rig

    def mono16(pixels, order):
        grey = cv2.cvtColor(pixels, cv2.COLOR_BGR2GRAY)
        message = rig.image(grey)
        message.encoding, message.is_bigendian, message.step = "mono16", int(order == ">"), 2 * grey.shape[1]
        message.data = array.array("B", (grey.astype(np.uint16) << 8).astype(order + "u2").tobytes())
        return message

    rig.send_infos()
    little, big = (rig.answer(rig.send(*(mono16(image, order) for image in scene_pair))) for order in "<>")
    assert len(little) == len(big) > 0
    np.testing.assert_array_equal(little[0].points, big[0].points)


def test_an_image_of_one_pixel(rig):
    rig.send_infos(size=(1, 1))
    pixel = np.zeros((1, 1, 3), np.uint8)
    assert rig.answer(rig.send(pixel, pixel)) == ()
    rig.assert_lives()


def test_images_of_4000x3000(rig, scene_pair):
    scale = 4000 / SIZE[0]
    P_left, P_right = (np.array(P).reshape(3, 4) for P in (projection(), RIGHT))
    for P in (P_left, P_right):
        P[:2] *= scale
        P[1, 2] += 896  # the scaled scene lies in the middle of the tall picture
    rig.send_infos(P_left.ravel().tolist(), P_right.ravel().tolist(), (4000, 3000))
    large = [cv2.resize(image, (4000, 1208)) for image in scene_pair]
    tall = [cv2.copyMakeBorder(image, 896, 896, 0, 0, cv2.BORDER_CONSTANT) for image in large]
    rig.answer(rig.send(*tall))
    rig.assert_lives()


@pytest.mark.parametrize("value", [0, 255])
def test_all_black_and_all_white(rig, value):
    rig.assert_lives()
    even = np.full((SIZE[1], SIZE[0]), value, np.uint8)
    assert rig.answer(rig.send(even, even)) == ()
    values = rig.diagnosis("Degraded stereo: no road surface", WARN)
    assert values["road profile"] == "last"
    rig.assert_lives()


def test_noise(rig):
    rng = np.random.default_rng(1)
    rig.send_infos()
    noise = [rng.integers(0, 256, (SIZE[1], SIZE[0]), np.uint8) for _ in range(2)]
    assert rig.answer(rig.send(*noise)) == ()
    values = rig.diagnosis("Degraded stereo: no road surface", WARN)
    assert values["road profile"] == "nominal"
    rig.assert_lives()


def test_images_without_a_pair(rig, scene_pair):
    rig.send_infos()

    def said():
        stamp_ns = rig.next_stamp()
        for side, image, late_ns in zip(("left", "right"), scene_pair, (0, 40_000_000), strict=True):
            rig.image_publishers[side].publish(rig.image(image, stamp_ns + late_ns))
        return any("Images come, but no pairs" in status.message for status in rig.statuses)

    rig.wait(said)
    values = rig.diagnosis("Images come, but no pairs", WARN)
    assert int(values["unpaired left images"]) > 0
    assert rig.arrays == []
    rig.assert_lives()


def test_stamps_that_run_backwards(rig):
    rig.send_infos()
    for stamp_ns in (9_000_000_000, 9_100_000_000, 1_000_000_000, 1_100_000_000):
        assert rig.answer(rig.send(stamp_ns=stamp_ns))
    rig.assert_one_answer_each()


def test_a_complaint_is_logged_once_and_not_at_every_report(rig, scene_pair):
    logged = []
    rig.listen(Log, "/rosout", logged.append)
    broken = rig.image(scene_pair[1])
    broken.encoding = "32FC1"
    rig.send_infos()

    def reported_thrice():
        rig.send(right=broken)
        return sum("32FC1" in status.message for status in rig.statuses) >= 3

    rig.wait(reported_thrice)
    complaints = [log for log in logged if "encoding is '32FC1', expected one of mono8" in log.msg]
    assert [log.level for log in complaints] == [Log.ERROR[0] if isinstance(Log.ERROR, bytes) else Log.ERROR]
    assert "\n" not in complaints[0].msg
