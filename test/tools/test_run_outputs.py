# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""lane_dp run: what it writes is read by others, is whole or not there, and comes of many bags at once."""

import csv
import importlib.util
import json
import os
import re
import subprocess
import sys
from collections import Counter
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from lane_dp_ros.messages.bag import BagReader, BagWriter
from lane_dp_ros.messages.bag_message import bag_message
from lane_dp_ros.messages.bag_output import Staging
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.messages.lanes import lanes_from_ros
from lane_dp_ros.messages.stamp import stamp_from_ros
from lane_dp_ros.tools import progress as progress_module
from lane_dp_ros.tools.cli import main

CONFIG = Path(__file__).resolve().parents[2] / "config"


@pytest.fixture
def bag(write_stereo_bag, scene_pairs) -> Path:
    return write_stereo_bag(scene_pairs)


def run(*arguments: object) -> int:
    return main(["run", *map(str, arguments)])


def lanes_of(path: Path) -> list[list]:
    with BagReader(path) as reader:
        return [list(lanes_from_ros(message)) for *_, message in reader.messages(["/lanes", "/road_edges"])]


def test_a_file_name_gives_one_file_that_mcap_reads(bag, tmp_path) -> None:
    mcap = pytest.importorskip("mcap_ros2.reader")
    out = tmp_path / "out.mcap"
    assert run(bag, "-o", out, "--left-image") == 0
    assert out.is_file()
    messages = list(mcap.read_ros2_messages(out))
    counts = Counter(message.channel.topic for message in messages)
    pictures = ("/overlay/image/compressed", "/ipm/image/compressed", "/left/image_rect/compressed")
    topics = ("/lanes", "/road_edges", "/left/camera_info", "/right/camera_info", *pictures)
    assert counts == dict.fromkeys(topics, 3)
    overlay = next(m.ros_msg for m in messages if m.channel.topic == "/overlay/image/compressed")
    assert cv2.imdecode(np.frombuffer(overlay.data, np.uint8), cv2.IMREAD_COLOR).shape == (375, 1242, 3)
    lanes = next(m.ros_msg for m in messages if m.channel.topic == "/lanes")
    assert {"ego_left", "ego_right"} <= {marker.ns for marker in lanes.markers}


def test_pictures_raw_or_none(bag, tmp_path) -> None:
    assert run(bag, "-o", tmp_path / "raw", "--raw-images") == 0
    assert run(bag, "-o", tmp_path / "none.mcap", "--no-images") == 0
    with BagReader(tmp_path / "raw") as raw, BagReader(tmp_path / "none.mcap") as none:
        assert raw.topics["/overlay/image"] == raw.topics["/ipm/image"] == "sensor_msgs/msg/Image"
        assert not [topic for topic in none.topics if "image" in topic]
    assert (tmp_path / "none.mcap").stat().st_size < 3 * 5000 + 20000  # 20 kB of definitions
    for one, other in zip(lanes_of(tmp_path / "raw"), lanes_of(tmp_path / "none.mcap"), strict=True):
        for a, b in zip(one, other, strict=True):
            np.testing.assert_array_equal(a.points, b.points)


