# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Starts the lane detector: ros2 launch lane_dp_ros lane_detector.launch.py [name:=value ...].

Parameters come from the preset, then from the vehicle's file, then from params_file, then from the arguments;
the later win. Topics come from the vehicle's file, then from camera, then from left, right and so on. A file
that is missing or wrong ends the launch with one line.
"""

from pathlib import Path
from tempfile import NamedTemporaryFile

import yaml
from ament_index_python.packages import PackageNotFoundError, get_package_prefix, get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction, SetEnvironmentVariable
from launch.substitutions import EnvironmentVariable, LaunchConfiguration
from launch_ros.actions import Node

CONFIG = Path(get_package_share_directory("lane_dp_ros")) / "config"
DDS_PROFILES = "FASTRTPS_DEFAULT_PROFILES_FILE"
PRESETS = {"default": "lane_detector.yaml", "paper": "paper.yaml"}

# The topics that the node listens to, by the arguments that name others.
TOPICS = {
    "left": "left/image_rect",
    "right": "right/image_rect",
    "left_info": "left/camera_info",
    "right_info": "right/camera_info",
}
VEHICLE_KEYS = {"topics", "parameters", "frame"}

# These are parameters of the node, too. Left empty here, the files have their say.
NODE_PARAMETERS = {
    "image_transport": "raw or compressed; empty: as the files say",
    "use_sim_time": "true or false: take the time from /clock; empty: as the files say",
}
CAMERAS = {path.stem: path for path in sorted((CONFIG / "cameras").glob("*.yaml"))}
ARGUMENTS = {
    "namespace": "namespace of node and topics",
    "vehicle": f"file of topics, frame and parameters of a vehicle, over preset; or {', '.join(CAMERAS)}",
    "params_file": "ROS parameter file, over preset and vehicle",
    "camera": f"what stands before {TOPICS['left']}, {TOPICS['left_info']} and so on",
    "left": "topic of the left rectified images",
    "right": "topic of the right rectified images",
    "left_info": "their CameraInfo; empty: camera_info beside the images",
    "right_info": "their CameraInfo; empty: camera_info beside the images",
    **NODE_PARAMETERS,
}


def given(context, names):
    """Return those of the arguments that are not empty."""
    values = {name: LaunchConfiguration(name).perform(context) for name in names}
    return {name: value for name, value in values.items() if value}


def checked_file(path, argument, or_name=""):
    """Return a path. Raises RuntimeError, which ends the launch, where there is no such file."""
    if not Path(path).is_file():
        raise RuntimeError(f"{argument}:={path}: no such file{or_name}")
    return path


def vehicle_file(name):
    """Return what a vehicle's file says. Raises RuntimeError for what is none."""
    path = CAMERAS.get(name) or checked_file(name, "vehicle", f", nor one of {', '.join(CAMERAS)}")
    try:
        vehicle = yaml.safe_load(Path(path).read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        raise RuntimeError(f"vehicle:={path} cannot be read: {' '.join(str(error).split())}") from None
    if not isinstance(vehicle, dict) or not vehicle.keys() <= VEHICLE_KEYS:
        came = ", ".join(map(str, vehicle)) if isinstance(vehicle, dict) else type(vehicle).__name__
        raise RuntimeError(f"vehicle:={path}: expected {', '.join(sorted(VEHICLE_KEYS))}, got {came}")
    if not isinstance(vehicle.get("parameters", {}), dict) or not isinstance(vehicle.get("frame", ""), str):
        raise RuntimeError(f"vehicle:={path}: expected parameters: with names and values, frame: with a name")
    topics = vehicle.get("topics", {})
    if not isinstance(topics, dict) or not topics.keys() <= TOPICS.keys():
        raise RuntimeError(f"vehicle:={path}: topics: expected some of {', '.join(TOPICS)}, got {topics}")
    return vehicle


def topics_of(context, vehicle):
    """Return the topics to listen to, by the names in TOPICS; those that are not named are the node's own."""
    prefix = LaunchConfiguration("camera").perform(context).rstrip("/")
    of_camera = {name: f"{prefix}/{topic}" for name, topic in TOPICS.items()} if prefix else {}
    named = {**vehicle.get("topics", {}), **of_camera, **given(context, TOPICS)}
    beside = {f"{side}_info": named[side].rpartition("/")[0] for side in ("left", "right") if side in named}
    return {**{name: f"{folder}/camera_info" for name, folder in beside.items()}, **named}


def flat(tree, prefix=""):
    """Return parameters by their dotted names."""
    pairs = ((f"{prefix}{name}", value) for name, value in tree.items())
    parts = (flat(value, f"{name}.") if isinstance(value, dict) else {name: value} for name, value in pairs)
    return {name: value for part in parts for name, value in part.items()}


def base_file(preset, vehicle):
    """Return a parameter file of preset and vehicle, for any node name.

    They go as one: after two files rcl takes no dotted name of a third, but the second's value.
    """
    values = yaml.safe_load((CONFIG / PRESETS[preset]).read_text(encoding="utf-8"))["/**"]["ros__parameters"]
    values = flat(values) | flat(vehicle.get("parameters", {}))
    with NamedTemporaryFile("w", prefix="lane_detector_", suffix=".yaml", delete=False) as file:
        yaml.safe_dump({"/**": {"ros__parameters": values}}, file)
    return file.name


def parameters_of(context, vehicle, params_file):
    """Return what the node's parameters are read from, the last of which wins."""
    files = [base_file(LaunchConfiguration("preset").perform(context), vehicle)]
    if params_file:
        files.append(checked_file(params_file, "params_file"))
    last = {name: yaml.safe_load(text) for name, text in given(context, NODE_PARAMETERS).items()}
    return [*files, *([last] if last else [])]


def lane_detector(context):
    """Return the node and, if asked for, RViz."""
    files = given(context, ("params_file", "vehicle"))
    vehicle = vehicle_file(files["vehicle"]) if "vehicle" in files else {}
    node = Node(
        package="lane_dp_ros",
        executable="lane_detector",
        name="lane_detector",  # for this one, arguments win over a params_file that ros2 param dump wrote
        namespace=LaunchConfiguration("namespace"),
        parameters=parameters_of(context, vehicle, files.get("params_file")),
        remappings=[(TOPICS[name], topic) for name, topic in topics_of(context, vehicle).items()],
        output="screen",
    )
    if LaunchConfiguration("rviz").perform(context) == "false":
        return [node]
    return [node, rviz(vehicle.get("frame", ""))]


def rviz(frame):
    """Return RViz with our displays, which look at the node's namespace."""
    try:
        get_package_prefix("rviz2")
    except PackageNotFoundError:
        raise RuntimeError("rviz:=true needs RViz: sudo apt install ros-jazzy-rviz2") from None
    config = CONFIG / "lanes.rviz"
    displays = yaml.safe_load(config.read_text(encoding="utf-8"))["Visualization Manager"]["Displays"]
    topics = [display["Topic"]["Value"] for display in displays if "Topic" in display]
    return Node(
        package="rviz2",
        executable="rviz2",
        namespace=LaunchConfiguration("namespace"),
        arguments=["-d", str(config), *(["-f", frame] if frame else [])],
        remappings=[(topic, topic.lstrip("/")) for topic in topics],
    )


def generate_launch_description():
    """Return the arguments, the DDS profile for big images (unless the user has one) and the node."""
    return LaunchDescription(
        [
            *(
                DeclareLaunchArgument(name, default_value="", description=description)
                for name, description in ARGUMENTS.items()
            ),
            DeclareLaunchArgument(
                "preset", default_value="default", choices=[*PRESETS], description="parameters to start from"
            ),
            DeclareLaunchArgument(
                "rviz",
                default_value="false",
                choices=["true", "false"],
                description="show lanes in RViz, too",
            ),
            SetEnvironmentVariable(
                DDS_PROFILES,
                EnvironmentVariable(DDS_PROFILES, default_value=str(CONFIG / "fastdds_big_images.xml")),
            ),
            OpaqueFunction(function=lane_detector),
        ]
    )
