# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The benchmarks of speed: what they count, and that they run."""

import os
import sys
import time
from itertools import islice

import bench_node
import matcher_ratio
import numpy as np
import pytest

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.messages.bag_message import typestore
from lane_dp_ros.messages.stamp import stamp_from_ros
from lane_dp_ros.messages.stereo_bag import StereoImages

STAMP_NS = 1_700_000_123_456_789_012


def small_drive(count):
    images = [np.full((4, 6), 10 * i, np.uint8) for i in range(2 * count)]
    pairs = [StereoImages(i, images[2 * i], images[2 * i + 1]) for i in range(count)]
    P_left = np.array([[700.0, 0, 3, 0], [0, 700, 2, 0], [0, 0, 1, 0]])
    return bench_node.Drive("small", pairs, P_left, P_left - np.eye(3, 4, 3) * 350)


def test_ratios_are_medians_over_pairs_and_rounds_of_what_ran_side_by_side():
    detector = np.array([[1.0, 2.0, 3.0], [1.0, 4.0, 30.0], [1.0, 6.0, 3.0]])
    timings = matcher_ratio.Timings(
        {
            matcher_ratio.DETECTOR: detector,
            matcher_ratio.STEREO: 0.5 * detector,
            matcher_ratio.SGBM: detector * [2, 4, 5],
            matcher_ratio.BM: np.full((3, 3), 2.0),
        }
    )
    assert timings.ratio(matcher_ratio.SGBM) == 0.25
    assert timings.ratio(matcher_ratio.BM) == 1.5
    assert timings.ratio(matcher_ratio.SGBM, matcher_ratio.STEREO) == 0.125
    assert timings.slowest == pytest.approx(4 / 3)  # pairs take 1, 4 and 3 in the median; one outlier is none
    assert "| **detector / SGBM 3WAY** | **0.25** |" in timings.lines()
    assert "| **stereo stage / SGBM 3WAY** | **0.125** |" in timings.lines()
    assert "| **slowest pair / median pair** | **1.33** |" in timings.lines()


def test_the_detector_and_both_matchers_are_measured(pairs):
    timings = matcher_ratio.measure([(pair.camera, pair.frame) for pair in pairs], rounds=2)
    assert {name: seconds.shape for name, seconds in timings.seconds.items()} == {
        "detector": (2, 2),
        "stereo stage": (2, 2),
        "SGBM 3WAY": (2, 2),
        "StereoBM": (2, 2),
    }
    assert all((seconds > 1e-3).all() for seconds in timings.seconds.values())


def test_the_matcher_is_that_of_the_product_at_full_resolution(pairs):
    config = DetectorConfig().disparity
    matcher = matcher_ratio.sgbm(config)
    assert (matcher.getNumDisparities(), matcher.getBlockSize(), matcher.getMode()) == (128, 7, 2)
    assert (matcher.getP1(), matcher.getP2(), matcher.getUniquenessRatio()) == (400, 1600, 10)
    frame = pairs[0].frame
    disparity = matcher.compute(frame.left, frame.right)
    assert disparity.shape == frame.left.shape and np.mean(disparity > 0) > 0.3


@pytest.mark.parametrize(
    ("count", "first"), [(1, [0, 0, 0]), (2, [0, 1, 0, 1]), (3, [0, 1, 2, 1, 0, 1, 2, 1, 0])]
)
def test_a_drive_goes_there_and_back(count, first):
    assert list(islice(bench_node.there_and_back(count), len(first))) == first


def test_a_stamp_is_set_in_the_bytes_of_every_message():
    drive = small_drive(2)
    found = {}
    for topic, type_name, data in drive.messages(1):
        bench_node.set_stamp(data, STAMP_NS)
        message = found[topic] = typestore().deserialize_cdr(bytes(data), type_name)
        assert stamp_from_ros(message.header.stamp) == STAMP_NS
        assert message.header.frame_id == "left_camera_optical_frame"
    assert list(found) == ["left/camera_info", "right/camera_info", "left/image_rect", "right/image_rect"]
    assert [found[f"{side}/image_rect"].data[0] for side in ("left", "right")] == [20, 30]
    assert [found[f"{side}/camera_info"].p[3] for side in ("left", "right")] == [0, -350]


def test_what_is_not_answered_has_no_latency():
    sent = {10: 1_000_000, 20: 2_000_000, 30: 3_000_000}
    found = bench_node.latencies(sent, {10: 31_000_000, 30: 53_000_000, 99: 1})
    assert found.tolist() == [30.0, 50.0]


def test_a_row_says_what_became_of_the_pairs():
    measured = bench_node.Measured(10.0, 5, 0, np.array([30.0, 50.0, 40.0, 40.0]), 0.456)
    assert measured.row() == "| 10 | 4 of 5 (80%) | 0 | 1 | 40 | 48 | 46% |"
    none = bench_node.Measured(30.0, 4, 3, np.empty(0), 0.0)
    assert none.row() == "| 30 | 0 of 4 (0%) | 3 | 1 | nan | nan | 0% |"
    assert bench_node.HEADS.splitlines()[0].count("|") == measured.row().count("|")


@pytest.mark.skipif(sys.platform != "linux", reason="/proc is Linux's")
def test_the_cpu_time_is_that_of_the_process():
    before, start = bench_node.cpu_seconds(os.getpid()), time.process_time()
    while time.process_time() - start < 0.2:
        pass
    assert bench_node.cpu_seconds(os.getpid()) - before == pytest.approx(0.2, abs=0.05)
    assert np.isnan(bench_node.cpu_seconds(2**22 + 1))  # more than a process can have


def test_the_node_answers_what_is_published(tmp_path, monkeypatch, capsys):
    pytest.importorskip("rclpy", reason="the node needs ROS 2")
    monkeypatch.setattr(bench_node, "RENDERED", 3)
    arguments = ["--data", str(tmp_path), "-o", str(tmp_path / "out"), "--seconds", "2", "--rates", "3"]
    monkeypatch.setattr(sys, "argv", ["bench_node", *arguments])
    assert bench_node.main() == 0
    printed = capsys.readouterr().out
    assert printed == (tmp_path / "out" / "node.md").read_text()
    assert "rendered, 1242x375, 2 s at each rate" in printed
    (row,) = [line for line in printed.splitlines() if line.startswith("| 3 |")]
    _, rate, answered, dropped, lost, p50, p95, cpu, _ = (cell.strip() for cell in row.split("|"))
    assert (rate, answered, dropped, lost) == ("3", "6 of 6 (100%)", "0", "0")
    assert 5 < int(p50) <= int(p95) < 5000
    assert 1 <= int(cpu.rstrip("%")) < 300


@pytest.mark.parametrize("given", [["--rates", "10,0"], ["--rates", "x"], ["--seconds", "0"]])
def test_what_cannot_be_measured_is_said(given, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["bench_node", *given])
    with pytest.raises(SystemExit, match="2"):
        bench_node.main()
    assert given[1] in capsys.readouterr().err
