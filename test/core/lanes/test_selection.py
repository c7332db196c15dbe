# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Which candidates are lane lines and road edges by how they lie to one another, under the shipped model."""

from dataclasses import replace
from itertools import permutations

import numpy as np
import pytest

from lane_dp_ros.core.lanes.candidate import Candidate, LaneEvidence, LaneLine
from lane_dp_ros.core.lanes.evidence_model import PAIRS, EvidenceModel, Term, evidence_model
from lane_dp_ros.core.lanes.selection import LaneSelectionConfig, select

CONFIG, MODEL = LaneSelectionConfig(), evidence_model()
# A model in which lines side by side mean nothing to one another.
ALONE = EvidenceModel({}, {}, dict.fromkeys(PAIRS, Term(np.array([0.0]), np.array([0.0]))), {})


def candidate(n, paint=3.0, edge=-np.inf, *, first=5.0, last=30.0, slope=0.0, refusal=""):
    """Return a line at n [m] with its log-odds."""
    s = np.linspace(first, last, 101)
    line = LaneLine(np.arange(101), s, n + slope * (s - first), 0.0, 10.0)
    evidence = LaneEvidence(length=line.length, start=first, slope=slope)
    return Candidate(line, evidence, log_odds=(paint, edge), refusal=refusal)


def selected(*candidates, model=MODEL, config=CONFIG):
    """Return what each is: "paint", "edge" or "none"."""
    judged = select(candidates, model, config)
    assert [each.line for each in judged] == [each.line for each in candidates]
    return ["edge" if each.is_edge else "none" if each.refusal else "paint" for each in judged]


def test_of_nothing_nothing_is_selected():
    assert select([], MODEL, CONFIG) == []


@pytest.mark.parametrize(
    ("log_odds", "kind"),
    [((1.0, -np.inf), "paint"), ((-1.0, -np.inf), "none"), ((-np.inf, 1.0), "edge"), ((1.0, 2.0), "edge")],
)
def test_a_line_by_itself_is_what_it_is_most_probably(log_odds, kind):
    (judged,) = select([candidate(1.75, *log_odds)], MODEL, CONFIG)
    assert selected(candidate(1.75, *log_odds)) == [kind]
    assert judged.probability == pytest.approx(np.exp(log_odds) / (1 + np.exp(log_odds).sum()))


def test_lines_a_lanes_width_apart_speak_for_one_another():
    weak = candidate(-1.75, -0.5), candidate(1.75, -0.5)
    assert selected(*weak) == ["paint", "paint"]
    assert selected(weak[0]) == ["none"]
    assert selected(*weak, model=ALONE) == ["none", "none"]


@pytest.mark.parametrize("order", list(permutations(range(3))), ids=str)
def test_a_weaker_line_in_the_middle_of_a_lane_is_none(order):
    """An arrow, or a seam: it speaks against both borders, and they speak against it."""
    candidates = [candidate(-1.75), candidate(0.0, 1.0), candidate(1.75)]
    found = selected(*[candidates[i] for i in order])
    assert [found[order.index(i)] for i in range(3)] == ["paint", "none", "paint"]


def test_a_line_in_a_lane_can_outweigh_one_of_its_borders():
    assert selected(candidate(-1.2, 0.5), candidate(0.0, 5.0)) == ["none", "paint"]


@pytest.mark.parametrize("aside", [0.0, 0.1, -0.15])
def test_of_a_line_found_twice_the_more_probable_one_is_taken(aside):
    found = selected(candidate(-1.75, 2.0), candidate(-1.75 + aside, 1.0))
    assert found == ["paint", "none"]


@pytest.mark.parametrize("last", [30.0, 18.0], ids=["all of it", "its nearer half"])
def test_of_a_line_found_twice_one_is_taken_however_sure_both_are(last):
    assert selected(candidate(-1.75, 9.0), candidate(-1.75, 8.0, last=last)) == ["paint", "none"]
    assert selected(candidate(-1.75, 8.0), candidate(-1.75, 9.0, last=last)) == ["none", "paint"]


