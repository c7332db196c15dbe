# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Whether a line is paint by its own evidence, rule by rule, and the reason that is given where it is not."""

from dataclasses import replace

import numpy as np
import pytest

from lane_dp_ros.core.lanes.candidate import LaneEvidence, LaneLine
from lane_dp_ros.core.lanes.scoring import is_paint_but_for_course, is_pale, needs_height, refusal
from lane_dp_ros.core.lanes.selection import LaneSelectionConfig

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
PALE = replace(GOOD, contrast=0.39, saturation_contrast=0.34)
FAINT = {"saturation_contrast": 0.09}
DASHED = {"longest_segment": 4.4, "dashes": 3}
UNBROKEN = {"longest_segment": 4.5, "dashes": 1}
ABOVE_KERB = {"kerb_step": 0.13, "paint_width": 0.31, "height": 0.031, "brightness": -0.11}
AT_KERB = {"kerb_step": 0.12, "paint_width": 0.3, "height": 0.03, "brightness": -0.1}


def line(n=1.75, first=5.0):
    s = np.linspace(first, 30.0, 26)
    return LaneLine(np.arange(26), s, np.full(26, n), 0.0, 10.0)


def painted(evidence, bend=0.0, config=CONFIG, first=5.0):
    return refusal(line(first=first), evidence, config, bend) == ""


def test_good_evidence_is_that_of_paint():
    assert painted(GOOD)


@pytest.mark.parametrize(
    ("field", "good", "bad"),
    [
        ("paint_width", 0.36, 0.37),
        ("wide_band_ratio", 1.0, 1.01),
        ("height", 0.05, 0.06),
        ("slope", 0.14, 0.15),
        ("off_paint_fraction", 0.1, 0.11),
        ("texture", 0.2, 0.21),
    ],
)
def test_each_piece_of_evidence_can_speak_against_a_line(field, good, bad):
    assert painted(replace(GOOD, **{field: good}))
    assert not painted(replace(GOOD, **{field: bad}))


def test_what_is_brighter_neither_by_contrast_nor_by_saturation_contrast_is_no_paint():
    assert painted(replace(GOOD, **FAINT, contrast=0.1))
    assert not painted(replace(GOOD, **FAINT, contrast=0.09))


def test_in_glare_paint_need_only_use_what_is_left_up_to_white():
    assert painted(replace(GOOD, contrast=0.09, saturation_contrast=0.1))


@pytest.mark.parametrize(
    ("name", "closer", "evidence"),
    [
        ("paint_width_max", 0.35, replace(GOOD, paint_width=0.36)),
        ("wide_band_ratio_max", 0.99, replace(GOOD, wide_band_ratio=1.0)),
        ("contrast_min", 0.11, replace(GOOD, **FAINT, contrast=0.1)),
        ("saturation_contrast_min", 0.11, replace(GOOD, contrast=0.0, saturation_contrast=0.1)),
        ("height_max", 0.04, replace(GOOD, height=0.05)),
        ("slope_max", 0.13, replace(GOOD, slope=0.14)),
        ("off_paint_fraction_max", 0.09, replace(GOOD, off_paint_fraction=0.1)),
        ("texture_max", 0.19, replace(GOOD, texture=0.2)),
        ("start_max", 5.0, GOOD),
        ("kerb_contrast_max", 0.41, replace(PALE, contrast=0.4, kerb_step=0.2)),
        ("kerb_saturation_contrast_max", 0.36, replace(PALE, saturation_contrast=0.35, kerb_step=0.2)),
        ("kerb_step_min", 0.11, replace(PALE, kerb_step=0.12)),
        ("unbroken_min", 4.3, replace(PALE, **DASHED, height=0.04)),
        ("rail_width_max", 0.12, replace(PALE, paint_width=0.11)),
        ("kerb_width_min", 0.29, replace(PALE, paint_width=0.3)),
        ("kerb_height_min", 0.02, replace(PALE, height=0.03)),
        ("kerb_brightness_max", -0.09, replace(PALE, brightness=-0.1)),
    ],
    ids=str,
)
def test_the_limits_are_those_of_the_configuration(name, closer, evidence):
    """What lies just within the default is paint; it is none where the limit is drawn closer."""
    first = 5.5  # m
    assert painted(evidence, first=first)
    assert not painted(evidence, config=replace(CONFIG, **{name: closer}), first=first)


def test_the_allowance_for_bends_is_that_of_the_configuration():
    steep = replace(GOOD, slope=0.25)
    assert painted(steep, bend=0.02)
    assert not painted(steep, bend=0.02, config=replace(CONFIG, slope_per_bend=4.0))


def test_a_height_that_is_not_known_speaks_neither_for_nor_against_paint():
    unknown = replace(GOOD, height=np.nan)
    assert painted(unknown)
    assert painted(replace(PALE, height=np.nan))
    assert not painted(replace(unknown, paint_width=0.37))


def test_paint_below_the_road_is_paint():
    """Where the road falls to its sides more than its surface tells."""
    assert painted(replace(GOOD, height=-0.2))


def test_a_pale_narrow_stripe_is_a_rail_unless_it_is_dashed():
    narrow = {"paint_width": 0.10}
    assert painted(replace(PALE, **UNBROKEN, paint_width=0.11))
    assert not painted(replace(PALE, **UNBROKEN, **narrow))
    assert painted(replace(PALE, **DASHED, **narrow))
    assert painted(replace(GOOD, **UNBROKEN, **narrow))


