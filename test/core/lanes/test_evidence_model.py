# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The evidence model: its terms, its file, and every kind of file that is none."""

import json
from copy import deepcopy

import numpy as np
import pytest

from lane_dp_ros.core.lanes.candidate import LaneEvidence
from lane_dp_ros.core.lanes.evidence_model import CLASSES, FORMAT, PAIRS, Term, evidence_model, parsed_model
from lane_dp_ros.core.lanes.selection import LaneSelectionConfig
from lane_dp_ros.tools.evidence_fit.model_file import model_text

FLAT = {"at": [0.0, 1.0], "log_odds": [0.0, 0.0], "unknown": 0.0}
CONTENT = {
    "format": FORMAT,
    "paint": {"start": -1.0, "terms": {"score": {"at": [0, 10], "log_odds": [-2, 3], "unknown": -0.5}}},
    "edge": {"start": -2.0, "terms": {"length": {"at": [5, 15, 25], "log_odds": [0, 1, 1.5]}}},
    "pairs": dict.fromkeys(PAIRS, FLAT),
}


def changed(*path, to):
    """Return the content with another value at the end of a path of keys, without it where that is None."""
    content = deepcopy(CONTENT)
    *parents, last = path
    inner = content
    for key in parents:
        inner = inner[key]
    if to is None:
        del inner[last]
    else:
        inner[last] = to
    return content


@pytest.fixture
def written(tmp_path):
    """Return a function: the path of a file with a text."""

    def written(text):
        path = tmp_path / "model.json"
        path.write_text(text)
        return str(path)

    return written


def test_a_term_is_straight_between_its_points_and_level_beyond_them():
    term = Term(np.array([1.0, 3.0]), np.array([-1.0, 1.0]), unknown=0.25)
    assert term([0.0, 1.0, 2.5, 3.0, 9.0, np.nan]).tolist() == [-1.0, -1.0, 0.5, 1.0, 1.0, 0.25]
    assert term([[2.0]]).shape == (1, 1)
    assert term.highest == 1.0
    assert Term(term.at, term.log_odds, unknown=2.0).highest == 2.0


def test_log_odds_are_the_start_and_what_each_measurement_adds():
    model = parsed_model(CONTENT)
    evidence = LaneEvidence(length=10.0, start=4.0, slope=0.0, score=4.0)
    assert model.parts("paint", evidence) == {"score": 0.0}
    assert model.log_odds("paint", [evidence])[0] == -1.0
    assert model.log_odds("edge", [evidence])[0] == -1.5
    unknown = LaneEvidence(length=25.0, start=4.0, slope=0.0)
    assert model.log_odds("paint", [unknown])[0] == -1.5
    assert model.log_odds("edge", [unknown])[0] == -0.5


def test_the_shipped_model_speaks_for_paint_and_against_grass():
    model = evidence_model()
    paint = {"length": 25.0, "start": 5.0, "slope": 0.01, "score": 20.0, "paint_width": 0.14}
    paint |= {"contrast": 0.6, "saturation_contrast": 0.5, "relative_contrast": 1.0, "brightness": 0.6}
    good = LaneEvidence(**paint, texture=0.03, height=0.0, kerb_step=0.0)
    grass = LaneEvidence(**{**paint, "contrast": 0.1, "relative_contrast": 0.2, "score": 1.0}, texture=0.3)
    assert model.log_odds("paint", [good])[0] > 2
    assert model.log_odds("paint", [grass])[0] < -2
    assert set(model.terms) == set(CLASSES)


def test_a_model_is_the_same_after_it_was_written(written):
    shipped = evidence_model()
    again = evidence_model(written(model_text(shipped, {"date": "2026-11-30"})))
    assert again.source["date"] == "2026-11-30"
    assert again.start == pytest.approx(shipped.start, rel=1e-3)
    for kind in CLASSES:
        assert again.terms[kind].keys() == shipped.terms[kind].keys()
    of_both = [
        (terms[name], others[name])
        for terms, others in zip(
            (*again.terms.values(), again.pairs), (*shipped.terms.values(), shipped.pairs), strict=True
        )
        for name in others
    ]
    for term, other in of_both:
        np.testing.assert_allclose(term.at, other.at, rtol=1e-3)
        np.testing.assert_allclose(term.log_odds, other.log_odds, rtol=1e-3)
        assert term.unknown == pytest.approx(other.unknown, rel=1e-3)


