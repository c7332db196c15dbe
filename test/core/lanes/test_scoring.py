# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The log-odds of candidates by their own evidence, and what can be no paint whatever speaks for it."""

from dataclasses import replace

import numpy as np
import pytest

from lane_dp_ros.core.lanes.candidate import Candidate, LaneEvidence, LaneLine
from lane_dp_ros.core.lanes.scoring import EvidenceScoring
from lane_dp_ros.core.lanes.selection import LaneSelectionConfig

SCORING = EvidenceScoring(LaneSelectionConfig())
LINE = LaneLine(np.arange(26), np.linspace(5.0, 30.0, 26), np.full(26, 1.75), 0.0, 20.0)
GOOD = LaneEvidence(
    length=25.0,
    start=5.0,
    slope=0.01,
    score=20.0,
    paint_width=0.14,
    wide_band_ratio=0.4,
    height=0.0,
    kerb_step=0.0,
    off_paint_fraction=0.02,
    texture=0.04,
    contrast=0.5,
    saturation_contrast=0.5,
    relative_contrast=1.0,
    brightness=0.5,
    rise=0.0,
)
CAPS = [
    ("paint_width", 0.40, 0.41, "0.41 m broad"),
    ("wide_band_ratio", 1.0, 1.01, "as bright beside as on it"),
    ("height", 0.10, 0.11, "0.11 m above or below the road"),
    ("height", -0.10, -0.11, "0.11 m above or below the road"),
]


def scored(evidence, variant="path", config=None):
    scoring = SCORING if config is None else EvidenceScoring(config)
    (found,) = scoring.scored([Candidate(LINE, evidence, variant)])
    return found


def test_the_log_odds_are_those_of_the_model():
    candidate = scored(GOOD)
    assert candidate.log_odds == tuple(SCORING.model.log_odds(kind, [GOOD])[0] for kind in ("paint", "edge"))
    assert candidate.refusal == ""
    assert (candidate.line, candidate.evidence, candidate.variant) == (LINE, GOOD, "path")


@pytest.mark.parametrize(("name", "most", "more", "reason"), CAPS)
def test_beyond_a_limit_nothing_is_paint(name, most, more, reason):
    assert scored(replace(GOOD, **{name: most})).refusal == ""
    beyond = scored(replace(GOOD, **{name: more}))
    assert beyond.refusal == reason
    assert beyond.log_odds[0] == -np.inf
    assert np.isfinite(beyond.log_odds[1])  # it may be a border


@pytest.mark.parametrize(
    ("name", "closer", "evidence"),
    [
        ("paint_width_max", 0.13, GOOD),
        ("wide_band_ratio_max", 0.35, GOOD),
        ("height_max", 0.02, replace(GOOD, height=-0.03)),
    ],
)
def test_the_limits_are_those_of_the_configuration(name, closer, evidence):
    assert scored(evidence).refusal == ""
    assert scored(evidence, config=LaneSelectionConfig(**{name: closer})).refusal != ""


@pytest.mark.parametrize("name", ["paint_width", "wide_band_ratio", "height"])
def test_what_is_not_known_is_beyond_no_limit(name):
    candidate = scored(replace(GOOD, **{name: np.nan}))
    assert candidate.refusal == ""
    assert np.isfinite(candidate.log_odds).all()


def test_a_path_along_a_border_is_no_paint():
    candidate = scored(LaneEvidence(length=20.0, start=5.0, slope=0.0), "border")
    assert candidate.refusal == "a border without paint"
    assert candidate.log_odds[0] == -np.inf


def test_of_unknown_height_a_line_is_less_probable_than_on_the_road_and_more_than_on_a_kerb():
    flat, unknown, high = (scored(replace(GOOD, height=height)).log_odds[0] for height in (0.0, np.nan, 0.09))
    assert high < unknown < flat


@pytest.mark.parametrize(
    ("name", "better", "worse"),
    [
        ("score", 20.0, 2.0),
        ("contrast", 0.6, 0.1),
        ("saturation_contrast", 0.5, 0.05),
        ("relative_contrast", 1.0, 0.2),
        ("texture", 0.04, 0.3),
        ("kerb_step", 0.0, 0.15),
        ("slope", 0.01, 0.4),
        ("start", 5.0, 35.0),
        ("paint_width", 0.14, 0.35),
        ("paint_width", 0.14, 0.06),
        ("height", 0.0, 0.08),
        ("height", 0.0, -0.08),
    ],
)
def test_each_measurement_speaks_as_it_physically_does(name, better, worse):
    good, bad = (scored(replace(GOOD, **{name: value})).log_odds[0] for value in (better, worse))
    assert good > bad


def test_the_height_is_needed_of_what_it_can_still_make_a_line():
    """Whatever height it has been given before."""
    assert SCORING.needs_height([GOOD])[0]
    assert SCORING.needs_height([replace(GOOD, height=0.3, kerb_step=0.3)])[0]
    hopeless = replace(GOOD, contrast=0.0, saturation_contrast=0.0, relative_contrast=0.0, texture=0.3)
    assert not SCORING.needs_height([replace(hopeless, score=-1.0, paint_width=0.02)])[0]


def test_the_course_does_not_count_for_what_a_line_is_but_for_its_course():
    astray = replace(GOOD, slope=0.4, off_paint_fraction=0.6)
    assert SCORING.but_for_course([astray])[0] == SCORING.but_for_course([GOOD])[0]
    assert SCORING.model.log_odds("paint", [astray])[0] < SCORING.model.log_odds("paint", [GOOD])[0]
    assert SCORING.but_for_course([replace(astray, texture=0.3)])[0] < SCORING.but_for_course([astray])[0]
    assert SCORING.but_for_course([replace(astray, height=0.1)])[0] < SCORING.but_for_course([astray])[0]


def test_candidates_are_selected_in_the_light_of_all_others():
    judged = SCORING.selected([scored(GOOD), scored(LaneEvidence(1.0, 30.0, 0.4), "border")])
    assert [each.refusal for each in judged] == ["", "a border without paint"]
    assert judged[0].probability[0] > 0.5
