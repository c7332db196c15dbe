# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The choice among things in a row, against all choices that there are."""

from itertools import pairwise, product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lane_dp_ros.core.dp.ordered_choice import NEVER, NONE, at_least_one, best_choice, marginals

CLASSES = 2


@st.composite
def problems(draw, most=5):
    """Draw what up to five things are worth in two classes, and each two of them together."""
    count = draw(st.integers(1, most))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    worth = rng.normal(0, 2, (count, CLASSES))
    worth[rng.random(worth.shape) < 0.2] = NEVER
    return worth, rng.normal(0, 2, (count, count, CLASSES, CLASSES))


def worth_of(choice, worth, together):
    """Return what a choice, a class or NONE of each thing, is worth."""
    chosen = [(i, kind) for i, kind in enumerate(choice) if kind != NONE]
    of_things = sum(worth[i, kind] for i, kind in chosen)
    return of_things + sum(together[i, j, a, b] for (i, a), (j, b) in pairwise(chosen))


def all_choices(count):
    return list(product((NONE, *range(CLASSES)), repeat=count))


def holds(choice, sets):
    return all(any(choice[i] != NONE for i in things) for things in sets)


def expected(worth, together, sets=()):
    """Return the logarithm of the sum over all choices, and the probabilities, each by enumeration."""
    count = len(worth)
    allowed = [choice for choice in all_choices(count) if holds(choice, sets)]
    values = np.array([worth_of(choice, worth, together) for choice in allowed])
    log_total = np.logaddexp.reduce(values)
    of_things, of_pairs = np.zeros((count, CLASSES)), np.zeros((count, count, CLASSES, CLASSES))
    for choice, probability in zip(allowed, np.exp(values - log_total), strict=True):
        chosen = [(i, kind) for i, kind in enumerate(choice) if kind != NONE]
        for i, kind in chosen:
            of_things[i, kind] += probability
        for (i, a), (j, b) in pairwise(chosen):
            of_pairs[i, j, a, b] += probability
    return log_total, of_things, of_pairs


@settings(deadline=None, max_examples=60)
@given(problems())
def test_the_best_choice_is_the_best_of_all(problem):
    worth, together = problem
    best = max(worth_of(choice, worth, together) for choice in all_choices(len(worth)))
    assert worth_of(best_choice(worth, together), worth, together) == pytest.approx(best)


@settings(deadline=None, max_examples=60)
@given(problems())
def test_the_marginals_are_those_of_all_choices(problem):
    worth, together = problem
    found = marginals(worth[None], together[None])
    log_total, of_things, of_pairs = expected(worth, together)
    assert found.log_total[0] == pytest.approx(log_total)
    np.testing.assert_allclose(found.of_things[0], of_things, atol=1e-9)
    np.testing.assert_allclose(found.of_pairs[0], of_pairs, atol=1e-9)


@settings(deadline=None, max_examples=60)
@given(problems(), st.data())
def test_one_of_each_set_that_has_to_be_is_chosen(problem, data):
    """The sets are of things side by side, as those are that match one label."""
    worth, together = problem
    worth = np.maximum(worth, -10.0)
    spans = data.draw(st.lists(st.tuples(*[st.integers(0, len(worth) - 1)] * 2), max_size=2))
    sets = [tuple(range(min(span), max(span) + 1)) for span in spans]
    found = marginals(worth[None], together[None], at_least_one(sets, len(worth))[None])
    log_total, of_things, of_pairs = expected(worth, together, sets)
    assert found.log_total[0] == pytest.approx(log_total)
    np.testing.assert_allclose(found.of_things[0], of_things, atol=1e-9)
    np.testing.assert_allclose(found.of_pairs[0], of_pairs, atol=1e-9)


@settings(deadline=None, max_examples=20)
@given(st.lists(problems(), min_size=2, max_size=4))
def test_many_rows_at_once_are_what_each_is_by_itself(several):
    """What a row lacks is worth nothing that could be chosen."""
    count = max(len(worth) for worth, _ in several)
    worth = np.full((len(several), count, CLASSES), NEVER)
    together = np.zeros((len(several), count, count, CLASSES, CLASSES))
    for row, (own, own_together) in enumerate(several):
        worth[row, : len(own)], together[row, : len(own), : len(own)] = own, own_together
    found = marginals(worth, together)
    for row, (own, own_together) in enumerate(several):
        alone = marginals(own[None], own_together[None])
        assert found.log_total[row] == pytest.approx(alone.log_total[0])
        np.testing.assert_allclose(found.of_things[row, : len(own)], alone.of_things[0], atol=1e-9)
        assert not found.of_things[row, len(own) :].any()


def test_of_nothing_nothing_is_chosen():
    worth, together = np.empty((0, CLASSES)), np.empty((0, 0, CLASSES, CLASSES))
    assert best_choice(worth, together) == []
    found = marginals(worth[None], together[None])
    assert found.log_total.tolist() == [0.0]
    assert found.of_things.shape == (1, 0, CLASSES)


def test_what_is_worth_less_than_nothing_is_not_chosen():
    together = np.zeros((2, 2, CLASSES, CLASSES))
    assert best_choice(np.array([[-1.0, -2.0], [-3.0, -0.5]]), together) == [NONE, NONE]
    assert best_choice(np.array([[-1.0, 2.0], [-3.0, -0.5]]), together) == [1, NONE]


def test_a_neighbour_can_speak_for_a_thing_and_against_it():
    worth = np.array([[2.0, NEVER], [-1.0, NEVER]])
    together = np.zeros((2, 2, CLASSES, CLASSES))
    together[0, 1, 0, 0] = 1.5
    assert best_choice(worth, together) == [0, 0]
    together[0, 1, 0, 0] = 0.5
    assert best_choice(worth, together) == [0, NONE]


def test_one_thing_is_as_probable_as_its_log_odds_say():
    found = marginals(np.array([[[0.0, NEVER]]]), np.zeros((1, 1, 1, CLASSES, CLASSES)))
    assert found.of_things[0, 0].tolist() == pytest.approx([0.5, 0.0])
    assert found.log_total[0] == pytest.approx(np.log(2))


def test_however_much_things_are_worth_nothing_overflows():
    """Ten sure things of 500 each, more than the exponential of a double can be, and a hopeless one."""
    worth = np.full((11, CLASSES), -900.0)
    worth[:10, 0] = 500.0
    found = marginals(worth[None], np.zeros((1, 11, 11, CLASSES, CLASSES)))
    assert found.log_total[0] == pytest.approx(5000.0)
    np.testing.assert_allclose(found.of_things[0, :, 0], [1.0] * 10 + [0.0], atol=1e-9)
    np.testing.assert_allclose(found.of_things[0, :, 1], 0.0, atol=1e-9)
    assert np.isfinite(found.of_pairs).all()


def test_of_nothing_to_choose_from_there_is_one_choice():
    found = marginals(np.empty((1, 0, CLASSES)), np.empty((1, 0, 0, CLASSES, CLASSES)))
    assert found.log_total.tolist() == [0.0]
    assert found.of_things.shape == (1, 0, CLASSES)
