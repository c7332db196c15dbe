# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What the package says of itself: package.xml, setup.py and the code agree, and what they name is there."""

from __future__ import annotations

import ast
import importlib.metadata
import os
import re
import runpy
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
import setuptools
import yaml
from packaging.requirements import Requirement

import lane_dp_ros

ROOT = Path(__file__).resolve().parents[1]
PROFILE = ROOT / "config" / "fastdds_big_images.xml"
LAUNCH_FILE = ROOT / "launch" / "lane_detector.launch.py"
CHANGELOG_VERSION = re.compile(r"^(\d+\.\d+\.\d+) \(\d{4}-\d\d-\d\d\)$", re.MULTILINE)

# The node needs neither, and apt has no rosbags: the commands say how to get them where they are missing.
NOT_ON_A_ROBOT = {"pyarrow", "rerun", "rosbags", "scipy"}
# What goes by another name in package.xml: the rosdep key of an import, and of a requirement in setup.py.
KEY_OF_IMPORT = {
    "argcomplete": "python3-argcomplete",
    "cv2": "python3-opencv",
    "numpy": "python3-numpy",
    "tqdm": "python3-tqdm",
    "yaml": "python3-yaml",
}
KEY_OF_REQUIREMENT = {
    "argcomplete": "python3-argcomplete",
    "hypothesis": "python3-hypothesis",
    "numpy": "python3-numpy",
    "opencv-python-headless": "python3-opencv",
    "pytest": "python3-pytest",
    "pyyaml": "python3-yaml",
    "scipy": "python3-scipy",
    "tqdm": "python3-tqdm",
}
# Of the extra `test`, what colcon test does without: the coverage and the workers; oracles, tables and a
# browser's driver, whose tests are skipped.
ONLY_FROM_PYPI = {"mcap-ros2-support", "pyarrow", "pytest-cov", "pytest-xdist", "rosbags-image", "selenium"}


@pytest.fixture(scope="module")
def manifest() -> ET.Element:
    return ET.parse(ROOT / "package.xml").getroot()


@pytest.fixture(scope="module")
def distribution() -> importlib.metadata.Distribution:
    """Return what setup.py told pip or colcon."""
    try:
        return importlib.metadata.distribution("lane_dp_ros")
    except importlib.metadata.PackageNotFoundError:
        pytest.skip("lane_dp_ros is not installed (make test installs it)")


def texts(manifest: ET.Element, tag: str) -> set[str]:
    return {element.text or "" for element in manifest.iter(tag)}


def requirements(distribution: importlib.metadata.Distribution, extra: str) -> set[str]:
    """Return the names of what is required, with an extra: of what that adds."""
    parsed = [Requirement(text) for text in distribution.requires or ()]
    plain = {each.name.lower() for each in parsed if each.marker is None}
    with_extra = {
        each.name.lower() for each in parsed if each.marker and each.marker.evaluate({"extra": extra})
    }
    return with_extra if extra else plain


