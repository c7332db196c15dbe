# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The curves of the evidence model: knots, signs, and what each coefficient counts."""

from dataclasses import fields

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lane_dp_ros.core.lanes.candidate import LaneEvidence
from lane_dp_ros.core.lanes.evidence_model import CLASSES
from lane_dp_ros.tools.evidence_fit.curves import SIGNS, Curve, Sign, curve

UNIFORM = np.linspace(0.0, 10.0, 1001)
SYMMETRIC = np.linspace(-1.0, 1.0, 1001)


def test_a_curve_has_knots_at_equal_shares_of_the_values():
    found = curve(Sign("rises"), UNIFORM)
    assert found.knots == pytest.approx([0.5, 2.75, 5.0, 7.25, 9.5])
    assert found.signs.tolist() == [1, 1, 1, 1]
    assert curve(Sign("falls"), UNIFORM).signs.tolist() == [-1, -1, -1, -1]


def test_a_peak_rises_up_to_its_turn_and_a_valley_falls():
    peak, valley = curve(Sign("peak", 0.0), SYMMETRIC), curve(Sign("valley", 0.0), SYMMETRIC)
    assert 0.0 in peak.knots
    assert peak.signs.tolist() == [1, 1, 1, -1, -1, -1]
    assert valley.signs.tolist() == [-1, -1, -1, 1, 1, 1]


def test_a_curve_goes_on_beyond_its_knots_where_it_speaks_against_the_class():
    """What is better than all that was seen counts no more than the best of it."""
    sides = {shape: curve(Sign(shape), SYMMETRIC) for shape in ("rises", "falls", "peak", "valley")}
    assert [(each.before, each.behind) for each in sides.values()] == [(2, 0), (0, 2), (2, 2), (0, 0)]


def test_of_few_values_a_curve_has_one_segment():
    few = np.r_[np.arange(19.0), np.full(50, np.nan)]
    assert len(curve(Sign("rises"), few).signs) == 1
    assert len(curve(Sign("rises"), np.r_[few, 19.0]).signs) > 1


@pytest.mark.parametrize("shape", ["rises", "falls", "peak", "valley"])
@pytest.mark.parametrize("values", [np.zeros(100), np.r_[np.zeros(99), 5.0], -np.ones(100)], ids=str)
def test_the_knots_rise_whatever_the_values(shape, values):
    found = curve(Sign(shape), values)
    assert np.all(np.diff(found.knots) > 0)
    assert len(found.signs) == len(found.knots) - 1 >= 1


@given(
    steps=st.lists(st.floats(-3, 3), min_size=3, max_size=3),
    values=st.lists(st.floats(-30, 30), min_size=1, max_size=10),
    beyond=st.tuples(st.sampled_from([0.0, 2.0]), st.sampled_from([0.0, 2.0])),
)
def test_a_term_adds_what_its_segments_count(steps, values, beyond):
    """The fit multiplies segments by coefficients; the detector looks up the term: both are one curve."""
    of = Curve(np.array([-2.0, 0.0, 1.0, 5.0]), np.zeros(3, np.int8), *beyond)
    term, values = of.term(np.array(steps), unknown=0.5), np.array(values)
    np.testing.assert_allclose(of.segments(values) @ steps, term(values), atol=1e-9)


def test_an_unknown_value_is_in_no_segment():
    of = Curve(np.array([0.0, 1.0, 2.0]), np.ones(2, np.int8), before=2.0)
    assert of.segments(np.array([np.nan, 0.5, 9.0, -9.0])).tolist() == [[0, 0], [0.5, 0], [1, 1], [-2, 0]]
    assert of.term(np.array([1.0, 1.0]), unknown=-0.7)([np.nan]).tolist() == [-0.7]


def test_every_sign_is_of_a_measurement():
    assert set(SIGNS) == set(CLASSES)
    measured = {field.name for field in fields(LaneEvidence)}
    assert all(set(signs) <= measured for signs in SIGNS.values())
