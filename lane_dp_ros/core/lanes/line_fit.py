# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Smooth lines through paths, on the centre of the paint."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.birdseye.paint_profile import PaintProfile
from lane_dp_ros.core.dp.robust_fit import ransac_parabola, tukey_fit
from lane_dp_ros.core.lanes.candidate import LaneLine, LanePath
from lane_dp_ros.core.parameter import Parameters, parameter

Floats = NDArray[Any]

CUBIC_LENGTH = 16.0  # m; a shorter line is a parabola
TEN_METRES = 10.0  # the unit of s in the fits, to condition them
RIDGE = np.array([1e-6, 1e-6, 0.02, 0.05])  # m^2 of paint; holds curvature and its change small
TOLERANCE = 0.25  # m; paint farther from the line is not its own
ROUNDS = 6
MIN_ROWS = 4


@dataclass(frozen=True)
class LaneModelConfig(Parameters):
    """The smooth line through a path."""

    model: str = parameter(
        "cubic",
        "cubic: robust cubic through the centres of the paint; parabola: the paper's parabola by RANSAC.",
        choices=("cubic", "parabola"),
    )
    residual_threshold: float = parameter(
        0.1, "Points of the path nearer to the parabola are inliers.", unit="m", limits=(0.01, 1.0)
    )
    min_inliers: float = parameter(0.6, "Share of inliers that makes a parabola a lane.", limits=(0.0, 1.0))
    max_trials: int = parameter(100, "RANSAC samples.", limits=(10, 1000))


class LineFit(Protocol):
    """Fits a smooth line to a path."""

    def fit(self, path: LanePath, paint: PaintProfile, rng: np.random.Generator) -> LaneLine | None:
        """Return the line through a path, or None where the model does not fit it well enough."""


class ParabolaFit:
    """The paper's parabola by RANSAC, accepted with enough inliers (section V-C), on the paint's centre."""

    def __init__(self, config: LaneModelConfig) -> None:
        self._config = config

    def fit(self, path: LanePath, paint: PaintProfile, rng: np.random.Generator) -> LaneLine | None:
        """See `LineFit`."""
        if len(path.rows) < MIN_ROWS:
            return None
        config, view = self._config, paint.view
        s = view.s[path.rows]
        n, _ = paint.centres(path.rows, path.columns)
        along_path = np.interp(path.columns, np.arange(len(view.n)), view.n)
        fit = ransac_parabola(s, along_path, config.residual_threshold, config.max_trials, rng)
        if fit is None or fit.inliers.mean() < config.min_inliers:
            return None
        fit_n = fit(s) + np.median((n - along_path)[fit.inliers])
        return LaneLine(path.rows, s, fit_n, 2 * float(fit.coefficients[2]), path.score)


class CubicFit:
    """A cubic, or on short lines a parabola, robustly through the centres of the paint."""

    def fit(self, path: LanePath, paint: PaintProfile, rng: np.random.Generator) -> LaneLine | None:  # noqa: ARG002
        """See `LineFit`."""
        if len(path.rows) < MIN_ROWS:
            return None
        s = paint.view.s[path.rows]
        fitted, bend = polynomial_fit(s, *paint.centres(path.rows, path.columns))
        return LaneLine(path.rows, s, fitted, bend, path.score)


def line_fit(config: LaneModelConfig) -> LineFit:
    """Return the fit that `config.model` names."""
    return ParabolaFit(config) if config.model == "parabola" else CubicFit()


def polynomial_fit(s: Floats, n: Floats, weight: Floats) -> tuple[Floats, float]:
    """Return the robust cubic (a parabola on short lines) at s, and its curvature [1/m] in the middle."""
    middle = s.mean()
    degree = 3 if np.ptp(s) > CUBIC_LENGTH else 2
    A = np.vander((s - middle) / TEN_METRES, degree + 1, increasing=True)
    b = tukey_fit(A, n, weight, np.diag(RIDGE[: degree + 1]), np.full(ROUNDS, TOLERANCE))
    return A @ b, 2 * float(b[2]) / TEN_METRES**2
