# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The benchmarks that judge: they name parameters and functions that exist, and choose and count rightly."""

import contextlib
import io
import re
import sys
from collections import Counter
from dataclasses import replace

import ablation
import drives
import explain_misses
import fit_line_kind
import numpy as np
import other_rigs
import pytest
import steady_lines
import study_runner
import varied_frames
import varied_pairs

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.lanes.candidate import Candidate, LaneEvidence, LaneLine
from lane_dp_ros.core.lanes.evidence_model import evidence_model
from lane_dp_ros.core.lanes.variants import near_half
from lane_dp_ros.core.parameter import replaced
from lane_dp_ros.core.pipeline import LanePipeline
from lane_dp_ros.core.types import Lane, StereoFrame
from lane_dp_ros.tools.evaluation.annotations import Label, LabelledFrame

LINE = LaneLine(np.arange(2), np.array([5.0, 30.0]), np.zeros(2), 0.0, 20.0)


def test_every_change_of_the_ablation_is_possible():
    ablation.check(ablation.ABLATIONS)


@pytest.mark.parametrize("parameters", [{"paint_map.colour": 1}, {"path_search.suppression": 100.0}])
def test_what_is_gone_is_said_at_the_start(parameters):
    with pytest.raises(ValueError, match=r"paint_map.colour|path_search.suppression"):
        ablation.check([ablation.Ablation("a", parameters)])


def test_a_name_that_is_gone_cannot_be_replaced():
    with pytest.raises(AttributeError, match="COLOUR"):
        study_runner.replacing(ablation.paint_map, COLOUR=1)


def test_every_change_of_the_ablation_changes_something():
    changes = [(each.parameters, each.patches) for each in ablation.ABLATIONS]
    assert changes[0] == ({}, {})
    assert all(replaced(DetectorConfig(), p) != DetectorConfig() or patches for p, patches in changes[1:])
    assert len({each.change for each in ablation.ABLATIONS}) == len(changes)


@pytest.mark.parametrize(
    "change", [each for each in ablation.ABLATIONS if each.patches], ids=lambda c: c.change
)
def test_what_takes_the_place_of_a_function_is_called_as_that_was(pairs, change):
    """A detection with it neither fails nor, where a function is replaced, goes round it."""
    called = []

    def watched(function):
        def function_and_note(*arguments):
            called.append(function)
            return function(*arguments)

        return function_and_note if callable(function) else function

    patches = {name: watched(value) for name, value in change.patches.items()}
    config = replaced(DetectorConfig(), change.parameters)
    always = study_runner.replacing(near_half, STEEP=-1.0)  # near halves are wanted
    with study_runner.patched({**patches, **always}):
        pipeline = LanePipeline()
        for pair in pairs:
            pair.followed(config, pipeline)
    assert len(set(called)) == sum(map(callable, change.patches.values()))


def test_a_row_has_a_cell_under_each_head(pairs):
    results = [pair.score(pair.detected(DetectorConfig())) for pair in pairs]
    row = ablation.row(ablation.ABLATIONS[0], results, frozenset())
    assert ablation.heads().split("\n")[0].count("|") == row.count("|")
    assert row.startswith("| none | - |") and "1.000" in row


def test_processes_answer_as_the_detector_does_with_names_replaced_or_not(pairs):
    blind = study_runner.replacing(ablation.paint_map, SENSOR_NOISE=1e9)
    with study_runner.Judges(pairs, jobs=2) as judges:
        seen, nothing = judges.results(DetectorConfig()), judges.results(DetectorConfig(), blind)
        again = judges.results(DetectorConfig())
        strict = judges.results(replaced(DetectorConfig(), {"lane_selection.wide_band_ratio_max": 0.1}))
    assert [result.name for result in seen] == ["road/00", "road/01"]
    assert [len(result.detections) for result in seen] == [3, 3] == [len(r.detections) for r in again]
    assert {d.lane.id for d in seen[0].detections} == {d.lane.id for d in seen[1].detections}  # tracked
    assert [len(result.detections) for result in nothing] == [0, 0]
    assert [len(result.detections) for result in strict] != [3, 3]


