# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""lane_dp evaluate --compare: what got better and what worse, in numbers and frame by frame."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from lane_dp_ros.core.types import Lane
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.scenes import CAMERA
from lane_dp_ros.tools.cli import main
from lane_dp_ros.tools.evaluation.annotations import Label, LabelledFrame
from lane_dp_ros.tools.evaluation.changes import apart, compare
from lane_dp_ros.tools.evaluation.changes_text import LISTED, comparison_text
from lane_dp_ros.tools.evaluation.depth import CURVE_DEPTHS, NO_SURFACE, DepthErrors
from lane_dp_ros.tools.evaluation.json_file import EvaluationFile, write_json
from lane_dp_ros.tools.evaluation.matching import judge, judge_unpainted
from lane_dp_ros.tools.evaluation.measures import MEASURES, Difference
from lane_dp_ros.tools.evaluation.scores import FrameScore
from lane_dp_ros.tools.evaluation.summary import Summary

HEIGHT = 1.65  # m
GROUND = np.array([0.0, 100 * CAMERA.baseline / HEIGHT, 0.0, 0.0])


def line(x, first=5.0):
    z = np.arange(first, 28.0, 0.5)
    return np.column_stack([np.full_like(z, x), np.full_like(z, HEIGHT), z])


def lane(x, confidence=0.9, first=5.0):
    return Lane(line(x, first), confidence, 0.12, "ego_left" if x < 0 else "ego_right", 0.0, x)


def frame(name="a/1", **fields):
    """Return a frame with lines L and R beside the vehicle, and O at -5.4 m."""
    lines = {"L": line(-1.8), "R": line(1.8), "O": line(-5.4)}
    labels = tuple(Label(i, "solid", True, CAMERA.project(p), p[:, [0, 2]]) for i, p in lines.items())
    return LabelledFrame(name, CAMERA, (1242, 375), GROUND, labels, "L", "R", **fields)


def score(*xs, name="a/1", **fields):
    """Return the verdict on lines at these places [m]."""
    return judge(frame(name, **fields), [lane(x) for x in xs], CAMERA)


def comparison(before, after):
    files = [
        EvaluationFile(Path(f"{name}.json"), tuple(each)) for name, each in (("A", before), ("B", after))
    ]
    return compare(*files)


def changed(before, after):
    """Return what got worse and what better in a frame, in words."""
    changes = comparison([before], [after]).changes
    return [(each.worse, each.better) for each in changes]


ALL = score(-1.8, 1.8, -5.4)


def test_a_frame_without_a_change_is_none():
    assert changed(ALL, score(-1.79, 1.81, -5.4)) == []


@pytest.mark.parametrize(
    ("found", "lost", "weight"),
    [
        ((1.8, -5.4), "L missed", 3),
        ((1.8, -5.4, -0.9), "L incorrect", 3),  # and the line 0.9 m beside it is false
        ((-1.8, 1.8), "O not found", 1),
    ],
)
def test_a_label_that_is_lost_or_found_again(found, lost, weight):
    poor = score(*found)
    (worse,) = comparison([ALL], [poor]).changes
    (better,) = comparison([poor], [ALL]).changes
    assert worse.worse[0] == f"{lost}, was found" and worse.better == ()
    assert better.better[0] == f"{lost[0]} found, was {lost[2:]}" and better.worse == ()
    assert worse.gain == -better.gain == -weight - 3 * (len(found) == 3)


def test_wrong_lines_that_come_go_and_stay():
    some = score(-1.8, 1.8, -5.4, 3.6)
    assert changed(ALL, some) == [(("new false line 3.6 m right (confidence 0.90)",), ())]
    assert changed(some, ALL) == [((), ("false line 3.6 m right gone",))]
    assert changed(some, score(-1.8, 1.8, -5.4, 3.9)) == []  # 0.3 m aside, it is the same
    assert changed(some, score(-1.8, 1.8, -5.4, 4.0)) == [
        (("new false line 4.0 m right (confidence 0.90)",), ("false line 3.6 m right gone",))
    ]
    assert changed(ALL, score(-1.8, 1.8, -5.4, 2.0)) == [
        (("new duplicate line 2.0 m right (confidence 0.90)",), ())
    ]


