# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Where frames to learn from come from, and that all of their candidates are measured in full."""

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.detector import LaneDetector
from lane_dp_ros.core.lanes.evidence_model import evidence_model
from lane_dp_ros.core.parameter import replaced
from lane_dp_ros.core.types import StereoFrame
from lane_dp_ros.messages.bag import BagReader, BagWriter
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.messages.topic_choice import TopicChoice
from lane_dp_ros.scenes.scene import CAMERA
from lane_dp_ros.scenes.suite import Drive
from lane_dp_ros.tools.cli.fit_evidence import training_frame
from lane_dp_ros.tools.evidence_fit.collecting import FrameSource, Kept, MeasuringDetector, collect
from lane_dp_ros.tools.evidence_fit.frames import unpainted_frames
from lane_dp_ros.tools.evidence_fit.model_file import model_text

P = "700 0 20 0 0 700 10 0 0 0 1 0"


@pytest.fixture(scope="module")
def scene():
    return training_frame(0, 0)


def sequence(root: Path) -> Path:
    folder = root / "sequences" / "06"
    for camera in (0, 1):
        (folder / f"image_{camera}").mkdir(parents=True)
        for i in range(4):
            picture = np.full((20, 40), 10 * i + camera, np.uint8)
            cv2.imwrite(str(folder / f"image_{camera}" / f"{i:06}.png"), picture)
    (folder / "calib.txt").write_text(f"P0: {P}\nP1: {P.replace(' 20 0 ', ' 20 -350 ', 1)}\n")
    (folder / "times.txt").write_text("0\n0.1\n0.2\n0.3\n")
    return folder


def test_a_sequence_without_paint(tmp_path):
    sources = unpainted_frames(sequence(tmp_path), [])
    assert [each.drive for each in sources] == ["06"] * 4
    assert [each.varied for each in sources] == [True, False, False, True]
    pair = sources[2].load()
    assert pair.name == "06/000002"
    assert pair.truth is None
    assert pair.camera.baseline == pytest.approx(0.5)
    assert pair.frame.left[0, 0] == 20
    assert pair.frame.right[0, 0] == 21


def test_it_is_of_the_drive_of_its_labelled_frames(tmp_path):
    sources = unpainted_frames(sequence(tmp_path), ["kitti_odometry/01", "kitti_odometry/06"])
    assert {each.drive for each in sources} == {"kitti_odometry/06"}


def test_a_bag_without_paint(write_stereo_bag, small_pairs):
    sources = unpainted_frames(write_stereo_bag(small_pairs, "yard"), [])
    assert [each.drive for each in sources] == ["yard"] * 5
    pair = sources[3].load()
    assert pair.name == f"yard/{small_pairs[3].stamp_ns}"
    assert pair.frame.left[0, 0] == 30
    assert pair.camera.fx == CAMERA.fx


def test_what_is_no_drive_is_said(tmp_path):
    with pytest.raises(CommandError, match="no such folder"):
        unpainted_frames(tmp_path / "gone", [])


def test_a_pair_is_loaded_once(tmp_path, scene):
    asked = []

    def load():
        asked.append(1)
        return scene

    kept = Kept(load, tmp_path / "0.pickle")
    again = [kept(), kept()][1]
    assert len(asked) == 1
    assert again.name == scene.name
    np.testing.assert_array_equal(again.frame.right, scene.frame.right)


def test_all_heights_are_measured(tmp_path):
    """The detector leaves out those that decide nothing; before the fit nobody knows which these are."""
    model = evidence_model()
    hopeless = replace(model, start={**model.start, "paint": -50.0})
    (tmp_path / "model.json").write_text(model_text(hopeless, {}))
    config = replaced(DetectorConfig(), {"lane_selection.evidence_model": str(tmp_path / "model.json")})
    pair = Drive("kerbs").render(0)
    plain, full = (
        [each.evidence.height for each in kind(CAMERA, config).detect(frame).candidates]
        for kind in (LaneDetector, MeasuringDetector)
        for frame in [StereoFrame(pair.left, pair.right)]
    )
    assert not np.isfinite(plain).any()
    assert np.isfinite(full).sum() >= 3


def test_a_varied_frame_has_five_examples(scene):
    (made,) = collect([FrameSource("here", lambda: scene, varied=True)], jobs=1)
    assert [each.name.removeprefix(scene.name) for each in made.examples] == [
        "",
        " (mirrored)",
        " (gamma 0.7)",
        " (gamma 1.4)",
        " (0.7 times the size)",
    ]
    assert {each.drive for each in made.examples} == {"here"}
    assert made.category == scene.truth.category


def test_the_topics_of_a_bag_may_be_named(tmp_path, write_stereo_bag, small_pairs):
    with BagReader(write_stereo_bag(small_pairs)) as reader, BagWriter(tmp_path / "yard") as writer:
        for topic, time_ns, message in reader.messages():
            for car in ("a", "b"):
                writer.write(f"/{car}{topic}", time_ns, message)
    assert len(unpainted_frames(tmp_path / "yard", [], TopicChoice(camera="/b"))) == 5
    with pytest.raises(CommandError, match="several stereo cameras"):
        unpainted_frames(tmp_path / "yard", [])