def test_pairs_that_are_judged_alone_have_no_ids(pairs):
    with study_runner.Judges(pairs, jobs=1, alone=True) as judges:
        results = judges.results(DetectorConfig())
    assert {d.lane.id for result in results for d in result.detections} == {-1}


def test_a_mirror_and_an_exposure_change_no_verdict(pairs):
    """Labels lie on the paint of the other camera's picture, sides and all: the lines are found there."""
    for each in varied_pairs.varied(pairs):
        verdict = each.score(each.detected(DetectorConfig()))
        assert verdict.name == each.name != pairs[0].name
        assert len(verdict.found) == len(verdict.labels) == 3 and not verdict.false_lines
        assert not verdict.missed and not verdict.incorrect
        assert max(match.error for match in verdict.found) < 0.05
    assert len({each.name for each in varied_pairs.varied(pairs)}) == 6


def test_a_mirrored_mirror_is_the_pair(pairs):
    twice = varied_pairs.mirrored(varied_pairs.mirrored(pairs[0]))
    np.testing.assert_array_equal(twice.frame.left, pairs[0].frame.left)
    assert twice.camera.cx == pairs[0].camera.cx
    np.testing.assert_allclose(twice.truth.ground, pairs[0].truth.ground)
    assert (twice.truth.ego_left, twice.truth.ego_right) == (
        pairs[0].truth.ego_left,
        pairs[0].truth.ego_right,
    )
    for label, same in zip(twice.truth.labels, pairs[0].truth.labels, strict=True):
        np.testing.assert_allclose(label.uv, same.uv)
        np.testing.assert_allclose(label.xz, same.xz)


def test_another_exposure_leaves_black_and_white(pairs):
    dark = varied_pairs.exposed(pairs[0], 2.0)
    np.testing.assert_array_equal(dark.frame.left, np.rint(255 * (pairs[0].frame.left / 255) ** 2))


@pytest.mark.parametrize("name", [name for name in other_rigs.RIGS if "400" not in name])
def test_other_cameras_change_no_verdict(pairs, name):
    """Nor do the labels, which are told in metres, move."""
    rig = other_rigs.RIGS[name](pairs[0])
    verdict = rig.score(rig.detected(DetectorConfig()))
    assert len(verdict.found) == len(verdict.labels) == 3
    assert not verdict.missed and not verdict.incorrect and not verdict.false_lines
    assert max(match.error for match in verdict.found) < 0.05


@pytest.mark.parametrize("offset", [-30, 30])
def test_the_right_picture_of_principal_points_apart_is_moved(pairs, offset):
    """u_left - u_right grows by the offset: what lay at column 600 lies as much farther left."""
    rig = varied_pairs.apart(pairs[0], offset)
    np.testing.assert_array_equal(rig.frame.left, pairs[0].frame.left)
    np.testing.assert_array_equal(rig.frame.right[:, 600 - offset], pairs[0].frame.right[:, 600])
    assert rig.camera.disparity_offset == offset
    assert rig.name != pairs[0].name


def test_a_picture_of_half_the_size_has_half_the_focal_length(pairs):
    half = varied_pairs.resized(pairs[0], 0.5)
    assert half.frame.left.shape == (188, 621)
    assert half.camera.fx == pairs[0].camera.fx / 2
    assert half.camera.cx == (pairs[0].camera.cx + 0.5) / 2 - 0.5  # pixel centres lie half a pixel in
    assert half.camera.fy == pytest.approx(188 / 375 * pairs[0].camera.fy)


@pytest.mark.parametrize(
    ("number", "drive", "expected"),
    [
        ("000072", "", "stereo 2015, 72-81 (multi-lane)"),
        ("000081", "", "stereo 2015, 72-81 (multi-lane)"),
        ("000089", "", "stereo 2015, 89"),
        ("000025", "kit15_busroad_a", "stereo 2015, 22-31 (dual carriageway)"),
        ("000131", "kit15_parkedcars", "stereo 2015, kit15_parkedcars"),
    ],
)
def test_neighbours_are_of_one_drive(pairs, number, drive, expected):
    name, truth = f"kitti_stereo_2015/{number}_10", replace(pairs[0].truth, drive=drive)
    pair = replace(pairs[0], name=name, sequence="kitti_stereo_2015", truth=truth)
    assert drives.drive_of(pair) == expected


