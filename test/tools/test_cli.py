# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The command line: exit codes, one line for each known error, nothing half-written left behind."""

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import cv2
import numpy as np
import pytest

from lane_dp_ros.messages.bag import BagReader
from lane_dp_ros.tools.cli import main

ROOT = Path(__file__).resolve().parents[2]
CLI = [sys.executable, "-m", "lane_dp_ros.tools.cli"]
P = "700 0 20 0 0 700 10 0 0 0 1 0"


def sequence(root: Path, pairs: int = 3) -> Path:
    folder = root / "sequences/00"
    for camera in (0, 1):
        (folder / f"image_{camera}").mkdir(parents=True)
        first = folder / f"image_{camera}/000000.png"
        cv2.imwrite(str(first), np.random.default_rng(camera).integers(0, 255, (200, 400), dtype=np.uint8))
        for index in range(1, pairs):
            (first.parent / f"{index:06}.png").hardlink_to(first)
    (folder / "calib.txt").write_text(f"P0: {P}\nP1: {P.replace(' 20 0 ', ' 20 -380 ', 1)}\n")
    (folder / "times.txt").write_text("".join(f"{0.1 * index}\n" for index in range(pairs)))
    return folder


def convert(folder: Path, output: Path, *options: str) -> int:
    return main(["convert", "kitti-odometry", str(folder), "-o", str(output), *options])


def run_cli(arguments, environment) -> subprocess.CompletedProcess:
    command = [*CLI, *arguments]
    return subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)


def only_line(capsys: pytest.CaptureFixture) -> str:
    captured = capsys.readouterr()
    assert captured.out == ""
    (line,) = captured.err.splitlines()
    assert line.startswith("lane_dp: ")
    return line


@pytest.mark.parametrize("options", [(), ("--storage", "sqlite3"), ("--jpeg",)])
def test_convert(tmp_path, capsys, options) -> None:
    assert convert(sequence(tmp_path), tmp_path / "bag", *options) == 0
    assert "3 pairs from" in capsys.readouterr().out
    with BagReader(tmp_path / "bag") as reader:
        assert reader.message_count() == 13
        assert ("/left/image_rect/compressed" in reader.topics) == ("--jpeg" in options)


def test_an_existing_output_needs_force(tmp_path, capsys) -> None:
    folder, output = sequence(tmp_path), tmp_path / "bag"
    assert convert(folder, output) == 0
    capsys.readouterr()
    assert convert(folder, output) == 1
    assert "exists already" in only_line(capsys)
    assert convert(folder, output, "--force") == 0


@pytest.mark.parametrize("command", ["play", "run"])
def test_inputs_that_are_no_bag(tmp_path, capsys, command) -> None:
    (tmp_path / "folder").mkdir()
    (tmp_path / "notes.txt").write_text("hello")
    (tmp_path / "cut.mcap").write_bytes(b"\x89MCAP0\r\n\x01")
    cases = {
        "none.mcap": "no such bag",
        "notes.txt": "is no rosbag2",
        "folder": "a storage file (.mcap, .db3) was expected",
    }
    for name, message in {**cases, "cut.mcap": "cut off"}.items():
        output = ["-o", str(tmp_path / "out")] if command == "run" else []
        assert main([command, str(tmp_path / name), *output]) == 1
        assert message in only_line(capsys)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("storage", ["mcap", "sqlite3"])
@pytest.mark.parametrize("command", ["play", "run"])
def test_a_bag_that_was_cut_off(tmp_path, capsys, command, storage) -> None:
    bag = tmp_path / "bag"
    assert convert(sequence(tmp_path), bag, "--storage", storage) == 0
    capsys.readouterr()
    file = next(path for path in bag.iterdir() if path.suffix != ".yaml")
    file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])
    output = ["-o", str(tmp_path / "out")] if command == "run" else []
    assert main([command, str(bag), *output]) == 1
    assert "damaged" in only_line(capsys)
    assert not (tmp_path / "out").exists()


def test_an_output_that_cannot_be_written(tmp_path, capsys) -> None:
    assert convert(sequence(tmp_path), Path("/proc/none/bag")) == 1
    assert only_line(capsys) == "lane_dp: cannot write /proc/none/bag: No such file or directory"
    (tmp_path / "file").touch()
    assert main(["demo", "-o", str(tmp_path / "file")]) == 1
    assert "cannot write" in only_line(capsys)


@pytest.mark.parametrize("inside", [False, True], ids=["folder", "file in it"])
def test_the_input_is_never_replaced_by_the_output(tmp_path, capsys, inside) -> None:
    bag = tmp_path / "bag"
    assert convert(sequence(tmp_path), bag) == 0
    capsys.readouterr()
    given = next(bag.glob("*.mcap")) if inside else bag
    assert main(["run", str(given), "-o", str(tmp_path / "x/../bag"), "--force"]) == 1
    assert "is the input bag itself" in only_line(capsys)
    with BagReader(bag) as reader:
        assert reader.message_count() == 13


