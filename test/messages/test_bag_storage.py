# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Bags as ros2 bag and other tools leave them: each is read to its last message."""

import logging
import re
import shutil
import sqlite3
import struct
from pathlib import Path

import lz4.frame
import numpy as np
import pytest
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer

from lane_dp_ros.messages.bag import STORAGES, BagReader, bag_message
from lane_dp_ros.messages.bag_files import looks_like_bag
from lane_dp_ros.messages.bag_message import typestore
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.messages.unpacking import zstd as zstd_module

zstd = zstd_module()
TOPIC, INFO = "/left/image_rect", "sensor_msgs/msg/CameraInfo"
MAGIC = b"\x89MCAP0\r\n"


def info(number: int) -> object:
    header = bag_message("std_msgs/msg/Header", frame_id=str(number) * 200)
    return bag_message(INFO, header=header, width=number)


def write(
    path: Path, storage: str = "mcap", numbers: range = range(5), topic: str = TOPIC, compression=None
) -> Path:
    writer = Writer(path, version=9, storage_plugin=StoragePlugin[storage.upper()])
    if compression:
        writer.set_compression(CompressionMode[compression.upper()], CompressionFormat.ZSTD)
    with writer:
        connection = writer.add_connection(topic, INFO, typestore=typestore())
        for number in numbers:
            writer.write(connection, number * 10**8, bytes(typestore().serialize_cdr(info(number), INFO)))
    return path


def numbers_in(path: Path) -> list[int]:
    with BagReader(path) as reader:
        read = [(time_ns, message.width) for _, time_ns, message in reader.messages([TOPIC])]
        assert reader.message_count([TOPIC]) == len(read)
        assert list(reader.topics) == [TOPIC]
    assert [time_ns for time_ns, _ in read] == [width * 10**8 for _, width in read]
    return [width for _, width in read]


def only_file(bag: Path) -> Path:
    (file,) = (path for path in bag.iterdir() if path.name != "metadata.yaml")
    return file


def edit(metadata: Path, pattern: str, text: str) -> None:
    edited, count = re.subn(pattern, text, metadata.read_text())
    assert count
    metadata.write_text(edited)


def records(data: bytes):
    """Yield operation and content of the records of an MCAP file's data section, chunks opened."""
    place = 0
    while place < len(data):
        operation, length = struct.unpack_from("<BQ", data, place)
        content = data[place + 9 : place + 9 + length]
        place += 9 + length
        if operation == 6:
            head = 28 + 4 + struct.unpack_from("<I", content, 28)[0] + 8
            yield from records(content[head:])
        elif operation in (1, 3, 4, 5):
            yield operation, content
        elif operation == 15:
            return


def without_chunks(file: Path) -> bytes:
    """Return an MCAP file as storage preset `fastwrite` writes it: no chunks, no index."""
    plain = [struct.pack("<BQ", op, len(body)) + body for op, body in records(file.read_bytes()[8:])]
    end = struct.pack("<BQI", 15, 4, 0) + struct.pack("<BQQQI", 2, 20, 0, 0, 0)
    return MAGIC + b"".join(plain) + end + MAGIC


@pytest.mark.parametrize(
    ("storage", "compression"),
    [("mcap", "storage"), *((storage, mode) for storage in STORAGES for mode in ("file", "message"))],
)
def test_compressed(tmp_path, storage, compression):
    bag = write(tmp_path / "bag", storage, compression=compression)
    assert numbers_in(bag) == [0, 1, 2, 3, 4]
    assert numbers_in(only_file(bag)) == [0, 1, 2, 3, 4]
    (bag / "metadata.yaml").unlink()
    assert numbers_in(bag) == [0, 1, 2, 3, 4]


@pytest.mark.parametrize("storage", STORAGES)
@pytest.mark.parametrize("with_metadata", [True, False])
def test_split(tmp_path, storage, with_metadata):
    bag = write(tmp_path / "bag", storage, range(0))
    only_file(bag).unlink()
    ending = {"mcap": ".mcap", "sqlite3": ".db3"}[storage]
    names = [f"bag_{part}{ending}" for part in range(11)]
    for part, name in enumerate(names):
        shutil.copy(
            only_file(write(tmp_path / f"part{part}", storage, range(part * 2, part * 2 + 2))), bag / name
        )
    if with_metadata:
        listed = "".join(f"\n  - {name}" for name in names)
        edit(bag / "metadata.yaml", r"relative_file_paths:\n *- .*", f"relative_file_paths:{listed}")
    else:
        (bag / "metadata.yaml").unlink()
    assert numbers_in(bag) == list(range(22))


