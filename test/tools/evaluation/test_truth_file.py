# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The truth's file: what is written comes back, and what is wrong in a file is named."""

import json

import pytest

from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.tools.evaluation.json_file import check_json_output
from lane_dp_ros.tools.evaluation.truth_file import load_truth, save_truth

LANE = {
    "id": "L",
    "kind": "dashed",
    "sure": True,
    "uv": [[500.25, 300.0], [550.0, 250.0]],
    "xz": [[-1, 9], [-1.5, 6]],
}
FIELDS = {
    "left": "a.png", "right": "b.png", "fx": 700, "fy": 701, "cx": 600, "cy": 180, "baseline": 0.54,
    "width": 1242, "height": 375, "ground": [0, 32, 0, 0.5], "ego_left": "L", "ego_right": None,
    "lanes": [LANE],
}  # fmt: skip


def written(tmp_path, frames):
    path = tmp_path / "truth.json"
    path.write_text(frames if isinstance(frames, str) else json.dumps(frames))
    return path


def test_a_frame_of_loose_images(tmp_path):
    (frame,) = load_truth(written(tmp_path, {"kitti_odometry/sequences/01/000005": FIELDS}))
    assert (frame.name, frame.sequence) == ("kitti_odometry/sequences/01/000005", "kitti_odometry/01")
    assert (frame.ego_ids, frame.stamp_ns, frame.category, frame.size) == (("L",), None, "", (1242, 375))
    assert (frame.camera.fy, frame.ground.tolist()) == (701, [0, 32, 0, 0.5])
    (label,) = frame.labels
    assert (label.painted, label.sure, label.kind) == (True, True, "dashed")
    assert label.xz.tolist() == [[-1.5, 6], [-1, 9]]  # near first
    assert label.uv.tolist() == LANE["uv"]


def test_a_frame_of_a_bag(tmp_path):
    fields = {**FIELDS, "stamp_ns": 1_500_000_000_123_456_789, "sequence": "hill 2", "category": "hill"}
    del fields["left"], fields["right"]
    (frame,) = load_truth(written(tmp_path, {"hill/00": fields}))
    assert (frame.stamp_ns, frame.sequence) == (1_500_000_000_123_456_789, "hill 2")
    assert (frame.category, frame.left) == ("hill", "")


def test_saved_truth_comes_back_and_is_the_same_to_the_byte(tmp_path):
    path = written(
        tmp_path,
        {
            "a/1": {**FIELDS, "stamp_ns": 5, "note": "né", "drive": "avenue"},
            "a/2": {**FIELDS, "lanes": [], "ego_left": None},
        },
    )
    save_truth(load_truth(path), tmp_path / "once.json")
    save_truth(load_truth(tmp_path / "once.json"), tmp_path / "twice.json")
    assert (tmp_path / "once.json").read_bytes() == (tmp_path / "twice.json").read_bytes()
    first, again = load_truth(path)[0], load_truth(tmp_path / "once.json")[0]
    assert (first.drive, load_truth(path)[1].drive) == ("avenue", "")
    same = "name", "camera", "size", "ego_left", "ego_right", "stamp_ns", "left", "sequence", "drive", "note"
    for name in same:
        assert getattr(again, name) == getattr(first, name)
    assert again.labels[0].xz.tolist() == first.labels[0].xz.tolist()
    assert len(list(tmp_path.iterdir())) == 3


def test_points_are_rounded(tmp_path):
    lane = {**LANE, "uv": [[1 / 3, 2 / 3]], "xz": [[1 / 3, 6], [1 / 3, 9]]}
    save_truth(load_truth(written(tmp_path, {"a/1": {**FIELDS, "lanes": [lane]}})), tmp_path / "saved.json")
    (frame,) = load_truth(tmp_path / "saved.json")
    assert frame.labels[0].uv.tolist() == [[0.333, 0.667]]
    assert frame.labels[0].xz[0].tolist() == [0.3333, 6]


