# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Detections made by hand, whose judgement can be told without a computer.

The ground is a plane 1.65 m below the camera: d = baseline / 1.65 (v - cy), so g1 = 100 * 0.54 / 1.65.
"""

import json
from dataclasses import replace

import numpy as np
import pytest

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.types import Lane
from lane_dp_ros.tools.evaluation.matching import judge, judge_unpainted
from lane_dp_ros.tools.evaluation.summary import Summary, by_category, by_sequence, summarise
from lane_dp_ros.tools.evaluation.truth_file import Label, LabelledFrame, load_truth

CAMERA = StereoCamera(700.0, 700.0, 600.0, 180.0, 0.54)
HEIGHT = 1.65


def label(x, start=5.0, end=30.0, *, name="L", kind="solid", sure=True):
    points = line(x, start, end)
    return Label(name, kind, sure, CAMERA.project(points), points[:, [0, 2]])


def frame(*labels, name="kitti_stereo_2015/000000_10", **fields):
    ground = np.array([0.0, 100 * CAMERA.baseline / HEIGHT, 0.0, 0.0])
    return LabelledFrame(name, CAMERA, (1200, 370), ground, labels, "L", "R", **fields)


def line(x, start=5.0, end=30.0):
    z = np.arange(start, end + 0.01, 0.5)
    return np.column_stack([np.full_like(z, x), np.full_like(z, HEIGHT), z])


def lane(points, identity=-1, confidence=0.9):
    return Lane(points, confidence, 0.12, "other", 0.0, 0.0, identity)


LEFT, RIGHT = label(-1.8), label(1.8, name="R")


def judged(*lines, labels=(LEFT, RIGHT)):
    return summarise([judge(frame(*labels), [lane(points) for points in lines], CAMERA)])


def test_perfect():
    score = judged(line(-1.8), line(1.8))
    assert (score.ego_labels, score.incorrect, score.missed) == (2, 0, 0)
    assert (score.labels, score.matched, score.detections) == (2, 2, 2)
    assert score.paper_precision == score.lane_recall == score.detection_precision == 1.0
    assert score.false_lanes_per_frame == 0.0
    assert score.localisation_error == pytest.approx(0.0, abs=1e-9)


def test_a_shift_within_the_tolerance_is_the_localisation_error():
    score = judged(line(-1.7), line(1.8))
    assert score.matched == 2
    assert score.localisation_error == pytest.approx(0.05)


def test_shifted_by_0_3_m_is_incorrect_but_no_false_lane():
    score = judged(line(-1.5), line(1.8))
    assert (score.incorrect, score.missed, score.matched) == (1, 0, 1)
    assert (score.false_lanes, score.duplicates) == (
        0,
        0,
    )  # within 0.35 m of a label that nothing else matched
    assert score.paper_precision == 0.5


def test_shifted_by_0_6_m_is_incorrect_and_a_false_lane():
    score = judged(line(-1.2), line(1.8))
    assert (score.incorrect, score.missed, score.false_lanes) == (1, 0, 1)
    assert score.detection_precision == 0.5


def test_half_the_length_does_not_match():
    score = judged(line(-1.8, 6.0, 15.5), line(1.8))
    assert (score.incorrect, score.missed, score.matched) == (1, 0, 1)


@pytest.mark.parametrize(("end", "matched"), [(19.2, 1), (18.7, 0)])
def test_seventy_per_cent_of_the_samples_with_slack_at_the_end(end, matched):
    # 39 samples from 6 to 25 m, of which 28 are 71 %: the 28th, at 19.5 m, may lie 0.25 m beyond the end.
    z = np.array([5.0, end + 0.1])
    points = np.column_stack([np.full(2, -1.8), np.full(2, HEIGHT), z])
    assert judged(points, labels=(LEFT,)).matched == matched


def test_a_good_mean_with_a_bad_end_does_not_match():
    points = line(-1.8)
    points[points[:, 2] > 22, 0] += 0.5  # 6 of 39 samples: mean 0.08 m, 90th percentile 0.5 m
    assert judged(points, labels=(LEFT,)).matched == 0


def test_doubled():
    score = judged(line(-1.8), line(-1.75), line(1.8))
    assert (score.matched, score.duplicates, score.false_lanes) == (2, 1, 0)
    assert score.detection_precision == pytest.approx(2 / 3)
    assert score.localisation_error == pytest.approx(0.0, abs=1e-9)  # the better one of the two is the match


def test_one_line_is_the_match_of_one_label():
    score = judged(line(-1.8), labels=(LEFT, label(-1.7, name="R")))
    assert (score.labels, score.matched, score.missed) == (2, 1, 1)
    assert score.localisation_error == pytest.approx(0.0, abs=1e-9)


def test_extra():
    score = judged(line(-1.8), line(1.8), line(5.0), line(0.0))
    assert (score.paper_precision, score.false_lanes, score.duplicates) == (1.0, 2, 0)
    assert score.detection_precision == 0.5


def test_nothing_found():
    score = judged()
    assert (score.incorrect, score.missed, score.detections) == (0, 2, 0)
    assert np.isnan(score.detection_precision)


@pytest.mark.parametrize("other", [label(1.8, name="E", kind="edge"), label(1.8, name="U", sure=False)])
def test_lines_on_edges_and_unsure_labels_are_neither_right_nor_wrong(other):
    score = judged(line(-1.8), line(2.0), line(1.5), labels=(LEFT, other))
    assert (score.labels, score.matched, score.false_lanes) == (1, 1, 0)
    assert score.localisation_error == pytest.approx(0.0, abs=1e-9)


def test_a_label_with_less_than_3_m_within_the_judged_depths_does_not_take_part():
    score = judged(line(-1.8), line(1.8, 23.0, 30.0), labels=(LEFT, label(1.8, 22.5, 40.0, name="R")))
    assert (score.ego_labels, score.labels, score.false_lanes) == (1, 1, 0)


def test_a_wrong_height_is_judged_through_the_image():
    """A line 10 % too near on too high a road falls on the same pixels: no error."""
    assert judged(line(-1.8) * 0.9, line(1.8)).localisation_error == pytest.approx(0.0, abs=1e-9)


def test_detections_are_in_the_frame_of_the_projection_matrix():
    beside = StereoCamera(700.0, 700.0, 600.0, 180.0, 0.54, left_translation=(0.06, 0.0, 0.0))
    score = summarise([judge(frame(LEFT), [lane(line(-1.86))], beside)])
    assert score.localisation_error == pytest.approx(0.0, abs=1e-9)


def test_points_behind_the_camera_or_above_the_horizon_say_nothing():
    assert judged(line(-1.8) * [1, -1, 1], line(-1.8) * [1, 1, -1]).matched == 0
    assert judged(np.empty((0, 3))).detections == 1


def test_results_add_up_by_sequence_and_category():
    folders = ["kitti_odometry/sequences/02", "kitti_odometry/sequences/02", "kitti_stereo_2015"]
    frames = [
        frame(LEFT, name=f"{f}/{i}", category=c) for i, (f, c) in enumerate(zip(folders, "ab ", strict=True))
    ]
    found = [[lane(line(-1.8))], [], [lane(line(-1.7))]]
    results = [judge(f, lanes, CAMERA) for f, lanes in zip(frames, found, strict=True)]
    sums = by_sequence(results)
    assert list(sums) == ["kitti_odometry/02", "kitti_stereo_2015", "total"]
    assert [s.frames for s in sums.values()] == [2, 1, 3]
    assert sums["kitti_odometry/02"].paper_precision == 0.5
    assert sums["total"].localisation_error == pytest.approx(0.05)
    assert sums["total"] == sums["kitti_odometry/02"] + sums["kitti_stereo_2015"]
    assert list(by_category(results)) == [" ", "a", "b", "total"]
    assert Summary() + summarise(results) == summarise(results)


def test_a_frame_result_says_which():
    found = [lane(line(-1.8)), lane(line(-1.75), confidence=0.3), lane(line(5.0)), lane(line(2.1))]
    result = judge(frame(LEFT, RIGHT), found, CAMERA, latency=0.02)
    assert [d.verdict for d in result.detections] == ["match", "duplicate", "false", "ignored"]
    assert [d.label for d in result.detections] == ["L", None, None, None]
    assert (result.labels, result.ego_labels, result.incorrect, result.missed) == (
        ("L", "R"),
        ("L", "R"),
        ("R",),
        (),
    )
    assert result.confidences == ((0.9, True), (0.3, False), (0.9, False), (0.9, True))
    (match,) = result.matches
    assert (match.label, match.detection, match.counts, len(match.depths)) == ("L", 0, True, 39)
    assert match.position == pytest.approx(-1.8) and match.label_position == pytest.approx(-1.8)
    assert summarise([result]).latencies == (0.02,)


def test_near_and_far_errors():
    points = line(-1.8)
    points[points[:, 2] > 12, 0] += 0.1
    result = judge(frame(LEFT), [lane(points)], CAMERA)
    assert result.matches[0].near == pytest.approx(0.0, abs=1e-9)
    assert result.matches[0].far == pytest.approx(0.1)
    short = judge(frame(label(-1.8, 6.0, 11.0)), [lane(points)], CAMERA).matches[0]
    assert short.far is None and short.near == pytest.approx(0.0, abs=1e-9)


def test_unpainted_frames():
    result = judge_unpainted("06/1", [lane(line(0.0))], "06", 1)
    summary = summarise([result, judge_unpainted("06/2", [], "06", 2)])
    assert (summary.frames, summary.false_lanes, summary.detection_precision) == (2, 1, 0.0)
    assert summary.false_lanes_per_frame == 0.5


# ---- A sequence: ten frames at 10 Hz, two lines, a vehicle that drifts to the right by 0.2 m/s.
STAMPS = [100_000_000 * i for i in range(10)]
PERFECT = {"L": (-1.8, 7), "R": (1.8, 9)}  # label: (x [m], track id)


def sequence_summary(change=lambda _i, lanes: lanes, stamps=STAMPS, drift=0.02):
    """Return the summary of the ten frames whose lanes `change(frame number, lanes)` has altered."""
    results = []
    for i, stamp in enumerate(stamps):
        x = {name: x - drift * i for name, (x, _) in PERFECT.items()}
        lanes = [lane(line(x[name]), identity) for name, (_, identity) in PERFECT.items()]
        truth = frame(*(label(x[name], name=name) for name in PERFECT), name=f"s/{i}", stamp_ns=stamp)
        results.append(judge(truth, change(i, lanes), CAMERA))
    return summarise(results)


def at(number, change):
    """Return the change of one frame's first lane into the lanes `change(lane)`."""
    return lambda i, lanes: [*change(lanes[0]), *lanes[1:]] if i == number else lanes