def imports(path: Path) -> set[str]:
    """Return the packages that a file imports or names as `package/msg/Type`; not Python's, not our own."""
    text = path.read_text()
    found = set(re.findall(r"\b(\w+)/msg/", text))
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            found |= {alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            found.add(node.module.partition(".")[0])
    return found - set(sys.stdlib_module_names) - {"lane_dp_ros"}


def test_package_xml_and_setup_py_tell_the_same(manifest, distribution):
    stated = distribution.metadata
    maintainer = manifest.find("maintainer")
    licence = manifest.find("license")
    assert texts(manifest, "name") == {stated["Name"].replace("-", "_")}
    assert texts(manifest, "version") == {stated["Version"]}
    assert texts(manifest, "description") == {stated["Summary"]}
    assert licence.text == (stated["License-Expression"] or stated["License"])
    assert maintainer.get("email") in (stated["Maintainer-Email"] or stated["Maintainer-email"])
    assert (ROOT / licence.get("file")).is_file()


def test_a_maintainer_address_that_ros_takes(manifest):
    # With an address that its tools refuse, colcon silently takes the package for plain Python.
    address = manifest.find("maintainer").get("email")
    assert re.fullmatch(r"[-\w%+]+(\.[-\w%+]+)*@[-a-zA-Z0-9%]+(\.[-a-zA-Z0-9%]+)*\.[a-zA-Z]{2,}", address)


def test_package_xml_names_exactly_what_is_imported(manifest):
    files = [*(ROOT / "lane_dp_ros").rglob("*.py"), LAUNCH_FILE]
    imported = {KEY_OF_IMPORT.get(name, name) for path in files for name in imports(path)}
    assert texts(manifest, "exec_depend") == imported - NOT_ON_A_ROBOT | {"ros2launch"}


def test_every_requirement_has_its_rosdep_key(manifest, distribution):
    needed = {KEY_OF_REQUIREMENT[name] for name in requirements(distribution, "") - NOT_ON_A_ROBOT}
    tested = {KEY_OF_REQUIREMENT[name] for name in requirements(distribution, "test") - ONLY_FROM_PYPI}
    assert needed <= texts(manifest, "exec_depend")
    assert tested <= texts(manifest, "test_depend") | texts(manifest, "exec_depend")


@pytest.mark.parametrize("ros", ["", "jazzy"])
def test_neither_ros_nor_opencv_is_forced_on_a_robot(monkeypatch, ros):
    monkeypatch.setenv("ROS_DISTRO", ros) if ros else monkeypatch.delenv("ROS_DISTRO", raising=False)
    monkeypatch.chdir(ROOT)
    stated = {}
    monkeypatch.setattr(setuptools, "setup", stated.update)
    runpy.run_path("setup.py")
    required = {Requirement(text).name for text in stated["install_requires"]}
    assert required == {"numpy", "rosbags", "tqdm"} | (set() if ros else {"opencv-python-headless", "pyyaml"})
    assert {Requirement(text).name for text in stated["extras_require"]["ros"]} == {
        "ros-jazzy-rclpy",
        "ros-jazzy-common-interfaces",
    }


def test_apt_serves_every_key(manifest):
    # A key of pip ends rosdep install on Ubuntu 24.04, and a release by bloom everywhere.
    assert not {key for key in texts(manifest, "exec_depend") if key.endswith("-pip")}


def test_the_version_is_told_by_the_package_itself(manifest, distribution):
    assert lane_dp_ros.__version__ == distribution.version
    assert CHANGELOG_VERSION.findall((ROOT / "CHANGELOG.rst").read_text())[0] in texts(manifest, "version")
    assert f"version: {manifest.find('version').text}" in (ROOT / "CITATION.cff").read_text().splitlines()


def test_the_source_tree_tells_its_version_where_nothing_is_installed(manifest, monkeypatch):
    def nothing(name):
        raise importlib.metadata.PackageNotFoundError(name)

    monkeypatch.setattr(importlib.metadata, "version", nothing)
    assert {lane_dp_ros.__version__} == texts(manifest, "version")


def test_the_executables_are_there(distribution):
    scripts = {point.name: point for point in distribution.entry_points if point.group == "console_scripts"}
    assert set(scripts) == {"lane_detector", "lane_dp"}
    assert all(callable(point.load()) for point in scripts.values())


def test_fast_dds_takes_the_profile():
    # A file that Fast DDS cannot read is dropped with a word on standard error, and the defaults are used.
    code = "import rclpy; rclpy.init(); rclpy.create_node('profiled').destroy_node(); rclpy.shutdown()"
    environment = {**os.environ, "FASTRTPS_DEFAULT_PROFILES_FILE": str(PROFILE)}
    run = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True
    )
    assert run.stdout + run.stderr == ""


def test_the_profile_holds_a_colour_image_in_one_piece():
    namespace = {"dds": "http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles"}
    root = ET.parse(PROFILE).getroot()
    shared_memory = root.find(".//dds:transport_descriptor[dds:type='SHM']", namespace)
    message = int(shared_memory.find("dds:maxMessageSize", namespace).text)
    segment = int(shared_memory.find("dds:segment_size", namespace).text)
    full_hd = 1920 * 1080 * 3
    assert full_hd < message
    assert 4 * message <= segment, "left and right of two frames may lie there at once"


def test_rviz_shows_what_the_node_publishes():
    displays = yaml.safe_load((ROOT / "config" / "lanes.rviz").read_text())["Visualization Manager"][
        "Displays"
    ]
    topics = {each["Topic"]["Value"] for each in displays if "Topic" in each}
    assert topics == {"/lanes", "/road_edges", "/overlay/image", "/ipm/image"}


def test_the_launch_file_starts_what_is_installed(manifest):
    text = LAUNCH_FILE.read_text()
    assert set(re.findall(r'(?:package=|share_directory\()"(lane\w+)"', text)) == texts(manifest, "name")
    assert re.findall(r'executable="(\w+)"', text) == ["lane_detector", "rviz2"]
    for name in re.findall(r'"([\w.]+\.(?:yaml|xml|rviz))"', text):
        assert (ROOT / "config" / name).is_file(), name
