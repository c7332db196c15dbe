# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""lane_dp fit-evidence from end to end: rendered frames in, a model that the detector takes out."""

import json
import sys
from pathlib import Path

import pytest

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.detector import LaneDetector
from lane_dp_ros.core.lanes.evidence_model import SHIPPED, evidence_model
from lane_dp_ros.core.parameter import replaced
from lane_dp_ros.scenes.scene import CAMERA
from lane_dp_ros.tools.cli import main
from lane_dp_ros.tools.cli.fit_evidence import training_frame

FIGURES = {
    "frames",
    "precision",
    "recall",
    "detection_precision",
    "detection_precision_strict",
    "unpainted_frames",
    "unpainted_false_lanes",
    "edge_recall",
    "false_edges",
    "calibration_error",
    "edge_calibration_error",
}


@pytest.fixture(scope="module")
def scenes(tmp_path_factory) -> Path:
    """A folder of two labelled drives, of two frames each."""
    folder = tmp_path_factory.mktemp("labelled") / "scenes"
    assert main(["scenes", "straight", "kerbs", "--frames", "2", "-o", str(folder), "--jobs", "1"]) == 0
    return folder


def error_of(capsys: pytest.CaptureFixture, *arguments: object) -> str:
    assert main(["fit-evidence", *map(str, arguments)]) == 1
    captured = capsys.readouterr()
    assert captured.out == ""
    (line,) = captured.err.splitlines()
    return line


def test_a_model_is_fitted_written_and_selected_by_the_parameter(scenes, tmp_path, capsys):
    file = tmp_path / "model.json"
    arguments = ["fit-evidence", str(scenes), "--scenes", "2", "--seed", "7", "--jobs", "1", "-o", str(file)]
    assert main(arguments) == 0
    printed = capsys.readouterr().out
    content = json.loads(file.read_text())
    assert content["data"]["frames"] == {"kerbs": 2, "straight": 2}
    assert (content["data"]["scenes"], content["data"]["seed"]) == (2, 7)
    assert set(content["figures"]) == {"total", "drive left out", "category left out"}
    for row in ("data, fitted on all", "data, drive left out", "scenes, category left out"):
        assert row in printed
        assert set(content["figures"]["total"][row]) == FIGURES
    assert [each["frames"] for each in content["figures"]["drive left out"].values()] == [2, 2]
    assert content["figures"]["total"]["data, fitted on all"]["recall"] == 1.0

    config = replaced(DetectorConfig(), {"lane_selection.evidence_model": str(file)})
    assert evidence_model(str(file)).source == content
    assert evidence_model(str(file)).start != evidence_model(SHIPPED).start
    pair = training_frame(0, 0)
    own = LaneDetector(pair.camera, config).detect(pair.frame)
    shipped = LaneDetector(pair.camera).detect(pair.frame)
    assert [each.log_odds for each in own.candidates] != [each.log_odds for each in shipped.candidates]
    assert pair.camera != CAMERA  # a training scene has a camera of its own


def test_no_file_is_replaced_unasked(scenes, tmp_path, capsys):
    file = tmp_path / "model.json"
    file.write_text("mine")
    line = error_of(capsys, scenes, "-o", file)
    assert line == f"lane_dp: {file} exists already: choose another name, or add --force to replace it"
    assert file.read_text() == "mine"


def test_a_folder_that_is_not_there_is_said_at_once(scenes, tmp_path, capsys):
    line = error_of(capsys, scenes, "-o", tmp_path / "nowhere" / "model.json")
    assert line == f"lane_dp: {tmp_path / 'nowhere'}: no such folder to write model.json into"


def test_data_without_labels(tmp_path, capsys):
    line = error_of(capsys, tmp_path / "drive.mcap", "-o", tmp_path / "model.json")
    assert "drive.mcap has no labelled frames: looked for" in line
    assert "drive.truth.json" in line


def test_without_scipy_one_line_says_how_to_get_it(scenes, tmp_path, capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "scipy.optimize", None)
    line = error_of(capsys, scenes, "-o", tmp_path / "model.json")
    assert line.startswith("lane_dp: needs scipy, for fits: ")


def test_one_drive_alone_cannot_be_left_out(tmp_path, capsys):
    folder = tmp_path / "one"
    assert main(["scenes", "straight", "--frames", "1", "-o", str(folder), "--jobs", "1"]) == 0
    capsys.readouterr()
    line = error_of(capsys, folder, "--scenes", 0, "--jobs", 1, "-o", tmp_path / "model.json")
    assert "all frames are of the drive 'straight'" in line
    assert not (tmp_path / "model.json").exists()
