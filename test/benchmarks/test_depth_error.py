# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The picture of depth errors before and after: drawn from what an evaluation writes."""

import json
import sys
from xml.etree import ElementTree

import depth_error
import pytest

from lane_dp_ros.tools.evaluation.depth import CURVE_DEPTHS, NO_SURFACE, DepthErrors
from lane_dp_ros.tools.evaluation.json_file import FORMAT, write_json
from lane_dp_ros.tools.evaluation.scores import FrameScore


def written(path, *errors):
    constant = [DepthErrors((error,) * (len(CURVE_DEPTHS) - 1) + (float("nan"),)) for error in errors]
    write_json([FrameScore("a/0", "a", "", None, (), depth=each) for each in constant], (), path)
    return path


def drawn(monkeypatch, *arguments):
    monkeypatch.setattr(sys, "argv", ["depth_error.py", *map(str, arguments)])
    return depth_error.main()


def test_a_curve_comes_back_from_the_file(tmp_path):
    curve = depth_error.curve_of(written(tmp_path / "a.json", 0.01, 0.02, 0.03))
    assert curve.depths.tolist() == CURVE_DEPTHS.tolist()
    assert curve.bias[:-1].tolist() == [0.02] * 24 and curve.counts.tolist() == [3] * 24 + [0]
    assert curve.low[0] == pytest.approx(0.011) and curve.high[0] == pytest.approx(0.029)
    assert curve.bias[-1] != curve.bias[-1]  # null is NaN


def test_before_and_after(tmp_path, monkeypatch, capsys):
    before, after = written(tmp_path / "b.json", 0.04, 0.02), written(tmp_path / "a.json", 0.01)
    picture = tmp_path / "picture.svg"
    assert drawn(monkeypatch, f"before={before}", f"after={after}", "-o", picture) == 0
    assert "before, after" in capsys.readouterr().out
    root = ElementTree.parse(picture).getroot()
    texts = [element.text for element in root.iter() if element.tag.endswith("text")]
    assert "before (2)" in texts and "after (1)" in texts
    styles = [element.attrib.get("class") for element in root.iter()]
    assert [styles.count(f"{kind} {series}") for kind in ("band", "series") for series in ("one", "two")] == [
        1
    ] * 4


def test_what_cannot_be_drawn_is_named_in_one_line(tmp_path, monkeypatch, capsys):
    good = written(tmp_path / "good.json", 0.01)
    (tmp_path / "odd.json").write_text(json.dumps({"format": "another"}))
    (tmp_path / "bad.json").write_text("{")
    (tmp_path / "empty.json").write_text(json.dumps({"format": FORMAT}))
    write_json([FrameScore("a/0", "a", "", None, (), depth=NO_SURFACE)], (), tmp_path / "none.json")
    for arguments, message in {
        (f"a={tmp_path / 'odd.json'}",): "odd.json is no evaluation",
        (f"a={tmp_path / 'bad.json'}",): "bad.json cannot be read as JSON",
        (f"a={tmp_path / 'missing.json'}",): "missing.json cannot be read as JSON",
        (f"a={tmp_path / 'empty.json'}",): "empty.json has no depth errors",
        (f"a={tmp_path / 'none.json'}",): "none.json has no depth errors",
        (f"a={good}", f"a={good}"): "two evaluations bear the same name",
        tuple(f"{name}={good}" for name in "abcde"): "5 curves in one chart, expected at most 4",
    }.items():
        assert drawn(monkeypatch, *arguments, "-o", tmp_path / "p.svg") == 1
        (text,) = capsys.readouterr().err.splitlines()
        assert message in text
    assert not (tmp_path / "p.svg").exists()
    with pytest.raises(SystemExit, match="2"):
        drawn(monkeypatch, str(good), "-o", tmp_path / "p.svg")
