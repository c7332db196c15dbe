# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Which candidates are lanes by how they lie to one another, rule by rule, and why the others are none."""

from dataclasses import replace

import numpy as np
import pytest

from lane_dp_ros.core.lanes.candidate import Candidate, LaneEvidence, LaneLine
from lane_dp_ros.core.lanes.selection import LaneSelectionConfig, lateral_gap, select_lanes

CONFIG = LaneSelectionConfig()
GOOD = LaneEvidence(
    paint_width=0.15,
    wide_band_ratio=0.4,
    height=0.0,
    kerb_step=0.0,
    slope=0.02,
    off_paint_fraction=0.02,
    texture=0.05,
    contrast=0.5,
    saturation_contrast=0.5,
    brightness=0.5,
    longest_segment=10.0,
    dashes=1,
)


def line(n, score=10.0, first=5.0, last=30.0, slope=0.0):
    s = np.linspace(first, last, 26)
    return LaneLine(np.arange(26), s, n + slope * (s - first), 0.0, score)


def selected(*lines, kept=(), config=CONFIG, **evidence):
    """Return the indices of the lines that are lanes, in the order in which they are chosen."""
    each = [Candidate(one, replace(GOOD, **evidence)) for one in lines]
    others = [candidate for i, candidate in enumerate(each) if i not in kept]
    found = select_lanes(others, config, [each[i] for i in kept])
    assert len(found.lanes) + len(found.refused) == len(lines)
    assert all(candidate.refusal for candidate in found.refused)
    return [each.index(candidate) for candidate in found.lanes]


def reasons(*candidates, kept=()):
    """Return of each candidate why it is refused, empty for a lane."""
    found = select_lanes(candidates, CONFIG, kept)
    refused = {id(candidate.line): candidate.refusal for candidate in found.refused}
    return [refused.get(id(candidate.line), "") for candidate in candidates]


def test_a_weak_line_by_itself_is_none_and_a_strong_one_is():
    assert selected(line(1.75, score=2.9)) == []
    assert selected(line(1.75, score=3.0)) == [0]


def test_of_unknown_height_a_line_by_itself_takes_more_paint():
    assert selected(line(1.75, score=8.9), height=np.nan) == []
    assert selected(line(1.75, score=9.0), height=np.nan) == [0]
    assert selected(line(1.75, score=8.9)) == [0]
    weak = line(-1.75, score=8.9), line(1.75, score=8.9)
    assert selected(*weak, height=np.nan) == [0, 1]  # but not beside another one


def test_more_paint_that_a_line_by_itself_is_to_have_holds_for_unknown_heights_too():
    config = replace(CONFIG, score_alone=10.0)
    assert selected(line(1.75, score=9.5), config=config, height=np.nan) == []
    assert selected(line(1.75, score=10.0), config=config, height=np.nan) == [0]


@pytest.mark.parametrize(
    ("width", "both"),
    [
        (2.4, False),
        (2.6, True),
        (4.2, True),
        (4.4, False),
    ],
)
def test_weak_lines_support_each_other_a_lanes_width_apart(width, both):
    assert selected(line(0, score=2.9), line(width, score=2.8)) == ([0, 1] if both else [])


def test_what_has_hardly_any_paint_is_no_lane_even_beside_one():
    assert selected(line(-1.75), line(1.75, score=1.8)) == [0]
    assert selected(line(-1.75), line(1.75, score=1.9)) == [0, 1]


@pytest.mark.parametrize(
    ("score", "segment", "dashes", "is_line"),
    [
        (5.9, 20.0, 9, False),
        (6.0, 8.0, 1, True),  # one long piece
        (6.1, 7.9, 2, False),
        (6.0, 3.0, 3, True),  # a dashed line
    ],
)
def test_an_arrow_in_the_middle_of_a_lane_is_no_line(score, segment, dashes, is_line):
    """Dashes one behind the other are more than an arrow, and so is a long piece; each with enough paint."""
    in_pieces = replace(GOOD, longest_segment=segment, dashes=dashes)
    candidates = [Candidate(line(-1.75), GOOD), Candidate(line(0.0, score=score), in_pieces)]
    assert list(select_lanes(candidates, CONFIG).lanes) == candidates[: 2 if is_line else 1]


def test_the_arrow_is_the_weaker_one_whatever_the_order():
    assert selected(line(0.0, score=5.0), line(-1.75)) == [1]


def test_a_double_line_is_two_lines():
    assert selected(line(-1.75), line(-1.45, score=5.0)) == [0, 1]
    assert selected(line(-1.75), line(-1.0, score=5.0)) == [0, 1]
    assert selected(line(-1.75), line(-0.99, score=5.0)) == [0]  # no longer beside it, but in the lane


def test_the_same_line_found_twice_is_one():
    for aside in (-0.15, 0.0, 0.14):
        assert selected(line(-1.75, score=5.0), line(-1.75 + aside)) == [1]
    assert selected(line(-1.75, score=5.0), line(-1.59)) == [1, 0]


@pytest.mark.parametrize(("together", "lines"), [(10.0, [1, 0]), (15.0, [1])])
def test_lines_that_part_are_two_where_they_run_apart_for_longer(together, lines):
    split = line(1.75, score=8.0)
    aside = np.maximum(0, split.s - split.s[0] - together + 1) * 0.2  # 0.15 m in 0.75 m
    split = replace(split, n=split.n + aside)
    assert selected(split, line(1.75)) == lines


