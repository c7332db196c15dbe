# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Lines as truth: on which ground, and only of frames that are wholly known."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from lane_dp_ros.core.geometry.quadratic_surface import QuadraticSurface
from lane_dp_ros.messages.bag import BagReader, BagWriter
from lane_dp_ros.messages.lanes import lanes_from_ros
from lane_dp_ros.review.drive import Drive
from lane_dp_ros.review.judgement import Judgement, Line, lines_to_json
from lane_dp_ros.review.lanes_bag import detect_lanes
from lane_dp_ros.review.lines_as_truth import (
    Grounds,
    detected_lines,
    ground_through,
    image_points,
    known,
    simplified,
)
from lane_dp_ros.review.read_drive import read_drive
from lane_dp_ros.review.review import Review
from lane_dp_ros.review.review_file import ReviewFile
from lane_dp_ros.tools.detection_config import load_config
from lane_dp_ros.tools.evaluation.truth_file import load_truth
from lane_dp_ros.tools.offline.lane_bag import RESOLUTION

CORRECT = Judgement("correct", "correct")


def grounds(drive: Drive) -> Grounds:
    return Grounds(drive, *load_config("default", None))


@pytest.fixture
def drive(drive_bag) -> Drive:
    return read_drive(drive_bag, drive_bag)


@pytest.fixture
def review(drive, tmp_path) -> Review:
    file = ReviewFile(tmp_path / "file.json")
    file.use_for(drive.fingerprint)
    return Review(drive, file, grounds(drive))


@pytest.fixture
def detected_drive(write_stereo_bag, scene_pairs, tmp_path) -> Drive:
    """Return a drive of rendered pairs, the lanes detected as lane_dp review does it."""
    bag = write_stereo_bag(scene_pairs[:2])
    with BagReader(bag) as reader, BagWriter(tmp_path / "lanes") as writer:
        detect_lanes(reader, writer, *load_config("default", None), jobs=1)
    return read_drive(bag, tmp_path / "lanes")


def test_the_ground_through_lanes_is_the_plane_they_lie_on(drive) -> None:
    frame = drive.frames[0]
    plane = QuadraticSurface.plane(frame.camera, height=1.5, pitch=0.0)
    for lanes in (frame.lanes, frame.lanes[:1]):  # one line is enough for a road without cross slope
        ground = ground_through(lanes, frame.camera)
        np.testing.assert_allclose(ground.coefficients, plane.coefficients, atol=1e-6)
    assert ground_through((), frame.camera) is None


def test_a_few_points_keep_the_line(drive) -> None:
    frame = drive.frames[0]
    lane = frame.lanes[0]
    bent = replace(lane, points=lane.points + np.outer(lane.points[:, 2] ** 2, [0.01, 0, 0]))
    pixels = image_points(bent, frame.camera)
    few = simplified(pixels)
    assert len(few) < len(pixels) / 4
    rows = pixels[::-1, 1]
    np.testing.assert_allclose(np.interp(rows, few[::-1, 1], few[::-1, 0]), pixels[::-1, 0], atol=1.0)


def test_correct_lanes_are_truth_where_they_are(drive) -> None:
    found = known(drive, drive.frames[0], CORRECT, grounds(drive)).frame
    assert (found.name, found.stamp_ns) == ("drive/000000", 1_317_000_000_000_000_000)
    assert (found.ego_left, found.ego_right, found.size) == ("7", "8", (400, 200))
    offsets = {label.id: label.xz[:, 0] for label in found.labels}
    for name, x in {"7": -1.8, "8": 1.7, "9": -5.2}.items():
        np.testing.assert_allclose(offsets[name], x, atol=0.02)
    # Nobody was asked about the other lines.
    assert {label.id: label.sure for label in found.labels} == {"7": True, "8": True, "9": False}
    assert found.labels[0].xz[0, 1] == pytest.approx(4.0, abs=0.1)
    assert found.labels[0].xz[-1, 1] == pytest.approx(30.0, abs=0.5)


def test_a_corrected_line_is_taken_as_drawn(drive) -> None:
    frame = drive.frames[2]
    camera = frame.camera
    uv = camera.project([[1.9, 1.5, 5.0], [1.9, 1.5, 20.0]])
    line = Line("8", "ego_right", "dashed", True, tuple(map(tuple, uv.tolist())))
    lines = (*detected_lines(frame), line)
    found = known(drive, frame, Judgement("correct", "missed", lines), grounds(drive)).frame
    label = next(label for label in found.labels if label.id == "8")
    assert (found.ego_right, label.kind, label.sure) == ("8", "dashed", True)
    np.testing.assert_allclose(label.xz[:, 0], 1.9, atol=0.01)
    np.testing.assert_allclose(label.xz[[0, -1], 1], [5, 20], atol=0.01)
    # As dense as evaluation samples it: interpolated between, it must stay on the road's line.
    assert np.all(np.diff(label.xz[:15, 1]) < 0.5)


