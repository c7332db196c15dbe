# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""lane_dp evaluate --surface, end to end: rendered pairs with the disparity that LiDAR would see."""

import json
import shutil

import cv2
import numpy as np
import pytest

from lane_dp_ros.scenes import CAMERA, SIZE
from lane_dp_ros.tools.cli import main

P_LEFT = CAMERA.P_left
P_RIGHT = P_LEFT - np.array([[0, 0, 0, CAMERA.fx * CAMERA.baseline], [0] * 4, [0] * 4])
PITCH, HEIGHT = 0.012, 1.65  # of the rendered camera above its flat road


def lidar(depth_factor=1.0):
    """Return the road's disparity * 256 (H, W), one pixel in six, of a road so many times as far away."""
    slope = (np.arange(SIZE[1]) - CAMERA.cy) / CAMERA.fy
    rows = CAMERA.fx * CAMERA.baseline * (slope * np.cos(PITCH) + np.sin(PITCH)) / HEIGHT / depth_factor
    scanned = np.random.default_rng(0).uniform(size=SIZE[::-1]) < 1 / 6
    return np.where(scanned & (rows > 3)[:, None], np.rint(rows[:, None] * 256), 0).astype(np.uint16)


def calibration():
    lines = {"P_rect_02": P_LEFT, "P_rect_03": P_RIGHT}
    return "".join(f"{name}: {' '.join(map(str, P.ravel()))}\n" for name, P in lines.items())


@pytest.fixture
def folder(tmp_path, scene_pairs):
    """Return a folder of two pairs, the first with LiDAR."""
    root = tmp_path / "made"
    for i, pair in enumerate(scene_pairs[:2]):
        write(root / f"image_2/00000{i}_10.png", pair.left)
        write(root / f"image_3/00000{i}_10.png", pair.right)
    write(root / "disp_occ_0/000000_10.png", lidar())
    (root / "calib_cam_to_cam.txt").write_text(calibration())
    return root


def write(path, picture):
    path.parent.mkdir(parents=True, exist_ok=True)
    assert cv2.imwrite(str(path), picture)


def evaluate(*arguments):
    return main(["evaluate", *map(str, arguments), "--jobs", "1"])


def measured(tmp_path, *arguments):
    assert evaluate(*arguments, "--json", tmp_path / "out.json") == 0
    return json.loads((tmp_path / "out.json").read_text())


def failed(capsys, *arguments):
    """Return the one line that a known error is."""
    assert evaluate(*arguments) == 1
    (text,) = capsys.readouterr().err.splitlines()
    return text


def test_the_rendered_road(tmp_path, folder, capsys):
    found = measured(tmp_path, "--surface", folder)
    depth = found["total"]["depth"]
    assert (depth["frames"], depth["no_surface"], found["total"]["frames"]) == (1, 0, 1)
    assert list(depth["bias"]) == ["8", "12", "18", "25"]
    assert max(abs(error) for error in depth["bias"].values()) < 0.04
    (frame,) = found["frames"]
    assert frame["name"] == "made/000000_10"
    assert frame["depth_errors"] == [point["bias"] for point in depth["curve"]] and len(depth["curve"]) == 25
    printed = capsys.readouterr().out
    assert "depth %" in printed and "note: 1 pairs without LiDAR disparity, left out" in printed
    assert "precision" not in printed


def test_a_road_that_is_2_per_cent_nearer_is_measured_2_per_cent_deeper(tmp_path, folder):
    right = measured(tmp_path, "--surface", folder)["total"]["depth"]["curve"]
    write(folder / "disp_occ_0/000000_10.png", lidar(1 / 1.02))
    deep = measured(tmp_path, "--surface", folder)["total"]["depth"]["curve"]
    for before, after in zip(right[2:20], deep[2:20], strict=True):  # 8 to 25 m
        assert after["bias"] - before["bias"] == pytest.approx(0.02, abs=0.003)


def test_a_pair_without_a_surface_is_counted_apart(tmp_path, folder, capsys):
    white = np.full((SIZE[1], SIZE[0], 3), 255, np.uint8)
    for side in (2, 3):
        write(folder / f"image_{side}/000000_10.png", white)
    found = measured(tmp_path, "--surface", folder, "--report", tmp_path / "page")
    depth = found["total"]["depth"]
    assert (depth["frames"], depth["no_surface"], depth["bias"]["8"]) == (1, 1, None)
    assert found["frames"][0]["depth_errors"] is None
    rows = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert ["total", *["-"] * 8, "1"] in rows
    assert "1 frames, 1 of them without a surface" in (tmp_path / "page/index.html").read_text()


def test_frames_whose_lidar_shows_no_road(tmp_path, folder, capsys):
    write(folder / "disp_occ_0/000001_10.png", np.zeros(SIZE[::-1], np.uint16))
    assert measured(tmp_path, "--surface", folder)["total"]["frames"] == 1
    assert "note: 1 frames whose LiDAR shows no road, left out" in capsys.readouterr().out
    (folder / "disp_occ_0/000000_10.png").unlink()
    assert "LiDAR disparity of none of its 1 frames shows a road" in failed(capsys, "--surface", folder)


