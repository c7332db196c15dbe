# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Which lines are lanes, rule by rule."""

from dataclasses import replace

import numpy as np
import pytest

from lane_dp_ros.core.lanes import selection as lane_selection
from lane_dp_ros.core.lanes.candidate import LaneEvidence, LaneLine
from lane_dp_ros.core.lanes.selection import LaneSelectionConfig, is_paint, lateral_gap, select_lanes

CONFIG = LaneSelectionConfig()
GOOD = LaneEvidence(
    paint_width=0.15,
    wide_band_ratio=0.4,
    height=0.0,
    step=0.0,
    slope=0.02,
    off_paint_fraction=0.02,
    roughness=0.05,
    contrast=0.5,
    saturation_contrast=0.5,
    brightness=0.5,
    run=10.0,
    dashes=1,
)
PALE = replace(
    GOOD,
    contrast=lane_selection.KERB_CONTRAST - 0.01,
    saturation_contrast=lane_selection.KERB_SATURATION_CONTRAST - 0.01,
)
FAINT = {"saturation_contrast": lane_selection.SATURATION_CONTRAST_MIN - 0.01}
DASHED = {"run": lane_selection.UNBROKEN - 0.1, "dashes": 3}
UNBROKEN = {"run": lane_selection.UNBROKEN, "dashes": 1}
ABOVE_KERB = {
    "step": lane_selection.KERB_STEP + 0.01,
    "paint_width": lane_selection.KERB_WIDTH + 0.01,
    "height": lane_selection.KERB_HEIGHT + 0.001,
    "brightness": lane_selection.KERB_BRIGHTNESS - 0.01,
}
AT_KERB = {
    "step": lane_selection.KERB_STEP,
    "paint_width": lane_selection.KERB_WIDTH,
    "height": lane_selection.KERB_HEIGHT,
    "brightness": lane_selection.KERB_BRIGHTNESS,
}


def line(n, score=10.0, first=5.0, last=30.0, slope=0.0):
    s = np.linspace(first, last, 26)
    return LaneLine(np.arange(26), s, n + slope * (s - first), 0.0, score)


def painted(evidence, bend=0.0, config=CONFIG):
    return is_paint(line(1.75), evidence, config, bend)


def selected(*lines, kept=(), **evidence):
    return select_lanes(lines, [replace(GOOD, **evidence)] * len(lines), CONFIG, kept)


def test_good_evidence_makes_a_lane():
    assert painted(GOOD)


@pytest.mark.parametrize(
    ("field", "good", "bad"),
    [
        ("paint_width", CONFIG.paint_width_max, CONFIG.paint_width_max + 0.01),
        ("wide_band_ratio", lane_selection.WIDE_BAND_RATIO_MAX, lane_selection.WIDE_BAND_RATIO_MAX + 0.01),
        ("height", CONFIG.height_max, CONFIG.height_max + 0.01),
        ("slope", CONFIG.slope_max, CONFIG.slope_max + 0.01),
        (
            "off_paint_fraction",
            lane_selection.OFF_PAINT_FRACTION_MAX,
            lane_selection.OFF_PAINT_FRACTION_MAX + 0.01,
        ),
        ("roughness", CONFIG.texture_max, CONFIG.texture_max + 0.01),
    ],
)
def test_each_piece_of_evidence_can_speak_against_a_line(field, good, bad):
    assert painted(replace(GOOD, **{field: good}))
    assert not painted(replace(GOOD, **{field: bad}))


def test_what_is_brighter_neither_by_contrast_nor_by_headroom_is_no_paint():
    low = CONFIG.contrast_min - 0.01
    assert painted(replace(GOOD, **FAINT, contrast=CONFIG.contrast_min))
    assert not painted(replace(GOOD, **FAINT, contrast=low))


def test_in_glare_paint_need_only_use_what_is_left_up_to_white():
    low = CONFIG.contrast_min - 0.01
    assert painted(replace(GOOD, contrast=low, saturation_contrast=lane_selection.SATURATION_CONTRAST_MIN))


