# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The benchmarks that judge: they name parameters and functions that exist, and choose and count rightly."""

import sys
from collections import Counter
from dataclasses import replace
from pathlib import Path
from unittest.mock import patch

import cv2
import numpy as np
import pytest

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.lane import Lane
from lane_dp_ros.core.lanes import selection as lane_selection
from lane_dp_ros.core.parameter import parameters, replaced
from lane_dp_ros.scenes.scene import CAMERA, Motion, Scene, render_frame
from lane_dp_ros.tools.evaluation.scores import Summary

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))  # scripts that import one another

import ablation
import calibrate_confidence
import judged_set
import leave_a_drive_out
import steady_lines
import thresholds
import varied_frames
import varied_pairs
import what_hinders

GOOD = Summary(frames=10, ego_labels=20, missed=1, labels=40, matched=38, detections=39, false_lanes=1)
BARE = Summary(frames=10)


@pytest.fixture(scope="module")
def pairs(rendered):
    """Two consecutive frames of an ordinary road."""
    frames = [rendered(render_frame, Scene(motion=Motion(start=100.0)), i, 1) for i in range(2)]
    return [
        judged_set.JudgedPair(
            f"road/{i:02d}",
            "road",
            *(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY) for image in (frame.left, frame.right)),
            CAMERA,
            frame.truth,
            frame.stamp_ns,
        )
        for i, frame in enumerate(frames)
    ]


def test_every_change_of_the_ablation_is_possible():
    ablation.check(ablation.ABLATIONS)


@pytest.mark.parametrize(
    ("change", "error"),
    [
        (ablation.Ablation("a", {"paint_map.colour": 1}), ValueError),
        (ablation.Ablation("a", {"path_search.suppression": 100.0}), ValueError),
        (ablation.Ablation("a", patches={"lane_dp_ros.core.birdseye.paint_map.COLOUR": 1}), AttributeError),
        (ablation.Ablation("a", patches={"lane_dp_ros.core.gone.COLOUR": 1}), (AttributeError, ImportError)),
    ],
)
def test_what_is_gone_is_said_at_the_start(change, error):
    with pytest.raises(error, match=r"colour|COLOUR|suppression|gone"):
        ablation.check([change])


def test_a_row_has_a_cell_under_each_head(pairs):
    results = [pair.judged(pair.detected(DetectorConfig()).lanes) for pair in pairs]
    row = ablation.row(ablation.ABLATIONS[0], results, frozenset())
    assert ablation.heads().split("\n")[0].count("|") == row.count("|")
    assert row.startswith("| none | - |") and "1.000" in row


def test_processes_answer_as_the_detector_does_with_names_replaced_or_not(pairs):
    blind = {"lane_dp_ros.core.lanes.path_search.FREE_PASSES": 0}
    with judged_set.Judges(pairs, jobs=2) as judges:
        seen, nothing = judges.results(DetectorConfig()), judges.results(DetectorConfig(), blind)
        again = judges.results(DetectorConfig())
    assert [result.name for result in seen] == ["road/00", "road/01"]
    assert [len(result.detections) for result in seen] == [3, 3] == [len(r.detections) for r in again]
    assert {d.lane.id for d in seen[0].detections} == {d.lane.id for d in seen[1].detections}  # tracked
    assert [len(result.detections) for result in nothing] == [0, 0]


def test_what_is_remembered_changes_no_verdict(pairs):
    memory = judged_set.Memory()
    strict = replaced(DetectorConfig(), {"lane_selection.start_max": 5.0})
    for config in (DetectorConfig(), strict, DetectorConfig()):
        with memory.in_use():
            remembered = pairs[0].detected(config).lanes
        fresh = pairs[0].detected(config).lanes
        assert len(remembered) == len(fresh)
        for one, other in zip(remembered, fresh, strict=True):
            np.testing.assert_array_equal(one.points, other.points)


def test_what_is_remembered_does_not_hide_a_constant(pairs):
    memory = judged_set.Memory()
    counts = []
    for wide_band_ratio in (thresholds.shipped("lane_selection.WIDE_BAND_RATIO_MAX"), -1e9):
        config, patches = thresholds.changed({"lane_selection.WIDE_BAND_RATIO_MAX": wide_band_ratio})
        with judged_set.patched(patches), memory.in_use():
            counts.append(len(pairs[0].detected(config).lanes))
    assert counts == [3, 0]


