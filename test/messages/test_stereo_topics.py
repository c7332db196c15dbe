# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Which topics of a bag are taken for the stereo camera's: named ones, or the one sensible guess."""

import logging

import numpy as np
import pytest

from lane_dp_ros.messages.bag import BagReader, BagWriter
from lane_dp_ros.messages.bag_message import bag_message
from lane_dp_ros.messages.camera import camera_info_to_ros
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.messages.image import compressed_image_to_ros, image_to_ros
from lane_dp_ros.messages.stamp import stamp_to_ros
from lane_dp_ros.messages.stereo_bag import find_stereo_topics, read_stereo_pairs, sync_of_bag
from lane_dp_ros.messages.topic_choice import TopicChoice

IMAGE = np.zeros((6, 8, 3), np.uint8)
WIDE = np.zeros((6, 10, 3), np.uint8)
LEFT, RIGHT = "/left/image_rect", "/right/image_rect"


def infos(baseline=0.1, d=0.0, fx=700.0):
    """Return the fields of the left and the right CameraInfo of a camera."""
    left = np.array([[fx, 0, 4, 0], [0, fx, 3, 0], [0, 0, 1, 0]], float)
    right = left.copy()
    right[0, 3] = -fx * baseline
    return [(P, d) for P in (left, right)]


@pytest.fixture
def bag(tmp_path):
    """Return a function that writes topics, each with what it carries: an image, P and d, or nothing."""

    def bag(topics):
        stamp = stamp_to_ros(10**9, bag_message)
        header = bag_message("std_msgs/msg/Header", stamp=stamp)
        with BagWriter(tmp_path / "bag") as writer:
            for topic, content in topics.items():
                if isinstance(content, tuple):
                    P, d = content
                    message = camera_info_to_ros(P, IMAGE.shape, header, bag_message)
                    message.d[0] = d
                elif topic.endswith(("compressed", "jpeg")):
                    message = compressed_image_to_ros(content, header, bag_message)
                else:
                    message = image_to_ros(content, header, bag_message)
                writer.write(topic, 10**9, message)
        return tmp_path / "bag"

    return bag


def camera(left, right, left_info="", right_info="", **camera_of):
    """Return the topics of a stereo camera and what they carry."""
    left_P, right_P = infos(**camera_of)
    left_info = left_info or f"{left.rpartition('/')[0]}/camera_info"
    right_info = right_info or f"{right.rpartition('/')[0]}/camera_info"
    return {left: IMAGE, right: IMAGE, left_info: left_P, right_info: right_P}


def found(path, **choice):
    """Return the topics that are taken, after reading the one pair on them: left, right and their infos."""
    with BagReader(path, TopicChoice(**choice)) as reader:
        topics = find_stereo_topics(reader)
        assert len(list(read_stereo_pairs(reader, topics, sync_of_bag(0.01)))) == 1
    return (*topics.images.values(), *topics.infos.values(), topics.namespace)


REALSENSE = {
    **camera("/camera/camera/infra1/image_rect_raw", "/camera/camera/infra2/image_rect_raw"),
    "/camera/camera/color/image_raw": IMAGE,
    "/camera/camera/color/camera_info": infos(fx=600.0)[0],
    "/camera/camera/depth/image_rect_raw": IMAGE,
    "/camera/camera/aligned_depth_to_infra1/image_raw": IMAGE,
}
ZED = {
    **camera("/zed/zed_node/left/image_rect_color", "/zed/zed_node/right/image_rect_color"),
    **camera("/zed/zed_node/left_gray/image_rect_gray", "/zed/zed_node/right_gray/image_rect_gray"),
    **camera("/zed/zed_node/left_raw/image_raw_color", "/zed/zed_node/right_raw/image_raw_color", d=0.2),
    "/zed/zed_node/depth/depth_registered": IMAGE,
}
ZED_5 = camera("/zed/zed_node/left/color/rect/image", "/zed/zed_node/right/color/rect/image")
OAK = {
    **camera("/oak/left/image_rect", "/oak/right/image_rect"),
    "/oak/left/image_raw": IMAGE,
    "/oak/right/image_raw": IMAGE,
    "/oak/stereo/image_raw": IMAGE,
}
IMAGE_PIPELINE = {
    **camera("/stereo/left/image_rect_color", "/stereo/right/image_rect_color"),
    "/stereo/left/image_raw": IMAGE,
    "/stereo/right/image_raw": IMAGE,
    "/stereo/left/image_rect": IMAGE,
    "/stereo/right/image_rect": IMAGE,
}


