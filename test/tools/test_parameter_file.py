# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The printed parameter files hold every value in its type, for PyYAML, for ROS, and for lane_dp run."""

from pathlib import Path

import pytest
import rclpy
import yaml
from rclpy.context import Context
from rclpy.node import Node
from rclpy.parameter import Parameter as RosParameter

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.parameter import Parameter, replaced
from lane_dp_ros.core.presets import PRESETS
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.messages.node_config import NodeConfig, all_parameters
from lane_dp_ros.ros.lane_detector_node import LaneDetectorNode
from lane_dp_ros.tools.cli import main
from lane_dp_ros.tools.cli.dump_config import dumped_config
from lane_dp_ros.tools.detection_config import load_config
from lane_dp_ros.tools.evaluation.evaluate import DetectorChoice
from lane_dp_ros.tools.parameter_file import parameter_file, read_parameter_file

CONFIG = Path(__file__).resolve().parents[2] / "config"


PRINTED = """# Title
/**:
  ros__parameters:
    # How fast. [unit m/s; 0 to 5; default 2.0]
    speed: 1.0e-07
    # Which. [default 1]
    seed: 1

    stage:
      # What. [one of a, b; default "a"]
      mode: "a"
      # Whether. [default true]
      on: true
      # How big. [unit px; 1 to 9 in steps of 2; default 3]
      size: 3
"""


def values_of(preset: str) -> dict:
    return {name: parameter.default for name, parameter in all_parameters(preset).items()}


def types(values: dict) -> dict:
    return {name: type(value) for name, value in values.items()}


@pytest.mark.parametrize("preset", PRESETS)
def test_the_print_holds_every_parameter_in_its_type(tmp_path: Path, preset: str) -> None:
    path = tmp_path / "print.yaml"
    path.write_text(dumped_config(preset))
    read = read_parameter_file(path)
    assert read == values_of(preset)
    assert types(read) == types(values_of(preset))


@pytest.mark.parametrize("preset", PRESETS)
def test_ros_loads_the_print(tmp_path: Path, preset: str) -> None:
    path = tmp_path / "print.yaml"
    path.write_text(dumped_config(preset))
    context = Context()
    rclpy.init(args=["--ros-args", "--params-file", str(path)], context=context)
    try:
        node = Node("any_name", context=context, automatically_declare_parameters_from_overrides=True)
        loaded = {name: node.get_parameter(name).value for name in values_of(preset)}
        node.destroy_node()
    finally:
        context.try_shutdown()
    assert loaded == values_of(preset)
    assert types(loaded) == types(values_of(preset))


@pytest.mark.parametrize(("name", "preset"), [("lane_detector.yaml", "default"), ("paper.yaml", "paper")])
def test_the_files_in_config_are_the_print(name: str, preset: str) -> None:
    assert (CONFIG / name).read_text() == dumped_config(preset), f"run lane_dp dump-config --preset {preset}"


def test_every_parameter_has_meaning_unit_range_and_default() -> None:
    specs = {
        "speed": Parameter("speed", 1e-7, "How fast.", "m/s", 0.0, 5.0),
        "stage.mode": Parameter("stage.mode", "a", "What.", choices=("a", "b")),
        "stage.on": Parameter("stage.on", True, "Whether."),
        "stage.size": Parameter("stage.size", 3, "How big.", "px", 1, 9, step=2),
        "seed": Parameter("seed", 1, "Which."),
    }
    defaults = {**specs, "speed": Parameter("speed", 2.0, "How fast.", "m/s", 0.0, 5.0)}
    text = parameter_file(specs, defaults, "Title")
    assert text == PRINTED
    assert yaml.safe_load(text)["/**"]["ros__parameters"]["speed"] == 1e-7


def test_the_command_prints_it(capsys: pytest.CaptureFixture) -> None:
    assert main(["dump-config", "--preset", "paper"]) == 0
    assert capsys.readouterr().out == dumped_config("paper")


def test_a_file_may_give_a_few_values_on_top_of_a_preset(tmp_path: Path) -> None:
    path = tmp_path / "few.yaml"
    path.write_text("lane_detector: {ros__parameters: {sync_tolerance: 0.02, disparity: {P1: 100}}}")
    node, detector = load_config("paper", path)
    assert node.sync_tolerance == 0.02
    assert detector.disparity.P1 == 100
    assert detector.vanishing_point.method == "dense"
    assert load_config("default", None)[1].vanishing_point.method == "arc"


OLD_NAMES = {  # with another value than the default's
    "lane_graph.feature": ("paint_map.feature", "edges_and_grey"),
    "lane_graph.edge_weight": ("paint_map.edge_weight", 0.5),
    "lane_graph.contrast_min": ("paint_map.contrast_min", 0.3),
    "lane_graph.contrast_max": ("paint_map.contrast_max", 2.5),
    "lane_selection.lane_width_min": ("parallel.lane_width_min", 2.25),
    "lane_selection.lane_width_max": ("parallel.lane_width_max", 5.0),
    "tracking.bridge_time": ("tracking.coast_time", 0.4),
}


