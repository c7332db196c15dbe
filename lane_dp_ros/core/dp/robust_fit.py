# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Robust polynomials y(x): RANSAC on a parabola, and iterated Tukey weights."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[Any]

STILL = 1e-5  # change of every coefficient, from round to round, of a fit that stands still
MIN_DETERMINANT = 1e-5  # of three rows (1, t, t^2), t in [-1, 1]: closer points fix no parabola


@dataclass(frozen=True, eq=False)
class RansacParabola:
    """y = beta_0 + beta_1 x + beta_2 x^2, fitted to the points that are `inliers` (N,) bool."""

    coefficients: Floats
    inliers: NDArray[np.bool_]

    def __call__(self, x: Floats) -> Floats:
        """Return y at x."""
        return np.asarray(np.polynomial.polynomial.polyval(x, self.coefficients))


def ransac_parabola(
    x: Floats, y: Floats, residual_threshold: float, max_trials: int, rng: np.random.Generator
) -> RansacParabola | None:
    """Return the parabola with the most points (x, y) (N,) within `residual_threshold`, None without one.

    All samples of three points are drawn and solved at once; the parabola with the most inliers is fitted
    again to them by least squares (Fischler & Bolles 1981; paper, section V-C, eq. 11).
    """
    if len(x) < 3:
        return None
    centre, scale = x.mean(), max(float(np.ptp(x)) / 2, 1e-9)
    A = np.vander((x - centre) / scale, 3, increasing=True)
    chosen = rng.integers(len(x), size=(max_trials, 3))
    samples = A[chosen]
    solvable = np.abs(np.linalg.det(samples)) > MIN_DETERMINANT
    if not solvable.any():
        return None
    parabolas = np.linalg.solve(samples[solvable], y[chosen[solvable], None])[..., 0]
    agree = np.abs(A @ parabolas.T - y[:, None]) < residual_threshold
    inliers = agree[:, agree.sum(axis=0).argmax()]
    b0, b1, b2 = np.linalg.lstsq(A[inliers], y[inliers], rcond=None)[0]
    b1, b2 = b1 / scale, b2 / scale**2
    return RansacParabola(np.array([b0 - b1 * centre + b2 * centre**2, b1 - 2 * b2 * centre, b2]), inliers)


def tukey_fit(
    A: Floats, y: Floats, weights: Floats, ridge: Floats, tolerances: Floats, start: Floats | None = None
) -> Floats:
    """Return b of A b = y by weighted least squares with Tukey's biweight, re-weighted once a tolerance.

    `A` (N, p), `y` and `weights` (N,); `ridge` (p, p) is added to the normal equations; residuals beyond a
    tolerance count nothing. Without `start` the first round takes all points. It ends before the tolerances
    do where the fit stands still and the tolerance does, too.
    """
    b: Floats | None = start
    before = np.inf
    A_T = np.ascontiguousarray(A.T)
    for tolerance in tolerances:
        if b is None:
            w = weights
        else:
            w = (y - A @ b) / tolerance
            w = weights * np.maximum(0, 1 - w * w) ** 2
        weighted = A_T * w
        fitted = _solved(weighted @ A + ridge, weighted @ y)
        still = b is not None and tolerance == before and bool(np.abs(fitted - b).max() < STILL)
        b, before = fitted, tolerance
        if still:
            break
    return np.asarray(b)


def _solved(M: Floats, b: Floats) -> Floats:
    """Return x of M x = b, for M symmetric and positive definite; OpenCV takes a fifth of NumPy's time."""
    _, x = cv2.solve(M, b[:, None], flags=cv2.DECOMP_CHOLESKY)
    return np.asarray(x).ravel()
