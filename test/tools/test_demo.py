# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""lane_dp demo end to end: a rendered road through a lane_detector process of its own, over DDS."""

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import cv2
import pytest

from lane_dp_ros.messages.bag import BagReader, BagWriter
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.messages.lanes import lanes_from_ros
from lane_dp_ros.ros import demo_session

ROOT = Path(__file__).resolve().parents[2]
RATE = 0.25  # slow enough for any machine, or other tests beside it: how fast it is, benchmarks tell
FRAMES = 12


def start_demo(folder: Path, frames: int, *options: str, **popen_options) -> subprocess.Popen:
    """Start a demo of fewer frames than a user's."""
    arguments = ["demo", "-o", str(folder), *options]
    code = f"""
import sys
from lane_dp_ros.tools import cli, demo
demo.FRAMES = {frames}
sys.exit(cli.main({arguments!r}))
"""
    return subprocess.Popen([sys.executable, "-c", code], cwd=ROOT, **popen_options)


def detectors_of(process: subprocess.Popen) -> list[int]:
    """Return the ids of the lane_detector processes that a demo has started and that still run."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            command, state = (folder / "cmdline").read_text(), (folder / "stat").read_text()
        except OSError:  # ended while we looked
            continue
        # The namespace bears the demo's process id.
        if f"/lane_dp_demo_{process.pid}\0" in command and state.rpartition(")")[2].split()[0] != "Z":
            found.append(int(folder.name))
    return found


def wait_for(condition, timeout: float):
    end = time.monotonic() + timeout
    while not (result := condition()):
        assert time.monotonic() < end, "timeout"
        time.sleep(0.02)
    return result


@pytest.fixture(scope="module")
def demo(tmp_path_factory) -> tuple[Path, str]:
    """Run the demo once; return its folder and what it printed."""
    folder = tmp_path_factory.mktemp("demo")
    process = start_demo(folder, FRAMES, "--rate", str(RATE), stdout=subprocess.PIPE, text=True)
    printed, _ = process.communicate(timeout=240)
    assert process.returncode == 0
    assert detectors_of(process) == []
    return folder, printed


def test_summary(demo) -> None:
    folder, printed = demo
    pattern = (
        r"(\d+) of (\d+) pairs answered, ([\d.]+) lanes per frame, latency \d+ ms .* "
        r"([\d.]+) frames/s, ([\d.]+) road edges per frame"
    )
    answered, pairs, lanes, rate, edges = re.search(pattern, printed).groups()
    assert int(pairs) == FRAMES
    assert int(answered) >= 0.9 * FRAMES
    assert 1.5 < float(lanes) < 3.5
    with BagReader(folder / "lanes.mcap") as reader:
        counts = [len(message.markers) - 1 for _, _, message in reader.messages(["/road_edges"])]
    assert float(edges) == pytest.approx(sum(counts) / len(counts), abs=0.005)
    assert "played into lane_detector at 2.5 Hz" in printed
    assert float(rate) < 3


def test_lanes_and_pictures_are_recorded(demo) -> None:
    with BagReader(demo[0] / "lanes.mcap") as reader:
        assert set(reader.topics) == {"/lanes", "/road_edges", "/ipm/image", "/overlay/image"}
        arrays = [message for _, _, message in reader.messages(["/lanes"])]
        assert reader.message_count(["/overlay/image"]) == len(arrays)
        edges = [message for _, _, message in reader.messages(["/road_edges"])]
    headers = [[message.markers[0].header.stamp for message in each] for each in (arrays, edges)]
    assert headers[0] == headers[1]
    roles = [{lane.role for lane in lanes_from_ros(array)} for array in arrays]
    assert sum({"ego_left", "ego_right"} <= found for found in roles) >= 0.8 * len(arrays)


def test_pictures(demo) -> None:
    overlay, ipm = (cv2.imread(str(demo[0] / name)) for name in ("overlay.png", "ipm.png"))
    assert overlay.shape == (4 * 375, 1242, 3)
    assert ipm.shape[0] >= 600
    assert (demo[0] / "road.mcap").is_file()
    film = cv2.VideoCapture(str(demo[0] / "lanes.mp4"))
    with BagReader(demo[0] / "lanes.mcap") as reader:
        assert film.get(cv2.CAP_PROP_FRAME_COUNT) == reader.message_count(["/overlay/image"])


ENDS = [(signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGKILL, -9)]


@pytest.mark.parametrize(("number", "code"), ENDS)
def test_no_process_outlives_the_demo(tmp_path, number, code) -> None:
    process = start_demo(tmp_path / "demo", 3, stdout=subprocess.DEVNULL)
    try:
        wait_for(lambda: detectors_of(process) or process.poll() is not None, timeout=120)
        os.kill(process.pid, number)
        assert process.wait(timeout=30) == code
        wait_for(lambda: not detectors_of(process), timeout=15)
    finally:
        process.kill()
        process.wait()
    assert not (tmp_path / "demo/lanes.mcap").exists()


def session_with(python: str, tmp_path, write_stereo_bag, small_pairs, monkeypatch) -> None:
    monkeypatch.setattr(sys, "executable", python)
    log = tmp_path / "log.txt"
    with BagReader(write_stereo_bag(small_pairs)) as reader, BagWriter(tmp_path / "out") as writer:
        demo_session.run_session(reader, writer, log)


def script(path: Path, text: str) -> str:
    path.write_text(f"#!/bin/sh\n{text}\n")
    path.chmod(0o755)
    return str(path)


def test_a_node_that_ends_early_is_told(tmp_path, write_stereo_bag, small_pairs, monkeypatch) -> None:
    python = script(tmp_path / "ends", "echo no shared memory; exit 3")
    with pytest.raises(CommandError, match="lane_detector ended with exit code 3: no shared memory"):
        session_with(python, tmp_path, write_stereo_bag, small_pairs, monkeypatch)
    assert not (tmp_path / "out").exists()


def test_a_node_that_does_not_come_up_is_told(tmp_path, write_stereo_bag, small_pairs, monkeypatch) -> None:
    pid_file = tmp_path / "pid"
    python = script(tmp_path / "hangs", f"echo $$ > {pid_file}; trap '' INT; while :; do sleep 0.1; done")
    monkeypatch.setattr(demo_session, "START_TIMEOUT", 1.0)
    monkeypatch.setattr(demo_session, "STOP_TIMEOUT", 0.5)
    with pytest.raises(CommandError, match="lane_detector did not come up within 1 s"):
        session_with(python, tmp_path, write_stereo_bag, small_pairs, monkeypatch)
    assert not Path("/proc", pid_file.read_text().strip()).exists()
