# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Bags are written and read back; damage and wrong paths give one clear line."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from lane_dp_ros.messages.bag import STORAGES, BagReader, BagWriter, bag_message
from lane_dp_ros.messages.errors import CommandError

IMAGE = "sensor_msgs/msg/Image"


def image(value: int) -> object:
    stamp = bag_message("builtin_interfaces/msg/Time", sec=value, nanosec=5)
    header = bag_message("std_msgs/msg/Header", stamp=stamp, frame_id="camera")
    pixels = np.full((30, 40), value, np.uint8)
    return bag_message(IMAGE, header=header, height=30, width=40, step=40, encoding="mono8", data=pixels)


def write_bag(path: Path, storage: str = "mcap", count: int = 5, force: bool = False) -> Path:
    with BagWriter(path, storage, force) as writer:
        for index in range(count):
            writer.write("/left/image_rect", index * 10**8, image(index))
    return path


def interrupted_write(path: Path, error: type[BaseException]) -> None:
    with BagWriter(path, force=True) as writer:
        writer.write("/a", 0, image(0))
        raise error


def storage_file(bag: Path) -> Path:
    return next(path for path in bag.iterdir() if path.suffix in (".mcap", ".db3"))


@pytest.mark.parametrize("storage", STORAGES)
def test_round_trip(tmp_path: Path, storage: str) -> None:
    bag = write_bag(tmp_path / "x.bag2", storage)
    for path in (bag, storage_file(bag)):
        with BagReader(path) as reader:
            assert reader.topics == {"/left/image_rect": IMAGE}
            assert reader.message_count() == 5
            read = list(reader.messages())
        assert [time_ns for _, time_ns, _ in read] == [index * 10**8 for index in range(5)]
        header = read[3][2].header
        assert (header.stamp.sec, header.stamp.nanosec, header.frame_id) == (3, 5, "camera")
        np.testing.assert_array_equal(read[3][2].data, np.full(1200, 3, np.uint8))


def test_only_the_named_topics_are_read(tmp_path: Path) -> None:
    with BagWriter(tmp_path / "x") as writer:
        writer.write("/a", 1, image(1))
        writer.write("/b", 2, image(2))
    with BagReader(tmp_path / "x") as reader:
        assert [raw.topic for raw in reader.raw_messages(["/b"])] == ["/b"]
        assert list(reader.raw_messages(["/c"])) == []


def test_message_defaults_and_conversions() -> None:
    marker = bag_message("visualization_msgs/msg/Marker", ns="lanes", action=3)
    assert (marker.ns, marker.action, marker.id, marker.points) == ("lanes", 3, 0, [])
    assert (marker.pose.orientation.w, marker.pose.orientation.x) == (1.0, 0.0)
    info = bag_message("sensor_msgs/msg/CameraInfo", p=np.arange(12).reshape(3, 4), d=(0.5, 1))
    assert info.p.dtype == np.float64
    assert (info.p.shape, info.k.shape) == ((12,), (9,))
    np.testing.assert_array_equal(info.d, [0.5, 1.0])
    with pytest.raises(TypeError, match="Marker has no field colour"):
        bag_message("visualization_msgs/msg/Marker", colour=1)


@pytest.mark.parametrize("storage", STORAGES)
@pytest.mark.parametrize("keep", [0.0, 0.002, 0.1, 0.5, 0.9, 0.999])
def test_a_cut_off_bag_is_one_line(tmp_path: Path, storage: str, keep: float) -> None:
    bag = write_bag(tmp_path / "x", storage, count=100)
    file = storage_file(bag)
    file.write_bytes(file.read_bytes()[: int(keep * file.stat().st_size)])
    for path in (bag, file):
        with pytest.raises(CommandError, match="damaged") as caught, BagReader(path) as reader:
            list(reader.messages())
        assert "\n" not in str(caught.value)
        assert str(path) in str(caught.value)


def test_a_message_that_cannot_be_decoded(tmp_path: Path) -> None:
    with BagReader(write_bag(tmp_path / "x", count=1)) as reader:
        raw = next(reader.raw_messages())
    with BagWriter(tmp_path / "y") as writer:
        writer.write_raw(dataclasses.replace(raw, data=raw.data[:50]))
    with pytest.raises(CommandError, match="cannot be read"), BagReader(tmp_path / "y") as reader:
        list(reader.messages())