@pytest.mark.parametrize("arguments", [["dump-config", "--expert"], ["scenes", "--list"]])
def test_a_reader_that_has_seen_enough_hears_of_no_error(arguments) -> None:
    command = [*CLI, *arguments]
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout is not None
        process.stdout.close()  # long before the command, which has yet to start, prints
        assert process.stderr is not None
        assert process.stderr.read() == b""
    assert process.returncode == 141  # as the shell has it of SIGPIPE


def test_results_that_cannot_be_printed() -> None:
    arguments = " ".join([*CLI, "scenes", "--list"])
    options = {"shell": True, "cwd": ROOT, "capture_output": True, "text": True}
    full = subprocess.run(f"{arguments} > /dev/full", check=False, **options)
    assert (full.returncode, full.stderr) == (1, "lane_dp: [Errno 28] No space left on device\n")
    closed = subprocess.run(f"{arguments} >&-", check=False, **options)
    assert (closed.returncode, closed.stderr) == (0, "")


def test_evaluate_names_the_file_that_is_not_there(tmp_path, capsys) -> None:
    assert main(["evaluate", str(tmp_path / "none.mcap")]) == 1
    assert only_line(capsys).endswith("none.mcap: no such bag or folder")
    assert convert(sequence(tmp_path), tmp_path / "bag.mcap") == 0
    capsys.readouterr()
    assert main(["evaluate", str(tmp_path / "bag.mcap"), "--truth", str(tmp_path / "truth.json")]) == 1
    assert "truth.json: no such file, expected labels" in only_line(capsys)


def test_a_failed_convert_leaves_nothing(tmp_path, capsys) -> None:
    folder = sequence(tmp_path)
    (folder / "image_1/000002.png").unlink()
    (folder / "image_1/000002.png").write_text("no picture")
    assert convert(folder, tmp_path / "bag") == 1
    assert "cannot be read as a picture" in only_line(capsys)
    assert [path.name for path in tmp_path.iterdir()] == ["sequences"]


def test_a_terminated_convert_leaves_nothing(tmp_path) -> None:
    folder = sequence(tmp_path, pairs=3000)
    command = [*CLI, "convert", "kitti-odometry", str(folder), "-o", str(tmp_path / "bag")]
    process = subprocess.Popen(command, cwd=ROOT, stderr=subprocess.PIPE, text=True)
    end = time.monotonic() + 20
    while not list(tmp_path.glob(".bag.*")) and time.monotonic() < end:
        time.sleep(0.001)
    process.send_signal(signal.SIGTERM)
    _, said = process.communicate(timeout=20)
    assert process.returncode == 143
    assert said == ""
    assert [path.name for path in tmp_path.iterdir()] == ["sequences"]


@pytest.mark.parametrize(
    "arguments",
    [
        [],
        ["no-such-command"],
        ["play"],
        ["play", "x", "--rate", "0"],
        ["play", "x", "--rate", "fast"],
        ["run", "x"],
        ["run", "x", "--no-images"],
        ["run", "x", "-o", "y", "--jpeg", "--no-images"],
        ["run", "x", "y", "-o", "z", "--force", "--skip-existing"],
        ["run", "x", "-o", "y", "--preset", "mine"],
        ["run", "x", "-o", "y", "--ros-args", "-r", "a:=b"],
        ["convert", "kitti-mono", "x", "-o", "y"],
        ["convert", "kitti-raw", "x", "-o", "y", "--storage", "zip"],
        ["evaluate", "x", "--max-error", "small"],
        ["review", "x", "--port", "65536"],
        ["scenes", "--list", "--rate", "fast"],
        ["scenes", "--list", "--seed", "-1"],
    ],
)
def test_wrong_usage_is_exit_code_2(capsys, arguments) -> None:
    with pytest.raises(SystemExit) as caught:
        main(arguments)
    assert caught.value.code == 2
    said = capsys.readouterr().err
    assert "usage: lane_dp" in said
    assert not re.search(r"invalid \w+ value", said)  # argparse's own words, with the name of a function


def test_version_and_help(capsys) -> None:
    for option, text in (("--version", "lane_dp "), ("--help", "convert")):
        with pytest.raises(SystemExit) as caught:
            main([option])
        assert caught.value.code == 0
        assert text in capsys.readouterr().out


def test_without_ros_only_what_needs_it_fails(tmp_path) -> None:
    (tmp_path / "rclpy.py").write_text("raise ModuleNotFoundError(\"No module named 'rclpy'\", name='rclpy')")
    environment = {**os.environ, "PYTHONPATH": f"{tmp_path}{os.pathsep}{ROOT}"}
    bag = tmp_path / "bag"
    assert convert(sequence(tmp_path), bag) == 0
    cases = {("play", str(bag)): 1, ("dump-config",): 0, ("demo", "-o", str(tmp_path / "demo")): 1}
    for arguments, code in cases.items():
        result = run_cli(arguments, environment)
        assert result.returncode == code
        if code:
            (line,) = result.stderr.splitlines()
            assert "needs ROS 2 (No module named 'rclpy')" in line
    assert not (tmp_path / "demo").exists()