def test_what_a_change_does_not_touch_is_not_computed_again(pairs):
    memory = judged_set.Memory()
    calls = []
    real = judged_set.lane_detector.dense_disparity

    def dense_disparity(*arguments):
        calls.append(arguments)
        return real(*arguments)

    dense_disparity.__module__ = real.__module__
    with patch("lane_dp_ros.core.detector.dense_disparity", dense_disparity):
        for value in (1.0, 2.0):
            with memory.in_use():
                pairs[0].detected(replaced(DetectorConfig(), {"lane_selection.score_min": value}))
        assert len(calls) == 1
        with memory.in_use():
            pairs[0].detected(replaced(DetectorConfig(), {"disparity.P1": 500}))
        assert len(calls) == 2


def test_a_constant_has_only_what_uses_it_computed_again(pairs):
    memory, calls = judged_set.Memory(), Counter()
    search, detector = judged_set.lane_search, judged_set.lane_detector

    def counted(module, name):
        real = getattr(module, name)

        def function(*arguments):
            calls[name] += 1
            return real(*arguments)

        function.__module__ = real.__module__
        return patch.object(module, name, function)

    def detect(name, value):
        patches = {f"lane_dp_ros.core.{name}": value}
        with judged_set.patched(patches), memory.in_use(patches):
            pairs[0].detected(DetectorConfig())
        return tuple(calls.values())

    with (
        counted(detector, "dense_disparity"),
        counted(search, "find_paths"),
        counted(search, "line_evidence"),
    ):
        disparities, paths, evidence = detect("line_heights.DISTINCT", 0.3)
        assert (disparities, paths) == (1, 1) and evidence >= 3
        assert detect("line_heights.DISTINCT", 0.4) == (1, 1, 2 * evidence)
        assert detect("line_heights.DISTINCT", 0.3) == (1, 1, 2 * evidence)
        assert detect("path_search.SLOPE_COST", 5.0)[:2] == (1, 2)


def test_evidence_is_remembered_by_the_pictures_that_it_comes_from(pairs):
    memory = judged_set.Memory()
    lines = []
    real = judged_set.lane_search.line_evidence

    def line_evidence(line, *others):
        lines.append(line)
        return real(line, *others)

    line_evidence.__module__ = real.__module__
    with patch("lane_dp_ros.core.lanes.search.line_evidence", line_evidence):
        counts = []
        for values in ({}, {"lane_selection.score_min": 2.0}, {"disparity.P1": 500}):
            with memory.in_use():
                pairs[0].detected(replaced(DetectorConfig(), values))
            counts.append(len(lines))
    first = lines[: counts[1]]
    assert counts[1] == len({id(line) for line in first}) >= 3  # each once, those of the second look, too
    assert 0 < counts[0] == counts[1] < counts[2]


