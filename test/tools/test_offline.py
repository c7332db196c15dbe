# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""lane_dp run: every pair of a bag is answered, whatever form it has in it."""

import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from lane_dp_ros.core.detector import LaneDetector
from lane_dp_ros.core.types import Lane
from lane_dp_ros.messages.bag import BagReader, BagWriter, bag_message
from lane_dp_ros.messages.image import compressed_image_from_ros
from lane_dp_ros.messages.lanes import lanes_from_ros
from lane_dp_ros.scenes import CAMERA, render_sequence
from lane_dp_ros.tools.cli import main

PICTURES = ("overlay/image/compressed", "ipm/image/compressed")
OUTPUTS = ("lanes", "road_edges", *PICTURES, "left/camera_info", "right/camera_info")
P_RIGHT = CAMERA.P_left - np.array([[0, 0, 0, CAMERA.fx * CAMERA.baseline], [0] * 4, [0] * 4])


def written(path: Path) -> dict[str, list]:
    messages: dict[str, list] = {}
    with BagReader(path) as reader:
        for topic, _, message in reader.messages():
            messages.setdefault(topic, []).append(message)
    return messages


def copied(bag: Path, path: Path, rename=str, keep=bool) -> Path:
    """Copy a bag with other topic names, and without some messages."""
    with BagReader(bag) as reader, BagWriter(path) as writer:
        for topic, time_ns, message in reader.messages():
            if keep((topic, time_ns)):
                writer.write(rename(topic), time_ns, message)
    return path


def run(bag: Path, *options: str, output: str = "out.mcap", jobs: int = 1) -> Path:
    path = bag.parent / output
    assert main(["run", str(bag), "-o", str(path), "--jobs", str(jobs), *options]) == 0
    return path


def failing_run(bag: Path, capsys: pytest.CaptureFixture, *options: str) -> str:
    """Return the one line of a run that ends with exit code 1; nothing may be left behind."""
    before = sorted(path.name for path in bag.parent.iterdir())
    assert main(["run", str(bag), "-o", str(bag.parent / "out.mcap"), *options]) == 1
    assert sorted(path.name for path in bag.parent.iterdir()) == before
    captured = capsys.readouterr()
    assert captured.out == ""
    (line,) = captured.err.splitlines()
    return line


@pytest.mark.parametrize(("jpeg", "storage"), [(False, "mcap"), (True, "sqlite3")])
def test_every_pair_is_answered(write_stereo_bag, scene_pairs, capsys, jpeg, storage) -> None:
    messages = written(run(write_stereo_bag(scene_pairs, jpeg=jpeg, storage=storage)))
    assert set(messages) == {f"/{name}" for name in OUTPUTS}
    ids = []
    for pair, array in zip(scene_pairs, messages["/lanes"], strict=True):
        assert array.markers[0].action == 3
        headers = {(marker.header.stamp.sec, marker.header.stamp.nanosec) for marker in array.markers}
        assert headers == {divmod(pair.stamp_ns, 10**9)}
        lanes = {lane.role: lane for lane in lanes_from_ros(array)}
        ids.append((lanes["ego_left"].id, lanes["ego_right"].id))
    assert len(set(ids)) == 1
    overlay = compressed_image_from_ros(messages["/overlay/image/compressed"][1])
    assert overlay.shape == scene_pairs[1].left.shape
    assert compressed_image_from_ros(messages["/ipm/image/compressed"][1]).ndim == 3
    out = capsys.readouterr().out
    assert "3 pairs" in out
    assert "disparity" in out


def road_edge(x: float) -> Lane:
    z = np.arange(6.0, 25.0, 0.25)
    points = np.column_stack([np.full_like(z, x), np.full_like(z, 1.65), z])
    return Lane(points, 0.75, 0.0, "other", 0.0, x, kind="edge")


