# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The judge of sameness: what it calls a difference, whose answers it compares, and on which bags."""

import json
import subprocess
import sys
from pathlib import Path

import cv2
import input_bags
import lane_changes
import numpy as np
import pytest
import same_answers
import versions

from lane_dp_ros.core.types import Lane
from lane_dp_ros.messages.bag import BagReader
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.tools.evaluation.answers import FrameAnswer

FRAME = {"fx": 700.0, "fy": 700.0, "cx": 40.0, "cy": 20.0, "baseline": 0.5, "width": 80, "height": 60}
GROUND = {"ground": [0.0, 30.0, 0.0, 0.0], "ego_left": None, "ego_right": None, "lanes": []}


def line(*points, confidence=0.9, role="other"):
    """A line through points (x, z) on a level road."""
    return Lane(np.array([[x, 1.65, z] for x, z in points]), confidence, 0.15, role, 0.0, points[0][0])


def straight(x, confidence=0.9):
    return line((x, 6.0), (x, 20.0), confidence=confidence)


def kinds(old, new):
    return [change.kind for change in lane_changes.changes("a/1", old, new)]


def test_equal_lines_are_no_difference_in_any_order():
    assert kinds([straight(-1.8), straight(1.7)], [straight(1.7), straight(-1.8)]) == []
    assert kinds([], []) == []


def test_a_line_that_appears_and_one_that_vanishes():
    left, right = straight(-1.8), straight(1.7)
    assert kinds([left], [left, right]) == ["appears"]
    assert kinds([left, right], [right]) == ["vanishes"]
    change = lane_changes.changes("a/1", [left], [])[0]
    assert str(change) == "a/1: vanishes: other, x -1.80 m, 6.0 to 20.0 m, confidence 0.90"


@pytest.mark.parametrize(
    ("aside", "expected"),
    [(0.01, []), (-0.01, []), (0.03, ["moves"]), (-0.03, ["moves"]), (0.49, ["moves"])],
)
def test_more_than_two_centimetres_are_a_move(aside, expected):
    assert kinds([straight(1.7)], [straight(1.7 + aside)]) == expected


def test_half_a_metre_aside_is_another_line():
    assert kinds([straight(1.7)], [straight(2.25)]) == ["vanishes", "appears"]


def test_the_largest_distance_counts_not_the_mean():
    """The old line is straight between its ends; the new one bends away by 3 cm in the middle alone."""
    bent = line((1.7, 6.0), (1.7, 12.5), (1.73, 13.0), (1.7, 13.5), (1.7, 20.0))
    assert kinds([straight(1.7)], [bent]) == ["moves"]
    np.testing.assert_allclose(lane_changes.lateral_distances(straight(1.7), bent), [0, 0, 0.03, 0, 0])


def test_only_shared_depths_are_compared():
    """x = z / 10; the lines share 10 to 20 m, and leave each other where only one of them is."""
    old, new = line((0.6, 6.0), (2.0, 20.0)), line((1.0, 10.0), (2.0, 20.0), (9.0, 30.0))
    assert kinds([old], [new]) == ["extent"]
    np.testing.assert_allclose(lane_changes.lateral_distances(old, new), [0, 0], atol=1e-12)
    apart = line((2.1, 21.0), (3.0, 30.0))
    assert kinds([old], [apart]) == ["vanishes", "appears"]


@pytest.mark.parametrize(
    ("confidence", "expected"),
    [(0.86, []), (0.94, []), (0.84, ["confidence"]), (0.96, ["confidence"])],
)
def test_six_hundredths_of_confidence_are_a_difference(confidence, expected):
    assert kinds([straight(1.7, 0.9)], [straight(1.7, confidence)]) == expected


@pytest.mark.parametrize(
    ("near", "far", "expected"),
    [
        (6.9, 20.9, []),
        (5.1, 19.1, []),
        (7.1, 20.0, ["extent"]),
        (6.0, 21.1, ["extent"]),
        (4.9, 18.9, ["extent"]),
    ],
)
def test_more_than_a_metre_of_extent_is_a_difference(near, far, expected):
    assert kinds([straight(1.7)], [line((1.7, near), (1.7, far))]) == expected
    if expected:
        (change,) = lane_changes.changes("a/1", [straight(1.7)], [line((1.7, near), (1.7, far))])
        assert "from 6.0 to 20.0 m: other" in str(change)


