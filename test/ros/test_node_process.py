# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The executable: it answers across processes, ends with 0 when told to, and says why it cannot start."""

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
DEADLINE = 30.0  # s
PERIOD = 0.1  # s


@pytest.fixture
def start():
    """Return a function that starts the executable; what still runs after the test is killed."""
    processes = []

    def start_node(*ros_arguments):
        command = [sys.executable, "-m", "lane_dp_ros.ros.start", "--ros-args", *ros_arguments]
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), *sys.path])}
        processes.append(subprocess.Popen(command, stderr=subprocess.PIPE, text=True, env=environment))
        return processes[-1]

    yield start_node
    for process in processes:
        process.kill()
        process.communicate()


def ended(process):
    """Wait for the end; return exit code and what was written to standard error."""
    _, errors = process.communicate(timeout=DEADLINE)
    return process.returncode, errors


def test_at_10_hz_every_pair_is_answered_from_another_process(start, make_rig):
    """Slower where the machine is busy: a pair that comes before the last one is answered may be dropped."""
    process = start()
    rig = make_rig(with_node=False)
    rig.warm_up()
    rig.answer(rig.send())
    begin = time.monotonic()
    for i in range(20):
        time.sleep(max(0.0, begin + i * PERIOD - time.monotonic()))
        assert rig.answer(rig.send())
    rig.assert_one_answer_each()
    rig.diagnosis("frames/s", b"\x00")
    process.send_signal(signal.SIGTERM)
    code, errors = ended(process)
    assert code == 0
    assert "Traceback" not in errors


@pytest.mark.parametrize("signals", [[signal.SIGINT], [signal.SIGTERM], [signal.SIGINT, signal.SIGINT]])
def test_a_busy_node_ends_with_0_when_told_to(start, make_rig, signals):
    process = start()
    rig = make_rig(with_node=False)
    rig.warm_up()
    for number in signals:
        process.send_signal(number)
        rig.send()
    code, errors = ended(process)
    assert code == 0
    assert "Traceback" not in errors


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_idle_node_ends_with_0_when_told_to(start, make_rig, number):
    process = start()
    make_rig(with_node=False)
    process.send_signal(number)
    assert ended(process) == (0, "")


@pytest.mark.parametrize("wait", [0.1, 0.4, 1.0])
@pytest.mark.parametrize("signals", [[signal.SIGINT], [signal.SIGTERM, signal.SIGTERM]])
def test_it_ends_with_0_while_it_starts(start, wait, signals):
    process = start()
    # Python itself takes a moment before it is ours to answer: it is once SIGTERM is caught.
    status = Path(f"/proc/{process.pid}/status")
    while not int(re.search(r"SigCgt:\s*(\w+)", status.read_text())[1], 16) & 1 << (signal.SIGTERM - 1):
        time.sleep(0.005)
    time.sleep(wait)
    for number in signals:
        process.send_signal(number)
        time.sleep(0.05)
    assert ended(process) == (0, "")


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("sync_tolerance: [1, 2", "Error parsing a event near line"),
        ("sync_tolerance: lots", "sync_tolerance: got 'lots', expected a value of type float"),
        ("sync_tolerance: -1.0", "sync_tolerance: got -1.0, expected 0 to 0.5"),
        ("disparity: {P1: 500, P2: 400}", "disparity.P2: got 400, expected more than P1 = 500"),
        (
            "qos_overrides: {/left/image_rect: {subscription: {depth: many}}}",
            "qos_overrides of left/image_rect:",
        ),
    ],
)
def test_a_wrong_parameter_file_is_answered_in_one_line(start, tmp_path, content, message):
    path = tmp_path / "node.yaml"
    path.write_text(f"/**:\n  ros__parameters:\n    {content}\n")
    code, errors = ended(start("--params-file", str(path)))
    *before, last = errors.strip().splitlines()
    assert code == 1
    assert last.startswith("lane_detector: ") and message in last
    assert all("[rcl]" in line for line in before)  # rcl has its own word on files that are no YAML


def test_a_misspelt_parameter_is_named(start, make_rig):
    process = start("-p", "disparity.disparty_range:=64")
    make_rig(with_node=False)
    process.send_signal(signal.SIGINT)
    code, errors = ended(process)
    assert code == 0
    assert "ignored: disparity.disparty_range" in errors


def test_old_names_of_parameters_are_named_too(start, make_rig):
    process = start("-p", "tracking.bridge_time:=0.3", "-p", "lane_graph.contrast_min:=0.4")
    make_rig(with_node=False)
    process.send_signal(signal.SIGINT)
    code, errors = ended(process)
    assert code == 0
    assert "Parameter tracking.bridge_time is tracking.coast_time now, take that name" in errors
    assert "Parameter lane_graph.contrast_min is paint_map.contrast_min now, take that name" in errors
    assert "ignored" not in errors
