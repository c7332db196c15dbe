# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Frames and lanes are joined by their stamps; bags that cannot be reviewed get one clear line."""

import socket
from pathlib import Path

import numpy as np
import pytest

from lane_dp_ros.messages.bag import STORAGES, BagReader, BagWriter, bag_message
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.messages.lanes import lanes_to_ros
from lane_dp_ros.messages.topic_choice import TopicChoice
from lane_dp_ros.review.drive import Drive
from lane_dp_ros.review.read_drive import read_drive
from lane_dp_ros.tools.cli import main


def copied(bag: Path, path: Path, change=lambda _, message: message, storage: str = "mcap") -> Path:
    """Copy a bag; `change(topic, message)` may return another message, or None to leave it out."""
    with BagReader(bag) as reader, BagWriter(path, storage) as writer:
        for topic, time_ns, message in reader.messages():
            if (changed := change(topic, message)) is not None:
                writer.write(topic, time_ns, changed)
    return path


def without(*topics: str):
    return lambda topic, message: None if topic in topics else message


def roles_of(drive: Drive) -> list[tuple[str, ...]]:
    return [tuple(lane.role for lane in frame.lanes) for frame in drive.frames]


@pytest.mark.parametrize("storage", STORAGES)
def test_images_and_lanes_of_one_bag(drive_bag, tmp_path, storage) -> None:
    drive = read_drive(*[copied(drive_bag, tmp_path / "copy", storage=storage)] * 2)
    assert [len(roles) for roles in roles_of(drive)] == [3, 2, 1, 2, 0]
    assert [int(drive.image(frame)[-1, 0]) for frame in drive.frames] == [60, 70, 80, 90, 100]
    assert drive.left_out == 0


def test_lanes_of_another_bag_in_a_namespace(split_bags, drive_bag) -> None:
    split, whole = read_drive(*split_bags), read_drive(drive_bag, drive_bag)
    assert roles_of(split) == roles_of(whole)
    assert split.fingerprint == whole.fingerprint


def test_images_without_lanes_are_left_out(drive_bag, tmp_path) -> None:
    seen = []

    def drop_second(topic, message):
        seen.append(topic)
        return None if topic == "/lanes" and seen.count("/lanes") == 2 else message

    bag = copied(drive_bag, tmp_path / "copy", drop_second)
    drive = read_drive(bag, bag)
    assert [len(roles) for roles in roles_of(drive)] == [3, 1, 2, 0]
    assert drive.left_out == 1


def test_the_fingerprint_tells_lanes_that_moved(drive_bag, tmp_path) -> None:
    def move(topic, message):
        if topic == "/lanes" and len(message.markers) > 1:
            message.markers[1].points[0].x += 0.01
        return message

    moved = copied(drive_bag, tmp_path / "copy", move)
    assert read_drive(moved, moved).fingerprint != read_drive(drive_bag, drive_bag).fingerprint


def test_a_calibration_that_changes_holds_from_then_on(drive_bag, tmp_path) -> None:
    seen = []

    def widen(topic, message):
        if topic == "/left/camera_info":
            seen.append(topic)
            message.p = message.p + np.eye(12)[2] * (10.0 if len(seen) > 3 else 0.0)  # cx
        return message

    bag = copied(drive_bag, tmp_path / "copy", widen)
    assert [frame.camera.cx for frame in read_drive(bag, bag).frames] == [199.5] * 3 + [209.5] * 2


def test_without_the_right_calibration_lines_are_where_they_were(drive_bag, tmp_path) -> None:
    bag = copied(drive_bag, tmp_path / "copy", without("/right/camera_info"))
    known, unknown = read_drive(drive_bag, drive_bag).frames[0], read_drive(bag, bag).frames[0]
    points = known.lanes[0].points
    assert unknown.camera.baseline == 1.0
    np.testing.assert_allclose(unknown.camera.project(points), known.camera.project(points))


def test_a_bag_without_images(refused, split_bags) -> None:
    line = refused(split_bags[1])
    assert "lanes has lanes but no left images" in line
    assert "name the bag with the images, and this one as --lanes" in line


def test_a_bag_without_images_and_lanes(refused, drive_bag, tmp_path) -> None:
    bag = copied(drive_bag, tmp_path / "odd", without("/lanes", "/left/image_rect"))
    line = refused(bag)
    assert (
        "no messages on left/image_rect or left/image_rect/compressed; it has /left/camera_info (5)" in line
    )