def test_another_role_is_a_difference():
    old, new = (line((1.7, 6.0), (1.7, 20.0), role=role) for role in ("ego_right", "other"))
    (change,) = lane_changes.changes("a/1", [old], [new])
    assert (change.kind, change.text[:23]) == ("role", "from ego_right: other, ")


def test_a_line_may_differ_in_two_ways():
    assert kinds([straight(1.7, 0.9)], [straight(1.73, 0.8)]) == ["moves", "confidence"]


def test_lines_go_one_to_one_the_nearest_first():
    """The new line at 0.3 is within reach of both old ones; the nearer one at 0.4 takes it."""
    old, new = [straight(0.0), straight(0.4)], [straight(0.3)]
    assert lane_changes.same_lines(old, new) == [(1, 0)]
    assert kinds(old, new) == ["vanishes", "moves"]
    # Here the nearest pair leaves the other old line with the other new one.
    assert lane_changes.same_lines(old, [straight(0.3), straight(-0.1)]) == [(0, 1), (1, 0)]


def test_a_missing_answer_is_not_an_empty_one():
    assert kinds(None, []) == kinds([], None) == ["no answer"]
    assert str(lane_changes.changes("a/1", [straight(1.7)], None)[0]) == "a/1: no answer: by the new one"
    assert kinds(None, None) == []


def test_totals_and_scores_tell_what_differs():
    bag = input_bags.InputBag("06", Path(), {1: "06/000000", 2: "06/000001"})
    old = {1: FrameAnswer((straight(1.7),)), 2: FrameAnswer(())}
    new = {1: FrameAnswer((straight(1.73), straight(-1.8)))}
    comparison = same_answers.Comparison("paper", bag, old, new)
    (total,) = same_answers.totals([comparison])
    counts = "appears 1, vanishes 0, moves 1, extent 0, role 0, confidence 0, no answer 1"
    assert total == f"paper    06          2 frames,    1 and    2 lines: {counts}"
    rows = same_answers.scores([comparison], "paper", frozenset()).splitlines()
    of_06 = [row.split()[-6:] for row in rows if "06, without paint" in row]
    assert [(row[0], row[-1]) for row in of_06] == [("2", "1"), ("2", "2")]


@pytest.mark.parametrize(
    "entry", ["'lane_dp = lane_dp_ros.cli.main:run'", '"lane_dp=lane_dp_ros.cli.main:run"']
)
def test_the_command_is_found_wherever_it_is(tmp_path, entry):
    names = f"['lane_detector = lane_dp_ros.ros.node:main', {entry}]"
    (tmp_path / "setup.py").write_text(f"setup(entry_points={{'console_scripts': {names}}})")
    assert versions.entry_point(tmp_path) == ("lane_dp_ros.cli.main", "run")


def test_what_is_no_version_is_said(tmp_path):
    with pytest.raises(CommandError, match=r"setup\.py names no command 'lane_dp = module:function'"):
        versions.entry_point(tmp_path)
    with pytest.raises(CommandError, match=r"git rev-parse --verify no-such-revision"):
        with versions.version("no-such-revision", tmp_path):
            pass


def test_a_folder_with_changes_is_no_commit(tmp_path):
    def git(*arguments):
        subprocess.run(["git", "-C", tmp_path, *arguments], check=True, capture_output=True)

    assert versions.clean_commit(tmp_path) is None
    git("init")
    (tmp_path / "file").write_text("1")
    git("add", "file")
    git("-c", "user.name=a", "-c", "user.email=a@b", "commit", "-m", "first")
    commit = versions.clean_commit(tmp_path)
    assert commit is not None and len(commit) == 40
    (tmp_path / "part").mkdir()
    assert versions.clean_commit(tmp_path / "part") is None
    (tmp_path / "new").write_text("2")
    assert versions.clean_commit(tmp_path) is None


