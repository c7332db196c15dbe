# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The fit of the evidence model, on frames whose truth is drawn by known rules."""

import json

import numpy as np
import pytest

from lane_dp_ros.core.lanes.candidate import LaneEvidence, LaneLine
from lane_dp_ros.core.lanes.evidence_model import CLASSES, PAIRS, parsed_model
from lane_dp_ros.core.lanes.neighbours import Neighbours
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.tools.evidence_fit.curves import GAPS, SIGNS
from lane_dp_ros.tools.evidence_fit.examples import Example
from lane_dp_ros.tools.evidence_fit.fit import EvidenceFit, hats
from lane_dp_ros.tools.evidence_fit.model_file import model_text

PAINT, EDGE, CLUTTER = (True, False, True), (False, True, True), (False, False, True)


def line(n):
    s = np.linspace(5.0, 25.0, 21)
    return LaneLine(np.arange(21), s, np.full(21, float(n)), 0.0, 10.0)


def evidence(rng, what):
    """Return the evidence of paint (bright, flat), of a border (a step behind it), or of clutter."""
    bright = 0.7 if what == PAINT else 0.25
    step = 0.15 if what == EDGE else 0.0
    return LaneEvidence(
        length=20.0,
        start=5.0,
        slope=float(rng.uniform(0, 0.1)),
        score=float(rng.uniform(5, 15)),
        height=float(rng.normal(0, 0.01)) if what == PAINT else np.nan,
        contrast=float(rng.normal(bright, 0.15)),
        far_rise=float(rng.normal(step, 0.04)),
        border=float(rng.uniform(0.3, 0.8)),
    )


def frame(rng, category=""):
    """Return a frame of two lines 3.5 m apart, a border right of them, and clutter in between."""
    places = {-1.75: PAINT, 0.0: CLUTTER, 1.75: PAINT, 4.0: EDGE}
    if rng.random() < 0.3:
        del places[0.0]
    what = tuple(places.values())
    found = tuple((i,) for i, each in enumerate(what) if each != CLUTTER)
    lines = [line(n + rng.normal(0, 0.05)) for n in places]
    measured = tuple(evidence(rng, each) for each in what)
    return Example("f", "d", category, measured, Neighbours.of(lines), np.array(what), found)


@pytest.fixture(scope="module")
def fit():
    rng = np.random.default_rng(0)
    return EvidenceFit([frame(rng) for _ in range(120)], [1.0] * 120)


@pytest.fixture(scope="module")
def model(fit):
    pytest.importorskip("scipy")
    return fit.model(fit.fit(), {})


def difference(model, kind, name, better, worse):
    term = model.terms[kind][name]
    return float(term(better) - term(worse))


def test_what_tells_paint_and_borders_apart_is_recovered(model):
    assert difference(model, "paint", "contrast", 0.8, 0.1) > 2
    assert difference(model, "edge", "far_rise", 0.15, 0.0) > 2
    assert model.terms["paint"]["height"](0.0) > model.terms["paint"]["height"](np.nan)


def test_what_tells_nothing_adds_little(model):
    assert abs(difference(model, "paint", "score", 14.0, 6.0)) < 1
    assert abs(difference(model, "paint", "slope", 0.01, 0.09)) < 1


def test_lines_a_lanes_width_apart_speak_for_one_another_and_nearer_ones_against(model):
    gap = model.pairs["paint_beside_paint"]
    assert gap(3.5) > gap(1.75) + 1


def test_every_curve_has_its_physical_sign(model):
    for kind in CLASSES:
        for name, sign in SIGNS[kind].items():
            steps = np.diff(model.terms[kind][name].log_odds)
            if sign.shape == "rises":
                assert steps.min() >= -1e-9, name
            if sign.shape == "falls":
                assert steps.max() <= 1e-9, name
    for name in ("paint_before_edge", "paint_behind_edge", "paint_across_edge"):
        assert model.pairs[name].log_odds.max() <= 1e-9