@pytest.mark.parametrize("old", OLD_NAMES)
def test_an_old_name_is_taken_with_a_warning(tmp_path: Path, capsys: pytest.CaptureFixture, old: str) -> None:
    new, value = OLD_NAMES[old]
    stage, field = old.split(".")
    path = tmp_path / "old.yaml"
    path.write_text(f"/**: {{ros__parameters: {{{stage}: {{{field}: {value}}}}}}}")
    _, detector = load_config("default", path)
    assert detector == replaced(DetectorConfig(), {new: value}) != DetectorConfig()
    assert capsys.readouterr().err == f"lane_dp: {path}: {old} is {new} now, take that name\n"


def test_of_an_old_name_and_that_of_today_the_latter_counts(tmp_path: Path) -> None:
    path = tmp_path / "both.yaml"
    path.write_text("/**: {ros__parameters: {tracking: {coast_time: 0.3, bridge_time: 0.4}}}")
    assert load_config("default", path)[1].tracking.coast_time == 0.3


SMALLER = "disparity.correlation_window_size and speckle_size count larger pixels now, leave them out, too"
JUDGED = "lane_selection.evidence_model judges lines, lane_selection.confidence_min says how sure it must be"
REMOVED = {  # with the values that they had, and why there is no need of them
    "disparity.disparity_range": (128, f"it follows from the camera's height and the image; {SMALLER}"),
    "disparity.downscale": (2, f"it follows from the camera's height and the image; {SMALLER}"),
    "road_profile.roll": ("true", "the cross slope is always measured, but by road_profile.model quadratic"),
    "road_profile.residual_threshold": (1.0, "it follows from what the matcher resolves"),
    "lane_selection.contrast_min": (0.1, JUDGED),
    "lane_selection.roughness_max": (0.2, JUDGED),
    "lane_selection.score_alone": (3.0, JUDGED),
    "lane_selection.score_min": (1.9, JUDGED),
    "lane_selection.slope_max": (0.14, JUDGED),
    "lane_selection.start_max": (22.0, JUDGED),
    "lane_selection.texture_max": (0.2, JUDGED),
}


@pytest.mark.parametrize("name", REMOVED)
def test_a_parameter_that_is_no_more_is_left_out_with_a_warning(
    tmp_path: Path, capsys: pytest.CaptureFixture, name: str
) -> None:
    """What stands beside it in the file counts."""
    value, reason = REMOVED[name]
    stage, field = name.split(".")
    path = tmp_path / "old.yaml"
    path.write_text(f"/**: {{ros__parameters: {{{stage}: {{{field}: {value}}}, sync_tolerance: 0.02}}}}")
    node, detector = load_config("default", path)
    assert node == replaced(NodeConfig(), {"sync_tolerance": 0.02})
    assert detector == DetectorConfig()
    assert capsys.readouterr().err == f"lane_dp: {path}: {name} is no more, left out: {reason}\n"


