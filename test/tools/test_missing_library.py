# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Where libraries are missing the command line still shows its help, and one line says how to get them."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from lane_dp_ros.messages import missing_library
from lane_dp_ros.tools.cli.main import COMMANDS

ROOT = Path(__file__).resolve().parents[2]
OPTIONAL = ("cv2", "rclpy", "rosbags", "scipy", "tqdm", "yaml", "argcomplete")
NAMES = [command.__name__.rpartition(".")[2].replace("_", "-") for command in COMMANDS]
# Blocked as Python blocks what is not there; what is imported by the way stays out, too.
BLOCKED = """
import sys
sys.modules.update(dict.fromkeys(sys.argv.pop(1).split(","), None))
from lane_dp_ros.{module} import main
sys.exit(main())
"""


def run_without(
    missing: tuple[str, ...], *arguments: object, module: str = "tools.cli"
) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", BLOCKED.format(module=module), ",".join(missing), *map(str, arguments)]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    return subprocess.run(command, capture_output=True, text=True, env=environment, check=False)


@pytest.mark.parametrize("arguments", [("--version",), ("--help",), *((name, "--help") for name in NAMES)])
def test_help_and_version_need_no_library(arguments) -> None:
    result = run_without(OPTIONAL, *arguments)
    assert result.returncode == 0, result.stderr
    assert result.stderr == ""
    assert result.stdout.startswith("lane_dp " if arguments == ("--version",) else "usage: lane_dp")


@pytest.mark.parametrize(
    ("missing", "arguments", "needed"),
    [
        ("cv2", ("dump-config",), "opencv"),
        ("cv2", ("scenes", "--list"), "opencv"),
        ("rosbags", ("run", "{here}/x.mcap", "-o", "{here}/out"), "rosbags"),
        ("rosbags", ("play", "{here}/x.mcap"), "rosbags"),
        ("yaml", ("run", "{here}/x.mcap", "-o", "{here}/out", "--config", "{here}/x.yaml"), "yaml"),
        ("rclpy", ("demo", "-o", "{here}/demo"), "ros"),
    ],
)
def test_a_missing_library_is_one_line_with_the_command_that_brings_it(
    tmp_path, missing, arguments, needed
) -> None:
    (tmp_path / "x.mcap").touch()
    (tmp_path / "x.yaml").touch()
    result = run_without((missing,), *(text.format(here=tmp_path) for text in arguments))
    assert result.returncode == 1
    (line,) = result.stderr.splitlines()
    assert line.startswith("lane_dp: needs ")
    command = line.rpartition(": ")[2]
    assert needed in command
    assert command.startswith((f"{sys.executable} -m pip install ", "sudo apt install ", "source /opt/ros/"))


def test_the_executable_of_the_node_says_what_is_missing() -> None:
    result = run_without(("rclpy",), module="ros.start")
    assert result.returncode == 1
    (line,) = result.stderr.splitlines()
    assert line.startswith("lane_detector: needs ROS 2 (import of rclpy halted")


def test_the_node_needs_no_rosbags() -> None:
    code = "import sys; import lane_dp_ros.ros.lane_detector_node; sys.exit('rosbags' in sys.modules)"
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    assert subprocess.run([sys.executable, "-c", code], env=environment, check=False).returncode == 0


@pytest.fixture
def machine(monkeypatch, tmp_path):
    """Return a function that gives this machine a venv, apt, a ROS, or a Python that Debian manages."""

    def machine(venv: bool, apt: bool = True, ros: bool = False, managed: bool = True) -> None:
        monkeypatch.setattr(sys, "prefix", sys.base_prefix + ("/venv" if venv else ""))
        monkeypatch.setattr(
            missing_library.shutil, "which", lambda _name: "/usr/bin/apt-get" if apt else None
        )
        if ros:
            (tmp_path / "ros" / "jazzy").mkdir(parents=True)
            (tmp_path / "ros" / "jazzy" / "setup.bash").touch()
        monkeypatch.setattr(missing_library, "ROS_ROOT", tmp_path / "ros")
        monkeypatch.delenv("ROS_DISTRO", raising=False)
        (tmp_path / "EXTERNALLY-MANAGED").touch() if managed else None
        monkeypatch.setattr(missing_library.sysconfig, "get_path", lambda _name: str(tmp_path))

    return machine


def missing(name: str) -> str:
    error = ModuleNotFoundError(f"No module named '{name}'", name=name)
    return missing_library.missing_library(error).replace(sys.executable, "python3")


def test_in_a_venv_pip_brings_it(machine) -> None:
    machine(venv=True)
    assert missing("cv2") == "needs OpenCV, for all pictures: python3 -m pip install opencv-python-headless"


def test_outside_apt_brings_it(machine) -> None:
    machine(venv=False)
    assert missing("yaml.cyaml") == "needs PyYAML, to read parameter files: sudo apt install python3-yaml"


def test_what_apt_has_not_pip_brings_where_debian_manages_python(machine) -> None:
    machine(venv=False)
    expected = "python3 -m pip install --user --break-system-packages rosbags"
    assert missing("rosbags") == f"needs rosbags, to read and write bags: {expected}"


def test_pip_is_asked_plainly_where_nobody_manages_python(machine) -> None:
    machine(venv=False, apt=False, managed=False)
    assert missing("rosbags").endswith(": python3 -m pip install rosbags")


def test_a_ros_that_was_not_sourced_is_named(machine, tmp_path) -> None:
    machine(venv=False, ros=True)
    expected = f"source {tmp_path}/ros/jazzy/setup.bash"
    assert missing("sensor_msgs") == f"needs ROS 2 (No module named 'sensor_msgs'): {expected}"


def test_a_library_that_cannot_be_loaded_is_told_from_a_missing_one() -> None:
    error = ImportError("libGL.so.1: cannot open shared object file", name="cv2")
    expected = "cv2 is installed but cannot be loaded: libGL.so.1: cannot open shared object file"
    assert missing_library.missing_library(error) == expected


def test_the_shell_is_told_how_a_command_line_may_go_on(tmp_path) -> None:
    pytest.importorskip("argcomplete")
    answer = tmp_path / "answer"
    line = "lane_dp dump-config --preset p"
    asked = {
        "_ARGCOMPLETE": "1",
        "_ARGCOMPLETE_STDOUT_FILENAME": str(answer),
        "_ARGCOMPLETE_IFS": "\n",
        "COMP_LINE": line,
        "COMP_POINT": str(len(line)),
        "PYTHONPATH": str(ROOT),
    }
    command = [sys.executable, "-m", "lane_dp_ros.tools.cli"]
    subprocess.run(command, env={**os.environ, **asked}, capture_output=True, check=False)
    assert answer.read_text().strip() == "paper"
