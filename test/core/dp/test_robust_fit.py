# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Robust linear models: RANSAC among outliers, Tukey's weights."""

import numpy as np
import pytest

from lane_dp_ros.core.dp.robust_fit import ransac, ransac_parabola, solved, tukey_fit, tukey_weights

TRUTH = np.array([1.5, -0.02, 0.003])  # y = 1.5 m - 0.02 x + 0.003 x^2
X = np.linspace(5, 35, 100)
Y = np.polynomial.polynomial.polyval(X, TRUTH)


def outliers(share):
    """Return Y with noise of 1 cm and, every so often, a value that is 1 to 4 m off."""
    rng = np.random.default_rng(3)
    wrong = rng.permutation(len(X)) < share * len(X)
    y = Y + rng.normal(0, 0.01, len(X))
    return np.where(wrong, Y + rng.uniform(1, 4, len(X)) * rng.choice([-1, 1], len(X)), y), wrong


def fit(x, y, seed=0, max_trials=100):
    return ransac_parabola(x, y, 0.1, max_trials, np.random.default_rng(seed))


@pytest.mark.parametrize("share", [0.0, 0.2, 0.4])
def test_outliers_do_not_bend_the_parabola(share):
    y, wrong = outliers(share)
    found = fit(X, y)
    np.testing.assert_array_equal(found.inliers, ~wrong)
    np.testing.assert_allclose(found(X), Y, atol=0.02)
    assert np.all(np.abs(found.coefficients - TRUTH) < [0.1, 0.01, 3e-4])


def test_exact_points_give_the_exact_parabola():
    found = fit(X[:3], Y[:3])
    np.testing.assert_allclose(found.coefficients, TRUTH, atol=1e-9)
    assert found.inliers.all()


def test_the_same_seed_gives_the_same_parabola():
    y, _ = outliers(0.4)
    first, again = fit(X, y, seed=5), fit(X, y, seed=5)
    np.testing.assert_array_equal(first.coefficients, again.coefficients)
    np.testing.assert_array_equal(first.inliers, again.inliers)
    few, other = fit(X, y, seed=5, max_trials=10), fit(X, y, seed=6, max_trials=10)
    assert not np.array_equal(few.coefficients, other.coefficients)


@pytest.mark.parametrize("count", [0, 1, 2])
def test_fewer_than_three_points_fix_no_parabola(count):
    assert fit(X[:count], Y[:count]) is None


def test_points_above_one_another_fix_no_parabola():
    assert fit(np.full(10, 7.0), np.arange(10.0)) is None


def test_any_linear_model_is_found_among_outliers():
    """y = 3 / x - 1 + 0.5 x, as a road's row is of its disparity; a third of the points are off by 1 to 4."""
    rng = np.random.default_rng(1)
    x = np.linspace(0.5, 4, 90)
    A, wrong = np.stack([1 / x, np.ones_like(x), x], axis=1), np.arange(90) % 3 == 0
    y = A @ [3.0, -1.0, 0.5] + np.where(wrong, rng.uniform(1, 4, 90), rng.normal(0, 0.01, 90))
    found = ransac(A, y, 0.05, 100, np.random.default_rng(0))
    np.testing.assert_array_equal(found.inliers, ~wrong)
    np.testing.assert_allclose(found.coefficients, [3.0, -1.0, 0.5], atol=0.03)


def test_as_many_points_as_coefficients_are_needed():
    A, rng = np.array([[1.0, 0.0], [1.0, 1.0]]), np.random.default_rng(0)
    assert ransac(A[:1], np.array([2.0]), 0.1, 20, rng) is None
    found = ransac(A, np.array([2.0, 5.0]), 0.1, 20, rng)
    np.testing.assert_allclose(found.coefficients, [2.0, 3.0])


def test_columns_that_depend_on_one_another_fix_no_model():
    A = np.outer(np.arange(1.0, 11), [1.0, 2.0])
    assert ransac(A, np.ones(10), 0.1, 50, np.random.default_rng(0)) is None


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_tukeys_weights_by_hand(dtype):
    """(1 - (r / 2)^2)^2."""
    residuals = np.array([0.0, 1.0, -1.0, 2.0, -5.0], dtype)
    weights = tukey_weights(residuals, 2.0)
    assert weights.dtype == dtype
    assert weights.tolist() == [1.0, 0.5625, 0.5625, 0.0, 0.0]
    assert residuals.tolist() == [0.0, 1.0, -1.0, 2.0, -5.0]


def test_normal_equations_are_solved():
    np.testing.assert_allclose(solved(np.array([[4.0, 1.0], [1.0, 3.0]]), np.array([9.0, 5.0])), [2.0, 1.0])


def tukey(A, y, weights=None, **options):
    weights = np.ones(len(y)) if weights is None else weights
    ridge = options.pop("ridge", np.zeros((A.shape[1],) * 2))
    return tukey_fit(A, y, weights, ridge, options.pop("tolerances", np.full(6, 0.25)), **options)


LINE = np.vander(np.linspace(-1, 1, 20), 2, increasing=True)


def test_residuals_beyond_the_tolerance_count_nothing():
    y = LINE @ [2.0, 0.5]
    y[[3, 16]] += [0.6, -0.6]
    np.testing.assert_allclose(tukey(LINE, y), [2.0, 0.5], atol=1e-6)
    assert abs(tukey(LINE, y, tolerances=[1.0])[1] - 0.5) > 0.02  # one round: plain least squares


def test_weights_say_what_counts():
    y = np.r_[np.zeros(10), np.ones(10)]
    weights = np.r_[np.zeros(10), np.ones(10)]
    np.testing.assert_allclose(tukey(LINE, y, weights), [1.0, 0.0], atol=1e-9)


def test_a_start_chooses_among_two_lines():
    y = np.where(np.arange(20) % 2, 1.0, 0.0)
    for level in (0.0, 1.0):
        found = tukey(LINE, y, start=np.array([level, 0.0]))
        np.testing.assert_allclose(found, [level, 0.0], atol=1e-9)


def test_the_ridge_holds_a_coefficient_small():
    y = LINE @ [2.0, 0.5]
    assert tukey(LINE, y, ridge=np.diag([0.0, 1e6]))[1] == pytest.approx(0, abs=1e-3)


def test_each_fit_of_a_stack_is_by_itself():
    """One stands still at once, one has to get rid of outliers."""
    y = np.stack([LINE @ [2.0, 0.5], LINE @ [-1.0, 0.2]])
    y[1, [3, 16]] += [0.4, -0.6]
    alone = [tukey(LINE, each) for each in y]
    found = tukey(np.stack([LINE, LINE]), y, np.ones(y.shape), ridge=np.zeros((2, 2)))
    np.testing.assert_allclose(found, alone, atol=1e-12)
