# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Smooth lines through paths, on the centre of the paint."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.config import LaneModelConfig
from lane_dp_ros.core.dp.robust_fit import ransac_parabola, tukey_fit
from lane_dp_ros.core.types import BirdsEyeView, LaneLine, LanePath, PaintMap

Floats = NDArray[np.float64]

CUBIC_LENGTH = 16.0  # m; a shorter line is a parabola
TEN_METRES = 10.0  # the unit of s in the fits, to condition them
RIDGE = np.array([1e-6, 1e-6, 0.02, 0.05])  # m^2 of paint; holds curvature and its change small
TOLERANCE = 0.25  # m; paint farther from the line is not its own
ROUNDS = 6
MIN_ROWS = 4


def fit_line(
    path: LanePath, view: BirdsEyeView, graph: PaintMap, config: LaneModelConfig, rng: np.random.Generator
) -> LaneLine | None:
    """Return the line through a path, or None where no model fits it well enough.

    By `config.model`: a parabola by RANSAC, accepted with enough inliers (paper, section V-C), or a
    polynomial fitted robustly to the centres of the paint.
    """
    if len(path.rows) < MIN_ROWS:
        return None
    s = view.s[path.rows]
    n, weight = view.paint_centres(graph, path.rows, path.columns)
    if config.model == "parabola":
        along_path = np.interp(path.columns, np.arange(len(view.n)), view.n)
        fit = ransac_parabola(s, along_path, config.residual_threshold, config.max_trials, rng)
        if fit is None or fit.inliers.mean() < config.min_inliers:
            return None
        fit_n = fit(s) + np.median((n - along_path)[fit.inliers])
        return LaneLine(path.rows, s, fit_n, 2 * float(fit.coefficients[2]), path.score)
    return polynomial_line(path, s, n, weight)


def polynomial_line(path: LanePath, s: Floats, n: Floats, weight: Floats) -> LaneLine:
    """Return the robust polynomial through the centres n(s) with their weights."""
    fitted, bend = polynomial_fit(s, n, weight)
    return LaneLine(path.rows, s, fitted, bend, path.score)


def polynomial_fit(s: Floats, n: Floats, weight: Floats) -> tuple[Floats, float]:
    """Return the robust cubic (a parabola on short lines) at s, and its curvature [1/m] in the middle."""
    middle = s.mean()
    degree = 3 if np.ptp(s) > CUBIC_LENGTH else 2
    A = np.vander((s - middle) / TEN_METRES, degree + 1, increasing=True)
    b = tukey_fit(A, n, weight, np.diag(RIDGE[: degree + 1]), np.full(ROUNDS, TOLERANCE))
    return A @ b, 2 * float(b[2]) / TEN_METRES**2