@pytest.mark.parametrize(
    ("index", "judgement", "problem"),
    [
        (0, Judgement("correct"), "not judged yet"),
        (0, Judgement("incorrect", "correct"), "left is incorrect, but the true line is not drawn"),
        (2, Judgement("correct", "missed"), "right is missed, but the true line is not drawn"),
        (0, Judgement("correct", "correct", ()), "left is correct, but the true line is not drawn"),
        (4, Judgement("none", "none"), "no road surface: neither a stereo pair nor lanes tell it"),
        (
            0,
            Judgement("none", "none", (Line("a", "other", "solid", True, ((0, 0), (9, 9))),)),
            "a line lies above the horizon",
        ),
    ],
)
def test_a_frame_that_is_not_wholly_known_is_no_truth(drive, index, judgement, problem) -> None:
    found = known(drive, drive.frames[index], judgement, grounds(drive))
    assert found.frame is None
    assert found.problem == problem


def test_where_no_marking_is_the_detected_line_is_no_truth(drive) -> None:
    found = known(drive, drive.frames[1], Judgement("correct", "none"), grounds(drive)).frame
    assert [label.id for label in found.labels] == ["7"]
    assert (found.ego_left, found.ego_right) == ("7", None)


def test_the_ground_of_a_pair_is_the_detectors(detected_drive, scene_pairs) -> None:
    assert len(detected_drive.frames) == 2
    for frame, pair in zip(detected_drive.frames, scene_pairs, strict=False):
        found = known(detected_drive, frame, CORRECT, grounds(detected_drive)).frame
        assert abs(found.ground[3]) > 0, "the surface through two lanes or the detector's: it knows of roll"
        for label in (each for each in found.labels if each.sure):
            x, z = label.xz[label.xz[:, 1] < 25].T
            errors = [np.abs(np.interp(z, lane[:, 2], lane[:, 0]) - x).mean() for lane in pair.lanes]
            assert min(errors) < 0.1


def test_a_right_image_that_is_missing_is_not_needed(detected_drive, drive) -> None:
    frame = detected_drive.frames[0]
    assert detected_drive.right_message(frame, 10_000_000) is not None
    assert (
        detected_drive.right_message(replace(frame, stamp_ns=frame.stamp_ns + 5 * 10**7), 10_000_000) is None
    )
    assert drive.right_message(drive.frames[0], 10_000_000) is None


def test_detected_lanes_are_those_of_lane_dp_run(detected_drive, tmp_path) -> None:
    from lane_dp_ros.tools.cli import main

    main(["run", str(detected_drive.bag), "-o", str(tmp_path / "run"), "--jobs", "1"])
    with BagReader(tmp_path / "run") as reader:
        arrays = [lanes_from_ros(message) for _, _, message in reader.messages(["/lanes"])]
    for frame, lanes in zip(detected_drive.frames, arrays, strict=True):
        assert [(lane.id, lane.role) for lane in frame.lanes] == [(lane.id, lane.role) for lane in lanes]
        for ours, theirs in zip(frame.lanes, lanes, strict=True):
            np.testing.assert_allclose(ours.points, theirs.points, atol=RESOLUTION)  # to which a bag rounds


def test_the_export_can_be_read_and_says_what_is_left_out(review, tmp_path) -> None:
    review.judge(0, {"left": "correct", "right": "correct"})
    review.judge(2, {"left": "correct", "right": "missed"})
    export = review.export()
    assert (export["name"], export["frames"]) == ("drive.truth.json", 1)
    assert export["left_out"] == ["frame 3: right is missed, but the true line is not drawn"]
    path = Path(tmp_path / "truth.json")
    path.write_text(export["text"])
    (frame,) = load_truth(path)
    assert (frame.sequence, frame.stamp_ns, frame.ego_ids) == ("drive", 1_317_000_000_000_000_000, ("7", "8"))


def test_a_verdict_must_fit_what_is_drawn(review) -> None:
    for verdict in ("correct", "incorrect"):
        with pytest.raises(
            ValueError, match="no line was detected right: it was missed, or there is no marking"
        ):
            review.judge(2, {"right": verdict})
    assert review.judge(2, {"right": "missed"})["table"]["missed"] == 1


def test_lines_go_back_to_the_detected_ones(review, drive) -> None:
    lines = lines_to_json(detected_lines(drive.frames[0])[:1])
    review.correct(0, lines)
    assert review.frame(0)["corrected"]
    assert review.frame(0)["lines"] == lines
    review.correct(0, None)
    assert not review.frame(0)["corrected"]
    assert len(review.frame(0)["lines"]) == 3