def moved(x):
    return lambda one: [replace(one, points=one.points + np.array([x, 0, 0]))]


def numbers(summary):
    names = [
        "frames", "ego_labels", "incorrect", "missed", "labels", "matched", "detections", "false_lanes",
        "duplicates", "localisation_error", "near_error", "far_error", "id_switches", "jitter",
        "label_jitter", "paper_precision", "lane_recall", "detection_precision",
    ]  # fmt: skip
    in_image = {
        "tusimple_accuracy": summary.tusimple.accuracy, "tusimple_fp": summary.tusimple.fp,
        "tusimple_fn": summary.tusimple.fn, "culane_f1": summary.culane.f1,
    }  # fmt: skip
    return {**{name: getattr(summary, name) for name in names}, **in_image}


def test_perfect_detections_score_one_everywhere():
    found = numbers(sequence_summary())
    ones = {"paper_precision", "lane_recall", "detection_precision", "tusimple_accuracy", "culane_f1"}
    counts = {"frames": 10, "ego_labels": 20, "labels": 20, "matched": 20, "detections": 20}
    assert found == pytest.approx(
        {**dict.fromkeys(found, 0.0), **counts, **dict.fromkeys(ones, 1.0)}, abs=1e-9
    )
    assert sequence_summary().jitter_windows == 12  # 6 windows of 5 frames, two lines