def test_a_bag_with_nothing_to_detect_lanes_in(refused, split_bags) -> None:
    assert "no messages on /car/right/image_rect; it has" in refused(split_bags[0])


def test_an_empty_bag(refused, tmp_path) -> None:
    with BagWriter(tmp_path / "empty"):
        pass
    assert "empty is an empty bag: left images were expected" in refused(tmp_path / "empty")


def test_no_bag(refused, tmp_path) -> None:
    assert refused(tmp_path / "x").endswith("x: no such bag")


def test_lanes_of_another_drive(refused, drive_bag, tmp_path) -> None:
    header = bag_message("std_msgs/msg/Header")
    with BagWriter(tmp_path / "other") as writer:
        writer.write("/lanes", 0, lanes_to_ros((), header, bag_message, 0.5))
    line = refused(drive_bag, "--lanes", tmp_path / "other")
    assert "are of 0.000 to 0.000 s" in line
    assert "of 1317000000.000 to 1317000000.400 s: no stamp in common" in line


def test_a_bag_of_lanes_without_lanes(refused, drive_bag, split_bags) -> None:
    line = refused(drive_bag, "--lanes", split_bags[0])
    assert (
        "no messages on lanes (visualization_msgs/msg/MarkerArray); it has /car/left/camera_info (5)" in line
    )


def test_lanes_with_nan_points(refused, drive_bag, tmp_path) -> None:
    def spoil(topic, message):
        if topic == "/lanes" and len(message.markers) > 1:
            message.markers[1].points[0].x = float("nan")
        return message

    line = refused(copied(drive_bag, tmp_path / "copy", spoil))
    assert "the lanes of stamp 1317000000000000000 ns hold NaN or infinity" in line


def test_a_damaged_file_of_judgements(refused, drive_bag) -> None:
    file = drive_bag.with_name("drive.mcap.review.json")
    file.write_text('{"format": ')
    assert "drive.mcap.review.json is no whole file of judgements: Expecting value: line 1" in refused(
        drive_bag
    )
    assert file.read_text() == '{"format": '


def test_a_place_that_cannot_be_written(refused, drive_bag, tmp_path) -> None:
    line = refused(drive_bag, "--review", tmp_path / "nowhere" / "file.json")
    assert "cannot write" in line
    assert "--review FILE names another place" in line


def test_a_port_in_use(refused, drive_bag) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        line = refused(drive_bag, "--port", port)
    assert f"cannot serve on port {port}" in line
    assert "--port names another one, 0 any that is free" in line


@pytest.mark.parametrize("port", ["-1", "65536", "http"])
def test_what_is_no_port(drive_bag, port, capsys) -> None:
    with pytest.raises(SystemExit, match="2"):
        main(["review", str(drive_bag), f"--port={port}"])
    assert f"{port} is not a port from 0 to 65535" in capsys.readouterr().err


def test_two_processes_for_one_bag(refused, drive_bag, start_review, tmp_path) -> None:
    review = start_review(drive_bag)
    (tmp_path / "link").symlink_to(drive_bag)  # one bag, whatever it is called
    for name in (drive_bag, tmp_path / "link"):
        assert "is being written by process" in refused(name, "--port", "0")
    review.end()
    assert not list(tmp_path.glob("*.lock"))


def test_the_left_images_may_be_of_any_camera(drive_bag, tmp_path):
    with BagReader(drive_bag) as reader, BagWriter(tmp_path / "other") as writer:
        for topic, time_ns, message in reader.messages():
            for car in ("a", "b"):
                name = topic if topic.endswith("lanes") else f"/{car}{topic}"
                if car == "a" or name != topic:
                    writer.write(name, time_ns, message)
    with pytest.raises(CommandError, match="several stereo cameras"):
        read_drive(tmp_path / "other", tmp_path / "other")
    drive = read_drive(tmp_path / "other", tmp_path / "other", TopicChoice(camera="/b"))
    assert drive.topics.images["left"].startswith("/b/left/image_rect")
    assert drive.image(drive.frames[0]).shape == read_drive(drive_bag, drive_bag).image(drive.frames[0]).shape


def test_a_right_camera_that_is_named_must_be_there(drive_bag):
    with pytest.raises(CommandError, match="no messages on /no/such for --right TOPIC"):
        read_drive(drive_bag, drive_bag, TopicChoice(left="/left/image_rect", right="/no/such"))
