# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Kind and colour of the paint: what is there against what a detection tells."""

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.types import Lane
from lane_dp_ros.tools.evaluation.annotations import Label, LabelledFrame
from lane_dp_ros.tools.evaluation.json_file import as_json
from lane_dp_ros.tools.evaluation.matching import judge
from lane_dp_ros.tools.evaluation.paint_kinds import (
    PaintSummary,
    compare_paint,
    confusion_rows,
    share_right,
)
from lane_dp_ros.tools.evaluation.summary import summarise
from lane_dp_ros.tools.evaluation.text import tables

CAMERA = StereoCamera(700.0, 700.0, 600.0, 180.0, 0.54)
GROUND = np.array([0.0, 100 * 0.54 / 1.65, 0.0, 0.0])  # a plane 1.65 m below the camera
POINTS = np.array([[-1.8, 1.65, z] for z in range(5, 31)], dtype=float)
LABEL = Label("L", "solid", True, CAMERA.project(POINTS), POINTS[:, [0, 2]])
RENDERED = replace(LABEL, colour="white", width=0.15, double=False)
LANE = Lane(POINTS, 0.9, 0.12, "ego_left", 0.0, -1.8)


def compared(label, **told):
    return compare_paint(label, replace(LANE, **told))


def judged(label, *lanes):
    frame = LabelledFrame("a/0", CAMERA, (1200, 370), GROUND, (label,), "L", None)
    return judge(frame, lanes, CAMERA)


def test_a_double_line_is_of_that_kind_whatever_its_sides():
    double = replace(RENDERED, double=True, kind="dashed")
    assert compared(double, kind="double", sides=("solid", "dashed"))[:2] == ("double", "double")
    assert compared(double, kind="dashed")[:2] == ("double", "dashed")


def test_labels_by_hand_know_no_double_lines():
    """One of the two lines is what was labelled; where neither is of its kind, the detection is wrong."""
    assert compared(LABEL, kind="double", sides=("dashed", "solid"))[:2] == ("solid", "solid")
    assert compared(LABEL, kind="double", sides=("dashed", "dashed"))[:2] == ("solid", "double")
    assert compared(LABEL, kind="double")[:2] == ("solid", "double")


def test_labels_of_scenes_know_them():
    assert compared(RENDERED, kind="double", sides=("solid", "solid"))[:2] == ("solid", "double")


def test_colours_are_compared_where_both_are_known():
    told = [
        compared(RENDERED, colour="white"),
        compared(RENDERED, colour="yellow"),
        compared(RENDERED),
        compared(LABEL, colour="white"),
    ]
    summary = PaintSummary.of(told)
    assert summary.colours == {("white", "white"): 1, ("white", "yellow"): 1}
    assert summary.colour_right == 0.5


def test_what_is_not_told_is_neither_right_nor_wrong():
    kinds = Counter({("solid", "solid"): 3, ("solid", "dashed"): 1, ("dashed", ""): 2})
    assert share_right(kinds) == 0.75
    assert np.isnan(share_right(Counter({("dashed", ""): 2})))
    heads, rows = confusion_rows(kinds)
    assert heads == ["solid", "dashed", "not told", "right"]
    assert rows == {
        "solid": ["3", "1", "0", "0.750"],
        "dashed": ["0", "0", "2", "-"],
        "total": ["3", "1", "2", "0.750"],
    }


def test_only_found_lines_that_had_to_be_are_counted():
    found = judged(RENDERED, replace(LANE, kind="solid", colour="white"))
    unsure = judged(replace(LABEL, sure=False), replace(LANE, kind="dashed"))
    missed = judged(LABEL, replace(LANE, points=POINTS + np.array([0.5, 0, 0]), kind="dashed"))
    edge = judged(replace(LABEL, kind="edge"), replace(LANE, kind="solid"))
    paint = summarise([found, unsure, missed, edge]).paint
    assert paint == PaintSummary(Counter({("solid", "solid"): 1}), Counter({("white", "white"): 1}))


def test_the_text_and_the_json_file_show_the_confusion():
    dashed = replace(RENDERED, kind="dashed", colour="yellow")
    results = [
        judged(RENDERED, replace(LANE, kind="solid", colour="white")),
        judged(RENDERED, replace(LANE, kind="dashed", colour="white")),
        judged(dashed, replace(LANE, kind="dashed")),
    ]
    lines = [line.split() for line in tables(results).splitlines()]
    assert ["kind", "solid", "dashed", "right"] in lines
    assert ["solid", "1", "1", "0.500"] in lines and ["dashed", "0", "1", "1.000"] in lines
    assert ["total", "1", "2", "0.667"] in lines and ["white", "2", "1.000"] in lines
    paint = as_json(results, ())["total"]["paint"]
    assert paint["kinds"] == {"solid": {"solid": 1, "dashed": 1}, "dashed": {"dashed": 1}}
    assert (paint["kind_right"], paint["colour_right"]) == (pytest.approx(2 / 3), 1.0)
    assert paint["colours"] == {"white": {"white": 2}}


def test_nothing_is_shown_where_nothing_is_told():
    text = tables([judged(LABEL, LANE)])
    assert "told" not in text
    assert as_json([judged(LABEL, LANE)], ())["total"]["paint"]["kind_right"] is None