@pytest.mark.parametrize(
    ("topics", "left", "right", "namespace"),
    [
        (REALSENSE, "/infra1/image_rect_raw", "/infra2/image_rect_raw", "/camera/camera"),
        (ZED, "/left/image_rect_color", "/right/image_rect_color", "/zed/zed_node"),
        (ZED_5, "/left/color/rect/image", "/right/color/rect/image", "/zed/zed_node"),
        (OAK, "/left/image_rect", "/right/image_rect", "/oak"),
        (IMAGE_PIPELINE, "/left/image_rect", "/right/image_rect", "/stereo"),
        (camera(LEFT, RIGHT), LEFT, RIGHT, ""),
        (camera("/a/Left_cam/rect", "/a/Right_cam/rect"), "/Left_cam/rect", "/Right_cam/rect", "/a"),
        (camera("/cam0/image_rect", "/cam1/image_rect"), "/cam0/image_rect", "/cam1/image_rect", ""),
        (camera("/left/image_raw", "/right/image_raw"), "/left/image_raw", "/right/image_raw", ""),
    ],
    ids=[
        "RealSense",
        "ZED",
        "ZED 5",
        "OAK-D",
        "image_pipeline",
        "standard",
        "odd",
        "cam0",
        "undistorted raw",
    ],
)
def test_known_layouts(bag, topics, left, right, namespace):
    taken = found(bag(topics))
    assert taken[:2] == (namespace + left, namespace + right)
    assert taken[2:4] == tuple(
        f"{(namespace + each).rpartition('/')[0]}/camera_info" for each in (left, right)
    )
    assert taken[4] == namespace


def test_compressed_images_have_their_camera_info_beside_the_raw_ones(bag):
    P_left, P_right = infos()
    topics = {"/left/camera_info": P_left, "/right/camera_info": P_right}
    path = bag({**topics, f"{LEFT}/compressed": IMAGE, f"{RIGHT}/compressed": IMAGE})
    assert found(path)[:3] == (f"{LEFT}/compressed", f"{RIGHT}/compressed", "/left/camera_info")


def test_compressed_images_of_another_name(bag):
    assert found(bag(camera("/left/jpeg", "/right/jpeg")))[:2] == ("/left/jpeg", "/right/jpeg")


def test_a_baseline_tells_cameras_whose_names_say_no_side(bag):
    names = "/rig/b/image_rect", "/rig/a/image_rect"
    topics = {**camera(*names), "/rig/c/image_rect": WIDE, "/rig/c/camera_info": infos(fx=500.0)[0]}
    assert found(bag(topics))[:2] == names


@pytest.mark.parametrize("baseline", [0.001, 0.0, 120.0])
def test_no_guess_by_a_baseline_that_no_vehicle_has(bag, baseline):
    with pytest.raises(CommandError, match="no messages on left/image_rect.*--left TOPIC --right TOPIC"):
        found(bag(camera("/a/image_rect", "/b/image_rect", baseline=baseline)))


def test_of_several_cameras_the_one_with_a_baseline_is_taken(bag):
    topics = {**camera("/front/left/image_rect", "/front/right/image_rect")}
    topics |= camera("/wide/left/image_rect", "/wide/right/image_rect", baseline=0.0)
    assert found(bag(topics))[4] == "/front"


def test_several_cameras_are_refused_and_one_can_be_named(bag):
    topics = camera("/front/left/image_rect", "/front/right/image_rect")
    path = bag({**topics, **camera("/rear/left/image_rect", "/rear/right/image_rect")})
    with pytest.raises(
        CommandError, match=r"several stereo cameras.*/front/, /rear/: name one by --camera PREFIX"
    ):
        found(path)
    for prefix in ("/rear", "rear", "/rear/"):
        assert found(path, camera=prefix)[4] == "/rear"
    assert found(path, left="/rear/left/image_rect")[:2] == (
        "/rear/left/image_rect",
        "/rear/right/image_rect",
    )


def test_named_topics(bag):
    path = bag(camera("/eye/one", "/eye/two", "/calibration/one", "/calibration/two"))
    named = {"left": "/eye/one", "right": "eye/two"}
    with pytest.raises(
        CommandError, match="no messages on /eye/camera_info for --left-info TOPIC; it has .*/eye/one"
    ):
        found(path, **named)
    named |= {"left_info": "calibration/one", "right_info": "/calibration/two"}
    assert found(path, **named)[:4] == ("/eye/one", "/eye/two", "/calibration/one", "/calibration/two")


