# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The launch file, run by the real launch: which topics and parameters the node that it starts has."""

# ruff: noqa: E402
from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).resolve().parents[1]
# Not `launch`: where there is no ROS, the folder of that name in this package would pass for it.
pytest.importorskip("launch_ros.actions", reason="launch_ros is not on PyPI: this needs a sourced ROS")

# Before ROS is loaded, so that client and node find one another at once.
os.environ.setdefault("FASTRTPS_DEFAULT_PROFILES_FILE", str(ROOT / "config" / "fastdds_big_images.xml"))
import rclpy
from ament_index_python.packages import (
    PackageNotFoundError,
    get_package_prefix,
    get_package_share_directory,
)
from rcl_interfaces.srv import GetParameters

try:
    SHARE = Path(get_package_share_directory("lane_dp_ros"))
except PackageNotFoundError:
    pytest.skip("lane_dp_ros is not installed by colcon", allow_module_level=True)

DEADLINE = 20.0  # s
OWN = ["/left/camera_info", "/left/image_rect", "/right/camera_info", "/right/image_rect"]
LAUNCH = """
import sys
from launch import LaunchService
from launch.actions import IncludeLaunchDescription
from launch import LaunchDescription
path, *arguments = sys.argv[1:]
service = LaunchService()
service.include_launch_description(LaunchDescription([
    IncludeLaunchDescription(path, launch_arguments=[text.split(":=", 1) for text in arguments])]))
sys.exit(service.run())
"""
# Subscribes to what the displays of the file after -d show, as RViz does.
RVIZ = """#!{python}
import sys
import rclpy, yaml
from visualization_msgs.msg import MarkerArray
rclpy.init(args=sys.argv)
node = rclpy.create_node("rviz")
config = yaml.safe_load(open(sys.argv[sys.argv.index("-d") + 1]))
for display in config["Visualization Manager"]["Displays"]:
    if "Topic" in display:
        node.create_subscription(MarkerArray, display["Topic"]["Value"], print, 1)
node.create_subscription(MarkerArray, "/fixed_frame/" + sys.argv[sys.argv.index("-f") + 1], print, 1)
rclpy.spin(node)
"""


@contextmanager
def launched(*arguments, environment=()):
    """Start the launch file with name:=value ..., end it when the block ends."""
    command = [sys.executable, "-c", LAUNCH, str(SHARE / "launch" / "lane_detector.launch.py"), *arguments]
    process = subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        env={**os.environ, **dict(environment)},
        start_new_session=True,
    )
    try:
        yield process
    finally:
        if process.poll() is None:
            process.send_signal(signal.SIGINT)
        try:
            process.communicate(timeout=DEADLINE)
        finally:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)


@pytest.fixture
def client():
    context = rclpy.Context()
    rclpy.init(context=context)
    node = rclpy.create_node("launch_test", context=context)
    yield node
    node.destroy_node()
    rclpy.shutdown(context=context)


def subscriptions(client, name="lane_detector", namespace="/", count=4):
    """Return the topics that a node subscribes to, once there are so many."""
    for _ in range(int(DEADLINE / 0.1)):
        if (name, namespace) in client.get_node_names_and_namespaces():
            found = client.get_subscriber_names_and_types_by_node(name, namespace)
            topics = sorted(topic for topic, _ in found if topic not in ("/parameter_events", "/clock"))
            if len(topics) >= count:
                return topics
        time.sleep(0.1)
    pytest.fail(f"no {namespace} {name} with {count} subscriptions")


def parameters(client, *names):
    """Return values of the running node's parameters."""
    service = client.create_client(GetParameters, "/lane_detector/get_parameters")
    assert service.wait_for_service(DEADLINE)
    future = service.call_async(GetParameters.Request(names=names))
    executor = rclpy.executors.SingleThreadedExecutor(context=client.context)
    executor.add_node(client)
    executor.spin_until_future_complete(future, DEADLINE)
    executor.remove_node(client)
    return [rclpy.parameter.parameter_value_to_python(value) for value in future.result().values]


@pytest.mark.parametrize(
    ("arguments", "namespace", "topics"),
    [
        ([], "/", OWN),
        (["namespace:=stereo"], "/stereo", [f"/stereo{topic}" for topic in OWN]),
        (["camera:=/front/"], "/", [f"/front{topic}" for topic in OWN]),
        (["camera:=cameras", "namespace:=car"], "/car", [f"/car/cameras{topic}" for topic in OWN]),
        (
            ["left:=/a/image", "right:=/b/image", "right_info:=/c/info"],
            "/",
            ["/a/camera_info", "/a/image", "/b/image", "/c/info"],
        ),
        (
            ["left:=/a/image", "image_transport:=compressed"],
            "/",
            [
                "/a/camera_info",
                "/a/image/compressed",
                "/right/camera_info",
                "/right/image_rect/compressed",
            ],
        ),
        (
            ["vehicle:=realsense", "right:=/other/image"],
            "/",
            [
                "/camera/camera/infra1/camera_info",
                "/camera/camera/infra1/image_rect_raw",
                "/other/camera_info",
                "/other/image",
            ],
        ),
    ],
)
def test_the_node_listens_where_the_arguments_say(client, arguments, namespace, topics):
    with launched(*arguments):
        assert subscriptions(client, namespace=namespace) == topics