def test_files_whose_times_overlap_are_read_by_time(tmp_path):
    bag = write(tmp_path / "bag", numbers=range(0, 10, 2))
    shutil.move(only_file(bag), bag / "bag_0.mcap")
    shutil.copy(only_file(write(tmp_path / "odd", numbers=range(1, 10, 2))), bag / "bag_1.mcap")
    (bag / "metadata.yaml").unlink()
    assert numbers_in(bag) == list(range(10))


@pytest.mark.parametrize("storage", STORAGES)
@pytest.mark.parametrize(
    ("pattern", "text"),
    [
        (r"storage_identifier: .*", "storage_identifier: ''"),
        (r"storage_identifier: .*", "storage_identifier: rosbag_v2"),
        (r"version: 9", "version: 10"),
        (r"compression_mode: .*", "compression_mode: message"),
        (r"compression_mode: .*", "compression_mode: file"),
        (r"offered_qos_profiles: \[\]", "offered_qos_profiles: [{history: keep_last, depth: 7}]"),
        (r"message_count: 5", "message_count: 3"),
        (r"type: sensor_msgs.*", "type: std_msgs/msg/String"),
        (r"(?s).*", "rosbag2_bagfile_information: 3"),
        (r"(?s).*", "[" * 1500),
    ],
)
def test_the_storage_counts_not_the_metadata(tmp_path, storage, pattern, text):
    bag = write(tmp_path / "bag", storage)
    edit(bag / "metadata.yaml", pattern, text)
    assert numbers_in(bag) == [0, 1, 2, 3, 4]


@pytest.mark.parametrize("storage", STORAGES)
def test_messages_that_the_metadata_counts_and_the_storage_lacks_are_told(tmp_path, storage, caplog):
    bag = write(tmp_path / "bag", storage)
    edit(bag / "metadata.yaml", "message_count: 5", "message_count: 7")
    assert numbers_in(bag) == [0, 1, 2, 3, 4]
    assert "counts 7 messages, its files hold 5: 2 are missing" in caplog.text


def test_a_renamed_file_is_found_and_a_missing_part_is_told(tmp_path, caplog):
    bag = write(tmp_path / "bag")
    only_file(bag).rename(bag / "other.mcap")
    assert numbers_in(bag) == [0, 1, 2, 3, 4]
    assert "metadata.yaml names bag.mcap, not there; reading other.mcap" in caplog.text
    (bag / "other.mcap").unlink()
    with pytest.raises(CommandError, match="names bag.mcap, of which none is there"):
        BagReader(bag)


def test_a_database_whose_recorder_was_killed(tmp_path):
    """The last messages stand in the write-ahead log alone (storage preset resilient)."""
    bag, file = write(tmp_path / "bag", "sqlite3"), "bag.db3"
    killed = tmp_path / "killed"
    killed.mkdir()
    connection = sqlite3.connect(bag / file)
    connection.execute("PRAGMA journal_mode=WAL")
    connection.execute("PRAGMA wal_autocheckpoint=0")
    data = bytes(typestore().serialize_cdr(info(5), INFO))
    connection.execute("INSERT INTO messages(topic_id, timestamp, data) VALUES(1, 500000000, ?)", [data])
    connection.commit()
    for path in bag.glob(f"{file}*"):  # as they lie there while it runs
        shutil.copy(path, killed)
    connection.close()
    before = {path: path.read_bytes() for path in killed.iterdir()}
    assert f"{file}-wal" in {path.name for path in before}
    assert numbers_in(killed) == [0, 1, 2, 3, 4, 5]
    assert numbers_in(killed / file) == [0, 1, 2, 3, 4, 5]
    assert {path: path.read_bytes() for path in killed.iterdir()} == before


