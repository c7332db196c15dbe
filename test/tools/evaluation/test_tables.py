# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""lane_dp tables: what is judged, what is missing, and the baseline that stands beside ours."""

import os
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from lane_dp_ros.scenes import CAMERA, Road, render_pair
from lane_dp_ros.tools.cli import main
from lane_dp_ros.tools.evaluation.detectors import baseline_detector
from lane_dp_ros.tools.evaluation.labelled_pairs import load_pairs
from lane_dp_ros.tools.evaluation.matching import judge
from lane_dp_ros.tools.evaluation.papers_tables import OURS, papers_tables
from lane_dp_ros.tools.evaluation.summary import Summary, summarise
from lane_dp_ros.tools.evaluation.truth_file import save_truth

DRIVE = "2011_09_26_drive_0027"
SOURCE = Path(__file__).resolve().parents[3]
NOON = 1317038400  # 2011-09-26 12:00:00 UTC


def row(text: str, name: str, table: int = 0) -> list[str]:
    """Return the cells of a line, without the bars, in the given one of the tables."""
    lines = [line for line in text.splitlines() if line.startswith(name)]
    return lines[table].removeprefix(name).replace("|", " ").split()


def write_drive(root: Path, pairs: list, truth: bool = True, name: str = f"{DRIVE}_sync") -> Path:
    """Write pairs as KITTI's raw data come, with their truth beside."""
    drive = root / name
    K = " ".join(map(str, CAMERA.P_left.ravel()))
    P_right = CAMERA.P_left - [[0, 0, 0, CAMERA.fx * CAMERA.baseline], [0] * 4, [0] * 4]
    for camera in (2, 3):
        (drive / f"image_{camera:02}/data").mkdir(parents=True)
    (root / "calib_cam_to_cam.txt").write_text(
        f"P_rect_02: {K}\nP_rect_03: {' '.join(map(str, P_right.ravel()))}\n"
    )
    for i, pair in enumerate(pairs):
        for camera, image in ((2, pair.left), (3, pair.right)):
            cv2.imwrite(str(drive / f"image_{camera:02}/data/{i:010}.png"), image)
    times = [f"2011-09-26 12:00:00.{i}00000000\n" for i in range(len(pairs))]
    (drive / "image_02/timestamps.txt").write_text("".join(times))
    if truth:
        stamps = [NOON * 10**9 + i * 100_000_000 for i in range(len(pairs))]
        frames = [replace(p.truth, stamp_ns=ns) for p, ns in zip(pairs, stamps, strict=True)]
        save_truth(frames, root / f"{name}.truth.json")
    return drive


@pytest.fixture
def folder(tmp_path, scene_pairs) -> Path:
    """A folder of two labelled pairs as loose images."""
    frames = []
    for i, pair in enumerate(scene_pairs[:2]):
        cv2.imwrite(str(tmp_path / f"left{i}.png"), pair.left)
        cv2.imwrite(str(tmp_path / f"right{i}.png"), pair.right)
        names = {"left": f"left{i}.png", "right": f"right{i}.png", "name": f"street/{i}"}
        frames.append(replace(pair.truth, **names, stamp_ns=None, category="", sequence=""))
    save_truth(frames, tmp_path / "truth.json")
    return tmp_path


@pytest.fixture
def detector(tmp_path_factory):
    """Return a function that writes a detector file."""

    def write(body: str, name: str = "mine.py") -> str:
        path = tmp_path_factory.mktemp("detector") / name
        path.write_text(body)
        return str(path)

    return write


def failure(capsys, *arguments: object) -> str:
    assert main(["tables", *map(str, arguments)]) == 1
    (line,) = capsys.readouterr().err.splitlines()
    return line


