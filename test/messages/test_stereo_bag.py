# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Which camera infos a pair of a bag is looked at with."""

import numpy as np
import pytest

from lane_dp_ros.messages.bag import BagReader, BagWriter
from lane_dp_ros.messages.bag_message import bag_message
from lane_dp_ros.messages.camera import camera_info_to_ros
from lane_dp_ros.messages.image import image_to_ros
from lane_dp_ros.messages.stamp import stamp_to_ros
from lane_dp_ros.messages.stereo_bag import find_stereo_topics, read_stereo_pairs, sync_of_bag

TENTH = 100_000_000
IMAGE = np.zeros((3, 4, 3), np.uint8)


@pytest.fixture
def focal_lengths(tmp_path):
    """Write what is said tenth by tenth, ("left", fx) or "pair", and read fx (left, right) of each pair."""

    def focal_lengths(*tenths):
        with BagWriter(tmp_path / "bag") as writer:
            for number, said in enumerate(tenths, start=1):
                time_ns = number * TENTH
                header = bag_message("std_msgs/msg/Header", stamp=stamp_to_ros(time_ns, bag_message))
                for each in said:
                    if each == "pair":
                        for side in ("left", "right"):
                            image = image_to_ros(IMAGE, header, bag_message)
                            writer.write(f"/{side}/image_rect", time_ns, image)
                    else:
                        side, fx = each
                        P = np.array([[fx, 0, 2, 0], [0, fx, 1, 0], [0, 0, 1, 0]], float)
                        info = camera_info_to_ros(P, IMAGE.shape, header, bag_message)
                        writer.write(f"/{side}/camera_info", time_ns, info)
        with BagReader(tmp_path / "bag") as reader:
            pairs = list(read_stereo_pairs(reader, find_stereo_topics(reader), sync_of_bag(0.01)))
        return [tuple(info.p[0] for info in pair.infos) for pair in pairs]

    return focal_lengths


BOTH = ("left", 700.0), ("right", 700.0)


def test_the_first_camera_infos_serve_before_they_come(focal_lengths):
    assert focal_lengths(["pair"], [*BOTH, "pair"]) == [(700, 700)] * 2


@pytest.mark.parametrize(("first", "second"), [("left", "right"), ("right", "left")])
def test_an_old_calibration_is_never_mixed_with_a_new_one(focal_lengths, first, second):
    found = focal_lengths([*BOTH, "pair"], [(first, 800.0), "pair"], [(second, 800.0), "pair"])
    assert found == [(700, 700), (700, 700), (800, 800)]


def test_a_side_that_changes_alone_is_taken_over_after_a_second(focal_lengths):
    found = focal_lengths([*BOTH, "pair"], [("left", 800.0), "pair"], *[["pair"]] * 11)
    assert found == [(700, 700)] * 12 + [(800, 700)]