def test_the_model_tells_new_frames_right(model):
    rng = np.random.default_rng(1)
    right = []
    for _ in range(50):
        paint, clutter = evidence(rng, PAINT), evidence(rng, CLUTTER)
        right.append(model.log_odds("paint", [paint])[0] > model.log_odds("paint", [clutter])[0])
    assert np.mean(right) > 0.9


def test_a_fitted_model_goes_through_its_file(model):
    again = parsed_model(json.loads(model_text(model, {"date": "today"})))
    rng = np.random.default_rng(2)
    for what in (PAINT, EDGE, CLUTTER):
        measured = evidence(rng, what)
        for kind in CLASSES:
            assert again.log_odds(kind, [measured]) == pytest.approx(
                model.log_odds(kind, [measured]), abs=0.02
            )


def test_the_gradient_is_that_of_the_loss(fit):
    """By central differences, at a point away from the start."""
    rng = np.random.default_rng(3)
    size = sum(each.size for each in fit._classes) + sum(fit._knots)
    point = rng.normal(0, 0.3, size)
    gradient = fit._loss(point)[1]
    for i in rng.choice(size, 25, replace=False):
        step = np.zeros(size)
        step[i] = 1e-4
        slope = (fit._loss(point + step)[0] - fit._loss(point - step)[0]) / 2e-4
        assert gradient[i] == pytest.approx(slope, abs=1e-3 * max(1.0, abs(slope)))


def test_a_weight_counts_as_often_as_the_frame_stood_there():
    rng = np.random.default_rng(4)
    one, other = frame(rng), frame(rng)
    weighted, repeated = EvidenceFit([one, other], [2.0, 1.0]), EvidenceFit([one, one, other], [1.0] * 3)
    point = np.zeros(sum(each.size for each in weighted._classes) + sum(weighted._knots))
    assert weighted._loss(point)[0] == pytest.approx(repeated._loss(point)[0])


def test_how_often_rendered_scenes_show_lines_is_kept_apart():
    """The last coefficient of a class is theirs, and no part of the model."""
    rng = np.random.default_rng(5)
    fit = EvidenceFit([frame(rng), frame(rng, "kerbs")], [1.0, 1.0])
    size = sum(each.size for each in fit._classes) + sum(fit._knots)
    coefficients = np.zeros(size)
    coefficients[fit._classes[0].size - 1] = 5.0
    measured = evidence(rng, PAINT)
    without, with_it = (fit.model(each, {}) for each in (np.zeros(size), coefficients))
    assert with_it.log_odds("paint", [measured]) == without.log_odds("paint", [measured])
    assert fit._loss(coefficients)[0] != pytest.approx(fit._loss(np.zeros(size))[0])


def test_hats_are_shares_of_the_two_knots_beside_a_value():
    knots = (0.0, 1.0, 3.0)
    found = hats(np.array([-1.0, 0.25, 2.0, 3.0, 9.0]), knots)
    assert found.tolist() == [[1, 0, 0], [0.75, 0.25, 0], [0, 0.5, 0.5], [0, 0, 1], [0, 0, 1]]
    gaps = np.random.default_rng(0).uniform(0, 9, (4, 4))
    np.testing.assert_allclose(hats(gaps, GAPS) @ np.array(GAPS), gaps)


def test_without_any_candidate_there_is_nothing_to_learn_from():
    nothing = Example("f", "d", "", (), Neighbours.of([]), np.ones((0, 3), bool), ())
    with pytest.raises(CommandError, match="no candidates in any frame: nothing to learn from"):
        EvidenceFit([nothing], [1.0])


def test_the_model_has_all_terms(model):
    assert set(model.pairs) == set(PAIRS)
    assert {kind: set(terms) for kind, terms in model.terms.items()} == {k: set(v) for k, v in SIGNS.items()}
