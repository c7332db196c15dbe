# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""A calibration that cannot be right is said within seconds; one that arrives by halves is not mixed."""

import time
from itertools import pairwise

import numpy as np
import pytest
from sensor_msgs.msg import CameraInfo

from lane_dp_ros.scenes import CAMERA, SIZE, render_sequence

OK, WARN, ERROR = b"\x00", b"\x01", b"\x02"
SLOW_NS = 500_000_000  # between pairs: few fill the seconds that a verdict takes, and the rows of each count


def projections():
    """Return P of the scene's left and right camera, (3, 4) each."""
    left = CAMERA.P_left
    right = left.copy()
    right[0, 3] -= left[0, 0] * CAMERA.baseline
    return left, right


def send_info(rig, side, P):
    info = CameraInfo(width=SIZE[0], height=SIZE[1], p=P.ravel().tolist())
    rig.info_publishers[side].publish(info)


def warned(rig, text, **images):
    """Send pairs until a report holds that text, and return its values."""
    rig.frame_ns = SLOW_NS

    def said():
        rig.answer(rig.send(**images))
        return any(text in status.message for status in rig.statuses)

    rig.wait(said, timeout=60.0)
    return rig.diagnosis(text, WARN)


def test_a_wrong_baseline_is_noticed_and_a_right_calibration_is_believed_again(rig):
    left, right = projections()
    right[0, 3] *= 1.2
    rig.send_infos(left.ravel().tolist(), right.ravel().tolist())
    values = warned(rig, "is the baseline, the focal length or road_profile.camera_height wrong?")
    assert float(values["camera height [m]"]) == pytest.approx(1.2 * 1.65, abs=0.06)
    rig.statuses.clear()
    rig.send_infos()

    def believed():
        rig.answer(rig.send())
        return any(status.level == OK for status in rig.statuses)

    rig.wait(believed)


@pytest.mark.parametrize("error", [5.0, 4.0, -4.0])
def test_cameras_turned_against_each_other_are_noticed(rig, error):
    left, right = projections()
    right[0, 2] += error  # every disparity seems to be so many px more
    rig.send_infos(left.ravel().tolist(), right.ravel().tolist())
    values = warned(rig, "is a principal point wrong, or a camera turned sideways?")
    assert abs(float(values["disparity error [px]"])) == pytest.approx(abs(error), abs=2)
    assert abs(float(values["lane width change [%/10 m]"])) > 6


def test_rows_that_do_not_meet_are_noticed(rig, scene_pair):
    rig.send_infos()
    lower = np.roll(scene_pair[1], 1, axis=0)
    values = warned(rig, "The rows of left and right miss each other", right=lower)
    assert float(values["row shift [px]"]) > 0.35


def test_left_and_right_swapped_are_noticed(rig, scene_pair):
    rig.send_infos()
    warned(rig, "Are left and right swapped", left=scene_pair[1], right=scene_pair[0])


def test_one_picture_on_both_sides_is_noticed(rig, scene_pair):
    rig.send_infos()
    warned(
        rig,
        "Left and right show the same picture: does one camera's topic serve as both?",
        right=scene_pair[0],
    )


def test_a_right_picture_that_is_a_frame_late_is_noticed(rig, rendered):
    rig.send_infos()
    pairs = rendered(render_sequence, 43, 10.0, 1)
    for before, pair in pairwise(pairs):
        rig.answer(rig.send(left=pair.left, right=before.right))
    values = rig.diagnosis(
        "The right picture seems to be of another time, 100 ms older than the left one", WARN
    )
    assert float(values["right picture older by [ms]"]) == pytest.approx(100, abs=5)


@pytest.mark.parametrize(
    ("place", "value", "said"),
    [
        ((0, 1), 52.4, "a skew of 52.4 px"),
        ((0, 3), -721.5 * 540, "the baseline is 540 m"),
        ((1, 1), 640, "fy is"),
    ],
)
def test_a_projection_of_no_stereo_camera_is_named(rig, place, value, said):
    left, right = projections()
    right[place] = value
    rig.send_infos(left.ravel().tolist(), right.ravel().tolist())
    rig.answer(rig.send())
    rig.diagnosis(said, ERROR)


def test_between_the_halves_of_a_new_calibration_the_old_one_holds(rig):
    """Judged with a mix, the road would lie elsewhere, or be none."""
    rig.assert_lives()
    before = rig.answer(rig.send())
    left, right = projections()
    wide = left.copy()
    wide[0, 0] *= 0.75
    send_info(rig, "left", wide)
    time.sleep(0.2)
    between = rig.answer(rig.send())
    assert [lane.id for lane in between] == [lane.id for lane in before]
    np.testing.assert_allclose(between[0].points[0], before[0].points[0], atol=0.02)
    right[0, 0] *= 0.75
    send_info(rig, "right", right)
    time.sleep(0.2)
    after = rig.answer(rig.send())
    assert not after or np.abs(after[0].points[0] - before[0].points[0]).max() > 0.5
