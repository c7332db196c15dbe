# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""lane_dp evaluate, end to end: bags with lanes or images, folders of images; exit codes and files."""

import json
from dataclasses import replace

import cv2
import numpy as np
import pytest

from lane_dp_ros.core.types import Lane
from lane_dp_ros.messages.bag import BagReader, BagWriter
from lane_dp_ros.messages.bag_message import bag_message
from lane_dp_ros.messages.lanes import lanes_to_ros
from lane_dp_ros.messages.stamp import stamp_to_ros
from lane_dp_ros.scenes import CAMERA
from lane_dp_ros.tools.cli import main
from lane_dp_ros.tools.evaluation.truth_file import Label, LabelledFrame, load_truth, save_truth

HEIGHT = 1.65
SECOND = 1_000_000_000
STAMPS = [5 * SECOND + i * SECOND // 10 for i in range(6)]


def line(x):
    z = np.arange(5.0, 28.0, 0.5)
    return np.column_stack([np.full_like(z, x), np.full_like(z, HEIGHT), z])


def lane(x, identity):
    return Lane(line(x), 0.9, 0.12, "ego_left" if x < 0 else "ego_right", 0.0, x, identity)


def labelled(name, stamp_ns, lines=None, **fields):
    """Return a frame whose lines (N, 3) lie left and right of the vehicle."""
    lines = (line(-1.8), line(1.8)) if lines is None else lines
    points = dict(zip("LR", lines, strict=True))
    labels = tuple(Label(i, "solid", True, CAMERA.project(p), p[:, [0, 2]]) for i, p in points.items())
    return LabelledFrame(name, CAMERA, (1242, 375), ground(lines), labels, "L", "R", stamp_ns, **fields)


def ground(lines):
    """Return the ground whose disparity is nearest to that of the lines' points."""
    points = np.vstack(lines)
    m, n = ((CAMERA.project(points) - (CAMERA.cx, CAMERA.cy)) / 100).T
    powers = np.column_stack([np.ones_like(n), n, n**2, m])
    return np.linalg.lstsq(powers, CAMERA.fx * CAMERA.baseline / points[:, 2], rcond=None)[0]


@pytest.fixture
def truth(tmp_path):
    save_truth(
        [labelled(f"made/{i}", ns, category="straight") for i, ns in enumerate(STAMPS)], tmp_path / "t.json"
    )
    return tmp_path / "t.json"


@pytest.fixture
def write_lanes(tmp_path):
    """Return a function that writes {stamp [ns]: lanes} to a bag, each recorded 30 ms after its image."""

    def write(lanes_by_stamp, name="lanes", image_stamps=(), change=lambda message: message, road_edges=()):
        with BagWriter(tmp_path / name) as writer:
            for ns in image_stamps:
                header = bag_message("std_msgs/msg/Header", stamp=stamp_to_ros(ns, bag_message))
                image = bag_message("sensor_msgs/msg/Image", header=header)
                writer.write("/car/left/image_rect", ns + 7, image)
                writer.write("/car/right/image_rect", ns + 9, image)
            for ns, lanes in lanes_by_stamp.items():
                header = bag_message("std_msgs/msg/Header", stamp=stamp_to_ros(ns, bag_message))
                message = change(lanes_to_ros(lanes, header, bag_message, 0.3))
                writer.write("/car/lanes", ns + 9 + 30_000_000, message)
            for ns, edges in dict(road_edges).items():
                header = bag_message("std_msgs/msg/Header", stamp=stamp_to_ros(ns, bag_message))
                writer.write("/car/road_edges", ns, lanes_to_ros(edges, header, bag_message, 0.3))
        return tmp_path / name

    return write


ROW = "made 12 0 0 1.000 1.000 1.000 1.000 0.00 0.00 0.000 0.000 0 0.000 30.0"
PERFECT = {ns: (lane(-1.8, 1), lane(1.8, 2)) for ns in STAMPS}


def evaluate(*arguments):
    return main(["evaluate", *map(str, arguments), "--jobs", "1"])


def failed(capsys, *arguments):
    """Return the one line that a known error is."""
    assert evaluate(*arguments) == 1
    (text,) = capsys.readouterr().err.splitlines()
    return text


def measured(tmp_path, *arguments):
    assert evaluate(*arguments, "--json", tmp_path / "out.json") == 0
    return json.loads((tmp_path / "out.json").read_text())


def test_recorded_lanes(tmp_path, truth, write_lanes, capsys):
    found = measured(tmp_path, write_lanes(PERFECT, image_stamps=STAMPS), "--truth", truth)
    total = found["total"]
    assert (total["frames"], total["total_lane_markings"], total["incorrect"], total["missed"]) == (
        6,
        12,
        0,
        0,
    )
    assert total["precision"] == total["recall"] == total["detection_precision"] == 1.0
    assert total["error"] < 1e-3 and total["jitter"] < 1e-3
    assert (total["id_switches"], total["id_chances"]) == (0, 10)
    assert total["latency"] == pytest.approx(0.03)
    assert found["sequences"]["made"] == found["categories"]["straight"] == total
    assert {match["label"] for match in found["frames"][0]["matches"]} == {"L", "R"}
    printed = capsys.readouterr().out.splitlines()
    head = "sequence   markings  incorrect  missed  precision  recall  precision  strict  per frame"
    assert printed[1].split()[: len(head.split())] == head.split()
    assert printed[2].split() == ROW.split()
    assert any(text.startswith("category") for text in printed)


def test_recorded_road_edges(tmp_path, truth, write_lanes):
    """Of the topic beside the lanes'; none in a frame without an answer, or without a message there."""
    with_edge = [replace(f, labels=(*f.labels, edge_label(4.0))) for f in load_truth(truth)]
    save_truth(with_edge, truth)
    lanes = {ns: found for ns, found in PERFECT.items() if ns != STAMPS[2]}
    edges = {ns: (lane(4.05, 3), lane(-6.0, 4)) for ns in STAMPS[:4] if ns != STAMPS[2]}
    found = measured(tmp_path, write_lanes(lanes, road_edges=edges), "--truth", truth)
    judged = found["total"]["road_edges"]
    assert (judged["frames"], judged["labels"], judged["matched"], judged["detections"]) == (6, 6, 3, 6)
    assert (judged["recall"], judged["false_per_frame"]) == (0.5, 0.5)
    assert found["total"]["detections"] == 10
    without = measured(tmp_path, write_lanes(lanes, "without"), "--truth", truth)["total"]["road_edges"]
    assert (without["frames"], without["labels"], without["recall"]) == (0, 0, None)


def edge_label(x):
    return Label("E", "edge", True, CAMERA.project(line(x)), line(x)[:, [0, 2]])


def test_latency_is_not_known_without_the_images(tmp_path, truth, write_lanes):
    assert measured(tmp_path, write_lanes(PERFECT), "--truth", truth)["total"]["latency"] is None


def test_a_frame_without_an_answer_counts_as_nothing_found(tmp_path, truth, write_lanes, capsys):
    lanes = {ns: found for ns, found in PERFECT.items() if ns not in STAMPS[1:3]}
    total = measured(tmp_path, write_lanes(lanes), "--truth", truth)["total"]
    assert (total["frames"], total["missed"]) == (6, 4)
    assert "note: 2 frames without an answer, judged as nothing found" in capsys.readouterr().out


def test_frames_outside_the_bag_are_left_out(tmp_path, truth, write_lanes, capsys):
    bag = write_lanes(dict(list(PERFECT.items())[:4]))
    assert measured(tmp_path, bag, "--truth", truth)["total"]["frames"] == 4
    assert "note: 2 frames of the truth lie outside the bag's time, left out" in capsys.readouterr().out


def test_a_detector_that_fell_silent_is_not_let_off(tmp_path, truth, write_lanes):
    bag = write_lanes(dict(list(PERFECT.items())[:4]), image_stamps=STAMPS)
    assert measured(tmp_path, bag, "--truth", truth)["total"]["missed"] == 4


def test_unpainted(tmp_path, write_lanes, capsys):
    bag = write_lanes({STAMPS[0]: (lane(0.5, 1),), STAMPS[1]: ()})
    total = measured(tmp_path, bag, "--unpainted")["total"]
    assert (total["frames"], total["false_lanes"], total["precision"]) == (2, 1, None)
    text = failed(capsys, bag, "--unpainted", "--max-false-per-frame", 0)
    assert text == "lane_dp: false lanes per frame 0.5000 is above --max-false-per-frame 0 by 0.5"


def test_thresholds(truth, write_lanes, capsys):
    half = {ns: found[:1] for ns, found in PERFECT.items()}
    bag = write_lanes(half)
    assert evaluate(bag, "--truth", truth, "--min-precision", 0.5, "--max-error", 0.01) == 0
    capsys.readouterr()
    text = failed(capsys, bag, "--truth", truth, "--min-precision", 0.9, "--min-recall", 0.6)
    assert text == (
        "lane_dp: precision 0.5000 is below --min-precision 0.9 by 0.4; "
        "recall 0.5000 is below --min-recall 0.6 by 0.1"
    )
    empty = write_lanes(dict.fromkeys(STAMPS, ()), "empty")
    text = failed(capsys, empty, "--truth", truth, "--min-detection-precision", 0.5)
    assert "detection precision is not known, there is nothing to count" in text


@pytest.mark.parametrize("option", ["--min-precision=nan", "--max-error=-1", "--jobs=0", "--report"])
def test_wrong_usage(option):
    with pytest.raises(SystemExit, match="2"):
        main(["evaluate", "bag", "--truth", "t.json", option])


def test_images_are_detected_in_first(tmp_path, scene_pairs, write_stereo_bag):
    frames = [labelled(f"scene/{i}", p.stamp_ns, p.lanes[:2]) for i, p in enumerate(scene_pairs)]
    save_truth(frames, tmp_path / "t.json")
    bag = write_stereo_bag(scene_pairs)
    total = measured(tmp_path, bag, "--truth", tmp_path / "t.json")["total"]
    assert (total["frames"], total["total_lane_markings"]) == (3, 6)
    assert total["recall"] > 0.5 and total["id_chances"] > 0 and total["latency"] > 0
    assert total["road_edges"]["frames"] == 3
    with BagReader(bag) as reader:
        assert reader.message_count() == 12  # nothing was written to it
    assert measured(tmp_path, bag, "--unpainted")["total"]["precision"] is None


def test_a_folder_written_by_scenes(tmp_path, scene_pairs, write_stereo_bag):
    frames = [labelled(f"scene/{i}", p.stamp_ns, p.lanes[:2]) for i, p in enumerate(scene_pairs)]
    save_truth(frames, tmp_path / "truth.json")
    write_stereo_bag(scene_pairs, "scenes.mcap")
    assert measured(tmp_path, tmp_path)["total"]["frames"] == 3


def test_loose_images(tmp_path, scene_pairs, capsys):
    cv2.imwrite(str(tmp_path / "l.png"), scene_pairs[0].left)
    cv2.imwrite(str(tmp_path / "r.png"), scene_pairs[0].right)
    frame = replace(labelled("scene/0", None, scene_pairs[0].lanes[:2]), left="l.png", right="r.png")
    save_truth([frame], tmp_path / "t.json")
    total = measured(tmp_path, tmp_path, "--truth", tmp_path / "t.json")["total"]
    assert (total["frames"], total["id_chances"], total["jitter"]) == (1, 0, None)
    assert total["latency"] > 0
    for wrong, message in {
        "none.png": "none.png: no such picture",
        "t.json": "cannot be read as a picture",
    }.items():
        save_truth([replace(frame, right=wrong)], tmp_path / "w.json")
        assert message in failed(capsys, tmp_path, "--truth", tmp_path / "w.json")
    save_truth([replace(frame, left="")], tmp_path / "w.json")
    assert "frame 'scene/0' names no files" in failed(capsys, tmp_path, "--truth", tmp_path / "w.json")
    save_truth([replace(frame, size=(10, 20))], tmp_path / "w.json")
    assert "its frame in the truth 10x20" in failed(capsys, tmp_path, "--truth", tmp_path / "w.json")


def test_truth_of_another_bag(truth, write_lanes, capsys):
    bag = write_lanes({ns + 100 * SECOND: lanes for ns, lanes in PERFECT.items()})
    text = failed(capsys, bag, "--truth", truth)
    assert text == (
        f"lane_dp: truth and bag have no stamp in common: 5.000 to 5.500 s in {truth}, "
        f"105.000 to 105.500 s in {bag}"
    )


def test_truth_without_stamps(tmp_path, write_lanes, capsys):
    save_truth([labelled("a/0", None)], tmp_path / "w.json")
    assert "needs a stamp_ns of its own" in failed(
        capsys, write_lanes(PERFECT), "--truth", tmp_path / "w.json"
    )


def test_points_that_are_not_finite(truth, write_lanes, capsys):
    def spoil(message):
        message.markers[1].points[3].x = float("nan")
        return message

    bag = write_lanes(PERFECT, change=spoil)
    text = failed(capsys, bag, "--truth", truth)
    assert f"/car/lanes, stamp {STAMPS[0]} ns, marker ego_left 1 holds values that are not finite" in text


def test_bags_that_have_nothing_to_judge(tmp_path, truth, capsys):
    with BagWriter(tmp_path / "empty"):
        pass
    assert "empty is empty: no message in it" in failed(capsys, tmp_path / "empty", "--truth", truth)
    with BagWriter(tmp_path / "odd") as writer:
        writer.write("/chatter", 1, bag_message("std_msgs/msg/String", data="hello"))
    text = failed(capsys, tmp_path / "odd", "--truth", truth)
    assert "no topic named lanes to judge; to detect first" in text and "it has /chatter (1)" in text


def test_two_topics_of_lanes(tmp_path, truth, capsys):
    header = bag_message("std_msgs/msg/Header", stamp=stamp_to_ros(STAMPS[0], bag_message))
    with BagWriter(tmp_path / "two") as writer:
        for topic in ("/a/lanes", "/b/lanes"):
            writer.write(topic, 1, lanes_to_ros((), header, bag_message, 0.3))
    assert "several topics of lanes: /a/lanes, /b/lanes" in failed(capsys, tmp_path / "two", "--truth", truth)


def test_a_message_without_markers(truth, write_lanes, capsys):
    def emptied(message):
        message.markers.clear()
        return message

    assert "has no marker, so no stamp" in failed(
        capsys, write_lanes(PERFECT, change=emptied), "--truth", truth
    )


def test_parameters_for_lanes_that_are_there_already(truth, write_lanes, capsys):
    text = failed(capsys, write_lanes(PERFECT), "--truth", truth, "--preset", "paper")
    assert "judged as recorded: leave --preset and --config away" in text


def test_inputs_that_are_not_there(tmp_path, truth, write_lanes, capsys):
    assert "no such bag" in failed(capsys, tmp_path / "none", "--truth", truth)
    bag = write_lanes(PERFECT)
    assert "none.json" in failed(capsys, bag, "--truth", tmp_path / "none.json")
    assert "needs --truth FILE, or --unpainted" in failed(capsys, bag)


def test_no_file_is_lost(tmp_path, truth, write_lanes, capsys):
    bag, before = write_lanes(PERFECT), truth.read_bytes()
    assert "is no evaluation" in failed(capsys, bag, "--truth", truth, "--json", truth)
    assert truth.read_bytes() == before
    earlier = tmp_path / "out.json"
    assert measured(tmp_path, bag, "--truth", truth)["total"]["frames"] == 6
    content = earlier.read_bytes()
    assert evaluate(bag, "--truth", tmp_path / "none.json", "--json", earlier) == 1
    assert earlier.read_bytes() == content
    capsys.readouterr()
    assert "cannot write" in failed(capsys, bag, "--truth", truth, "--json", "/proc/none/out.json")
    assert measured(tmp_path, bag, "--truth", truth)["total"]["frames"] == 6  # replaced by its like


def test_labelled_kitti_frames(tmp_path, kitti_data):
    found = measured(tmp_path, kitti_data, "--truth", kitti_data / "labels" / "lanes.json")
    total = found["total"]
    assert total["total_lane_markings"] == 81
    assert total["precision"] >= 0.88
    assert total["recall"] >= 0.79
    assert total["detection_precision"] >= 0.94
    assert found["sequences"]["kitti_odometry/06"]["false_lanes"] == 0