@pytest.mark.parametrize(("shared", "kinds"), [(12.0, ["paint", "none"]), (8.0, ["paint", "paint"])])
def test_lines_that_part_are_two_where_they_share_less_than_half(shared, kinds):
    """From where they part on the other line runs 1 m aside."""
    other = candidate(1.75, 8.0, last=25.0)
    aside = np.where(other.line.s > 5.0 + shared, 1.0, 0.0)
    assert selected(candidate(1.75, 9.0), replace(other, line=replace(other.line, n=1.75 + aside))) == kinds


def test_a_line_found_twice_is_as_probable_as_both_together():
    """Each by itself is improbable beside the other one."""
    twice = [candidate(-1.75, 1.0), candidate(-1.7, 0.9)]
    judged = select(twice, MODEL, CONFIG)
    alone = select(twice[:1], MODEL, CONFIG)
    assert judged[0].probability[0] > alone[0].probability[0]
    assert judged[0].probability[0] <= 1.0


def test_a_double_line_is_two_lines():
    assert selected(candidate(-1.75), candidate(-1.45), candidate(1.75)) == ["paint"] * 3


def test_two_pieces_of_a_line_one_behind_the_other_are_both_found():
    assert selected(candidate(-1.75, last=15.0), candidate(-1.7, first=20.0)) == ["paint", "paint"]


def test_paint_before_a_border_is_judged_with_it():
    found = selected(candidate(-1.75, 5.0), candidate(1.75, 5.0), candidate(2.2, -np.inf, 4.0))
    assert found == ["paint", "paint", "edge"]


def test_a_border_in_the_middle_of_a_lane_is_none():
    found = selected(candidate(-1.75, 4.0), candidate(0.3, -np.inf, 1.0), candidate(1.75, 4.0))
    assert found == ["paint", "none", "paint"]


@pytest.mark.parametrize(("confidence_min", "kind"), [(0.7, "paint"), (0.76, "none")])
def test_what_is_less_probable_than_configured_is_none(confidence_min, kind):
    """Log-odds of 1.1 are a probability of 0.75."""
    config = LaneSelectionConfig(confidence_min=confidence_min)
    assert selected(candidate(1.75, 1.1), config=config) == [kind]
    assert selected(candidate(1.75, -np.inf, 1.1), config=config) == [kind.replace("paint", "edge")]


@pytest.mark.parametrize(("log_odds", "kind"), [(-4.9, "paint"), (-5.1, "none")])
def test_what_is_hopeless_by_itself_no_neighbour_makes_a_line(log_odds, kind):
    helps = Term(np.array([0.0]), np.array([9.0]))
    model = replace(ALONE, pairs={**ALONE.pairs, "paint_beside_paint": helps})
    assert selected(candidate(-1.75), candidate(1.75, log_odds), model=model) == ["paint", kind]


def test_a_hopeless_candidate_has_no_probability_and_a_reason():
    (judged,) = select([candidate(1.75, -8.0)], MODEL, CONFIG)
    assert (judged.probability, judged.refusal) == ((0.0, 0.0), "log-odds -8.0")


def test_what_is_refused_before_stays_refused_with_its_reason():
    """It may be a border nevertheless."""
    broad = candidate(3.0, -np.inf, 2.0, refusal="0.50 m broad")
    assert select([replace(broad, log_odds=(-np.inf, -2.0))], MODEL, CONFIG)[0].refusal == "0.50 m broad"
    (edge,) = select([broad], MODEL, CONFIG)
    assert edge.is_edge
    assert edge.refusal == "a road edge"


def test_a_line_that_the_others_speak_against_is_told_so():
    judged = select([candidate(-1.75), candidate(0.0, 1.0), candidate(1.75)], MODEL, CONFIG)
    assert judged[1].refusal.startswith("log-odds +1.0, but 0.0")
    assert judged[1].refusal.endswith(" beside the other lines")
    assert select([candidate(0.0, -0.7)], MODEL, CONFIG)[0].refusal == "log-odds -0.7"