# One of 20 ego lines is judged otherwise than a perfect one.
LOST = {"paper_precision": 0.95, "lane_recall": 0.95, "matched": 19}
EXTRA = {"detections": 21, "detection_precision": 20 / 21, "tusimple_fp": 1 / 30, "culane_f1": 40 / 41}
PIXELS_OFF = {"tusimple_fp": 0.05, "tusimple_fn": 0.05}

# TuSimple's rows: 180, 190 ... 360, so 19; a label from 5 to 30 m covers 220 ... 360; in the other 4 rows
# both label and detection are absent. At x = -1.88 m a line slants by 1.88 / 1.65: 20 px / cos = 30.3 px.
# A shift of 0.3 m is 0.3 / 1.65 (v - 180) px: too far off in 2 rows, from 350 on; 0.6 m in 10.
CASES = {
    "shifted 0.1 m": (
        at(4, moved(0.1)),
        {"localisation_error": 0.005, "near_error": 0.005, "far_error": 0.005, "jitter": None},
    ),
    "shifted 0.3 m": (
        at(4, moved(0.3)),
        {"incorrect": 1, **LOST, "tusimple_accuracy": 1 - 2 / 19 / 20, "culane_f1": 0.95},
    ),
    "shifted 0.6 m": (
        at(4, moved(0.6)),
        {
            "incorrect": 1, **LOST, "false_lanes": 1, "detection_precision": 0.95,
            "tusimple_accuracy": 1 - 10 / 19 / 20, **PIXELS_OFF, "culane_f1": 0.95,
        },
    ),
    "half length": (  # 6 to 15 m: rows 260 ... 360, 11 of 15
        at(4, lambda one: [replace(one, points=line(one.points[0, 0], 6.0, 15.0))]),
        {"incorrect": 1, **LOST, "tusimple_accuracy": 1 - 4 / 19 / 20, **PIXELS_OFF},
    ),
    "doubled": (
        at(4, lambda one: [one, replace(one, points=one.points + np.array([0.05, 0, 0]), id=20)]),
        {"duplicates": 1, **EXTRA},
    ),
    "extra": (at(4, lambda one: [one, replace(one, points=line(6.0), id=20)]), {"false_lanes": 1, **EXTRA}),
    "missing": (  # in 4 rows the label is absent, and so is the other line
        at(4, lambda _: []),
        {
            "missed": 1, **LOST, "detections": 19,
            "tusimple_accuracy": 1 - 15 / 19 / 20, "tusimple_fn": 0.05, "culane_f1": 38 / 39,
        },
    ),
    "swapped ids": (
        lambda i, lanes: [replace(one, id=16 - one.id) for one in lanes] if i >= 4 else lanes,
        {"id_switches": 2},
    ),
}  # fmt: skip