@pytest.mark.parametrize("sign", ABOVE_KERB, ids=str)
def test_a_pale_stripe_with_one_sign_of_a_kerb_is_a_kerb(sign):
    assert painted(replace(PALE, **UNBROKEN))
    assert painted(replace(PALE, **UNBROKEN, **{sign: AT_KERB[sign]}))
    assert not painted(replace(PALE, **UNBROKEN, **{sign: ABOVE_KERB[sign]}))


def test_a_pale_stripe_at_the_foot_of_a_step_is_a_kerb():
    assert painted(replace(PALE, height=-0.12))
    assert not painted(replace(PALE, height=-0.13))


@pytest.mark.parametrize("sign", ABOVE_KERB, ids=str)
@pytest.mark.parametrize(("field", "bright"), [("contrast", 0.4), ("saturation_contrast", 0.35)])
def test_what_is_not_pale_is_no_kerb_whatever_else_it_has(sign, field, bright):
    """In glare fresh paint has little contrast, but takes much of what is left up to white."""
    stripe = replace(PALE, **UNBROKEN, **{field: bright})
    assert painted(replace(stripe, **{sign: ABOVE_KERB[sign]}))


@pytest.mark.parametrize(
    ("sign", "dashes_are_paint"), [("kerb_step", False), *[(s, True) for s in list(ABOVE_KERB)[1:]]]
)
def test_of_pale_dashes_only_a_step_makes_a_kerb(sign, dashes_are_paint):
    assert painted(replace(PALE, **DASHED, **{sign: ABOVE_KERB[sign]})) == dashes_are_paint


@pytest.mark.parametrize(("first", "paint"), [(22.0, True), (22.5, False)], ids=["near", "far"])
def test_what_begins_far_away_is_no_lane(first, paint):
    assert painted(GOOD, first=first) == paint


@pytest.mark.parametrize("bend", [-0.02, 0.02])  # 1/m
def test_lines_may_be_steeper_on_a_bend(bend):
    steepest = 0.14 + 7.0 * 0.02
    assert painted(replace(GOOD, slope=steepest - 0.001), bend)
    assert not painted(replace(GOOD, slope=steepest + 0.001), bend)
    assert not painted(replace(GOOD, slope=steepest - 0.001))


UNKNOWN = {"height": np.nan, "kerb_step": 0.0}


@pytest.mark.parametrize(
    ("evidence", "reason"),
    [
        (GOOD, ""),
        (replace(GOOD, paint_width=0.5), "0.50 m broad"),
        (replace(GOOD, wide_band_ratio=1.2), "as bright beside as on it"),
        (replace(GOOD, contrast=0.05, saturation_contrast=0.05), "contrast 0.05"),
        (replace(GOOD, height=0.08), "0.08 m above the road"),
        (replace(GOOD, slope=0.25), "slope 0.25"),
        (replace(GOOD, off_paint_fraction=0.256), "beside its paint for 26%"),
        (replace(GOOD, texture=0.3), "texture 0.30 beside it"),
        (replace(PALE, kerb_step=0.15), "kerb: a step of 0.15 m behind it"),
        (replace(PALE, height=-0.2), "gutter: 0.20 m below the road"),
        (replace(PALE, paint_width=0.08), "rail: narrow and unbroken"),
        (replace(PALE, paint_width=0.33), "kerb: broad and unbroken"),
        (replace(PALE, height=0.04), "kerb: 0.04 m high"),
        (replace(PALE, brightness=-0.2), "kerb: darker than the lane"),
    ],
    ids=str,
)
def test_a_line_that_is_refused_is_told_why(evidence, reason):
    assert refusal(line(), evidence, CONFIG, bend=0.0) == reason


def test_a_line_that_begins_far_away_is_told_so():
    assert refusal(line(first=24.0), GOOD, CONFIG, bend=0.0) == "begins at 24 m"


@pytest.mark.parametrize(
    "field", ["paint_width", "wide_band_ratio", "slope", "off_paint_fraction", "texture"]
)
def test_evidence_that_is_no_number_does_not_speak_for_paint(field):
    """The height and what depends on it alone may be unknown."""
    assert not painted(replace(GOOD, **{field: np.nan}))


@pytest.mark.parametrize(
    ("contrast", "saturation_contrast", "pale"),
    [(0.39, 0.34, True), (0.4, 0.34, False), (0.39, 0.35, False)],
)
def test_a_stripe_is_pale_by_both_contrasts(contrast, saturation_contrast, pale):
    evidence = replace(GOOD, contrast=contrast, saturation_contrast=saturation_contrast)
    assert is_pale(evidence, CONFIG) == pale


def test_a_line_may_be_paint_but_for_where_it_leads():
    astray = replace(GOOD, slope=0.5, off_paint_fraction=0.6)
    assert is_paint_but_for_course(line(), astray, CONFIG)
    assert not is_paint_but_for_course(line(), replace(astray, texture=0.3), CONFIG)
    assert not is_paint_but_for_course(line(), replace(astray, height=0.3), CONFIG)
    assert not is_paint_but_for_course(line(first=24.0), astray, CONFIG)


def test_the_height_is_asked_of_lines_that_are_paint_by_all_else():
    """Whatever height they have been given before."""
    assert needs_height(line(), replace(GOOD, height=0.3), CONFIG)
    assert needs_height(line(), replace(PALE, kerb_step=0.3), CONFIG)
    assert needs_height(line(), replace(GOOD, **UNKNOWN, slope=0.5, off_paint_fraction=0.6), CONFIG)
    assert not needs_height(line(), replace(GOOD, **UNKNOWN, paint_width=0.37), CONFIG)
    assert not needs_height(line(), replace(PALE, **UNKNOWN, paint_width=0.08), CONFIG)