def test_exact_points_and_rows_come_back(tmp_path):
    lane = {**LANE, "xyz": [[-1, 1.6, 9], [-1.51234, 1.65, 6]]}
    profile = [[5.0, 370.1234], [6, 340.5], [7, 320.25]]
    plain, exact = FIELDS, {**FIELDS, "lanes": [lane], "profile": profile}
    frames = load_truth(written(tmp_path, {"a/0": plain, "a/1": exact}))
    save_truth(frames, tmp_path / "saved.json")
    without, with_them = load_truth(tmp_path / "saved.json")
    assert (without.profile, without.labels[0].xyz) == (None, None)
    assert with_them.profile.tolist() == [[5, 370.123], [6, 340.5], [7, 320.25]]
    assert with_them.labels[0].xyz.tolist() == [[-1.5123, 1.65, 6], [-1, 1.6, 9]]  # near first
    assert with_them.labels[0].in_space.tolist() == [[-1.5123, 6], [-1, 9]]
    assert without.labels[0].in_space.tolist() == [[-1.5, 6], [-1, 9]]
    assert [*with_them.rows_ahead([6.0, 5.0]), *without.rows_ahead([10.0])] == [
        340.5,
        370.123,
        pytest.approx(180 + 100 * 37.8 / 32),  # 700 px * 0.54 m / 10 m of disparity
    ]


def test_what_is_known_of_the_paint_comes_back(tmp_path):
    known = [
        {"id": "L", "colour": "yellow", "width": 0.12, "double": True},
        {"id": "R", "colour": "white", "width": 0.25, "double": False},
        {"id": "E", "kind": "edge", "border": "kerb"},
        {"id": "old"},
    ]
    lanes = [{**LANE, **each} for each in known]
    save_truth(load_truth(written(tmp_path, {"a/1": {**FIELDS, "lanes": lanes}})), tmp_path / "saved.json")
    (frame,) = load_truth(tmp_path / "saved.json")
    said = [(label.colour, label.width, label.double, label.border) for label in frame.labels]
    assert said == [
        ("yellow", 0.12, True, ""),
        ("white", 0.25, False, ""),
        ("", None, None, "kerb"),
        ("", None, None, ""),
    ]
    lines = json.loads((tmp_path / "saved.json").read_text())["a/1"]["lanes"]
    assert [sorted({"colour", "width", "double", "border"} & set(line)) for line in lines] == [
        ["colour", "double", "width"],
        ["colour", "double", "width"],
        ["border"],
        [],
    ]


def test_a_failed_save_leaves_the_file(tmp_path):
    path = written(tmp_path, {"a/1": FIELDS})
    before = path.read_bytes()
    with pytest.raises(ZeroDivisionError):
        save_truth((1 / 0 for _ in range(1)), path)
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", r"truth\.json, line 1, column 1: no JSON"),
        ('{"a/1":\n {"fx": 700,\n "fy" 700}}', r"truth\.json, line 3, column 7: no JSON: Expecting ':'"),
        ("[]", r"truth\.json holds a list, expected an object of labelled frames"),
        ('{"a": {}, "a": {}}', r"truth\.json: 'a' stands twice"),
        ({"a/1": {}}, r"truth\.json: frame 'a/1' lacks the field 'fx'"),
        ({"a/1": 1}, r"truth\.json: frame 'a/1'"),
        ({"a/1": {**FIELDS, "fx": 0}}, "frame 'a/1': fx is 0"),
        ({"a/1": {**FIELDS, "ground": [1, 2]}}, "frame 'a/1': ground is no list of 4 numbers"),
        ({"a/1": {**FIELDS, "profile": [[6, 300]]}}, r"frame 'a/1': profile is no list of at least 2 points"),
        ({"a/1": {**FIELDS, "profile": [5, 320, 6, 300]}}, r"profile is no list of"),
        ({"a/1": {**FIELDS, "ground": [0, 1e300, 0, 0]}}, r"ground holds values of more than 1e\+06"),
        (
            {"a/1": {**FIELDS, "profile": [[6, 300], [5, 320]]}},
            r"profile is .* with rising z >= 0.1",
        ),
        ({"a/1": {**FIELDS, "profile": 7}}, "frame 'a/1': profile is no list of"),
        ({"a/1": {**FIELDS, "ego_right": "R"}}, "frame 'a/1': ego line 'R' is none of the lines L"),
        ({"a/1": {**FIELDS, "lanes": [LANE, LANE]}}, "frame 'a/1': two lines have the id 'L'"),
    ],
)
def test_what_is_wrong_in_a_file_is_named(tmp_path, text, message):
    with pytest.raises(ValueError, match=message):
        load_truth(written(tmp_path, text))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"kind": "wavy"}, "line 'L' is of kind 'wavy', expected one of solid, dashed, edge"),
        (
            {"xz": [[0, 6], [float("nan"), 9]]},
            r"line 'L': xz holds values that are not finite numbers \(NaN\?\)",
        ),
        ({"uv": [[0, float("inf")]]}, "line 'L': uv holds values that are not finite"),
        ({"colour": "blue"}, "line 'L': colour is 'blue', expected white or yellow"),
        ({"width": 0}, "line 'L': width is 0, expected more than 0 and at most 2 m"),
        ({"width": float("nan")}, "line 'L': width is nan, expected"),
        ({"width": 12}, "line 'L': width is 12, expected"),
        ({"double": "yes"}, "line 'L': double is 'yes', expected true or false"),
        ({"double": 2}, "line 'L': double is 2, expected true or false"),
        ({"xz": [[0, 6]]}, "line 'L': xz has 1 points, expected at least 2"),
        ({"uv": [1, 2, 3]}, r"line 'L': uv is no list of \[a, b\] points"),
        ({"xyz": [[0, 6], [0, 9], [0, 12]]}, r"line 'L': xyz is no list of \[a, b, c\] points"),
        ({"xyz": [[0, 1.6, 6]]}, "line 'L': xyz has 1 points, expected at least 2"),
        ({"xyz": [[0, 1.6, 6], [0, 1.6, float("nan")]]}, "line 'L': xyz holds values that are not finite"),
    ],
)
def test_what_is_wrong_in_a_line_is_named(tmp_path, change, message):
    with pytest.raises(ValueError, match=message):
        load_truth(written(tmp_path, {"a/1": {**FIELDS, "lanes": [{**LANE, **change}]}}))