def test_a_frame_of_no_known_drive_is_refused(pairs):
    pair = replace(pairs[0], name="kitti_stereo_2015/000199_10", sequence="kitti_stereo_2015")
    with pytest.raises(Exception, match="000199_10 is of no known drive"):
        drives.drive_of(pair)


def test_every_labelled_frame_is_of_a_drive(kitti_data):
    pairs = study_runner.labelled_pairs(kitti_data, kitti_data / "labels" / "lanes.json")
    count = Counter(map(drives.drive_of, pairs))
    assert count.total() == len(pairs) and len(count) > 15
    assert count["stereo 2015, kit15_turn"] == 2 and count["stereo 2015, 119-126 (gutters)"] == 6


def test_a_row_that_counts_twice_is_as_two_rows():
    A, right = np.array([[1.0, -1.0], [1.0, 0.5], [1.0, 2.0]]), np.array([0.0, 1.0, 1.0])
    counts = np.array([1.0, 2.0, 1.0])
    np.testing.assert_allclose(
        fit_line_kind.logistic_weights(A, right, counts),
        fit_line_kind.logistic_weights(A[[0, 1, 1, 2]], right[[0, 1, 1, 2]]),
    )


def known_line(road, dashed, missing, run):
    return fit_line_kind.KnownLine(fit_line_kind.RoadPair(None, "", road), dashed, missing, run, True)


def test_the_kind_of_a_line_is_judged_by_the_other_roads():
    """On two roads dashes are what lacks much, on the third nothing but what is short."""
    plain = [known_line(r, d, 0.05 + 0.5 * d + 0.01 * i, 5.0) for r in "ab" for d in (0, 1) for i in range(9)]
    odd = [known_line("c", True, 0.05 + 0.01 * i, 2.0) for i in range(9)]
    right = fit_line_kind.left_out([*plain, *odd])
    assert all(right[line] for line in plain)
    assert not any(right[line] for line in odd)


def test_known_lines_are_those_on_sure_labels(pairs):
    lines = [
        line for pair in pairs for line in fit_line_kind.known_lines(fit_line_kind.RoadPair(pair, "", ""))
    ]
    lanes = [line for line in lines if line.is_lane]
    assert sorted(line.dashed for line in lanes) == [False, False, False, False, True, True]
    assert all((line.missing > 0.4) == line.dashed for line in lanes)


@pytest.mark.parametrize("script", [explain_misses, fit_line_kind, steady_lines, varied_frames])
def test_data_that_is_not_there_is_one_line(script, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["script", str(tmp_path / "none")])
    assert script.main() == 1
    error = capsys.readouterr().err
    assert error.count("\n") == 1 and "none" in error


def test_a_label_that_is_not_found_is_named_with_what_refused_it(pairs):
    blind = replaced(DetectorConfig(), {"lane_selection.paint_width_max": 0.1})
    (pair, _), labels = pairs, [label.id for label in pairs[0].truth.labels if label.painted]
    assert explain_misses.not_found(pair.score(pair.detected(DetectorConfig()))) == []
    assert explain_misses.not_found(pair.score(pair.detected(blind))) == labels  # all are broader
    lines = list(explain_misses.misses([pair], blind))
    assert [line for line in lines if not line.startswith("  ")] == [f"road/00 {label}:" for label in labels]
    why = [line for line in lines if line.startswith("  path, 0.0")]
    assert len(why) >= 3
    assert all(re.search(r"m of paint: (0\.1\d m broad|a road edge) \(\w+ -\d", text) for text in why)


def test_what_costs_a_line_most_is_told_first():
    """Far, steep and faint: each measurement against the best that it could be."""
    best = LaneEvidence(length=25.0, start=5.0, slope=0.01, contrast=1.0, paint_width=0.13)
    model = evidence_model()
    far = replace(best, start=39.0)
    told = dict(each.split() for each in explain_misses.costs(Candidate(LINE, far), model).split(", "))
    term = model.terms["paint"]["start"]
    assert len(told) == 3
    assert float(told["start"]) == pytest.approx(float(term(39.0)) - term.highest, abs=0.06)
    assert [float(each) for each in told.values()] == sorted(map(float, told.values()))


