# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The JSON file of an evaluation, written and read again: the same frames, the same numbers."""

import json
from dataclasses import replace

import numpy as np
import pytest

from lane_dp_ros.core.config import preset
from lane_dp_ros.core.detector import LaneDetector
from lane_dp_ros.core.types import Lane, StereoFrame
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.scenes import CAMERA
from lane_dp_ros.tools.evaluation.depth import NO_SURFACE, depth_errors
from lane_dp_ros.tools.evaluation.json_file import as_json, read_json, write_json
from lane_dp_ros.tools.evaluation.matching import judge, judge_unpainted


@pytest.fixture(scope="module")
def scores(scene_pairs):
    """Judged frames: rendered ones with all that is known, and one of a road without paint."""
    detector = LaneDetector(CAMERA, preset("default"))
    judged = []
    for i, pair in enumerate(scene_pairs):
        found = detector.detect(StereoFrame(pair.left, pair.right))
        frame = replace(pair.truth, name=f"s/{i}", category="curve", stamp_ns=i * 100_000_000)
        score = judge(frame, found.lanes, CAMERA, 0.03, found.road_edges if i else None)
        judged.append(replace(score, depth=depth_errors(frame, found.road)))
    points = np.array([[1.0, 1.5, 5.0], [1.0, 1.5, 9.123456]])
    line = Lane(points, 0.5, 0.1, "ego_right", 0.0, 1.0, 3, "double", "yellow", ("solid", "dashed"))
    bare = judge_unpainted("bare/7", [line], "bare", 7)
    return [*judged, replace(bare, depth=NO_SURFACE)]


@pytest.fixture
def written(tmp_path, scores):
    write_json(scores, ["a note"], tmp_path / "e.json", tmp_path / "bag")
    return tmp_path / "e.json"


def test_an_evaluation_read_again_has_the_same_numbers(tmp_path, written, scores):
    found = read_json(written)
    assert (found.path, found.source) == (written, tmp_path / "bag")
    before, after = as_json(scores, ()), as_json(found.results, ())
    assert_nearly_equal(after, before)


def assert_nearly_equal(found, expected):
    """Compare what JSON holds; lengths are written to 0.1 mm."""
    assert type(found) is type(expected)
    if isinstance(expected, dict):
        assert found.keys() == expected.keys()
        for key, value in expected.items():
            assert_nearly_equal(found[key], value)
    elif isinstance(expected, list | tuple):
        assert len(found) == len(expected)
        for one, other in zip(found, expected, strict=True):
            assert_nearly_equal(one, other)
    else:
        assert found == (pytest.approx(expected, abs=1e-4) if isinstance(expected, float) else expected)


def test_the_lines_come_back(written):
    *_, bare = read_json(written).results
    (line,) = (detection.lane for detection in bare.detections)
    np.testing.assert_allclose(line.points, [[1, 1.5, 5], [1, 1.5, 9.1235]], atol=1e-9)
    assert (line.id, line.role, line.kind, line.colour, line.sides) == (
        3, "ego_right", "double", "yellow", ("solid", "dashed"),
    )  # fmt: skip
    assert bare.truth is None and bare.unpainted and bare.depth == NO_SURFACE


def test_a_frame_is_a_line_of_the_file(written, scores):
    lines = [line for line in written.read_text().splitlines() if line.startswith('  {"name"')]
    assert [json.loads(line.rstrip(","))["name"] for line in lines] == [score.name for score in scores]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda content: content.update(format="else"), "is no evaluation, expected what lane_dp evaluate"),
        (lambda content: content.pop("source"), "lacks 'source'; perhaps an earlier release wrote it"),
        (lambda content: content["frames"][0].pop("truth"), "lacks 'truth'; perhaps an earlier release"),
        (lambda content: content.update(frames=3), "is damaged: 'int' object is not iterable"),
        (lambda content: content["frames"].append(3), "is damaged: frame '3': "),
        (lambda content: line_of(content).update(verdict="good"), "frame 's/0': verdict is 'good', expected"),
        (
            lambda content: line_of(content).update(points=[[1, 2]]),
            r"points is no list of",
        ),
        (lambda content: content["frames"][0].update(stamp_ns="x"), "frame 's/0': invalid literal for int"),
        (lambda content: content["frames"][0]["matches"][0].update(detection=99), "detection 99 of "),
        (lambda content: content["frames"][0].update(depth_errors=[1]), "1 depth_errors, expected 25"),
    ],
)
def test_what_is_no_evaluation_is_refused_in_one_line(written, change, message):
    content = json.loads(written.read_text())
    change(content)
    written.write_text(json.dumps(content))
    with pytest.raises(CommandError, match=message) as failure:
        read_json(written)
    assert "\n" not in str(failure.value) and str(written) in str(failure.value)


def line_of(content):
    return content["frames"][0]["detections"][0]


@pytest.mark.parametrize("text", ["", "[" * 100_000, "\xff"])
def test_what_is_no_json_is_refused(tmp_path, text):
    (tmp_path / "e.json").write_bytes(text.encode("latin-1"))
    with pytest.raises(CommandError, match="e.json is no evaluation"):
        read_json(tmp_path / "e.json")
    with pytest.raises(CommandError, match="cannot read .*none.json: No such file"):
        read_json(tmp_path / "none.json")