def test_bytes_that_are_no_text(tmp_path):
    (tmp_path / "truth.json").write_bytes(b'{"a": "\xff"}')
    with pytest.raises(ValueError, match="is no JSON: byte 7 is not UTF-8"):
        load_truth(tmp_path / "truth.json")


def test_real_labels(kitti_data, tmp_path):
    frames = load_truth(kitti_data / "labels" / "lanes.json")
    assert (len(frames), sum(len(frame.ego_ids) for frame in frames)) == (72, 86)
    save_truth(frames, tmp_path / "saved.json")
    assert len(load_truth(tmp_path / "saved.json")) == 72


@pytest.mark.parametrize(
    ("fields", "said"),
    [
        ({"fx": 10**400}, "'a/1': fx is 1000.*, expected a number"),
        ({"baseline": "wide"}, "'a/1': baseline is 'wide', expected a number"),
        ({"stamp_ns": float("inf")}, "'a/1': stamp_ns is inf, expected a whole number"),
        ({"stamp_ns": 10**30}, "'a/1': stamp_ns is 1000"),
        ({"width": 100_000}, "'a/1': width is 100000, expected a whole number from 0 to 20000"),
        ({"height": 10.5}, "'a/1': height is 10.5"),
        ({"ground": [10**400, 0, 0, 0]}, "'a/1': ground is no list of 4 numbers"),
        ({"lanes": [{**LANE, "xz": [[0, 26.0], [0, 1e9]]}]}, "xz holds values of more than 1e"),
        ({"lanes": [{**LANE, "kind": "x" * 5000}]}, r"is of kind 'x{39}\.\.\., expected one of"),
        ({"lanes": [{**LANE, "width": 10**400}]}, "width is 1000"),
    ],
)
def test_numbers_out_of_all_bounds_are_named(tmp_path, fields, said):
    with pytest.raises(ValueError, match=said) as caught:
        load_truth(written(tmp_path, {"a/1": {**FIELDS, **fields}}))
    assert len(str(caught.value)) < 300 + len(str(tmp_path))


def test_what_is_nested_too_deep_is_refused(tmp_path):
    path = tmp_path / "deep.json"
    for text in ("[" * 100_000, '{"a": ' * 100_000):
        path.write_text(text)
        with pytest.raises(ValueError, match="deep.json is nested too deep"):
            load_truth(path)
        with pytest.raises(CommandError, match="is no evaluation"):
            check_json_output(path)