def test_an_error_that_a_label_itself_may_have_is_no_change():
    assert changed(ALL, score(-1.8, 1.76, -5.4)) == []
    assert changed(ALL, score(-1.8, 1.72, -5.4)) == [(("R 0.08 m off, was 0.00 m",), ())]
    assert changed(score(-1.8, 1.72, -5.4), ALL) == [((), ("R 0.00 m off, was 0.08 m",))]


def test_a_surface_that_is_measured_no_longer():
    measured = replace(ALL, depth=DepthErrors((0.0,) * len(CURVE_DEPTHS)))
    assert changed(measured, replace(ALL, depth=NO_SURFACE)) == [(("no road surface, was measured",), ())]
    assert changed(replace(ALL, depth=NO_SURFACE), measured) == [((), ("road surface measured, was none",))]
    assert changed(ALL, replace(ALL, depth=NO_SURFACE)) == []  # it was not known before


def test_the_worst_comes_first_and_a_frame_may_be_both():
    names = "a/worse", "a/worst", "a/better", "a/both", "a/alike"
    before = [score(*x, name=name) for name, x in zip(names, [(-1.8, 1.8)] * 5, strict=True)]
    xs = [(-1.8, 1.8, 3.6), (3.6,), (-1.8, 1.8, -5.4), (-1.8, 1.8, -5.4, 2.0), (-1.8, 1.8)]
    after = [score(*x, name=name) for name, x in zip(names, xs, strict=True)]
    found = comparison(before, after)
    assert [change.after.name for change in found.changes] == ["a/worst", "a/worse", "a/both", "a/better"]
    assert [len(each) for each in (found.worse, found.mixed, found.better)] == [2, 1, 1]
    text = comparison_text(found)
    assert "5 frames: 1 better, 2 worse, 1 better in one thing and worse in another, 1 unchanged." in text
    assert text.index("\nworse:\n  a/worst: L missed, was found") < text.index(
        "\nbetter:\n  a/better: O found"
    )


def test_only_frames_of_both_count():
    found = comparison([ALL, score(name="a/2")], [ALL, score(name="a/3"), score(name="a/4")])
    assert [result.name for result in found.before] == [result.name for result in found.after] == ["a/1"]
    assert found.notes == (
        "1 frames are in A.json alone, left out",
        "2 frames are in B.json alone, left out",
    )
    with pytest.raises(CommandError, match=r"A.json and B.json have no frame in common"):
        comparison([ALL], [score(name="a/2")])


def test_frames_without_truth_are_paired_by_their_stamps():
    """The name of a bag is part of theirs, and that of what another release recorded is another."""
    before = judge_unpainted("old/7", [lane(1.0)], "old", 7)
    after = judge_unpainted("new/7", [], "new", 7)
    assert changed(before, after) == [((), ("false line 1.0 m right gone",))]


def test_other_labels_are_told_of():
    relabelled = judge(replace(frame(), ego_left=None), [lane(-1.8)], CAMERA)
    (note,) = comparison([ALL], [relabelled]).notes
    assert note == "1 frames were judged by different labels: their numbers are not of like with like"


def test_how_far_lines_lie_apart():
    assert apart(lane(1.0), lane(1.5)) == pytest.approx(0.5)
    assert apart(lane(1.0), lane(1.5, first=27.0)) == pytest.approx(0.5)
    short = replace(lane(1.0), points=line(1.0)[:4])
    assert apart(short, lane(1.0, first=10.0)) == math.inf  # it ends at 6.5 m


MEASURE_OF = {measure.name: measure for measure in MEASURES}


@pytest.mark.parametrize(
    ("name", "before", "after", "verdict"),
    [
        ("recall", Summary(labels=4, matched=1), Summary(labels=4, matched=2), "better"),
        ("recall", Summary(labels=4, matched=2), Summary(labels=4, matched=1), "worse"),
        ("false lanes per frame", Summary(frames=2, false_lanes=1), Summary(frames=2), "better"),
        ("missed", Summary(ego_labels=2), Summary(ego_labels=2, missed=1), "worse"),
        (
            "error [m]",
            Summary(matched=9, error_sum=0.9),
            Summary(matched=9, error_sum=0.9001),
            "",
        ),  # reads alike
        ("recall", Summary(), Summary(labels=4, matched=1), ""),  # there was nothing to count
        ("id switches", Summary(id_switches=0), Summary(id_switches=1, id_chances=2), ""),
        (
            "id switches",
            Summary(id_chances=2),
            Summary(id_switches=1, id_chances=2),
            "worse",
        ),
    ],
)
def test_which_way_a_number_is_better(name, before, after, verdict):
    assert Difference.of(MEASURE_OF[name], before, after).verdict == verdict


