# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Lines keep the kind and the colour that most of their recent sightings had."""

import numpy as np
import pytest

from lane_dp_ros.core.tracking.paint_vote import PaintVote
from lane_dp_ros.core.tracking.tracker import LaneTracker, TrackingConfig
from lane_dp_ros.core.types import Lane

FRAME = 100_000_000  # ns: 10 Hz
START = 1_316_533_000_000_000_000  # ns
SOLID, DASHED = {"kind": "solid"}, {"kind": "dashed"}


def lane(offset, kind="", colour="", sides=None, confidence=0.9):
    """A line of the straight road, from 5 to 20 m ahead."""
    z = np.arange(5.0, 20.0, 0.5)
    points = np.column_stack([np.full_like(z, offset), np.full_like(z, 1.65), z])
    return Lane(points, confidence, 0.15, "other", 0.0, offset, kind=kind, colour=colour, sides=sides)


def published(sightings, tracker=None, offset=1.75):
    """The line that a tracker publishes, one for each sighting (fields of `lane`, None for none)."""
    tracker = tracker or LaneTracker()
    beside = lane(-1.75)  # another line, which is always seen
    drive = [[beside] if seen is None else [beside, lane(offset, **seen)] for seen in sightings]
    answers = [tracker.update(lanes, START + i * FRAME) for i, lanes in enumerate(drive)]
    assert len({each.id for found in answers for each in found}) == 2
    return [next((each for each in found if each.lateral_offset > 0), None) for found in answers]


def kinds(sightings, **options):
    return [found.kind for found in published(sightings, **options)]


def test_the_first_sighting_says_what_is_published():
    assert kinds([SOLID]) == ["solid"]
    assert kinds([{}]) == [""]


def test_one_sighting_of_another_kind_changes_nothing():
    seen = [SOLID] * 5 + [DASHED] + [SOLID] * 5
    assert kinds(seen) == ["solid"] * 11


def test_kinds_that_take_turns_do_not_flicker():
    assert kinds([SOLID, DASHED] * 15) == ["solid"] * 30


def test_a_wrong_first_sighting_is_corrected_by_the_third():
    assert kinds([DASHED, SOLID, SOLID, SOLID])[2:] == ["solid", "solid"]


def test_a_line_that_really_changes_is_so_published_within_a_second():
    """As at a junction, where a dashed line becomes a solid one."""
    told = kinds([DASHED] * 30 + [SOLID] * 20)
    assert told[:30] == ["dashed"] * 30
    assert 33 <= told.index("solid") <= 40
    assert set(told[40:]) == {"solid"}


def test_what_is_not_known_does_not_vote():
    assert kinds([SOLID, *[{}] * 20]) == ["solid"] * 21
    assert kinds([{}, {}, DASHED]) == ["", "", "dashed"]


def test_unsure_sightings_count_less():
    sure, unsure = {**SOLID, "confidence": 1.0}, {**DASHED, "confidence": 0.2}
    assert kinds([sure, sure, *[unsure] * 7])[-1] == "solid"
    assert kinds([sure, sure, *[{**DASHED, "confidence": 1.0}] * 7])[-1] == "dashed"


def test_the_colour_is_voted_for_by_itself():
    yellow, white = {"kind": "solid", "colour": "yellow"}, {"kind": "dashed", "colour": "white"}
    seen = [yellow] * 4 + [{**white, "kind": "solid"}] + [{"kind": "dashed"}] * 10
    last = published(seen)[-1]
    assert (last.kind, last.colour) == ("dashed", "yellow")


def test_the_sides_of_a_double_line_are_held_and_those_of_a_single_one_are_none():
    double = {"kind": "double", "sides": ("solid", "dashed")}
    other = {"kind": "double", "sides": ("dashed", "dashed")}
    found = published([*[double] * 5, other, SOLID, double])
    assert {(each.kind, each.sides) for each in found} == {("double", ("solid", "dashed"))}
    assert published([*[double] * 2, *[SOLID] * 20])[-1].sides is None


def test_a_line_that_coasts_keeps_its_kind_and_colour():
    seen = {"kind": "dashed", "colour": "white"}
    found = published([seen] * 6 + [None] * 4)
    assert [(each.kind, each.colour) for each in found] == [("dashed", "white")] * 10
    assert found[-1].confidence < 0.9


def test_each_line_has_a_vote_of_its_own():
    tracker = LaneTracker()
    for i in range(6):
        answer = tracker.update([lane(-1.75, "solid"), lane(1.75, "dashed")], START + i * FRAME)
    assert {each.lateral_offset: each.kind for each in answer} == {-1.75: "solid", 1.75: "dashed"}


def test_without_tracking_a_line_has_the_kind_of_its_frame():
    tracker = LaneTracker(TrackingConfig(enabled=False))
    assert kinds([SOLID, SOLID, DASHED, {}], tracker=tracker) == ["solid", "solid", "dashed", ""]


def test_after_a_jump_of_time_the_votes_are_forgotten():
    tracker = LaneTracker()
    published([SOLID] * 10, tracker)
    (again,) = tracker.update([lane(1.75, "dashed")], START + 60 * 10 * FRAME)
    assert again.kind == "dashed"


@pytest.mark.parametrize("confidence", [1e-3, 0.5, 1.0])
def test_nothing_else_of_a_sighting_changes(confidence):
    seen = lane(1.75, "double", "white", ("solid", "dashed"), confidence)
    assert vars(PaintVote().steadied(seen)) == vars(seen)
