# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What is said of a drive: counted as the paper does, and never lost."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.review.judgement import (
    Judgement,
    Line,
    Table,
    judgement_from_json,
    judgement_to_json,
    lines_from_json,
    table_of,
)
from lane_dp_ros.review.review_file import ReviewFile, locked

LINE = Line("7", "ego_left", "dashed", True, ((10.0, 190.0), (150.5, 80.25)))
FIELDS = {"id": "7", "role": "ego_left", "kind": "solid", "sure": True, "uv": [[0, 1], [2.5, 3]]}


def opened(path: Path, lanes: str = "lanes") -> ReviewFile:
    file = ReviewFile(path)
    file.use_for(lanes)
    return file


def test_the_table_counts_what_the_paper_counts() -> None:
    said = [
        Judgement("correct", "correct"),
        Judgement("incorrect", "missed"),
        Judgement("missed", "none"),
        Judgement("correct", None),
        Judgement(),
    ]
    assert table_of(said) == Table(total=6, incorrect=1, missed=2)
    assert table_of(said).precision == pytest.approx(3 / 6)
    assert table_of(said).text("drive").splitlines() == [
        "sequence | total lane markings | incorrect | missed | precision",
        "drive    |                   6 |         1 |      2 |    50.0 %",
    ]


def test_a_drive_without_markings_has_no_precision() -> None:
    assert table_of([Judgement("none", "none")]).precision is None
    assert table_of([]).text("drive").endswith("|         -")


@pytest.mark.parametrize(
    "judgement",
    [Judgement(), Judgement("correct"), Judgement("none", "missed", ()), Judgement(lines=(LINE,))],
)
def test_a_judgement_as_json_and_back(judgement) -> None:
    assert judgement_from_json(json.loads(json.dumps(judgement_to_json(judgement)))) == judgement


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ([], "[] is no judgement: expected left, right, lines"),
        ({"left": "right"}, "verdict is 'right', expected one of correct, incorrect, missed, none"),
        ({"up": "correct"}, "is no judgement"),
        ({"lines": {}}, "lines are {}, expected a list of at most 50"),
        ({"lines": [{}]}, "{} is no line: expected id, role, kind, sure, uv"),
        ({"lines": [{**FIELDS, "kind": "dotted"}]}, "kind is 'dotted', expected one of solid, dashed, edge"),
        ({"lines": [{**FIELDS, "role": []}]}, "role is [], expected one of ego_left, ego_right, other"),
        ({"lines": [{**FIELDS, "sure": 1}]}, "sure is 1, expected true or false"),
        ({"lines": [{**FIELDS, "id": ""}]}, "id is '', expected a text of 1 to 40 characters"),
        ({"lines": [{**FIELDS, "uv": [[1, 2]]}]}, "uv is [[1, 2]], expected 2 to 1000 points"),
        ({"lines": [{**FIELDS, "uv": [[1, 2], [3, float("nan")]]}]}, "[3, nan], expected two finite numbers"),
        ({"lines": [{**FIELDS, "uv": [[1, 2], [3, True]]}]}, "[3, True], expected two finite numbers"),
        ({"lines": [FIELDS, {**FIELDS, "role": "other"}]}, "two lines have one id: 7, 7"),
        ({"lines": [FIELDS, {**FIELDS, "id": "8"}]}, "two lines have one role: ego_left, ego_left"),
    ],
)
def test_what_is_no_judgement_is_named(fields, message) -> None:
    with pytest.raises(ValueError, match=re.escape(message)):
        judgement_from_json(fields)


def test_several_other_lines_may_share_their_role() -> None:
    others = [{**FIELDS, "id": each, "role": "other"} for each in "ab"]
    assert [line.id for line in lines_from_json(others)] == ["a", "b"]