def test_thresholds_that_are_searched_exist_and_begin_in_the_middle():
    start = leave_a_drive_out.named(leave_a_drive_out.middle())
    for name, grid in thresholds.THRESHOLDS.items():
        assert list(grid) == sorted(set(grid)) and len(grid) % 2 == 1, name
        assert start[name] == grid[len(grid) // 2]
        assert grid[0] <= thresholds.shipped(name) <= grid[-1]
        for value in grid:
            with judged_set.patched(thresholds.changed({name: value})[1]):
                assert not thresholds.is_constant(name) or thresholds.shipped(name) == value


def test_every_number_that_selects_lanes_is_searched():
    of = "lane_selection."
    constants = {of + name for name in vars(lane_selection) if name.isupper()}
    numbers = {
        name
        for name, spec in parameters(DetectorConfig()).items()
        if name.startswith(of) and isinstance(spec.default, float)
    }
    assert {name for name in thresholds.THRESHOLDS if name.startswith(of)} == constants | numbers


def test_a_threshold_that_is_gone_is_said_at_the_start(monkeypatch):
    for name, error in (("lane_selection.GONE", AttributeError), ("lane_selection.gone", ValueError)):
        monkeypatch.setattr(leave_a_drive_out, "THRESHOLDS", {name: (1.0,)})
        with pytest.raises(error, match=r"gone|GONE"):
            leave_a_drive_out.check()


def test_the_objective_falls_with_every_kind_of_error():
    best = leave_a_drive_out.objective([GOOD, BARE])
    assert best == pytest.approx(3 / (20 / 19 + 40 / 38 + 39 / 38))
    for worse in (
        replace(GOOD, missed=2),
        replace(GOOD, matched=37),
        replace(GOOD, false_lanes=2),
        replace(GOOD, matched=0, missed=20, detections=0, false_lanes=0),
    ):
        assert leave_a_drive_out.objective([worse, BARE]) < best
    bare = replace(BARE, detections=1, false_lanes=1)
    assert leave_a_drive_out.objective([GOOD, bare]) < 0.91 * best


def test_the_search_takes_what_is_best_on_the_other_drives_and_nearest_to_the_middle():
    search = leave_a_drive_out.Search(None, {"a": "one", "b": "two"})
    start = leave_a_drive_out.middle()
    grid = thresholds.THRESHOLDS[next(iter(thresholds.THRESHOLDS))]
    missed = {"one": (5, 5, 5, 5, 0), "two": (0, 0, 3, 0, 0), "three": (0, 0, 0, 0, 0)}
    for i, value in enumerate(grid):
        scores = {drive: replace(GOOD, missed=counts[i]) for drive, counts in missed.items()}
        search.scores[(value, *start[1:])] = scores
    assert search._best_along(0, start, ["one"])[0] == grid[4]
    assert search._best_along(0, start, ["two"])[0] == grid[1]
    assert search._best_along(0, start, ["three"])[0] == grid[2]


def test_each_third_pair_of_the_drive_without_paint_is_varied(pairs):
    bare = [replace(pairs[0], name=f"06/{i}", sequence=judged_set.UNPAINTED) for i in range(4)]
    names = [pair.name for pair in leave_a_drive_out.to_vary([*pairs, *bare])]
    assert names == ["road/00", "road/01", "06/1"]


def test_nothing_is_chosen_on_the_drive_that_is_judged():
    drives = ["one", "two", "one, varied", "two, varied", "suite", "one"]
    assert leave_a_drive_out.all_but("one", drives) == ["two", "two, varied", "suite"]


def test_a_mirror_and_an_exposure_change_no_verdict(pairs):
    """Labels lie on the paint of the other camera's picture, sides and all: the lines are found there."""
    for each in varied_pairs.varied(pairs):
        verdict = each.judged(each.detected(DetectorConfig()).lanes)
        assert verdict.name == each.name != pairs[0].name
        assert len(verdict.found) == len(verdict.labels) == 3 and not verdict.false_lanes
        assert not verdict.missed and not verdict.incorrect
        assert max(match.error for match in verdict.found) < 0.05
    assert len({each.name for each in varied_pairs.varied(pairs)}) == 6


def test_a_mirrored_mirror_is_the_pair(pairs):
    twice = varied_pairs.mirrored(varied_pairs.mirrored(pairs[0]))
    np.testing.assert_array_equal(twice.left, pairs[0].left)
    assert twice.camera.cx == pairs[0].camera.cx
    np.testing.assert_allclose(twice.frame.ground, pairs[0].frame.ground)
    assert (twice.frame.ego_left, twice.frame.ego_right) == (
        pairs[0].frame.ego_left,
        pairs[0].frame.ego_right,
    )
    for label, same in zip(twice.frame.labels, pairs[0].frame.labels, strict=True):
        np.testing.assert_allclose(label.uv, same.uv)
        np.testing.assert_allclose(label.xz, same.xz)


def test_another_exposure_leaves_black_and_white(pairs):
    dark = varied_pairs.exposed(pairs[0], 2.0)
    np.testing.assert_array_equal(dark.left, np.rint(255 * (pairs[0].left / 255) ** 2))


@pytest.mark.parametrize(
    ("name", "drive"),
    [
        ("kitti_stereo_2015/000072_10", "stereo 2015, 72-81 (multi-lane)"),
        ("kitti_stereo_2015/000081_10", "stereo 2015, 72-81 (multi-lane)"),
        ("kitti_stereo_2015/000089_10", "stereo 2015, 89"),
    ],
)
def test_neighbours_are_of_one_drive(pairs, name, drive):
    pair = replace(pairs[0], name=name, sequence="kitti_stereo_2015")
    assert leave_a_drive_out.drive_of(pair) == drive


def test_a_frame_of_no_known_drive_is_refused(pairs):
    pair = replace(pairs[0], name="kitti_stereo_2015/000199_10", sequence="kitti_stereo_2015")
    with pytest.raises(Exception, match="000199_10 is of none of the known drives"):
        leave_a_drive_out.drive_of(pair)


def test_every_published_line_comes_with_its_evidence(pairs):
    lines = list(calibrate_confidence.published_lines(pairs, DetectorConfig()))
    assert len(lines) == 6 and all(line.right for line in lines)
    assert all(line.evidence["score"] > 1 and line.evidence["paint_width"] > 0.1 for line in lines)


def test_the_regression_finds_the_share_of_right_lines():
    """Right with probability x^2 / (1 + x^2): z = 2 log x."""
    rng = np.random.default_rng(0)
    x = np.exp(rng.uniform(-1.5, 2.5, 4000))
    right = rng.random(len(x)) < x**2 / (1 + x**2)
    weights = calibrate_confidence.fit_logistic(x[:, None], right.astype(float))
    np.testing.assert_allclose(weights, [0, 2], atol=0.15)
    assert calibrate_confidence.predicted(np.array([[1.0]]), weights)[0] == pytest.approx(0.5, abs=0.04)


@pytest.mark.parametrize("script", [leave_a_drive_out, calibrate_confidence, steady_lines, varied_frames])
def test_data_that_is_not_there_is_one_line(script, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["script", str(tmp_path / "none")])
    assert script.main() == 1
    error = capsys.readouterr().err
    assert error.count("\n") == 1 and "none" in error


def test_each_threshold_is_tried_at_both_limits_that_go_with_the_others():
    tried = dict(what_hinders.extremes())
    assert len(tried) > 20
    assert tried["path_search.min_score 1"][0].path_search.min_score == 1.0
    assert tried["lane_selection.KERB_STEP 0.06"][1] == {"lane_dp_ros.core.lanes.selection.KERB_STEP": 0.06}


def test_a_label_that_is_not_found_is_named(pairs):
    blind = replaced(DetectorConfig(), {"path_search.min_score": 20.0, "lane_selection.score_min": 20.0})
    labels = [label.id for label in pairs[0].frame.labels]
    assert what_hinders.not_found(pairs[0].judged(pairs[0].detected(DetectorConfig()).lanes)) == []
    found = what_hinders.not_found(pairs[0].judged(pairs[0].detected(blind).lanes))
    assert found and set(found) < set(labels)  # the dashed one has too little paint


def test_jitter_is_what_a_line_deviates_from_its_own_motion():
    def lane(identity, x):
        return Lane(np.array([[x, 1.6, 6.0], [x, 1.6, 14.0]]), 1.0, 0.15, "other", 0.0, x, identity)

    def drive(*offsets, identity=3):
        return [(lane(identity, x),) for x in offsets]

    assert steady_lines.jitters(drive(1.0, 1.1, 1.2, 1.3, 1.4, 1.5)) == pytest.approx([0.0, 0.0], abs=1e-9)
    swinging = [0.0, 0.1, 0.0, -0.1, 0.0]
    assert steady_lines.jitters(drive(*swinging)) == pytest.approx([np.std(swinging - np.polyval(
        np.polyfit(range(5), swinging, 1), range(5)))])  # fmt: skip
    assert steady_lines.jitters(drive(*swinging[:4])) == []
    assert steady_lines.jitters(drive(0.0, 0.0, 0.0) + drive(0.0, 0.0, identity=4)) == []


def test_the_frames_are_judged_in_a_mirror_and_at_other_exposures(kitti_data, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["varied_frames", str(kitti_data), "--jobs", "2"])
    assert varied_frames.main() == 0
    rows = capsys.readouterr().out.splitlines()[2:]
    assert [row.split("  ")[0] for row in rows] == [
        "as they are", "in a mirror", "gamma 0.7", "in a mirror, gamma 0.7", "gamma 1.4",
        "in a mirror, gamma 1.4",
    ]  # fmt: skip
    numbers = np.array([row.split()[-9:] for row in rows], float)
    markings, incorrect, missed, precision = numbers.T[:4]
    assert np.all(markings == 69)
    assert np.all(incorrect + missed <= 10)
    assert min(precision) > 0.85 and max(precision) < 1
    assert len(set(missed)) > 1 and len(np.unique(numbers, axis=0)) == 6  # each way is judged by itself


def test_the_lines_of_both_drives_are_steady(kitti_data, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["steady_lines", str(kitti_data)])
    assert steady_lines.main() == 0
    out = capsys.readouterr().out.splitlines()
    assert [line.split(":")[0] for line in out] == ["01", "02", "all"]
    assert ["51 frames" in out[0], "20 frames" in out[1]] == [True, True]
    assert 0.002 < float(out[-1].split()[-2]) <= 0.0105
