# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Every command that reads a bag takes the topics of any camera: guessed and told, or named."""

import subprocess
import sys
from pathlib import Path

import pytest

from lane_dp_ros.messages.bag import BagReader, BagWriter
from lane_dp_ros.tools.cli import main

REALSENSE = {"left": "/camera/camera/infra1", "right": "/camera/camera/infra2"}


def renamed(bag: Path, path: Path, *name_of: dict[str, str]) -> Path:
    """Write the bag of a stereo camera anew as those of other names; `name_of` is what each calls a side."""
    with BagReader(bag) as reader, BagWriter(path) as writer:
        for topic, time_ns, message in reader.messages():
            _, side, name = topic.split("/", 2)
            for names in name_of:
                writer.write(f"{names[side]}/{name}", time_ns, message)
    return path


def two_cars(bag: Path, path: Path) -> Path:
    return renamed(bag, path, *({side: f"/{car}/{side}" for side in ("left", "right")} for car in ("a", "b")))


@pytest.fixture
def realsense(write_stereo_bag, scene_pairs, tmp_path) -> Path:
    return renamed(write_stereo_bag(scene_pairs), tmp_path / "realsense", REALSENSE)


def lanes_of(bag: Path) -> dict[str, int]:
    with BagReader(bag) as reader:
        return {topic: reader.message_count([topic]) for topic in reader.topics if topic.endswith("/lanes")}


def test_run_tells_what_it_guesses(realsense, tmp_path, capsys) -> None:
    assert main(["run", str(realsense), "-o", str(tmp_path / "out")]) == 0
    guess = "left is /camera/camera/infra1/image_rect, right /camera/camera/infra2/image_rect"
    assert capsys.readouterr().err.splitlines() == [f"lane_dp: {realsense}: {guess}"]
    assert lanes_of(tmp_path / "out") == {"/camera/camera/lanes": 3}


@pytest.mark.parametrize(
    "named", [["--camera", "/b"], ["--left", "b/left/image_rect"], ["--right", "/b/right/image_rect"]]
)
def test_run_on_the_camera_that_is_named(write_stereo_bag, scene_pairs, tmp_path, named) -> None:
    bag = two_cars(write_stereo_bag(scene_pairs), tmp_path / "two")
    assert main(["run", str(bag), "-o", str(tmp_path / "out"), *named]) == 0
    assert lanes_of(tmp_path / "out") == {"/b/lanes": 3}


def test_evaluate_and_its_report(write_stereo_bag, scene_pairs, tmp_path, capsys) -> None:
    bag = two_cars(write_stereo_bag(scene_pairs), tmp_path / "two")
    command = ["evaluate", str(bag), "--unpainted", "--jobs", "1", "--report", str(tmp_path / "report")]
    assert main(command) == 1
    assert "name one by --camera PREFIX" in capsys.readouterr().err
    assert main([*command, "--camera", "/a"]) == 0
    page = (tmp_path / "report/index.html").read_text()
    assert "data:image/" in page
    assert "no images" not in page


def test_what_was_run_is_judged_by_the_camera_infos_beside_its_lanes(realsense, tmp_path) -> None:
    assert main(["run", str(realsense), "-o", str(tmp_path / "out")]) == 0
    assert main(["evaluate", str(tmp_path / "out"), "--unpainted"]) == 0


def test_topics_lists_the_bag_and_says_what_is_taken(realsense, capsys) -> None:
    assert main(["topics", str(realsense)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].split() == ["/camera/camera/infra1/camera_info", "3", "sensor_msgs/msg/CameraInfo"]
    assert lines[-1] == "right: /camera/camera/infra2/image_rect with /camera/camera/infra2/camera_info"


def test_topics_of_a_bag_without_a_camera(write_stereo_bag, capsys) -> None:
    assert main(["topics", str(write_stereo_bag([]))]) == 1
    assert "it has no topics; name the camera's topics: --left" in capsys.readouterr().err


def test_a_prefix_and_names_are_wrong_usage(realsense, capsys) -> None:
    with pytest.raises(SystemExit) as caught:
        main(["topics", str(realsense), "--camera", "/camera", "--left", "/camera/left"])
    assert caught.value.code == 2
    assert "expected either --camera or --left and --right" in capsys.readouterr().err


@pytest.mark.parametrize("command", ["run", "play", "evaluate", "review", "tables", "fit-evidence", "topics"])
def test_every_command_that_reads_a_bag_takes_them(command, capsys) -> None:
    with pytest.raises(SystemExit):
        main([command, "--help"])
    said = capsys.readouterr().out
    for option in (
        "--left TOPIC",
        "--right TOPIC",
        "--left-info TOPIC",
        "--right-info TOPIC",
        "--camera PREFIX",
    ):
        assert option in said


def test_a_ros_1_bag_gives_the_same_lanes(write_stereo_bag, scene_pairs, tmp_path) -> None:
    bag, old = write_stereo_bag(scene_pairs), tmp_path / "old.bag"
    conversion = [sys.executable, "-m", "rosbags.convert", "--src", str(bag), "--dst", str(old)]
    subprocess.run([*conversion, "--dst-typestore", "ros1_noetic"], check=True, capture_output=True)
    lanes = []
    for path in (bag, old):
        assert main(["run", str(path), "-o", str(tmp_path / f"lanes_of_{path.name}")]) == 0
        with BagReader(tmp_path / f"lanes_of_{path.name}") as reader:
            lanes.append([raw.data for raw in reader.raw_messages(["/lanes"])])
    assert len(lanes[0]) == 3
    assert lanes[0] == lanes[1]


def test_several_bags_of_one_vehicle(write_stereo_bag, scene_pairs, tmp_path) -> None:
    plain = write_stereo_bag(scene_pairs[:1])
    bags = [two_cars(plain, tmp_path / name) for name in ("morning", "evening")]
    assert main(["run", *map(str, bags), "-o", str(tmp_path / "out"), "--camera", "/b"]) == 0
    assert [lanes_of(tmp_path / "out" / f"{bag.name}.mcap") for bag in bags] == [{"/b/lanes": 1}] * 2


def test_a_comparison_finds_its_images_on_the_topics_that_are_named(
    write_stereo_bag, scene_pairs, tmp_path
) -> None:
    bag = two_cars(write_stereo_bag(scene_pairs), tmp_path / "two")
    judged = ["evaluate", str(bag), "--unpainted", "--jobs", "1", "--camera", "/a"]
    for name, preset in (("a", "default"), ("b", "paper")):
        assert main([*judged, "--preset", preset, "--json", str(tmp_path / f"{name}.json")]) == 0
    compared = [str(tmp_path / f"{name}.json") for name in ("a", "b")]
    report = ["--report", str(tmp_path / "changes"), "--camera", "/a"]
    assert main(["evaluate", str(bag), "--compare", *compared, *report]) == 0
    assert "several stereo cameras" not in (tmp_path / "changes/index.html").read_text()