def test_an_evaluation_reads_its_file_once(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    """Whoever detects and whoever draws the report has the same parameters; what is wrong is said once."""
    path = tmp_path / "old.yaml"
    path.write_text("/**: {ros__parameters: {road_profile: {roll: true}}}")
    choice = DetectorChoice(config=path)
    assert choice.configs is choice.configs
    assert len(capsys.readouterr().err.splitlines()) == 1


def test_a_parameter_that_is_no_more_is_not_printed() -> None:
    assert not set(REMOVED) & set(all_parameters(expert=True))


def test_what_a_running_node_has_can_be_kept_in_a_file(tmp_path: Path) -> None:
    """As `ros2 param dump` writes it: with the parameters of ROS itself, names nested at their dots."""
    context = Context()
    rclpy.init(context=context)
    try:
        node = LaneDetectorNode(context=context)
        node.set_parameters([RosParameter("disparity.P1", value=100)])
        values = {name: node.get_parameter(name).value for name in node.list_parameters([], 0).names}
        node.destroy_node()
    finally:
        context.try_shutdown()
    assert {"use_sim_time", "start_type_description_service"} <= set(values)
    tree: dict = {}
    for name, value in values.items():
        *stages, last = name.split(".")
        branch = tree
        for stage in stages:
            branch = branch.setdefault(stage, {})
        branch[last] = value
    path = tmp_path / "dump.yaml"
    path.write_text(yaml.safe_dump({"/lane_detector": {"ros__parameters": tree}}))
    _, detector = load_config("paper", path)
    assert detector == replaced(DetectorConfig(), {"disparity.P1": 100})


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a: [", "cannot be read"),
        ("- 1", "is no ROS parameter file"),
        ("/**: {parameters: {}}", "is no ROS parameter file"),
        (
            "a: {ros__parameters: {}}\nb: {ros__parameters: {}}",
            "is for /a, /b, expected parameters for lane_d",
        ),
        ("/**: {ros__parameters: {no_such: 1}}", "no_such: no such parameter"),
        ("/**: {ros__parameters: {lane_graph: {no_such: 1}}}", "lane_graph.no_such: no such parameter"),
        ("/**: {ros__parameters: {tracking: {bridge_time: -1.0}}}", "tracking.coast_time: got -1.0"),
        ("/**: {ros__parameters: {sync_tolerance: 9.0}}", "sync_tolerance: got 9.0, expected 0 to 0.5"),
        ("/**: {ros__parameters: {disparity: {P1: many}}}", "disparity.P1: got 'many'"),
        (
            "/**: {ros__parameters: {sync_tolerance: " + "9" * 400 + "}}",
            r"sync_tolerance: 9{40}\.\.\. has more",
        ),
        ("/**: {ros__parameters: {sync_tolerance: " + "9" * 5000 + "}}", "cannot be read: Exceeds the limit"),
        ("/**: {ros__parameters: {sync_tolerance: .inf}}", "sync_tolerance: got inf"),
        ("/**: {ros__parameters: {seed: !!int ''}}", "cannot be read"),
        ("/**: {ros__parameters: {seed: &a {b: *a}}}", "ROS takes no aliases"),
        ("a: &a [1]\n/**: {ros__parameters: {seed: *a}}", "ROS takes no aliases"),
        ("/**: {ros__parameters: {seed: " + "[" * 3000 + "}}", "nested deeper than 50 levels"),
        ("/**: {ros__parameters: {seed: 1}}" + " " * 1_000_000, "more than 1000000 bytes"),
    ],
)
def test_a_bad_file_is_one_line(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "bad.yaml"
    path.write_text(text)
    with pytest.raises(CommandError, match=message) as caught:
        load_config("default", path)
    assert "\n" not in str(caught.value)
    assert str(path) in str(caught.value)


def test_a_file_that_is_missing(tmp_path: Path) -> None:
    with pytest.raises(CommandError, match="cannot be read"):
        load_config("default", tmp_path / "none.yaml")


HEIGHT = "ros__parameters: {road_profile: {camera_height: 1.5}}"


@pytest.mark.parametrize(
    "text",
    [
        f"/**: {{{HEIGHT}}}",
        f"lane_detector: {{{HEIGHT}}}",
        f"/lane_detector: {{{HEIGHT}}}",
        f"/stereo/lane_detector: {{{HEIGHT}}}",
        f"stereo: {{lane_detector: {{{HEIGHT}}}}}",
        f"/**: {{lane_detector: {{{HEIGHT}}}}}",
        f"/*: {{{HEIGHT}}}",
        f"my_lanes: {{{HEIGHT}}}",
        f"other: {{ros__parameters: {{gain: 3}}}}\nlane_detector: {{{HEIGHT}}}",
        f"lane_detector: {{{HEIGHT}}}\n/**: {{ros__parameters: {{road_profile.camera_height: 1.0}}}}",
        "lane_detector: {ros__parameters: {road_profile.camera_height: 1.5}}",
        f"\ufefflane_detector: {{{HEIGHT}}}",
    ],
)
def test_a_file_for_several_nodes_is_read_for_ours(tmp_path: Path, text: str) -> None:
    path = tmp_path / "vehicle.yaml"
    path.write_text(text, encoding="utf-8")
    assert read_parameter_file(path)["road_profile.camera_height"] == 1.5
    assert load_config("default", path)[1].road_profile.camera_height == 1.5


SCALARS = (
    "2e-2",
    "1e3",
    "5.",
    ".5",
    "+3",
    "-0x1F",
    "010",
    "08",
    "1_000",
    "1:30",
    "y",
    "No",
    "on",
    "2024-01-01",
)


def test_scalars_are_read_as_ros_reads_them(tmp_path: Path) -> None:
    path = tmp_path / "scalars.yaml"
    lines = [f"    p{number}: {text}" for number, text in enumerate(SCALARS)]
    path.write_text("/**:\n  ros__parameters:\n" + "\n".join(lines) + "\n")
    context = Context()
    rclpy.init(args=["--ros-args", "--params-file", str(path)], context=context)
    try:
        node = Node("any_name", context=context, automatically_declare_parameters_from_overrides=True)
        by_ros = {f"p{number}": node.get_parameter(f"p{number}").value for number in range(len(SCALARS))}
        node.destroy_node()
    finally:
        context.try_shutdown()
    ours = read_parameter_file(path)
    assert ours == by_ros
    assert types(ours) == types(by_ros)