def test_numbers_are_written_with_four_digits():
    model = parsed_model(changed("paint", "start", to=-1.23456))
    assert json.loads(model_text(model, {}))["paint"]["start"] == -1.235


SCORE = "paint", "terms", "score"


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        ([], "does not say format 'lane_dp_ros evidence 1'"),
        (7, "does not say format"),
        (changed("format", to="lane_dp_ros evidence 2"), "does not say format"),
        (changed("edge", to=None), "lacks the section 'edge'"),
        (changed("paint", to=[1]), "lacks the section 'paint'"),
        (changed("paint", "terms", to=None), "lacks the section 'terms'"),
        (changed("paint", "terms", "colour", to=FLAT), "paint: there is no measurement 'colour'"),
        (changed("paint", "start", to=None), "paint: start: expected a number"),
        (changed("edge", "start", to="much"), "edge: start: expected a number"),
        (changed("edge", "start", to=True), "edge: start: expected a number"),
        (changed("edge", "start", to=1e7), r"edge: start: expected a number of at most 1e\+06"),
        (changed("edge", "start", to=float("nan")), "edge: start: expected a number"),
        (changed("edge", "start", to=float("inf")), "edge: start: expected a number"),
        (changed("edge", "start", to=10**400), "edge: start: expected a number"),
        (changed(*SCORE, to=3), "lacks the section 'score'"),
        (changed(*SCORE, "at", to=[10, 0]), "paint: score: expected as many log_odds as rising values at"),
        (changed(*SCORE, "at", to=[1, 1]), "paint: score: expected as many log_odds"),
        (changed(*SCORE, "at", to=[0, 1, 2]), "paint: score: expected as many log_odds"),
        (changed(*SCORE, "at", to=[]), "paint: score: at: expected a list of 1 to 1000 numbers"),
        (changed(*SCORE, "at", to=list(range(1001))), "paint: score: at: expected a list of 1 to 1000"),
        (changed(*SCORE, "log_odds", to=None), "paint: score: log_odds: expected a list"),
        (changed(*SCORE, "log_odds", to=[[0], 1]), "paint: score: log_odds: expected a number"),
        (changed(*SCORE, "unknown", to="none"), "paint: score: unknown: expected a number"),
        (changed("pairs", "paint_on_paint", to=None), "pairs: expected the terms paint_beside_paint,"),
        (changed("pairs", "paint_over_paint", to=FLAT), "pairs: expected the terms"),
    ],
)
def test_a_file_that_says_something_else_is_refused_with_the_reason(written, content, reason):
    path = written(json.dumps(content))
    with pytest.raises(ValueError, match=reason) as caught:
        evidence_model(path)
    message = str(caught.value)
    assert message.startswith(f"evidence model {path!r}: ")
    assert message.endswith("; expected a file of lane_dp fit-evidence")
    assert "\n" not in message


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", "Expecting value"),
        ("{", "Expecting property name"),
        ("[" * 100_000, "recursion"),
        ('{"format": ' + "9" * 5000 + "}", "Exceeds the limit|integer string conversion"),
    ],
    ids=["empty", "cut off", "nested", "digits"],
)
def test_a_file_that_cannot_be_parsed_is_refused_in_one_line(written, text, reason):
    with pytest.raises(ValueError, match=reason) as caught:
        evidence_model(written(text))
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 600


def test_a_file_of_other_bytes_is_refused(tmp_path):
    path = tmp_path / "picture.png"
    path.write_bytes(b"\x89PNG\xff\xfe\x00")
    with pytest.raises(ValueError, match="codec can't decode"):
        evidence_model(str(path))


def test_a_file_that_is_missing_or_a_folder_is_refused(tmp_path):
    with pytest.raises(ValueError, match="No such file or directory; expected a file of lane_dp"):
        evidence_model(str(tmp_path / "none.json"))
    with pytest.raises(ValueError, match="Is a directory"):
        evidence_model(str(tmp_path))
    with pytest.raises(ValueError, match="evidence model"):
        evidence_model("nothing\0here")


def test_a_configuration_with_such_a_file_is_refused_at_once(tmp_path):
    with pytest.raises(ValueError, match="No such file"):
        LaneSelectionConfig(evidence_model=str(tmp_path / "none.json"))