def test_every_change_is_on_disk_at_once(tmp_path) -> None:
    path = tmp_path / "drive.review.json"
    file = opened(path)
    file.change(5, Judgement("correct"))
    assert opened(path).judgements == {5: Judgement("correct")}
    file.change(5, Judgement("correct", "missed", (LINE,)))
    assert opened(path).judgements == file.judgements == {5: Judgement("correct", "missed", (LINE,))}
    assert [each.name for each in tmp_path.iterdir()] == ["drive.review.json"]


def test_undo_goes_back_step_by_step_also_after_a_restart(tmp_path) -> None:
    path = tmp_path / "drive.review.json"
    file = opened(path)
    file.change(5, Judgement("correct"))
    file.change(6, Judgement("missed"))
    file.change(6, Judgement("missed"))  # says nothing new: nothing to undo
    assert file.undo() == 6
    file = opened(path)
    assert file.judgements == {5: Judgement("correct")}
    assert file.undo() == 5
    assert file.undo() is None
    assert opened(path).judgements == {}


def test_a_change_that_cannot_be_saved_is_no_change(tmp_path) -> None:
    folder = tmp_path / "gone"
    folder.mkdir()
    file = opened(folder / "drive.review.json")
    file.change(5, Judgement("correct"))
    (folder / "drive.review.json").unlink()
    folder.rmdir()
    with pytest.raises(FileNotFoundError):
        file.change(5, Judgement("missed"))
    assert file.judgement(5) == Judgement("correct")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "Expecting value: line 1"),
        ('{"format": "lane_dp review 1", "lanes": "x", "judge', "line 1 column"),
        ("{}", "'format' is missing"),
        ("[]", "list indices"),
        ('{"format": "lane_dp review 9"}', "format is 'lane_dp review 9', expected 'lane_dp review 1'"),
        ('{"format": "lane_dp review 1", "lanes": "x", "judgements": {"5": {"left": "good"}}}', "'good'"),
        ('{"format": "lane_dp review 1", "lanes": "x", "judgements": {"five": {}}}', "'five'"),
        ('{"format": "lane_dp review 1", "lanes": "x", "judgements": {}, "undo": [1]}', "int"),
        ("\x80", "codec"),
    ],
)
def test_a_damaged_file_is_named_and_left_alone(tmp_path, text, message) -> None:
    path = tmp_path / "drive.review.json"
    path.write_bytes(text.encode("latin-1"))
    with pytest.raises(
        CommandError, match=rf"drive\.review\.json is no whole file of judgements: .*{message}"
    ):
        ReviewFile(path)
    assert path.read_bytes() == text.encode("latin-1")


def test_other_lanes_than_those_that_were_judged(tmp_path) -> None:
    path = tmp_path / "drive.review.json"
    opened(path, "these").change(5, Judgement("correct"))
    with pytest.raises(CommandError, match=r"review\.json judges other lanes than these"):
        opened(path, "others")
    assert opened(path, "these").judgements


def test_the_lock_keeps_another_process_out(tmp_path) -> None:
    path = tmp_path / "drive.review.json"
    code = "from lane_dp_ros.review.review_file import locked\nfrom pathlib import Path\n"
    code += f"with locked(Path({str(path)!r})): print('locked', flush=True); input()"
    with subprocess.Popen(
        [sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as other:
        assert other.stdout.readline() == "locked\n"
        with pytest.raises(
            CommandError, match=rf"being written by process {other.pid}: one review at a time"
        ):
            with locked(path):
                pass
        other.kill()
    assert (tmp_path / "drive.review.json.lock").exists(), "left behind by the process that was killed"
    with locked(path):  # and no hindrance
        assert f"{os.getpid()}" in (tmp_path / "drive.review.json.lock").read_text()
    assert list(tmp_path.iterdir()) == []


def test_a_place_where_nothing_can_be_written(tmp_path) -> None:
    with pytest.raises(CommandError, match=r"cannot write .*/x\.json: .*; --review FILE names another place"):
        with locked(tmp_path / "nowhere" / "x.json"):
            pass
