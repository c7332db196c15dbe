# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""How deep the measured surface of the road is against the truth's, straight ahead of the camera."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.geometry.road_surface import RoadSurface
from lane_dp_ros.tools.evaluation.annotations import LabelledFrame

Floats = NDArray[np.float64]

DEPTHS = (8.0, 12.0, 18.0, 25.0)  # m, of the tables
CURVE_DEPTHS: Floats = np.arange(6.0, 31.0, dtype=np.float64)  # m, of the curve over distance
NO_ROAD = 1.0  # error where there is road, but none was measured: twice as deep
SPREAD = 90.0  # percentile of the magnitude of errors
BAND = (5.0, 95.0)  # percentiles between which nine of ten errors lie


@dataclass(frozen=True)
class DepthErrors:
    """How much too deep the surface of a frame was measured, z_measured / z - 1, at each of CURVE_DEPTHS.

    NaN where the truth knows of no road in the image; `NO_ROAD` at and above the horizon of the measured
    surface. `measured` is False for a frame in which no surface was found.
    """

    errors: tuple[float, ...]
    measured: bool = True

    def at(self, depth: float) -> float:
        """Return the error at a depth [m], one of CURVE_DEPTHS."""
        return self.errors[CURVE_DEPTHS.tolist().index(depth)]


NO_SURFACE = DepthErrors((float("nan"),) * len(CURVE_DEPTHS), measured=False)


def depth_errors(
    frame: LabelledFrame, surface: RoadSurface | None, reach: float = float("inf")
) -> DepthErrors:
    """Compare a measured surface (None: nothing was found) with the truth, on pixels straight ahead.

    The pixel at u = cx is taken in which the truth has the road at depth z; its depth is read there from the
    surface. Beyond `reach` [m] the truth is not known.
    """
    if surface is None:
        return NO_SURFACE
    rows = frame.rows_ahead(CURVE_DEPTHS)
    known = np.isfinite(rows) & (reach >= CURVE_DEPTHS)
    errors = np.full(len(rows), np.nan)
    _, measured = surface.pixel_to_ground(np.full(np.count_nonzero(known), frame.camera.cx), rows[known])
    errors[known] = np.where(np.isfinite(measured), measured / CURVE_DEPTHS[known] - 1, NO_ROAD)
    return DepthErrors(tuple(errors.tolist()))


@dataclass(frozen=True, eq=False)
class DepthCurve:
    """Errors over distance at `depths` (N,) [m]: the median, the band of nine in ten frames, their number."""

    depths: Floats
    bias: Floats
    low: Floats
    high: Floats
    counts: NDArray[np.int64]


@dataclass(frozen=True)
class DepthSummary:
    """The errors of any number of frames, a row to each with a surface; summaries add up.

    `no_surface` counts the frames in which none was found. Frames of which it is not known what was measured
    are in neither. Numbers are NaN where there is nothing to count.
    """

    rows: tuple[DepthErrors, ...] = ()
    no_surface: int = 0

    @classmethod
    def of(cls, errors: DepthErrors | None) -> DepthSummary:
        """Return the summary of one frame, None: not known."""
        if errors is None:
            return cls()
        return cls((errors,)) if errors.measured else cls(no_surface=1)

    def __add__(self, other: DepthSummary) -> DepthSummary:
        return DepthSummary(self.rows + other.rows, self.no_surface + other.no_surface)

    @property
    def frames(self) -> int:
        """Number of frames in which a surface was looked for."""
        return len(self.rows) + self.no_surface

    def bias(self, depth: float) -> float:
        """Return the median error at a depth [m], one of CURVE_DEPTHS."""
        return _percentile(self._at(depth), 50)

    def spread(self, depth: float) -> float:
        """Return the 90th percentile of the errors' magnitude at a depth [m], one of CURVE_DEPTHS."""
        return _percentile([abs(error) for error in self._at(depth)], SPREAD)

    def count(self, depth: float) -> int:
        """Return of how many frames the error is known at a depth [m], one of CURVE_DEPTHS."""
        return len(self._at(depth))

    def curve(self) -> DepthCurve:
        """Return the errors over distance."""
        columns = [self._at(depth) for depth in CURVE_DEPTHS.tolist()]
        low, bias, high = (
            np.array([_percentile(column, q) for column in columns]) for q in (BAND[0], 50, BAND[1])
        )
        return DepthCurve(CURVE_DEPTHS, bias, low, high, np.array([len(column) for column in columns]))

    def _at(self, depth: float) -> list[float]:
        return [error for row in self.rows if np.isfinite(error := row.at(depth))]


def _percentile(values: Sequence[float], q: float) -> float:
    return float(np.percentile(values, q)) if len(values) else float("nan")