@pytest.mark.parametrize("profile", ["", "ros2", "my own"])
def test_the_profile_of_an_mcap_file(tmp_path, profile):
    plain = without_chunks(only_file(write(tmp_path / "bag")))
    length = int.from_bytes(plain[9:17], "little")
    header = struct.pack("<I", len(profile)) + profile.encode() + struct.pack("<I", 0)
    (tmp_path / "x.mcap").write_bytes(
        MAGIC + struct.pack("<BQ", 1, len(header)) + header + plain[17 + length :]
    )
    assert numbers_in(tmp_path / "x.mcap") == [0, 1, 2, 3, 4]


def test_an_mcap_file_without_index_whose_messages_came_out_of_order(tmp_path):
    bag = write(tmp_path / "bag", numbers=[0, 2, 1, 3])
    (tmp_path / "x.mcap").write_bytes(without_chunks(only_file(bag)))
    assert numbers_in(tmp_path / "x.mcap") == [0, 2, 1, 3]


def test_an_index_that_does_not_stand_where_the_file_says_is_left_aside(tmp_path):
    data = only_file(write(tmp_path / "bag")).read_bytes()
    length = int.from_bytes(data[9:17], "little") - 4
    (tmp_path / "x.mcap").write_bytes(data[:9] + struct.pack("<QI", length, 0) + data[25:])
    assert numbers_in(tmp_path / "x.mcap") == [0, 1, 2, 3, 4]


@pytest.mark.parametrize("storage", STORAGES)
@pytest.mark.parametrize("name", ["a b", "ü", "a#b", "a?b", "a%20b", "no ending", "x.bag", "x.db3"])
def test_the_content_tells_what_a_file_is_not_its_name(tmp_path, storage, name):
    shutil.copy(only_file(write(tmp_path / "bag", storage)), tmp_path / name)
    assert numbers_in(tmp_path / name) == [0, 1, 2, 3, 4]


@pytest.mark.parametrize("storage", STORAGES)
def test_topics_without_a_leading_slash(tmp_path, storage):
    assert numbers_in(write(tmp_path / "bag", storage, topic=TOPIC[1:])) == [0, 1, 2, 3, 4]


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 123\n", "git lfs pull"),
        (b"#ROSBAG V2.0\n" + bytes(5000), "ROS 1 bag that is damaged.*rosbag reindex"),
        (b"PK\x03\x04" + bytes(100), "zip archive: unpack"),
        (b"\x1f\x8b\x08" + bytes(100), "gzip: unpack"),
        (b"<!DOCTYPE html><html>", "web page"),
        (b"", "empty"),
        (MAGIC, "damaged"),
        (MAGIC[:4], "cut off after 4 bytes"),
        (b"\x28\xb5\x2f\xfd" + bytes(100), "damaged"),
        (b"SQLite format 3\0", "damaged.*sqlite3 x.mcap .recover"),
        (b"hello", "no rosbag2"),
    ],
)
def test_what_is_no_bag_is_told_in_one_line(tmp_path, content, said):
    (tmp_path / "x.mcap").write_bytes(content)
    with pytest.raises(CommandError, match=said) as caught:
        BagReader(tmp_path / "x.mcap")
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 500