@pytest.mark.parametrize("jobs", ["1", "2"])
def test_a_folder_of_drives(tmp_path, scene_pairs, capsys, jobs) -> None:
    write_drive(tmp_path / "2011_09_26", scene_pairs)
    write_drive(tmp_path / "2011_09_26", scene_pairs[:1], truth=False, name="2011_09_26_drive_0028_sync")
    write_drive(tmp_path / "2011_09_26", scene_pairs[:1], name="2011_09_26_drive_0001_sync")
    assert main(["tables", str(tmp_path), "--jobs", jobs]) == 0
    out = capsys.readouterr().out
    cells = row(out, DRIVE)
    assert cells[:4] == ["6", "0", "0", "100.0"]  # three frames, two lines each: ours
    assert [cells[4], cells[8]] == ["6", "6"]  # the paper preset and the baseline
    assert cells[12:] == ["376", "12", "2", "96.3", "376", "44", "0", "88.3"]
    assert row(out, "2011_09_26_drive_0015")[:12] == ["-"] * 12
    assert row(out, "total of the five")[:12] == ["-"] * 12
    assert "2011_09_26_drive_0015: no data, expected the folder 2011_09_26_drive_0015_sync" in out
    assert "2011_09_26_drive_0028: no truth, looked for" in out
    assert "2011_09_26_drive_0028_sync.truth.json" in out
    assert f"{DRIVE}:" not in out
    assert "drive_0001" not in out
    assert row(out, DRIVE, 2)[:4] == ["6", "0", "0", "1.000"]  # in the table of today's numbers
    assert row(out, DRIVE, 2)[11] == "0"  # id switches: the drive has stamps


def test_bags_and_folders_are_further_rows(folder, scene_pairs, write_stereo_bag, capsys) -> None:
    scenes = folder / "scenes"
    scenes.mkdir()
    write_stereo_bag(scene_pairs).rename(scenes / "scenes.mcap")
    save_truth([pair.truth for pair in scene_pairs], scenes / "truth.json")
    bag = write_stereo_bag(scene_pairs[:1], f"{DRIVE}_sync.mcap")
    save_truth([scene_pairs[0].truth], folder / f"{DRIVE}_sync.truth.json")
    assert main(["tables", str(folder), str(scenes), str(bag), "--jobs", "1"]) == 0
    out = capsys.readouterr().out
    assert [row(out, name)[0] for name in ("street", "road", DRIVE)] == ["4", "6", "2"]
    (total,) = [line for line in out.splitlines() if line.startswith("total  ") and "|" in line]
    assert total.split()[1] == "|"
    assert total.split()[2] == "12"
    assert "Wang" in out


def test_the_numbers_are_those_of_the_detector(folder, detector, capsys) -> None:
    nothing = detector("NAME = 'blind'\ndef lanes(left, right, camera): return []")
    assert main(["tables", str(folder), "--detector", nothing, "--jobs", "1"]) == 0
    out = capsys.readouterr().out
    assert row(out, "street")[8:12] == ["4", "0", "4", "0.0"]
    assert "blind" in out
    parallel = (
        "import numpy as np\nz = np.arange(5.0, 25.0, 0.5)\n"
        "def lanes(left, right, camera): return [np.stack([0 * z + x, 0 * z + 1.65, z], 1) for x in (-1, 5)]"
    )
    assert main(["tables", str(folder), "--detector", detector(parallel), "--jobs", "1"]) == 0
    cells = row(capsys.readouterr().out, "street")
    assert (cells[8], int(cells[9]) + int(cells[10])) == ("4", 4)
    assert int(cells[9]) > 0  # 0.8 m beside the left line: incorrect


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ("x = 1", "has no function lanes(left, right, camera)"),
        ("def lanes(", "cannot be run: SyntaxError"),
        ("import nothing_there", "cannot be run: ModuleNotFoundError"),
        ("def lanes(left, right, camera): return 1 / 0", "failed: ZeroDivisionError: division by zero"),
        (
            "def lanes(left, right, camera): return [[[1, 2], [3, 4]]]",
            "has the shape (2, 2), expected (N, 3)",
        ),
        ("def lanes(left, right, camera): return [[[float('nan')] * 3]]", "expected (N, 3), finite"),
    ],
)
def test_a_detector_that_does_not_work(folder, detector, capsys, body, message) -> None:
    path = detector(body)
    line = failure(capsys, folder, "--detector", path, "--jobs", "1")
    assert path in line
    assert message in line


def test_a_detector_that_is_not_there(folder, capsys) -> None:
    assert "none.py is no Python file" in failure(capsys, folder, "--detector", folder / "none.py")


@pytest.fixture(scope="module")
def installed_package(tmp_path_factory) -> Path:
    """Return a folder with what setup.py installs, and nothing else of the source tree."""
    pytest.importorskip("setuptools", reason="packages are built by it: pip install setuptools")
    copy = tmp_path_factory.mktemp("source") / "copy"  # a build leaves files in its tree
    shutil.copytree(
        SOURCE / "lane_dp_ros", copy / "lane_dp_ros", ignore=shutil.ignore_patterns("__pycache__")
    )
    for name in ("setup.py", "README.md"):
        shutil.copy(SOURCE / name, copy)
    build = [sys.executable, "setup.py", "--quiet", "build_py", "--build-lib", str(copy.parent / "installed")]
    subprocess.run(build, cwd=copy, check=True, capture_output=True)
    return copy.parent / "installed"