def test_road_edges_are_written_drawn_and_counted(write_stereo_bag, scene_pairs, capsys, monkeypatch) -> None:
    detect, edges = LaneDetector.detect, (road_edge(-4.2), road_edge(4.2))
    monkeypatch.setattr(LaneDetector, "detect", lambda *a: replace(detect(*a), road_edges=edges))
    messages = written(run(write_stereo_bag(scene_pairs)))
    assert "2.00 road edges per pair" in capsys.readouterr().out
    for pair, array in zip(scene_pairs, messages["/road_edges"], strict=True):
        assert [marker.ns for marker in array.markers] == ["road_edges", "road_edge_left", "road_edge_right"]
        assert array.markers[0].action == 3
        stamps = {(marker.header.stamp.sec, marker.header.stamp.nanosec) for marker in array.markers}
        assert stamps == {divmod(pair.stamp_ns, 10**9)}
        found = lanes_from_ros(array)
        assert [edge.kind for edge in found] == ["edge", "edge"]
        np.testing.assert_allclose(found[0].points[:, 0], -4.2, atol=1e-3)
    ids = [[edge.id for edge in lanes_from_ros(array)] for array in messages["/road_edges"]]
    assert ids[0] == ids[1] == ids[2] == [0, 1]
    assert all(lane.kind != "edge" for array in messages["/lanes"] for lane in lanes_from_ros(array))
    for topic in ("/overlay/image/compressed", "/ipm/image/compressed"):
        blue, green, red = np.moveaxis(compressed_image_from_ros(messages[topic][0]).astype(int), 2, 0)
        assert np.count_nonzero((blue - green > 60) & (red - green > 50)) > 50  # violet


def broken_stereo_bag(write_stereo_bag, scene_pairs, path: Path) -> Path:
    """Write twelve pairs: one picture that cannot be read, and one size that the camera does not have."""
    pairs = [
        replace(pair, stamp_ns=pair.stamp_ns + i * 300_000_000) for i in range(4) for pair in scene_pairs
    ]
    with BagReader(write_stereo_bag(pairs)) as reader, BagWriter(path) as writer:
        for topic, time_ns, message in reader.messages():
            if topic == "/left/image_rect" and time_ns == pairs[4].stamp_ns:
                message.encoding = "32FC1"
            if topic.endswith("image_rect") and time_ns == pairs[7].stamp_ns:
                message.height -= 10
            writer.write(topic, time_ns, message)
    return path


def test_two_processes_write_what_one_does(write_stereo_bag, scene_pairs, tmp_path, capsys) -> None:
    bag = broken_stereo_bag(write_stereo_bag, scene_pairs, tmp_path / "broken")
    raw = []
    for jobs in (1, 2):
        with BagReader(run(bag, output=f"out{jobs}", jobs=jobs)) as reader:
            raw.append(list(reader.raw_messages()))
        out = capsys.readouterr().out
        assert "1 x left image: encoding is '32FC1'" in out
        assert "365, their CameraInfo says" in out
        assert f"pairs/s, {jobs} process" in out
    assert raw[0] == raw[1]
    lanes = [lanes_from_ros(array) for array in written(bag.parent / "out2")["/lanes"]]
    assert len(lanes) == 11  # none for what cannot be read
    assert [len(found) for found in lanes].count(0) == 1  # none in what does not fit the camera
    assert len({lane.id for found in lanes for lane in found}) < 6


@pytest.mark.parametrize(("end", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGKILL, -9)])
def test_nothing_is_left_running(write_stereo_bag, scene_pairs, tmp_path, end, code) -> None:
    many = [replace(scene_pairs[0], stamp_ns=i * 100_000_000) for i in range(1, 61)]
    output = tmp_path / "out"
    command = ["run", str(write_stereo_bag(many, jpeg=True)), "-o", str(output), "--jobs", "2"]
    process = subprocess.Popen(
        [sys.executable, "-m", "lane_dp_ros.tools.cli", *command],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        start_new_session=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
    )
    deadline = time.monotonic() + 30
    while not any(path.stat().st_size for path in tmp_path.glob(".out.*.part/*/*.mcap")):
        assert process.poll() is None and time.monotonic() < deadline
        time.sleep(0.05)
    if end == signal.SIGINT:
        os.killpg(process.pid, end)  # as a terminal does
    else:
        process.send_signal(end)
    out, err = process.communicate(timeout=20)  # comes when every process that holds these pipes has ended
    assert (process.returncode, out) == (code, b"")
    assert not output.exists()
    if end != signal.SIGKILL:
        assert err == b""
        assert not list(tmp_path.glob(".out.*"))


@pytest.mark.parametrize("jobs", ["0", "-1", "two", "1.5"])
def test_a_wrong_number_of_jobs(tmp_path, capsys, jobs) -> None:
    with pytest.raises(SystemExit, match="2"):
        main(["run", str(tmp_path), "-o", "out", "--jobs", jobs])
    assert f"{jobs} is not a whole number > 0" in capsys.readouterr().err


def test_lanes_lie_on_the_rendered_paint(write_stereo_bag, scene_pairs) -> None:
    arrays = written(run(write_stereo_bag(scene_pairs)))["/lanes"]
    for pair, array in zip(scene_pairs, arrays, strict=True):
        for lane in lanes_from_ros(array):
            z = lane.points[:, 2]
            lines = [np.interp(z, truth[:, 2], truth[:, 0]) for truth in pair.lanes]
            assert min(np.abs(line - lane.points[:, 0]).mean() for line in lines) < 0.1


