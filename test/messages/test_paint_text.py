# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What a marker's text says of a line's paint."""

from itertools import product

import pytest

from lane_dp_ros.messages.paint_text import Paint, paint_from_text, paint_to_text

SIDES = ("solid", "dashed", "")


@pytest.mark.parametrize(
    ("paint", "text"),
    [
        (Paint("solid", "white"), "solid white"),
        (Paint("dashed", "yellow"), "dashed yellow"),
        (Paint("solid"), "solid"),
        (Paint(), ""),
        (Paint("edge"), "edge"),
        (Paint("double", "white", ("solid", "solid")), "double white"),
        (Paint("double", "white", ("solid", "dashed")), "double white, solid left, dashed right"),
        (Paint("double", "", ("dashed", "solid")), "double, dashed left, solid right"),
        (Paint("double", "yellow", ("dashed", "dashed")), "double yellow, dashed left, dashed right"),
        (Paint("double", "white", ("solid", "")), "double white, solid left, unknown right"),
    ],
)
def test_texts(paint, text):
    assert paint_to_text(paint) == text
    assert paint_from_text(text) == paint


def test_every_paint_has_a_text_of_its_own():
    colours = ("white", "yellow", "")
    singles = [Paint(kind, colour) for kind, colour in product(("solid", "dashed", "edge", ""), colours)]
    doubles = [Paint("double", colour, pair) for colour in colours for pair in product(SIDES, SIDES)]
    assert [paint_from_text(paint_to_text(paint)) for paint in singles + doubles] == singles + doubles


@pytest.mark.parametrize(
    "text", ["white solid", "Solid white", "solid  white", "double white, solid left", "?"]
)
def test_of_any_other_text_nothing_is_known(text):
    assert paint_from_text(text) == Paint("", "", None)