def test_tables_hold_what_the_bag_holds(bag, tmp_path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    outputs = ("--csv", tmp_path / "t.csv", "--parquet", tmp_path / "t.parquet")
    assert run(bag, "-o", tmp_path / "out.mcap", "--no-images", *outputs) == 0
    with BagReader(tmp_path / "out.mcap") as reader:
        lines = {
            (stamp_from_ros(message.markers[0].header.stamp), lane.kind == "edge", lane.id): lane
            for *_, message in reader.messages(["/lanes", "/road_edges"])
            for lane in lanes_from_ros(message)
        }
    with (tmp_path / "t.csv").open(newline="") as file:
        told = list(csv.DictReader(file))
    rows = parquet.read_table(tmp_path / "t.parquet").to_pylist()
    assert len(lines) == len(told) == len(rows) > 6
    for text, row in zip(told, rows, strict=True):
        lane = lines[row["stamp_ns"], row["line"] == "road_edge", row["id"]]
        np.testing.assert_allclose(np.column_stack([row[axis] for axis in "xyz"]), lane.points, atol=1e-3)
        assert (text["role"], int(text["id"])) == (lane.role, lane.id) == (row["role"], row["id"])
        assert text["kind"] == ("" if lane.kind == "edge" else lane.kind)
        expected = np.interp(15.0, lane.points[:, 2], lane.points[:, 0])
        assert text["x_at_15_m"] == "" or float(text["x_at_15_m"]) == pytest.approx(expected, abs=1e-3)
        assert float(text["near_m"]) == pytest.approx(lane.points[0, 2], abs=1e-3)


def test_a_pair_without_lines_has_a_row(write_stereo_bag, scene_pairs, tmp_path) -> None:
    grey = np.full_like(scene_pairs[0].left, 128)
    bag = write_stereo_bag([replace(scene_pairs[0], left=grey, right=grey), *scene_pairs[1:]])
    assert run(bag, "--csv", tmp_path / "t.csv") == 0
    with (tmp_path / "t.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert rows[0]["pair"] == "0"
    assert rows[0]["line"] == ""
    assert {row["pair"] for row in rows} == {"0", "1", "2"}


def test_a_video_has_each_pair_at_the_cameras_rate(write_stereo_bag, scene_pairs, tmp_path) -> None:
    many = [replace(scene_pairs[0], stamp_ns=10**9 + i * 50_000_000) for i in range(14)]
    assert run(write_stereo_bag(many, jpeg=True), "--video", tmp_path / "v.mp4") == 0
    film = cv2.VideoCapture(str(tmp_path / "v.mp4"))
    assert film.get(cv2.CAP_PROP_FRAME_COUNT) == 14
    assert film.get(cv2.CAP_PROP_FPS) == pytest.approx(20)
    ok, picture = film.read()
    assert ok
    assert picture.shape == (374, 1242, 3)  # whole pairs of rows
    blue, green, red = np.moveaxis(picture.astype(int), 2, 0)
    assert np.count_nonzero((green - blue > 60) & (green - red > 60)) > 100  # the left line's outline


def test_a_video_that_the_disk_has_no_room_for_is_an_error(write_stereo_bag, scene_pairs, tmp_path) -> None:
    bag = write_stereo_bag(scene_pairs)
    limited = """
import resource, signal, sys
from lane_dp_ros.tools.cli import main
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (50_000, 50_000))
sys.exit(main(sys.argv[1:]))
"""
    before = sorted(tmp_path.rglob("*"))
    command = [sys.executable, "-c", limited, "run", str(bag), "--video", str(tmp_path / "v.mp4")]
    ran = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert ran.returncode == 1
    (line,) = ran.stderr.splitlines()
    assert "v.mp4: 0 of 3 pictures can be read of it" in line
    assert sorted(tmp_path.rglob("*")) == before


@pytest.mark.parametrize("name", ["film", "film.webm"])
def test_a_video_of_another_kind_is_refused_by_its_name(bag, tmp_path, capfd, name) -> None:
    assert run(bag, "--video", tmp_path / name) == 1
    (line,) = capfd.readouterr().err.splitlines()
    assert line.endswith(f"{name}: a video is written as .mp4, such as {tmp_path / 'film.mp4'}")
    assert not (tmp_path / name).exists()


def test_many_bags_go_into_folders_and_one_that_fails_stops_none(bag, tmp_path, capsys) -> None:
    other = tmp_path / "other.mcap"
    with BagReader(bag) as reader, BagWriter(other) as writer:
        for raw in reader.raw_messages():
            writer.write_raw(raw)
    broken = tmp_path / "broken.mcap"
    broken.write_bytes(other.read_bytes()[:5000])
    out, tables = tmp_path / "out", tmp_path / "tables"
    arguments = (bag, broken, other, "-o", out, "--csv", tables, "--no-images")
    assert run(*arguments) == 1
    captured = capsys.readouterr()
    assert "3 bags: 2 done, 0 skipped, 1 failed" in captured.out
    (line,) = captured.err.splitlines()
    assert "1 of 3 bags failed" in line
    assert str(broken) in line
    assert {path.name for path in out.iterdir()} == {f"{bag.stem}.mcap", "other.mcap"}
    assert {path.name for path in tables.iterdir()} == {f"{bag.stem}.csv", "other.csv"}
    (out / "other.mcap").unlink()
    before = (out / f"{bag.stem}.mcap").stat().st_mtime_ns
    assert run(*arguments[:-1], "--skip-existing") == 1
    assert "1 done, 1 skipped, 1 failed" in capsys.readouterr().out or (tables / "other.csv").exists()
    assert (out / f"{bag.stem}.mcap").stat().st_mtime_ns == before


def test_bags_of_one_name_are_refused_before_any_work(bag, tmp_path, capsys) -> None:
    other = tmp_path / "elsewhere" / bag.name
    assert run(bag, other, "-o", tmp_path / "out") == 1
    assert "would both be written to" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("option", ["-o", "--video", "--csv"])
def test_a_file_where_the_folder_of_many_outputs_is_to_be(bag, tmp_path, capsys, option) -> None:
    file = tmp_path / "out.x"
    file.write_text("mine")
    for bags in ([bag, tmp_path / "other.mcap"], [bag, "--skip-existing"]):
        assert run(*bags, option, file) == 1
        captured = capsys.readouterr()
        assert captured.out == ""
        (line,) = captured.err.splitlines()
        assert f"{file} is no folder" in line
    assert file.read_text() == "mine"


def test_a_bag_that_is_named_twice_is_one(bag, tmp_path, capsys) -> None:
    assert run(bag, bag, "-o", tmp_path / "out", "--no-images") == 0
    assert "1 bags: 1 done, 0 skipped, 0 failed" in capsys.readouterr().out


@pytest.mark.parametrize("option", ["-o", "--video", "--csv", "--parquet"])
def test_no_output_is_replaced_or_left_half_written(bag, tmp_path, capsys, option) -> None:
    if option == "--parquet":
        pytest.importorskip("pyarrow")
    file = tmp_path / "out.x"
    file.write_text("mine")
    assert run(bag, option, file) == 1
    assert "exists already" in capsys.readouterr().err
    assert file.read_text() == "mine"
    with BagReader(bag) as reader, BagWriter(tmp_path / "useless.mcap") as writer:
        for topic, time_ns, message in reader.messages():
            if topic.endswith("image_rect"):
                message.encoding = "none"
            writer.write(topic, time_ns, message)
    before = sorted(path.name for path in tmp_path.iterdir())
    assert run(tmp_path / "useless.mcap", option, tmp_path / "never.x") == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == before


def test_what_was_made_meanwhile_is_never_replaced(tmp_path) -> None:
    message = bag_message("std_msgs/msg/Header")
    for name in ("folder", "file.mcap"):
        with pytest.raises(CommandError, match="made by somebody else meanwhile"):
            with BagWriter(tmp_path / name) as writer:
                writer.write("/a", 1, message)
                (tmp_path / name).mkdir()
                (tmp_path / name / "mine").touch()
        assert [path.name for path in (tmp_path / name).iterdir()] == ["mine"]


def test_what_a_killed_process_left_goes_with_the_next_run(tmp_path) -> None:
    ended = subprocess.Popen([sys.executable, "-c", ""])
    ended.wait()
    dead, alive = (tmp_path / f".out.{process}.part" for process in (ended.pid, os.getppid()))
    unknown = tmp_path / ".out.x.part"
    for folder in (dead, alive, unknown):
        folder.mkdir()
    Staging(tmp_path / "out").make()
    assert not dead.exists()
    assert alive.exists()
    assert unknown.exists()


def test_a_log_gets_a_plain_line_now_and_then(monkeypatch, capsys) -> None:
    monkeypatch.setattr(progress_module, "LOG_PERIOD", 0.0)
    assert list(progress_module.progress(iter("abc"), 3, "pair")) == ["a", "b", "c"]
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 3
    assert lines[1].startswith("2 of 3 pairs")
    assert "\r" not in "".join(lines)
    monkeypatch.setattr(progress_module, "LOG_PERIOD", 30.0)
    list(progress_module.progress(iter("abc"), 3, "pair"))
    assert capsys.readouterr().err == ""


def test_nobody_needs_to_hear_of_the_progress(bag, tmp_path) -> None:
    command = f"{sys.executable} -m lane_dp_ros.tools.cli run {bag} --csv {tmp_path / 'out.csv'} 2>&-"
    ran = subprocess.run(command, shell=True, capture_output=True, text=True, timeout=60, check=False)
    assert (ran.returncode, ran.stderr) == (0, "")
    assert (tmp_path / "out.csv").exists()
    assert "pairs/s" in ran.stdout


def test_the_foxglove_layout_shows_what_run_writes(write_stereo_bag, scene_pairs, tmp_path) -> None:
    layout = json.loads((CONFIG / "foxglove_lanes.json").read_text())
    assert run(write_stereo_bag(scene_pairs[:1]), "-o", tmp_path / "out.mcap", "--left-image") == 0
    with BagReader(tmp_path / "out.mcap") as reader:
        there = set(reader.topics)
    panels = layout["configById"]
    shown = {topic for panel in panels.values() for topic in panel.get("topics", {})}
    for panel in panels.values():
        modes = panel.get("imageMode", {})
        shown |= {modes[key] for key in ("imageTopic", "calibrationTopic") if key in modes}
    assert {"/lanes", "/road_edges", "/ipm/image/compressed", "/left/image_rect/compressed"} <= shown <= there
    placed = re.findall(r'"((?:3D|Image)![a-z]+)"', json.dumps(layout["layout"]))
    assert sorted(placed) == sorted(panels)


def test_a_recording_for_rerun(bag, tmp_path, capsys) -> None:
    if importlib.util.find_spec("rerun") is None:
        assert run(bag, "--rerun", tmp_path / "out.rrd") == 1
        (line,) = capsys.readouterr().err.splitlines()
        assert line.startswith("lane_dp: needs Rerun's SDK")
        assert line.endswith("rerun-sdk")
        assert not (tmp_path / "out.rrd").exists()
        return
    assert run(bag, "--rerun", tmp_path / "out.rrd") == 0
    assert (tmp_path / "out.rrd").read_bytes()[:3] == b"RRF"