def test_a_recording_that_was_cut_off_names_the_tool_that_mends_it(tmp_path):
    for storage, tool in (("mcap", "mcap recover"), ("sqlite3", r"\.recover \|")):
        file = only_file(write(tmp_path / storage, storage))
        file.write_bytes(file.read_bytes()[: file.stat().st_size * 9 // 10])
        with pytest.raises(CommandError, match=tool):
            BagReader(file)


def test_a_folder_of_bags_names_them(tmp_path):
    for name in ("a", "b"):
        write(tmp_path / name)
    with pytest.raises(CommandError, match="is no bag but holds a, b: name one"):
        BagReader(tmp_path)
    for name in ("a", "b"):
        shutil.copy(only_file(tmp_path / name), tmp_path)
    with pytest.raises(
        CommandError, match=r"holds several bags and no metadata.yaml: name one of a.mcap, b.mcap"
    ):
        BagReader(tmp_path)


@pytest.mark.parametrize("algorithm", ["zstd", "lz4"])
def test_no_more_is_unpacked_than_a_chunk_says(tmp_path, algorithm, memory_limit):
    """300 MB are packed into a chunk that says 1000 bytes."""
    zeros = bytes(3 * 10**8)
    data = zstd.compress(zeros) if algorithm == "zstd" else lz4.frame.compress(zeros)
    del zeros
    text = algorithm.encode()
    chunk = struct.pack("<QQQII", 0, 1, 1000, 0, len(text)) + text + struct.pack("<Q", len(data)) + data
    header = struct.pack("<I", 4) + b"ros2" + bytes(4)
    body = [(1, header), (6, chunk), (15, bytes(4)), (2, bytes(20))]
    file = tmp_path / "x.mcap"
    file.write_bytes(MAGIC + b"".join(struct.pack("<BQ", op, len(c)) + c for op, c in body) + MAGIC)
    del data, chunk, body
    with memory_limit(200 << 20), pytest.raises(CommandError, match="expected 1000 bytes"):
        BagReader(file)


def test_a_message_that_unpacks_to_more_than_any_image_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr("lane_dp_ros.messages.unpacking.LARGEST_MESSAGE", 100)
    with BagReader(write(tmp_path / "bag", compression="message")) as reader:
        with pytest.raises(CommandError, match="unpacks to more than 100 bytes"):
            list(reader.raw_messages())


def test_the_bag_is_closed_when_one_of_its_files_is_damaged(tmp_path, recwarn):
    bag = write(tmp_path / "bag")
    (bag / "bag_1.mcap").write_bytes(b"nothing")
    (bag / "metadata.yaml").unlink()
    with pytest.raises(CommandError, match="no rosbag2"):
        BagReader(bag)
    assert not recwarn.list


def test_nothing_is_said_of_a_sound_bag(tmp_path, caplog):
    caplog.set_level(logging.INFO)
    numbers_in(write(tmp_path / "bag"))
    assert not caplog.records


def test_the_offers_that_were_recorded(tmp_path):
    from rosbags.interfaces import Qos, QosDurability, QosHistory, QosLiveliness, QosReliability, QosTime

    none = QosTime(0, 0)
    policies = QosHistory.KEEP_LAST, 5, QosReliability.BEST_EFFORT, QosDurability.TRANSIENT_LOCAL
    qos = Qos(*policies, none, none, QosLiveliness.AUTOMATIC, none, False)
    for storage in STORAGES:
        with Writer(tmp_path / storage, version=9, storage_plugin=StoragePlugin[storage.upper()]) as writer:
            writer.add_connection("/a", INFO, typestore=typestore(), offered_qos_profiles=[qos, qos])
            writer.add_connection("/b", INFO, typestore=typestore())
        with BagReader(tmp_path / storage) as reader:
            assert reader.offered_qos("/a") == [qos]
            assert reader.offered_qos("/b") == []


def write_ros1(path: Path, compression: str | None) -> None:
    from rosbags.rosbag1 import Writer as Writer1
    from rosbags.typesys import Stores, get_typestore

    ros1 = get_typestore(Stores.ROS1_NOETIC)
    types = ros1.types
    writer = Writer1(path)
    if compression:
        writer.set_compression(Writer1.CompressionFormat[compression.upper()])
    with writer:
        connection = writer.add_connection(TOPIC, INFO, typestore=ros1, latching=1)
        ours = writer.add_connection("/mine", "my_msgs/msg/Own", msgdef="int32 x", md5sum="0" * 32)
        writer.write(ours, 0, bytes(4))
        for number in range(5):
            stamp = types["builtin_interfaces/msg/Time"](sec=number, nanosec=7)
            header = types["std_msgs/msg/Header"](seq=3, stamp=stamp, frame_id="left")
            roi = types["sensor_msgs/msg/RegionOfInterest"](0, 0, 0, 0, False)
            arrays = (np.zeros(5), np.zeros(9), np.eye(3).ravel(), np.arange(12.0) + number)
            message = types[INFO](header, 375, number, "plumb_bob", *arrays, 0, 0, roi)
            writer.write(connection, number * 10**8, ros1.serialize_ros1(message, INFO))


@pytest.mark.parametrize("compression", [None, "bz2", "lz4"])
def test_ros_1_bags_are_read_as_ros_2_has_their_messages(tmp_path, compression):
    write_ros1(tmp_path / "old.bag", compression)
    assert numbers_in(tmp_path / "old.bag") == [0, 1, 2, 3, 4]
    with BagReader(tmp_path / "old.bag") as reader:
        *_, (_, _, last) = reader.messages()
        assert (last.header.stamp.sec, last.header.stamp.nanosec, last.header.frame_id) == (4, 7, "left")
        np.testing.assert_array_equal(last.p, np.arange(12.0) + 4)
        assert [qos.durability.name for qos in reader.offered_qos(TOPIC)] == ["TRANSIENT_LOCAL"]


@pytest.mark.parametrize("dropped", [3, 4, 8, 11], ids=["schemas", "channels", "chunk indexes", "statistics"])
def test_a_summary_may_lack_what_the_specification_lets_it_lack(tmp_path, dropped):
    data = only_file(write(tmp_path / "bag")).read_bytes()
    start = int.from_bytes(data[-28:-20], "little")
    place, kept = start, b""
    while (kind := data[place]) != 14:  # the offsets of the summary
        length = 9 + int.from_bytes(data[place + 1 : place + 9], "little")
        kept += b"" if kind == dropped else data[place : place + length]
        place += length
    footer = struct.pack("<BQQQI", 2, 20, start, 0, 0)
    (tmp_path / "x.mcap").write_bytes(data[:start] + kept + footer + MAGIC)
    assert len(kept) < place - start
    assert numbers_in(tmp_path / "x.mcap") == [0, 1, 2, 3, 4]


@pytest.mark.parametrize("storage", STORAGES)
def test_topics_of_another_serialisation_are_left_out_and_told(tmp_path, storage, caplog):
    with Writer(tmp_path / "bag", version=9, storage_plugin=StoragePlugin[storage.upper()]) as writer:
        odd = {"serialization_format": "json"}
        for topic, how in ((TOPIC, {}), ("/odd", odd)):
            connection = writer.add_connection(topic, INFO, typestore=typestore(), **how)
            writer.write(connection, 0, bytes(typestore().serialize_cdr(info(0), INFO)))
    assert numbers_in(tmp_path / "bag") == [0]
    assert caplog.messages == ["/odd is left out: serialised as json, not as cdr"]


@pytest.mark.parametrize("storage", STORAGES)
def test_types_without_msg_in_their_names(tmp_path, storage):
    with Writer(tmp_path / "bag", version=9, storage_plugin=StoragePlugin[storage.upper()]) as writer:
        definition = typestore().generate_msgdef(INFO, ros_version=2)[0]
        connection = writer.add_connection(
            TOPIC, "sensor_msgs/CameraInfo", msgdef=definition, rihs01="RIHS01_0"
        )
        writer.write(connection, 0, bytes(typestore().serialize_cdr(info(0), INFO)))
    assert numbers_in(tmp_path / "bag") == [0]
    with BagReader(tmp_path / "bag") as reader:
        assert reader.topics == {TOPIC: INFO}


def test_a_file_that_unpacks_beyond_all_measure_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr("lane_dp_ros.messages.unpacking.LARGE_FILE", 10**6)
    (tmp_path / "x.mcap.zstd").write_bytes(zstd.compress(bytes(10**7)))
    with pytest.raises(CommandError, match="too large to unpack into .*: it unpacks to more than 1000 times"):
        BagReader(tmp_path / "x.mcap.zstd")


@pytest.mark.parametrize("compression", ["bz2", "lz4"])
def test_a_ros_1_chunk_that_unpacks_to_more_than_any_message_is_refused(tmp_path, monkeypatch, compression):
    write_ros1(tmp_path / "old.bag", compression)
    monkeypatch.setattr("lane_dp_ros.messages.unpacking.LARGEST_MESSAGE", 500)
    with (
        pytest.raises(CommandError, match="a chunk unpacks to more than 500 bytes"),
        BagReader(tmp_path / "old.bag") as reader,
    ):
        list(reader.messages())


def test_what_looks_like_a_bag(tmp_path):
    bag = write(tmp_path / "bag")
    assert looks_like_bag(bag)
    assert looks_like_bag(only_file(bag))
    assert not looks_like_bag(tmp_path)
    (bag / "metadata.yaml").unlink()
    (bag / ".hidden").touch()
    assert looks_like_bag(bag)
    (bag / "truth.json").touch()  # a folder of data with a bag in it
    assert not looks_like_bag(bag)
    assert numbers_in(bag) == [0, 1, 2, 3, 4]