@pytest.mark.parametrize("name", ["paint_width_max", "contrast_min", "height_max"])
def test_the_limits_are_those_of_the_configuration(name):
    field = name[:-4]
    turned = getattr(CONFIG, name) * (2 if name.endswith("_min") else 0.5)
    evidence = replace(GOOD, **FAINT, **{field: getattr(CONFIG, name)})
    assert painted(evidence)
    assert not painted(evidence, config=replace(CONFIG, **{name: turned}))


def test_a_height_that_is_not_known_speaks_neither_for_nor_against_paint():
    unknown = replace(GOOD, height=np.nan)
    assert painted(unknown)
    assert painted(replace(PALE, height=np.nan))
    assert not painted(replace(unknown, paint_width=CONFIG.paint_width_max + 0.01))


def test_paint_below_the_road_is_paint():
    """Where the road falls to its sides more than its surface tells."""
    assert painted(replace(GOOD, height=-0.2))


def test_a_pale_narrow_stripe_is_a_rail_unless_it_is_dashed():
    narrow = {"paint_width": lane_selection.RAIL_WIDTH - 0.01}
    assert painted(replace(PALE, **UNBROKEN, paint_width=lane_selection.RAIL_WIDTH))
    assert not painted(replace(PALE, **UNBROKEN, **narrow))
    assert painted(replace(PALE, **DASHED, **narrow))
    assert painted(replace(GOOD, **UNBROKEN, **narrow))


@pytest.mark.parametrize("sign", ABOVE_KERB, ids=str)
def test_a_pale_stripe_with_one_sign_of_a_kerb_is_a_kerb(sign):
    assert painted(replace(PALE, **UNBROKEN))
    assert painted(replace(PALE, **UNBROKEN, **{sign: AT_KERB[sign]}))
    assert not painted(replace(PALE, **UNBROKEN, **{sign: ABOVE_KERB[sign]}))


def test_a_pale_stripe_at_the_foot_of_a_step_is_a_kerb():
    assert painted(replace(PALE, height=-lane_selection.KERB_STEP))
    assert not painted(replace(PALE, height=-lane_selection.KERB_STEP - 0.01))


@pytest.mark.parametrize("sign", ABOVE_KERB, ids=str)
@pytest.mark.parametrize("field", ["contrast", "saturation_contrast"])
def test_what_is_not_pale_is_no_kerb_whatever_else_it_has(sign, field):
    """In glare fresh paint has little contrast, but takes much of what is left up to white."""
    bright = replace(PALE, **UNBROKEN, **{field: lane_selection.KERB_CONTRAST})
    assert painted(replace(bright, **{sign: ABOVE_KERB[sign]}))


@pytest.mark.parametrize(
    ("sign", "dashes_are_paint"), [("step", False), *[(s, True) for s in list(ABOVE_KERB)[1:]]]
)
def test_of_pale_dashes_only_a_step_makes_a_kerb(sign, dashes_are_paint):
    assert painted(replace(PALE, **DASHED, **{sign: ABOVE_KERB[sign]})) == dashes_are_paint


@pytest.mark.parametrize(
    ("first", "paint"), [(CONFIG.start_max, True), (CONFIG.start_max + 0.5, False)], ids=["near", "far"]
)
def test_what_begins_far_away_is_no_lane(first, paint):
    assert is_paint(line(1.75, first=first), GOOD, CONFIG, bend=0.0) == paint


@pytest.mark.parametrize("bend", [-0.02, 0.02])  # 1/m
def test_lines_may_be_steeper_on_a_bend(bend):
    steepest = CONFIG.slope_max + lane_selection.SLOPE_PER_BEND * 0.02
    assert painted(replace(GOOD, slope=steepest - 0.001), bend)
    assert not painted(replace(GOOD, slope=steepest + 0.001), bend)
    assert not painted(replace(GOOD, slope=steepest - 0.001))


def test_a_weak_line_by_itself_is_none_and_a_strong_one_is():
    assert selected(line(1.75, score=CONFIG.score_alone - 0.1)) == []
    assert selected(line(1.75, score=CONFIG.score_alone)) == [0]