def test_the_later_of_preset_vehicle_file_and_argument_wins(client, tmp_path):
    file, vehicle = tmp_path / "file.yaml", tmp_path / "vehicle.yaml"
    values = {"image_transport": "raw", "road_profile": {"camera_height": 2}}
    file.write_text(yaml.safe_dump({"/**": {"ros__parameters": values}}))
    mounting = "road_profile: {camera_height: 3, camera_pitch: 0.1}"
    vehicle.write_text(f"parameters: {{sync_tolerance: 0.02, {mounting}}}")
    with launched(
        "preset:=paper",
        f"params_file:={file}",
        f"vehicle:={vehicle}",
        "image_transport:=compressed",
        "use_sim_time:=true",
    ):
        names = (
            "lane_model.model",  # the paper's
            "sync_tolerance",
            "road_profile.camera_pitch",
            "road_profile.camera_height",
            "image_transport",
            "use_sim_time",
        )
        assert parameters(client, *names) == ["parabola", 0.02, 0.1, 2.0, "compressed", True]


def test_an_argument_wins_over_a_file_that_ros2_param_dump_wrote(client, tmp_path):
    file = tmp_path / "dump.yaml"
    values = {"image_transport": "raw", "road_profile": {"camera_height": 2.0}}
    file.write_text(yaml.safe_dump({"/lane_detector": {"ros__parameters": values}}))
    with launched(f"params_file:={file}", "vehicle:=zed", "image_transport:=compressed"):
        names = ("image_transport", "road_profile.camera_height")
        assert parameters(client, *names) == ["compressed", 2.0]


@pytest.mark.parametrize("path", sorted((SHARE / "config" / "cameras").glob("*.yaml")), ids=lambda p: p.stem)
def test_each_file_that_is_shipped_is_taken(client, path):
    vehicle = yaml.safe_load(path.read_text())
    images = [vehicle["topics"]["left"], vehicle["topics"]["right"]]
    infos = [f"{topic.rpartition('/')[0]}/camera_info" for topic in images]
    with launched(f"vehicle:={path.stem}"):
        assert subscriptions(client) == sorted([*images, *infos])


@pytest.mark.parametrize(
    ("argument", "content", "line"),
    [
        ("params_file:={path}", None, "params_file:={path}: no such file"),
        ("vehicle:={path}", None, "vehicle:={path}: no such file, nor one of image_pipeline, oak_d, "),
        ("vehicle:={path}", "topics: [", "vehicle:={path} cannot be read: while parsing"),
        ("vehicle:={path}", "topic: {left: /a}", "expected frame, parameters, topics, got topic"),
        ("vehicle:={path}", "topics: {lefft: /a}", "topics: expected some of left, right, left_info"),
        ("vehicle:={path}", "parameters: 3", "expected parameters: with names and values"),
        ("vehicle:={path}", "just text", "got str"),
        ("preset:=papr", None, 'Argument "preset" provided value "papr" is not valid'),
        ("rviz:=maybe", None, 'Argument "rviz" provided value "maybe" is not valid'),
    ],
)
def test_what_is_wrong_ends_the_launch_with_one_line(tmp_path, argument, content, line):
    path = tmp_path / "file.yaml"
    if content is not None:
        path.write_text(content)
    with launched(argument.format(path=path)) as process:
        output, _ = process.communicate(timeout=DEADLINE)
    assert process.returncode == 1
    said = [text for text in output.splitlines() if "Caught exception in launch" in text]
    assert len(said) == 1
    assert line.format(path=path) in said[0]
    assert "process started" not in output


@pytest.mark.parametrize("namespace", ["", "stereo/front"])
def test_rviz_looks_at_the_namespace_of_the_node(client, tmp_path, namespace):
    (tmp_path / "share/ament_index/resource_index/packages").mkdir(parents=True)
    (tmp_path / "share/ament_index/resource_index/packages/rviz2").touch()
    program = tmp_path / "lib/rviz2/rviz2"
    program.parent.mkdir(parents=True)
    program.write_text(RVIZ.format(python=sys.executable))
    program.chmod(0o755)
    prefixes = {"AMENT_PREFIX_PATH": os.pathsep.join([str(tmp_path), os.environ["AMENT_PREFIX_PATH"]])}
    arguments = ["rviz:=true", "vehicle:=zed", f"namespace:={namespace}"]
    prefix = f"/{namespace}" if namespace else ""
    with launched(*arguments, environment=prefixes):
        subscriptions(client, namespace=prefix or "/")
        shown = subscriptions(client, "rviz", prefix or "/", count=5)
        published = client.get_publisher_names_and_types_by_node("lane_detector", prefix or "/")
    frame = "/fixed_frame/zed_left_camera_frame_optical"
    assert sorted(shown) == sorted(
        [frame, *(f"{prefix}/{name}" for name in ("ipm/image", "lanes", "overlay/image", "road_edges"))]
    )
    assert {f"{prefix}/lanes", f"{prefix}/road_edges"} <= {topic for topic, _ in published}


def test_without_rviz_the_launch_says_how_to_get_it():
    try:
        get_package_prefix("rviz2")
    except PackageNotFoundError:
        with launched("rviz:=true") as process:
            output, _ = process.communicate(timeout=DEADLINE)
        assert process.returncode == 1
        assert "rviz:=true needs RViz: sudo apt install ros-jazzy-rviz2" in output
    else:
        pytest.skip("RViz is installed here")
