# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Robust fits of linear models: RANSAC, and iterated Tukey weights."""

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
class RansacFit:
    """y = A b: the `coefficients` b (p,), fitted to the points that are `inliers` (N,) bool."""

    coefficients: Floats
    inliers: NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class RansacParabola(RansacFit):
    """y = beta_0 + beta_1 x + beta_2 x^2."""

    def __call__(self, x: Floats) -> Floats:
        """Return y at x."""
        return np.asarray(np.polynomial.polynomial.polyval(x, self.coefficients))


def ransac(
    A: Floats, y: Floats, residual_threshold: float, max_trials: int, rng: np.random.Generator
) -> RansacFit | None:
    """Return b of the model A b = y with the most points within `residual_threshold`, None without one.

    `A` (N, p) holds columns of like size, `y` (N,). All samples of p points are drawn and solved at once; the
    model with the most inliers is fitted again to them by least squares (Fischler & Bolles 1981).
    """
    count, size = A.shape
    if count < size:
        return None
    chosen = rng.integers(count, size=(max_trials, size))
    samples = A[chosen]
    solvable = np.abs(np.linalg.det(samples)) > MIN_DETERMINANT
    if not solvable.any():
        return None
    models = np.linalg.solve(samples[solvable], y[chosen[solvable], None])[..., 0]
    agree = np.abs(A @ models.T - y[:, None]) < residual_threshold
    inliers = agree[:, agree.sum(axis=0).argmax()]
    return RansacFit(np.linalg.lstsq(A[inliers], y[inliers], rcond=None)[0], inliers)


def ransac_parabola(
    x: Floats, y: Floats, residual_threshold: float, max_trials: int, rng: np.random.Generator
) -> RansacParabola | None:
    """Return the parabola with the most points (x, y) (N,) within `residual_threshold`, None without one.

    See `ransac` (paper, section V-C, eq. 11).
    """
    if len(x) < 3:
        return None
    centre, scale = x.mean(), max(float(np.ptp(x)) / 2, 1e-9)
    found = ransac(
        np.vander((x - centre) / scale, 3, increasing=True), y, residual_threshold, max_trials, rng
    )
    if found is None:
        return None
    b0, b1, b2 = found.coefficients
    b1, b2 = b1 / scale, b2 / scale**2
    coefficients = np.array([b0 - b1 * centre + b2 * centre**2, b1 - 2 * b2 * centre, b2])
    return RansacParabola(coefficients, found.inliers)


def tukey_weights(residuals: Floats, tolerance: float) -> Floats:
    """Return Tukey's biweight of residuals (..., N): 1 at zero, 0 beyond the tolerance."""
    w = residuals * residuals.dtype.type(1 / tolerance)
    w *= w
    np.subtract(1, w, out=w)
    np.maximum(w, 0, out=w)
    w *= w
    return np.asarray(w)


def tukey_fit(
    A: Floats, y: Floats, weights: Floats, ridge: Floats, tolerances: Floats, start: Floats | None = None
) -> Floats:
    """Return b (..., p) of A b = y by weighted least squares with Tukey's biweight, one round a tolerance.

    `A` (..., N, p), `y` and `weights` (..., N): each fit of a stack is by itself. `ridge` (p, p) is added to
    the normal equations; residuals beyond a tolerance count nothing. Without `start` the first round takes
    all points. A fit ends before the tolerances do where it stands still and the tolerance does, too.
    """
    b: Floats | None = start
    before = np.inf
    A_T = np.ascontiguousarray(np.swapaxes(A, -1, -2))
    going = np.ones((*A.shape[:-2], 1), bool)
    for tolerance in tolerances:
        w = weights if b is None else weights * tukey_weights(y - (A @ b[..., None])[..., 0], tolerance)
        weighted = A_T * w[..., None, :]
        fitted = np.linalg.solve(weighted @ A + ridge, weighted @ y[..., None])[..., 0]
        if b is not None:
            moves = np.abs(fitted - b).max(axis=-1, keepdims=True) >= STILL
            fitted = np.where(going, fitted, b)
            going &= moves | (tolerance != before)
        b, before = fitted, tolerance
        if not going.any():
            break
    return np.asarray(b)


def solved(M: Floats, b: Floats) -> Floats:
    """Return x of M x = b, for M symmetric and positive definite; OpenCV takes a fifth of NumPy's time."""
    _, x = cv2.solve(M, b[:, None], flags=cv2.DECOMP_CHOLESKY)
    return np.asarray(x).ravel()