@pytest.mark.parametrize(("change", "moves"), CASES.values(), ids=CASES)
def test_each_error_moves_exactly_its_numbers(change, moves):
    perfect, found = numbers(sequence_summary()), numbers(sequence_summary(change))
    changed = {name for name in found if found[name] != pytest.approx(perfect[name], abs=1e-9)}
    assert changed == set(moves)
    for name, value in moves.items():
        assert value is None or found[name] == pytest.approx(value), name


def test_jitter_is_what_a_straight_line_leaves():
    """The middle one of five frames is 0.1 m aside: the line through them runs level, at 0.02 m."""
    summary = sequence_summary(at(2, moved(0.1)), STAMPS[:5])
    assert summary.jitter_windows == 2
    assert summary.jitter == pytest.approx(np.std([0, 0, 0.1, 0, 0]) / 2)
    assert summary.label_jitter == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(("factor", "windows", "chances"), [(1, 12, 18), (2, 12, 18), (3, 0, 18), (11, 0, 0)])
def test_nothing_is_compared_across_a_second(factor, windows, chances):
    """Five frames must lie within 1 s for jitter, two for an id switch."""
    summary = sequence_summary(stamps=[factor * stamp for stamp in STAMPS])
    assert (summary.jitter_windows, summary.id_chances) == (windows, chances)


def test_the_labels_judge_themselves_perfect(kitti_data):
    """Every label, lifted from its own pixels to any depth, comes back as a perfect detection."""
    frames = load_truth(kitti_data / "labels" / "lanes.json")
    raw = json.loads((kitti_data / "labels" / "lanes.json").read_text())
    scores = []
    for f in frames:
        pixels = [np.array(lane["uv"]) for lane in raw[f.name]["lanes"]]
        lifted = [f.camera.back_project(uv, np.full(len(uv), 10.0)) for uv in pixels]
        scores.append(judge(f, map(lane, lifted), f.camera))
    total = summarise(scores)
    assert (total.frames, total.ego_labels, total.labels) == (72, 81, 135)
    assert total.paper_precision == total.lane_recall == total.detection_precision == 1.0
    assert total.localisation_error < 0.01