def test_an_installed_package_needs_no_source_tree(folder, installed_package, tmp_path_factory) -> None:
    empty = tmp_path_factory.mktemp("empty")
    environment = {**os.environ, "PYTHONPATH": str(installed_package)}
    evaluation = ["evaluate", folder, "--truth", folder / "truth.json", "--report", "report"]
    for command in (["tables", folder], evaluation):
        arguments = [sys.executable, "-m", "lane_dp_ros.tools.cli", *map(str, command), "--jobs", "1"]
        done = subprocess.run(
            arguments, cwd=empty, env=environment, capture_output=True, text=True, check=False
        )
        assert (done.returncode, done.stderr) == (0, "")
        if command[0] == "tables":
            assert [row(done.stdout, "street")[i] for i in (0, 4, 8)] == ["4", "4", "4"]  # with the baseline
    assert [each.name for each in empty.iterdir()] == ["report"]


def test_nothing_to_judge(tmp_path, write_stereo_bag, scene_pairs, capsys) -> None:
    assert "no such folder or bag" in failure(capsys, tmp_path / "x")
    assert "none of the paper's drives is in it" in failure(capsys, tmp_path)
    bag = write_stereo_bag(scene_pairs[:1])
    assert f"has no truth: looked for {tmp_path}/stereo.truth.json" in failure(capsys, bag)
    (tmp_path / "stereo.truth.json").write_text("{}")
    assert "has no frames" in failure(capsys, bag)


def test_truth_of_another_drive(tmp_path, scene_pairs, capsys) -> None:
    drive = write_drive(tmp_path, scene_pairs[:1])
    truth = tmp_path / f"{DRIVE}_sync.truth.json"
    save_truth([pair.truth for pair in scene_pairs], truth)
    assert f"{drive} has pairs for 0 of the 3 stamps in {truth}" in failure(capsys, drive, "--jobs", "1")
    save_truth([replace(scene_pairs[0].truth, stamp_ns=None)], truth)
    assert "needs a stamp_ns of its own" in failure(capsys, drive, "--jobs", "1")


def test_loose_frames_without_files(folder, scene_pairs, capsys) -> None:
    save_truth([scene_pairs[0].truth], folder / "truth.json")
    assert "names no files left and right" in failure(capsys, folder, "--jobs", "1")


def test_the_total_of_the_five_takes_all_five() -> None:
    summaries = {name: Summary(ego_labels=10, incorrect=1, missed=i) for i, name in enumerate(OURS)}
    summaries["total"] = sum(summaries.values(), Summary())
    text = papers_tables(["a"], [summaries])
    published = ["3146", "67", "10", "97.6", "1830", "100", "0", "94.5"]
    assert row(text, "total of the five") == ["50", "5", "10", "70.0", *published]
    del summaries["2011_09_30_drive_0016"]
    assert row(papers_tables(["a"], [summaries]), "total of the five") == ["-"] * 4 + published


def test_the_baseline_finds_straight_lines() -> None:
    baseline = baseline_detector()
    assert "reading" in baseline.name
    pair = render_pair(Road(swing=0.0), position=50.0, seed=3)
    result = judge(pair.truth, baseline.detect(pair.left, pair.right, CAMERA), CAMERA)
    assert (len(result.ego_labels), result.incorrect, result.missed) == (2, (), ())
    grey = [cv2.cvtColor(image, cv2.COLOR_BGR2GRAY) for image in (pair.left, pair.right)]
    assert len(baseline.detect(*grey, CAMERA)) == len(baseline.detect(pair.left, pair.right, CAMERA))


@pytest.mark.parametrize("level", [0, 255])
def test_the_baseline_finds_nothing_in_nothing(level) -> None:
    image = np.full((375, 1242), level, np.uint8)
    assert baseline_detector().detect(image, image, CAMERA) == ()


def test_the_baseline_is_no_straw_man(kitti_data) -> None:
    baseline = baseline_detector()
    _, pairs = load_pairs(kitti_data, kitti_data / "labels/lanes.json")
    results = [
        judge(p.frame, baseline.detect(*p.load(), p.frame.camera), p.frame.camera)
        for p in pairs
        if p.frame.sequence == "kitti_stereo_2015"
    ]
    assert summarise(results).paper_precision > 0.61
    assert summarise(results).detection_precision > 0.75
