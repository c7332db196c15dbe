# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Smooth lines through paths, on the centre of the paint."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.birdseye.paint_profile import PaintProfile
from lane_dp_ros.core.dp.robust_fit import ransac_parabola, tukey_fit
from lane_dp_ros.core.lanes.candidate import LaneLine, LanePath
from lane_dp_ros.core.lanes.segments import Segments
from lane_dp_ros.core.parameter import Parameters, parameter

Floats = NDArray[Any]
Centres = Callable[[NDArray[np.intp], Floats], tuple[Floats, Floats]]

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
    """Fits smooth lines to paths."""

    def fit(self, paths: Sequence[LanePath], paint: PaintProfile, rng: np.random.Generator) -> list[LaneLine]:
        """Return the lines through paths, in their order, without those that the model does not fit."""


class ParabolaFit:
    """The paper's parabola by RANSAC, accepted with enough inliers (section V-C), on the paint's centre."""

    def __init__(self, config: LaneModelConfig) -> None:
        self._config = config

    def fit(self, paths: Sequence[LanePath], paint: PaintProfile, rng: np.random.Generator) -> list[LaneLine]:
        """See `LineFit`."""
        lines = (self._line(path, paint, rng) for path in paths if len(path.rows) >= MIN_ROWS)
        return [line for line in lines if line is not None]

    def _line(self, path: LanePath, paint: PaintProfile, rng: np.random.Generator) -> LaneLine | None:
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

    def fit(self, paths: Sequence[LanePath], paint: PaintProfile, rng: np.random.Generator) -> list[LaneLine]:  # noqa: ARG002
        """See `LineFit`."""
        return cubic_lines(paths, paint.view.s, paint.centres)


def line_fit(config: LaneModelConfig) -> LineFit:
    """Return the fit that `config.model` names."""
    return ParabolaFit(config) if config.model == "parabola" else CubicFit()


def cubic_lines(paths: Sequence[LanePath], s_of_rows: Floats, centres: Centres) -> list[LaneLine]:
    """Return the robust cubics through paths of enough rows, in their order.

    `s_of_rows` (rows,) [m] are those of the grid of the paths; `centres` gives n (N,) [m] of what is near
    cells (rows (N,), columns (N,)) of it, and its weights (N,).
    """
    paths = [path for path in paths if len(path.rows) >= MIN_ROWS]
    if not paths:
        return []
    lines = Segments([len(path.rows) for path in paths])
    rows, columns = (np.concatenate([getattr(path, name) for path in paths]) for name in ("rows", "columns"))
    s = s_of_rows[rows]
    fitted, bends = polynomial_fits(s, *centres(rows, columns), lines)
    return [
        LaneLine(path.rows, s[lines.part(i)], fitted[lines.part(i)], float(bends[i]), path.score)
        for i, path in enumerate(paths)
    ]


def polynomial_fit(s: Floats, n: Floats, weight: Floats) -> tuple[Floats, float]:
    """Return the robust cubic of one line, and its bend, see `polynomial_fits`."""
    fitted, bends = polynomial_fits(s, n, weight, Segments([len(s)]))
    return fitted, float(bends[0])


def polynomial_fits(s: Floats, n: Floats, weight: Floats, lines: Segments) -> tuple[Floats, Floats]:
    """Return the robust cubics (parabolas on short lines) at s (N,), and how they bend in the middle.

    `s`, `n` [m] and `weight` (N,) are of all lines, one after the other; bends (lines,) are curvatures [1/m].
    """
    own = (
        np.arange(lines.lengths.max()) < lines.lengths[:, None]
    )  # shorter lines are filled up with no weight
    t, y, w = np.zeros((3, *own.shape))
    t[own] = (s - lines.spread(lines.sum(s) / lines.lengths)) / TEN_METRES
    y[own], w[own] = n, weight
    A = np.vander(t.ravel(), 4, increasing=True).reshape(*t.shape, 4)
    A[np.ptp(t, axis=1) * TEN_METRES <= CUBIC_LENGTH, :, 3] = 0
    b = tukey_fit(A, y, w, np.diag(RIDGE), np.full(ROUNDS, TOLERANCE))
    return (A @ b[..., None])[own, 0], 2 * b[:, 2] / TEN_METRES**2