@pytest.mark.parametrize("first", [12.0, 15.0, 20.0], ids=["overlap", "touch", "apart"])
def test_two_pieces_of_a_line_are_one(first):
    assert selected(line(-1.75, last=15), line(-1.7, score=5.0, first=first)) == [0]


def test_a_short_line_that_a_long_one_holds_is_the_same():
    short = line(1.7, score=5.0, first=8, last=16, slope=0.03)  # nearer than 0.15 m over 6.7 m of 8 m
    assert selected(line(1.75), short) == [0]


def test_the_strongest_comes_first():
    assert selected(line(-1.75, score=5), line(1.75, score=9), line(5.25, score=7)) == [1, 2, 0]


def test_no_lines_no_lanes():
    assert selected() == []


def test_lines_that_were_kept_stay():
    weak = line(0.0, score=0.1)  # in the middle of a lane, too
    assert selected(line(-1.75), weak, kept=[1]) == [1, 0]


def test_a_second_look_adds_no_double_lines():
    lines = line(-1.75), line(-1.45), line(1.75, score=3.0)
    assert selected(*lines, kept=[0]) == [0, 2]


def test_the_gap_of_lines_side_by_side_is_their_mean_distance():
    assert lateral_gap(line(-1.75), line(1.75)) == pytest.approx(3.5)
    assert lateral_gap(line(-1.75), line(1.75, first=20)) == pytest.approx(3.5)
    assert lateral_gap(line(0, last=25), line(0, last=25, slope=0.1)) == pytest.approx(1.0)  # 0 to 2 m
    assert lateral_gap(line(1, slope=0.1, last=25), line(0, last=25)) == pytest.approx(2.0)


def test_the_gap_of_lines_one_behind_the_other_is_that_of_their_ends():
    near, far = line(0, last=15, slope=0.1), line(3, first=20)  # ends at n = 1
    assert lateral_gap(near, far) == pytest.approx(2.0)
    assert lateral_gap(far, near) == pytest.approx(2.0)


@pytest.mark.parametrize(
    ("weaker", "reason"),
    [
        (line(5.0, score=1.5), "1.5 m of paint, expected 1.9"),
        (line(0.0, score=5.0), "weak, inside a lane: 1.8 m beside a stronger line"),
        (line(-1.7, score=5.0), "a stronger line found twice"),
        (line(5.0, score=2.5), "2.5 m of paint, no line a lane's width aside"),
    ],
    ids=["little paint", "inside a lane", "twice", "alone"],
)
def test_a_candidate_that_is_no_lane_is_told_why(weaker, reason):
    assert reasons(Candidate(line(-1.75), GOOD), Candidate(weaker, GOOD)) == ["", reason]


def test_a_double_line_of_one_that_is_kept_is_told_why_it_is_none():
    beside = Candidate(line(-1.45, score=9.0), GOOD)
    assert reasons(beside, kept=[Candidate(line(-1.75), GOOD)]) == ["0.3 m beside a lane found before"]


def test_what_is_refused_is_the_same_line_with_the_same_evidence():
    weak = Candidate(line(5.0, score=1.5), GOOD, "near half")
    (refused,) = select_lanes([weak], CONFIG).refused
    assert (refused.line, refused.evidence, refused.variant) == (weak.line, weak.evidence, "near half")
    assert weak.refusal == ""


@pytest.mark.parametrize(
    ("name", "value", "lines", "lanes"),
    [
        ("score_min", 2.6, (line(-1.75), line(1.75, score=2.5)), [0]),
        ("score_alone", 2.4, (line(1.75, score=2.5),), [0]),
        ("lane_width_min", 1.5, (line(-1.75), line(0.0, score=5.0)), [0, 1]),
        ("lane_width_max", 5.5, (line(0.0, score=2.5), line(5.0, score=2.5)), [0, 1]),
        ("same_line", 0.35, (line(-1.75), line(-1.45, score=5.0)), [0]),
        ("double_line", 0.25, (line(-1.75), line(-1.45, score=5.0)), [0]),
        ("strong_score", 4.0, (line(-1.75), line(0.0, score=5.0)), [0, 1]),
        ("strong_segment", 12.0, (line(-1.75), line(0.0, score=9.0)), [0]),
    ],
    ids=str,
)
def test_the_limits_are_those_of_the_configuration(name, value, lines, lanes):
    assert selected(*lines) != lanes
    assert selected(*lines, config=replace(CONFIG, **{name: value})) == lanes


def test_the_limits_of_dashes_and_unknown_heights_are_those_of_the_configuration():
    dashed = {"longest_segment": 3.0, "dashes": 2}
    in_lane = line(-1.75), line(0.0, score=7.0)
    assert selected(*in_lane, **dashed) == [0]
    assert selected(*in_lane, config=replace(CONFIG, strong_dashes=2), **dashed) == [0, 1]
    lonely = line(1.75, score=5.0)
    assert selected(lonely, height=np.nan) == []
    assert selected(lonely, config=replace(CONFIG, score_unknown_height=4.0), height=np.nan) == [0]