def test_of_unknown_height_a_line_by_itself_takes_more_paint():
    enough = lane_selection.UNKNOWN_HEIGHT
    assert enough > CONFIG.score_alone
    assert selected(line(1.75, score=enough - 0.1), height=np.nan) == []
    assert selected(line(1.75, score=enough), height=np.nan) == [0]
    assert selected(line(1.75, score=enough - 0.1)) == [0]
    weak = line(-1.75, score=enough - 0.1), line(1.75, score=enough - 0.1)
    assert selected(*weak, height=np.nan) == [0, 1]  # but not beside another one


def test_more_paint_that_a_line_by_itself_is_to_have_holds_for_unknown_heights_too():
    config = replace(CONFIG, score_alone=lane_selection.UNKNOWN_HEIGHT + 1)
    weak = [line(1.75, score=lane_selection.UNKNOWN_HEIGHT + 0.5)]
    assert select_lanes(weak, [replace(GOOD, height=np.nan)], config) == []


@pytest.mark.parametrize(
    ("width", "both"),
    [
        (CONFIG.lane_width_min - 0.1, False),
        (CONFIG.lane_width_min + 0.1, True),
        (CONFIG.lane_width_max - 0.1, True),
        (CONFIG.lane_width_max + 0.1, False),
    ],
)
def test_weak_lines_support_each_other_a_lanes_width_apart(width, both):
    weak = CONFIG.score_alone - 0.1
    assert selected(line(0, score=weak), line(width, score=weak - 0.1)) == ([0, 1] if both else [])


def test_what_has_hardly_any_paint_is_no_lane_even_beside_one():
    assert selected(line(-1.75), line(1.75, score=CONFIG.score_min - 0.1)) == [0]
    assert selected(line(-1.75), line(1.75, score=CONFIG.score_min)) == [0, 1]


@pytest.mark.parametrize(
    ("score", "run", "dashes", "is_line"),
    [
        (-0.1, 20.0, 9, False),
        (0.1, lane_selection.LONG_PIECE, 1, True),  # one long piece
        (0.1, lane_selection.LONG_PIECE - 0.1, lane_selection.DASHES - 1, False),
        (0.1, 3.0, lane_selection.DASHES, True),  # a dashed line
    ],
)
def test_an_arrow_in_the_middle_of_a_lane_is_no_line(score, run, dashes, is_line):
    """Dashes one behind the other are more than an arrow, and so is a long piece; each with enough paint."""
    lines = [line(-1.75), line(0.0, score=lane_selection.STRONG + score)]
    evidence = [GOOD, replace(GOOD, run=run, dashes=dashes)]
    assert select_lanes(lines, evidence, CONFIG) == ([0, 1] if is_line else [0])


def test_the_arrow_is_the_weaker_one_whatever_the_order():
    assert selected(line(0.0, score=lane_selection.STRONG - 1), line(-1.75)) == [1]


def test_a_double_line_is_two_lines():
    assert selected(line(-1.75), line(-1.45, score=5.0)) == [0, 1]
    assert selected(line(-1.75), line(-1.75 + lane_selection.BESIDE, score=5.0)) == [0, 1]


def test_the_same_line_found_twice_is_one():
    for aside in (-lane_selection.SAME, 0.0, lane_selection.SAME - 0.01):
        assert selected(line(-1.75, score=5.0), line(-1.75 + aside)) == [1]
    assert selected(line(-1.75, score=5.0), line(-1.74 + lane_selection.SAME)) == [1, 0]


@pytest.mark.parametrize(("together", "lines"), [(10.0, [1, 0]), (15.0, [1])])
def test_lines_that_part_are_two_where_they_run_apart_for_longer(together, lines):
    split = line(1.75, score=8.0)
    split = replace(
        split, n=split.n + np.maximum(0, split.s - split.s[0] - together + 1) * 0.2
    )  # SAME in 1 m
    assert selected(split, line(1.75)) == lines


@pytest.mark.parametrize("first", [12.0, 15.0, 20.0], ids=["overlap", "touch", "apart"])
def test_two_pieces_of_a_line_are_one(first):
    assert selected(line(-1.75, last=15), line(-1.7, score=5.0, first=first)) == [0]


def test_a_short_line_that_a_long_one_holds_is_the_same():
    short = line(1.7, score=5.0, first=8, last=16, slope=0.03)  # nearer than SAME over 6.7 m of 8 m
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