def test_a_tree_answers_by_its_own_command(tmp_path):
    (tmp_path / "setup.py").write_text("'lane_dp = moved_package.deep.commands:begin'")
    folder = tmp_path / "moved_package" / "deep"
    folder.mkdir(parents=True)
    (folder / "commands.py").write_text("import sys\ndef begin():\n    sys.exit(' '.join(sys.argv[1:]))")
    version = versions.Version(tmp_path, tmp_path / "answers")
    with pytest.raises(CommandError, match=r"lane_dp run of .*: run BAG$"):
        version.lane_dp("run", "BAG")
    (tmp_path / "setup.py").write_text("'lane_dp = json:dumps'")
    with pytest.raises(CommandError, match=r"json is not that of"):
        version.lane_dp("run", "BAG")


def test_answers_are_worked_out_once_and_kept_without_pictures(
    tmp_path, scene_pairs, write_stereo_bag, monkeypatch
):
    bag = write_stereo_bag(scene_pairs)
    version = versions.Version(versions.HERE, tmp_path / "answers")
    found = version.lanes_in(bag, "default")
    assert list(found) == [pair.stamp_ns for pair in scene_pairs]
    assert all(len(answer.lanes) >= 2 for answer in found.values())
    with BagReader(next(version.answers.iterdir())) as kept:
        assert set(kept.topics) == {"/lanes", "/left/camera_info", "/right/camera_info"}
    monkeypatch.setattr(versions.Version, "lane_dp", None)
    again = version.lanes_in(bag, "default")
    assert [kinds(found[i].lanes, again[i].lanes) for i in found] == [[], [], []]
    with pytest.raises(TypeError):
        version.lanes_in(bag, "paper")


def test_labelled_frames_of_two_cameras_make_two_bags(tmp_path):
    frames = {}
    for i, fx in enumerate((700.0, 710.0, 700.0)):
        for side in ("left", "right"):
            cv2.imwrite(str(tmp_path / f"{side}{i}.png"), np.full((60, 80), 10 * i, np.uint8))
        names = {"left": f"left{i}.png", "right": f"right{i}.png"}
        frames[f"a/{i}"] = {**FRAME, **GROUND, **names, "fx": fx, **({"drive": "new"} if i == 2 else {})}
    (tmp_path / "labels").mkdir()
    (tmp_path / "labels" / "lanes.json").write_text(json.dumps(frames))
    bags = input_bags.labelled_bags(tmp_path, tmp_path / "cache")
    assert [bag.names for bag in bags] == [{2 * 10**9: "a/0", 4 * 10**9: "a/2"}, {2 * 10**9: "a/1"}]
    for bag, fx, grey in zip(bags, (700.0, 710.0), ([0, 20], [10]), strict=True):
        with BagReader(bag.path) as reader:
            infos = [message for *_, message in reader.messages(["/right/camera_info"])]
            images = [message for *_, message in reader.messages(["/left/image_rect"])]
        assert [(info.p[0], info.p[3]) for info in infos] == [(fx, -fx * 0.5)] * len(grey)
        assert [image.data[0] for image in images] == grey
    assert same_answers.older_frames(tmp_path / "labels" / "lanes.json") == {"a/0", "a/1"}
    assert [bag.path for bag in input_bags.labelled_bags(tmp_path, tmp_path / "cache")] == [
        bag.path for bag in bags
    ]


def test_the_exit_code_tells_whether_anything_differs(tmp_path, monkeypatch, capsys):
    bag = input_bags.InputBag("06", Path(), {1: "06/000000"})
    (tmp_path / "labels").mkdir()
    (tmp_path / "labels" / "lanes.json").write_text("{}")
    monkeypatch.setattr(sys, "argv", ["same_answers", "OLD", "NEW", str(tmp_path)])
    for lanes, code in (((), 0), ((straight(1.7),), 1)):
        found = same_answers.Comparison("paper", bag, {1: FrameAnswer(())}, {1: FrameAnswer(lanes)})
        monkeypatch.setattr(same_answers, "compared", lambda *_, found=found: [found])
        assert same_answers.main() == code
    printed = capsys.readouterr()
    assert "paper, 06, 06/000000: appears: other, x +1.70 m" in printed.out
    assert printed.err == "differences between OLD and NEW: 1\n"