@pytest.mark.parametrize(
    ("choice", "said"),
    [
        ({"left": "/eye"}, "name both sides, add --right TOPIC; it has /left/camera_info"),
        ({"right": "/eye"}, "name both sides, add --left TOPIC"),
        ({"left": "/eye", "right": "/right/image_rect"}, "no messages on /eye for --left TOPIC; it has"),
        ({"left": LEFT, "right": LEFT}, "is named for both sides"),
        ({"left": LEFT, "right_info": "/no"}, "no messages on /no for --right-info TOPIC"),
        ({"camera": "/zed"}, "no messages on left/image_rect or .*name the camera's topics: --left TOPIC"),
    ],
)
def test_names_that_the_bag_does_not_have(bag, choice, said):
    with pytest.raises(CommandError, match=said) as caught:
        found(bag(camera(LEFT, RIGHT)), **choice)
    assert "\n" not in str(caught.value)


def test_images_with_distortion_are_taken_by_name_only(bag, caplog):
    path = bag(camera("/left/image_raw", "/right/image_raw", d=0.1))
    with pytest.raises(CommandError, match="/left/image_raw is not rectified, by its CameraInfo"):
        found(path)
    assert found(path, left="/left/image_raw")[0] == "/left/image_raw"
    assert "/left/image_raw is taken as rectified" in caplog.text


@pytest.mark.parametrize("missing", ["/left/camera_info", RIGHT, "/right/camera_info"])
def test_what_a_camera_lacks_is_named(bag, missing):
    topics = camera(LEFT, RIGHT)
    del topics[missing]
    with pytest.raises(CommandError, match=f"no messages on {missing}; it has .*{LEFT} "):
        found(bag(topics))


def test_a_guess_of_other_names_is_told_in_one_line(bag, caplog):
    caplog.set_level(logging.INFO)
    path = bag(REALSENSE)
    found(path)
    left, right = (f"/camera/camera/infra{number}/image_rect_raw" for number in (1, 2))
    assert caplog.messages == [f"{path}: left is {left}, right {right}"]


def test_nothing_is_told_of_standard_names(bag, caplog):
    caplog.set_level(logging.INFO)
    found(bag(camera(f"/car{LEFT}", f"/car{RIGHT}")))
    assert not caplog.messages


def test_a_refusal_of_a_bag_with_many_topics_is_bounded(bag):
    path = bag({f"/topic{number}/image": IMAGE for number in range(300)})
    with pytest.raises(CommandError, match="270 more topics; name the camera's topics") as caught:
        found(path)
    assert len(str(caught.value)) < 1500


def test_left_alone(bag):
    path = bag({"/zed/left/image_rect_color": IMAGE, "/zed/left/camera_info": infos()[0]})
    with BagReader(path) as reader:
        assert find_stereo_topics(reader, ("left",)).images["left"] == "/zed/left/image_rect_color"


@pytest.mark.parametrize("option", ["left", "right", "left_info", "right_info"])
@pytest.mark.parametrize("others", [{}, {"left": LEFT, "right": RIGHT}])
def test_a_named_topic_of_another_type_is_refused(bag, option, others) -> None:
    topic = LEFT if option.endswith("info") else "/left/camera_info"
    choice = TopicChoice(**{**others, option: topic})
    with BagReader(bag(camera(LEFT, RIGHT)), choice) as reader:
        with pytest.raises(
            CommandError, match=f"--{option.replace('_', '-')} {topic} is .*, expected sensor"
        ):
            find_stereo_topics(reader)


def test_cameras_whose_names_begin_alike(bag) -> None:
    rigs = ("/cam1", "/cam10", "/front")
    path = bag({k: v for rig in rigs for k, v in camera(f"{rig}/left/image", f"{rig}/right/image").items()})
    named = {
        "/cam1": "/cam1",
        "cam1/": "/cam1",
        "/cam10": "/cam10",
        "front": "/front",
        "/fro": "/front",
    }
    for given, rig in named.items():
        with BagReader(path, TopicChoice(camera=given)) as reader:
            found = find_stereo_topics(reader)
        assert found.images == {"left": f"{rig}/left/image", "right": f"{rig}/right/image"}
    with BagReader(path) as reader, pytest.raises(CommandError, match="/cam1/, /cam10/, /front/"):
        find_stereo_topics(reader)