def test_as_the_official_files_unpack(tmp_path, folder):
    """In training/, with a calibration for each pair."""
    before = measured(tmp_path, "--surface", folder)["total"]["depth"]["bias"]
    training = tmp_path / "data_scene_flow/training"
    shutil.copytree(folder, training)
    (training / "calib_cam_to_cam.txt").unlink()
    for i in range(2):
        path = training / f"calib_cam_to_cam/00000{i}.txt"
        path.parent.mkdir(exist_ok=True)
        path.write_text(calibration())
    found = measured(tmp_path, "--surface", training.parent)
    assert found["total"]["depth"]["bias"] == before
    assert found["frames"][0]["name"] == "data_scene_flow/000000_10"


def test_the_page(tmp_path, folder, capsys):
    assert evaluate("--surface", folder, "--report", tmp_path / "page") == 0
    assert f"report: {tmp_path / 'page/index.html'}" in capsys.readouterr().out
    page = (tmp_path / "page/index.html").read_text()
    assert 'class="band one"' in page and "made/<wbr>000000_<wbr>10" in page and "$" not in page
    assert evaluate("--surface", folder, "--report", tmp_path / "page") == 0  # replaced by its like


def test_parameters(tmp_path, folder):
    (tmp_path / "p.yaml").write_text(
        "lane_detector:\n  ros__parameters:\n    road_profile.camera_height: 5.0\n"
    )
    found = measured(tmp_path, "--surface", folder, "--config", tmp_path / "p.yaml")
    assert found["total"]["depth"]["no_surface"] == 1  # 1.65 m is no height for it
    paper = measured(tmp_path, "--surface", folder, "--preset", "paper")
    assert paper["total"]["depth"]["no_surface"] == 0


def test_processes_change_nothing(tmp_path, folder):
    write(folder / "disp_occ_0/000001_10.png", lidar())
    one = measured(tmp_path, "--surface", folder)
    assert (
        main(["evaluate", "--surface", str(folder), "--jobs", "2", "--json", str(tmp_path / "two.json")]) == 0
    )
    two = json.loads((tmp_path / "two.json").read_text())
    assert two["total"]["depth"] == one["total"]["depth"]


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (shutil.rmtree, "made: no such folder"),
        (lambda root: shutil.rmtree(root / "image_3"), "made has no stereo images: looked for image_2"),
        (lambda root: (root / "image_3/000001_10.png").unlink(), "000001_10.png has no partner"),
        (lambda root: shutil.rmtree(root / "disp_occ_0"), "no LiDAR disparity of any of the 2 images"),
        (lambda root: (root / "calib_cam_to_cam.txt").unlink(), "no calibration: looked for"),
        (lambda root: (root / "calib_cam_to_cam.txt").write_text("P_rect_02: 1"), "'P_rect_02: ' with 12"),
        (
            lambda root: write(root / "disp_occ_0/000000_10.png", np.ones(SIZE[::-1], np.uint8)),
            "000000_10.png is uint8 gray, expected uint16 gray",
        ),
        (
            lambda root: write(root / "disp_occ_0/000000_10.png", np.ones((*SIZE[::-1], 3), np.uint16)),
            "000000_10.png is uint16 colour, expected uint16 gray",
        ),
        (
            lambda root: (root / "disp_occ_0/000000_10.png").write_bytes(b"no picture"),
            "000000_10.png cannot be read as a picture",
        ),
        (
            lambda root: write(root / "disp_occ_0/000000_10.png", np.ones((300, 400), np.uint16)),
            "000000_10.png is 400x300, its left image 1242x375, expected equal",
        ),
        (
            lambda root: write(root / "image_3/000000_10.png", np.ones((300, 400), np.uint8)),
            "expected equal pictures",
        ),
        (
            lambda root: write(root / "disp_occ_0/000007_10.png", np.ones(SIZE[::-1], np.uint16)),
            "000007_10.png has no left image",
        ),
    ],
)
def test_what_cannot_be_judged_is_named_in_one_line(folder, capsys, spoil, message):
    spoil(folder)
    assert message in failed(capsys, "--surface", folder)


@pytest.mark.parametrize("arguments", [(), ("DIR", "--surface", "DIR"), ("--surface", "DIR", "--unpainted")])
def test_one_thing_is_judged(folder, capsys, arguments):
    with pytest.raises(SystemExit, match="2"):
        evaluate(*(folder if each == "DIR" else each for each in arguments))
    assert "--surface" in capsys.readouterr().err


def test_a_limit_for_lanes_says_that_there_are_none(folder, capsys):
    assert "precision is not known" in failed(capsys, "--surface", folder, "--min-precision", 0.5)


def test_kitti(tmp_path, kitti_data):
    found = measured(tmp_path, "--surface", kitti_data / "kitti_stereo_2015")
    depth = found["total"]["depth"]
    assert depth["frames"] == 52 and depth["no_surface"] <= 1
    assert abs(depth["bias"]["8"]) < 0.01 and depth["spread"]["8"] < 0.02