def test_a_namespace_is_kept(write_stereo_bag, scene_pairs, tmp_path) -> None:
    bag = copied(write_stereo_bag(scene_pairs[:1]), tmp_path / "car", lambda topic: f"/car/front{topic}")
    assert set(written(run(bag))) == {f"/car/front/{name}" for name in OUTPUTS}


def test_a_preset_and_a_parameter_file(write_stereo_bag, scene_pairs, tmp_path) -> None:
    config = tmp_path / "params.yaml"
    config.write_text("/**: {ros__parameters: {birds_eye: {width: 8.0}, lane_lifetime: 2.0}}")
    options = ("--preset", "paper", "--config", str(config))
    messages = written(run(write_stereo_bag(scene_pairs[:1]), *options))
    assert messages["/lanes"][0].markers[-1].lifetime.sec == 2
    assert compressed_image_from_ros(messages["/ipm/image/compressed"][0]).shape[1] < 240


def test_a_file_of_before_with_parameters_that_are_no_more_still_serves(
    write_stereo_bag, scene_pairs, tmp_path, capsys
) -> None:
    config = tmp_path / "old.yaml"
    config.write_text(
        "/**: {ros__parameters: "
        "{disparity: {downscale: 4, disparity_range: 64}, road_profile: {roll: false}}}"
    )
    bag = write_stereo_bag(scene_pairs[:1])
    (array,) = written(run(bag, "--config", str(config), output="with"))["/lanes"]
    warnings = capsys.readouterr().err.splitlines()
    names = ("disparity.downscale", "disparity.disparity_range", "road_profile.roll")
    for warning, name in zip(warnings, names, strict=True):
        assert warning.startswith(f"lane_dp: {config}: {name} is no more, left out: ")
    (expected,) = written(run(bag, output="without"))["/lanes"]
    for lane, same in zip(lanes_from_ros(array), lanes_from_ros(expected), strict=True):
        np.testing.assert_array_equal(lane.points, same.points)


def test_images_without_a_partner_are_told(write_stereo_bag, scene_pairs, tmp_path, capsys) -> None:
    lost = ("/right/image_rect", scene_pairs[1].stamp_ns)
    complete = write_stereo_bag(scene_pairs)
    bag = copied(complete, tmp_path / "gap", keep=lambda raw: raw != lost)
    assert len(written(run(bag))["/lanes"]) == 2
    assert "1 images without a partner" in capsys.readouterr().out


def test_camera_infos_that_come_late_serve_the_first_pair(write_stereo_bag, scene_pairs, tmp_path) -> None:
    late = scene_pairs[2].stamp_ns
    complete = write_stereo_bag(scene_pairs)
    bag = copied(complete, tmp_path / "x", keep=lambda raw: "info" not in raw[0] or raw[1] == late)
    assert len(written(run(bag))["/lanes"]) == 3


def test_a_bag_without_the_topics(write_stereo_bag, scene_pairs, tmp_path, capsys) -> None:
    complete = write_stereo_bag(scene_pairs)
    bag = copied(complete, tmp_path / "odd", lambda topic: topic.replace("image", "depth"))
    line = failing_run(bag, capsys)
    assert "no messages on left/image_rect or left/image_rect/compressed; it has /left/camera" in line
    assert "/right/depth_rect (3); name the camera's topics: --left TOPIC --right TOPIC" in line


@pytest.mark.parametrize("missing", ["/right/image_rect", "/left/camera_info"])
def test_a_bag_without_one_topic(write_stereo_bag, scene_pairs, tmp_path, capsys, missing) -> None:
    bag = copied(write_stereo_bag(scene_pairs), tmp_path / "odd", keep=lambda raw: raw[0] != missing)
    assert f"no messages on {missing}; it has" in failing_run(bag, capsys)


def test_two_cameras(write_stereo_bag, scene_pairs, tmp_path, capsys) -> None:
    with BagReader(write_stereo_bag(scene_pairs[:1])) as reader, BagWriter(tmp_path / "two") as writer:
        for topic, time_ns, message in reader.messages():
            for car in ("a", "b"):
                writer.write(f"/{car}{topic}", time_ns, message)
    line = failing_run(tmp_path / "two", capsys)
    assert "several stereo cameras, their topics begin with /a/, /b/: name one by --camera PREFIX" in line