def test_every_measure_of_a_whole_summary_can_be_printed():
    for measure in MEASURES:
        assert Difference.of(measure, Summary(), Summary()).verdict == ""


def test_sequences_and_categories_are_told_apart():
    frames = [("a/1", "curve"), ("a/2", ""), ("b/1", "curve"), ("b/2", "glare")]
    before = [score(-1.8, name=name, category=category) for name, category in frames]
    after = [
        score(-1.8, *([1.8] if name[0] == "b" else [3.6]), name=name, category=category)
        for name, category in frames
    ]
    text = comparison_text(comparison(before, after))
    rows = {line.split()[0]: line for line in text.splitlines() if line}
    assert rows["a"].split()[1:7] == ["0.500", "0.333", "1.000", "->", "0.500", "!"]
    assert rows["b"].split()[1:5] == ["0.500", "->", "1.000", "+"]
    assert rows["glare"].split()[1:5] == ["0.500", "->", "1.000", "+"]


def test_long_lists_end():
    before = [score(name=f"a/{i}") for i in range(LISTED + 3)]
    after = [score(-1.8, name=f"a/{i}") for i in range(LISTED + 3)]
    text = comparison_text(comparison(before, after))
    assert text.count("L found, was missed") == LISTED
    assert text.endswith("  and 3 more: see --report")


@pytest.fixture
def files(tmp_path):
    write_json([ALL, score(-1.8, name="a/2")], (), tmp_path / "A.json")
    write_json([ALL, score(-1.8, 1.8, name="a/2")], (), tmp_path / "B.json", tmp_path / "gone")
    return [str(tmp_path / "A.json"), str(tmp_path / "B.json")]


def test_the_command(files, capsys):
    assert main(["evaluate", "--compare", *files]) == 0
    out = capsys.readouterr().out
    assert out.startswith(f"A: {files[0]}, B: {files[1]}\n")
    rows = [line.split() for line in out.splitlines()]
    assert ["paper's", "precision", "0.750", "1.000", "+0.250", "better"] in rows
    assert "  a/2: R found, was missed" in out.splitlines()


def test_what_cannot_be_compared_is_one_line(files, tmp_path, capsys):
    def failure(*arguments):
        assert main(["evaluate", "--compare", *arguments]) == 1
        (text,) = capsys.readouterr().err.splitlines()
        return text

    assert "none.json: No such file" in failure(files[0], str(tmp_path / "none.json"))
    missing = failure(*files, "--report", str(tmp_path / "page"), str(tmp_path / "gone"))
    assert f"{tmp_path}/gone: no such bag or folder" in missing
    content = json.loads(Path(files[1]).read_text())
    del content["frames"][0]["detections"][0]["points"]
    Path(files[1]).write_text(json.dumps(content))
    assert "lacks 'points'; perhaps an earlier release wrote it" in failure(*files)


@pytest.mark.parametrize("spare", [("--json", "x.json"), ("--max-error", "1"), ("--unpainted",)])
def test_what_judges_anew_does_not_go_with_it(files, spare, capsys):
    with pytest.raises(SystemExit) as exit_:
        main(["evaluate", "--compare", *files, *spare])
    assert exit_.value.code == 2
    assert f"--compare takes BAG_OR_DIR and --report alone, not {spare[0]}" in capsys.readouterr().err


def test_images_without_a_report_have_no_use(files, tmp_path, capsys):
    with pytest.raises(SystemExit):
        main(["evaluate", str(tmp_path), "--compare", *files])
    assert "takes BAG_OR_DIR for the images of --report alone" in capsys.readouterr().err


def test_frames_of_a_surface_alone_can_be_compared():
    near, far = (
        [FrameScore("s/1", "s", "", None, (), depth=DepthErrors((error,) * len(CURVE_DEPTHS)))]
        for error in (0.01, 0.05)
    )
    assert "at 12 m   1.00   5.00   +4.00  worse" in comparison_text(comparison(near, far))