def test_a_label_without_a_candidate_is_named_with_what_the_detector_says(pairs):
    nothing = replaced(DetectorConfig(), {"paint_map.contrast_max": 20.0, "paint_map.contrast_min": 10.0})
    lines = list(explain_misses.misses(pairs, nothing))
    wanted = [label for label in pairs[0].truth.labels if label.counts]
    assert len(lines) == 2 * len(pairs) * len(wanted)
    assert set(lines[1::2]) == {"  no lanes among 0 paths"}
    alone = replace(pairs[0], frame=StereoFrame(pairs[0].frame.left))
    assert list(explain_misses.misses([alone], DetectorConfig()))[1] == "  no right image"


def test_how_far_beside_a_label_a_lane_lies():
    """The road is level, 1.5 m below the camera; the label runs straight from 6 to 20 m."""
    camera = StereoCamera(700.0, 700.0, 600.0, 180.0, 0.5)
    label = Label("L", "solid", True, np.empty((0, 2)), np.array([[-1.5, 6.0], [-1.5, 20.0]]))
    truth = LabelledFrame("a/1", camera, (1200, 400), np.array([0.0, 100 * 0.5 / 1.5, 0.0, 0.0]), (label,))
    pair = study_runner.JudgedPair("a/1", "a", StereoFrame(np.zeros((400, 1200), np.uint8)), camera, truth)

    def lane(*points):
        return Lane(np.array([[x, 1.5, z] for x, z in points]), 1.0, 0.15, "other", 0.0, 0.0)

    assert explain_misses.beside(pair, label, lane((-1.4, 4.0), (-1.4, 30.0))) == pytest.approx((0.1, 1.0))
    askew = explain_misses.beside(pair, label, lane((-1.7, 6.0), (-1.3, 20.0)))  # 0.2 m at both ends
    assert askew == pytest.approx((0.1, 1.0), abs=0.005)
    half = explain_misses.beside(pair, label, lane((-1.6, 13.3), (-1.6, 30.0)))
    assert half == pytest.approx((0.1, 14 / 29))  # of the samples, half a metre apart, those from 13.5 m on
    assert explain_misses.beside(pair, label, lane((-1.5, 21.0), (-1.5, 30.0))) == (np.inf, 0.0)


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


def printed(script, *arguments):
    """Return the lines that a script prints."""
    out = io.StringIO()
    with pytest.MonkeyPatch.context() as patch, contextlib.redirect_stdout(out):
        patch.setattr(sys, "argv", ["script", *map(str, arguments)])
        assert script.main() == 0
    return out.getvalue().splitlines()


@pytest.fixture(scope="module")
def ways(kitti_data):
    """The rows of the labelled frames as they are, in a mirror and at other exposures."""
    return printed(varied_frames, kitti_data, "--jobs", "2")[2:]


def test_the_frames_are_judged_in_a_mirror_and_at_other_exposures(ways):
    assert [row.split("  ")[0] for row in ways] == [
        "as they are", "in a mirror", "gamma 0.7", "in a mirror, gamma 0.7", "gamma 1.4",
        "in a mirror, gamma 1.4",
    ]  # fmt: skip
    numbers = np.array([row.split()[-11:] for row in ways], float)
    markings, _, missed, precision = numbers.T[:4]
    assert np.all(markings == 81)
    assert min(precision) > 0.8 and max(precision) < 1
    assert len(set(missed)) > 1 and len(np.unique(numbers, axis=0)) == 6  # each way is judged by itself


@pytest.mark.xfail(
    reason="in a mirror and at other exposures up to 11 of 81 are lost, where 7 are as they are", strict=True
)
def test_another_view_of_the_frames_loses_few_more_lines(ways):
    numbers = np.array([row.split()[-11:] for row in ways], float)
    assert np.all(numbers[:, 1] + numbers[:, 2] <= 10)  # incorrect and missed


def test_the_lines_of_both_drives_are_steady(kitti_data):
    out = printed(steady_lines, kitti_data)
    assert [line.split(":")[0] for line in out] == ["01", "02", "all"]
    assert "51 frames" in out[0] and "20 frames" in out[1]
    assert 0.002 < float(out[-1].split()[-2]) <= 0.0115