def test_stamps_that_never_meet(write_stereo_bag, scene_pairs, tmp_path, capsys) -> None:
    first = scene_pairs[0].stamp_ns
    bag = copied(
        write_stereo_bag(scene_pairs[:2]),
        tmp_path / "apart",
        keep=lambda raw: (raw[0] != "/left/image_rect") == (raw[1] == first),
    )
    message = "no stereo pair that can be used: no left and right stamps within 0.01 s"
    assert message in failing_run(bag, capsys)


def test_swapped_cameras(write_stereo_bag, scene_pairs, capsys) -> None:
    P_right = CAMERA.P_left
    P_right[0, 3] = CAMERA.fx * CAMERA.baseline
    bag = write_stereo_bag(scene_pairs, P_right=P_right)
    assert "baseline" in failing_run(bag, capsys)


@pytest.mark.parametrize(
    ("place", "value", "said"),
    [
        ((0, 1), 52.4, "P of the right camera has a skew of 52.4 px"),
        ((1, 1), 640.0, "fy is 721.5 px left and 640 px right, expected equal"),
        ((2, 0), 0.05, "P of the right camera has the third row"),
        (
            (0, 3),
            -721.5 * 540,
            "the baseline is 540 m, expected 0.01 to 4 m on a vehicle (is P[0,3] in px mm?)",
        ),
        (
            (0, 3),
            0.0,
            "the baseline is 0 m, expected 0.01 to 4 m on a vehicle (P[0,3] is equal left and right",
        ),
    ],
)
def test_a_projection_of_no_stereo_camera(write_stereo_bag, scene_pairs, capsys, place, value, said) -> None:
    P_right = P_RIGHT.copy()
    P_right[place] = value
    assert said in failing_run(write_stereo_bag(scene_pairs[:1], P_right=P_right), capsys)


@pytest.mark.parametrize(
    ("right_of", "said"),
    [
        (lambda pairs, i: pairs[i].right, ""),
        (lambda pairs, i: pairs[i].left, "Left and right show the same picture"),
        (lambda pairs, i: pairs[i - 1].right, "The right picture seems to be of another time, 100 ms older"),
    ],
    ids=["sound", "one camera", "late"],
)
def test_what_is_wrong_with_the_pictures_is_told(write_stereo_bag, rendered, capsys, right_of, said) -> None:
    pairs = rendered(render_sequence, 43, 10.0, 1)
    wrong = [replace(pairs[i], right=right_of(pairs, i)) for i in range(1, len(pairs))]
    run(write_stereo_bag(wrong, jpeg=True))
    lines = [line for line in capsys.readouterr().out.splitlines() if " x " in line]
    assert any(said in line for line in lines) if said else not lines


def test_images_that_cannot_be_read_are_skipped(write_stereo_bag, scene_pairs, tmp_path, capsys) -> None:
    with BagReader(write_stereo_bag(scene_pairs)) as reader, BagWriter(tmp_path / "odd") as writer:
        for topic, time_ns, message in reader.messages():
            if topic == "/left/image_rect" and time_ns == scene_pairs[0].stamp_ns:
                message.encoding = "32FC1"
            writer.write(topic, time_ns, message)
    assert len(written(run(tmp_path / "odd"))["/lanes"]) == 2
    assert "1 x left image: encoding is '32FC1'" in capsys.readouterr().out


def test_the_input_is_never_the_output(write_stereo_bag, scene_pairs, capsys) -> None:
    bag = write_stereo_bag(scene_pairs[:1])
    assert main(["run", str(bag), "-o", str(bag), "--force"]) == 1
    assert "is the input bag itself" in capsys.readouterr().err
    assert len(written(bag)) == 4


def test_a_topic_of_another_type(tmp_path, capsys) -> None:
    with BagWriter(tmp_path / "odd") as writer:
        writer.write("/left/image_rect", 1, bag_message("std_msgs/msg/String", data="no picture"))
    assert "it has /left/image_rect (1)" in failing_run(tmp_path / "odd", capsys)


@pytest.mark.parametrize(("number", "pairs"), [("01", 51), ("02", 20)])
def test_real_sequences(tmp_path, kitti_data, capsys, number, pairs) -> None:
    folder = kitti_data / "kitti_odometry/sequences" / number
    bag = tmp_path / "bag"
    assert main(["convert", "kitti-odometry", str(folder), "-o", str(bag), "--jpeg"]) == 0
    assert len(written(run(bag))["/lanes"]) == pairs
    assert f"{pairs} pairs" in capsys.readouterr().out