def test_paths_that_are_no_bag(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("hello")
    (tmp_path / "fake.mcap").write_text("this is no mcap file at all, however long it may be")
    (tmp_path / "odd").mkdir()
    (tmp_path / "odd/metadata.yaml").write_text("rosbag2_bagfile_information: 3")
    (tmp_path / "folder").mkdir()
    cases = {"none": "no such bag", "notes.txt": "no rosbag2", "fake.mcap": "no rosbag2"}
    cases |= {"odd": "storage file .* was expected", "folder": r"metadata.yaml or a storage file \(.mcap"}
    for name, message in cases.items():
        with pytest.raises(CommandError, match=message):
            BagReader(tmp_path / name)


def test_an_existing_output_is_kept_without_force(tmp_path: Path) -> None:
    bag = write_bag(tmp_path / "x", count=2)
    with pytest.raises(CommandError, match=r"exists already.*--force"):
        write_bag(bag, count=1)
    with BagReader(bag) as reader:
        assert reader.message_count() == 2


def test_force_replaces_a_bag_folder_and_a_bag_file(tmp_path: Path) -> None:
    bag = write_bag(tmp_path / "x", count=2)
    file = storage_file(bag).rename(tmp_path / "single.mcap")
    (bag / "x.db3").touch()  # a recording that was interrupted: storage without an index
    for path in (bag, file):
        write_bag(path, count=1, force=True)
        with BagReader(path) as reader:
            assert reader.message_count() == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == ["single.mcap", "x"]


def test_force_deletes_nothing_but_bags(tmp_path: Path) -> None:
    (tmp_path / "notes.mcap").write_text("my notes")
    with_notes = write_bag(tmp_path / "with_notes")
    (with_notes / "notes.txt").write_text("mine")
    (tmp_path / "link").symlink_to(write_bag(tmp_path / "target"))
    (tmp_path / "empty").mkdir()
    for name in ("notes.mcap", "with_notes", "link", "empty"):
        with pytest.raises(CommandError, match="no rosbag2, so --force does not delete it"):
            write_bag(tmp_path / name, force=True)
    assert (with_notes / "notes.txt").read_text() == "mine"


@pytest.mark.parametrize("name", ["a b", "ü", "a#b", "a?b", "a%20b"])
def test_odd_names(tmp_path: Path, name: str) -> None:
    with BagReader(write_bag(tmp_path / name)) as reader:
        assert reader.message_count() == 5
    path = tmp_path / "sqlite" / name
    if set("#?%") & set(name):
        with pytest.raises(CommandError, match="must be free of #"):
            write_bag(path, "sqlite3")
        assert not path.parent.exists()
    else:
        with BagReader(write_bag(path, "sqlite3")) as reader:
            assert reader.message_count() == 5


def test_no_half_written_bag_is_left(tmp_path: Path) -> None:
    bag = write_bag(tmp_path / "x", count=2)
    for error in (ValueError, KeyboardInterrupt):
        with pytest.raises(error):
            interrupted_write(bag, error)
    assert [path.name for path in tmp_path.iterdir()] == ["x"]
    with BagReader(bag) as reader:
        assert reader.message_count() == 2


@pytest.mark.parametrize("storage", STORAGES)
def test_a_path_that_cannot_be_written(tmp_path: Path, storage: str) -> None:
    (tmp_path / "file").touch()
    for path in (tmp_path / "file/x", Path("/proc/x"), tmp_path / ("n" * 300)):
        with pytest.raises(CommandError, match="cannot write"):
            write_bag(path, storage)


@pytest.mark.parametrize("storage", STORAGES)
def test_messages_of_a_stretch_of_time(write_stereo_bag, small_pairs, storage) -> None:
    stamps = [pair.stamp_ns for pair in small_pairs]
    with BagReader(write_stereo_bag(small_pairs, storage=storage)) as reader:
        found = list(reader.messages_between("/left/image_rect", stamps[1], stamps[3]))
        assert [image.data[0] for image in found] == [10, 20]
        assert list(reader.messages_between("/lanes", 0, stamps[-1])) == []
