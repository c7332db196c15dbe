# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The lateral error in metres without going through the image: what an error of the road's surface adds."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.types import Lane
from lane_dp_ros.tools.evaluation.annotations import JUDGED_DEPTHS, SAMPLE_STEP, Label, by_depth

Floats = NDArray[np.float64]

NEAR, FAR = (6.0, 12.0), (12.0, 25.0)  # m of depth; 12 m itself is near
AT = (10.0, 25.0)  # m of depth at which the error is told, too


@dataclass(frozen=True, eq=False)
class LateralErrors:
    """Lateral distances `errors` (N,) [m], always >= 0, at `depths` (N,) [m]."""

    depths: Floats
    errors: Floats

    @property
    def near(self) -> float | None:
        """Their mean [m] from 6 to 12 m of depth, None where there is none."""
        return self.between(*NEAR)

    @property
    def far(self) -> float | None:
        """Their mean [m] beyond 12 m of depth, None where there is none."""
        return self.between(float(np.nextafter(FAR[0], np.inf)), FAR[1])

    def at(self, depth: float) -> float | None:
        """Return the error [m] at a depth [m], None where there is none."""
        return self.between(depth - 1e-6, depth + 1e-6)

    def between(self, low: float, high: float) -> float | None:
        """Return their mean [m] over a range of depths [m], None where there is none."""
        inside = (self.depths >= low) & (self.depths <= high)
        return float(np.mean(self.errors[inside])) if inside.any() else None


NOT_COMPARED = LateralErrors(np.empty(0), np.empty(0))


def lateral_errors(label: Label, lane: Lane, camera: StereoCamera) -> LateralErrors:
    """Compare the 3-D points of a lane with a label at equal depth, every 0.5 m over the judged depths.

    `lane` is in the left optical frame of `camera`. Only depths that both reach are compared.
    """
    line = by_depth((np.asarray(lane.points, dtype=np.float64) + camera.left_translation)[:, [0, 2]])
    truth = label.in_space
    low, high = JUDGED_DEPTHS
    z = np.arange(low, high + 1e-9, SAMPLE_STEP)
    ends = max(truth[0, 1], line[0, 1]), min(truth[-1, 1], line[-1, 1])
    z = z[(z >= ends[0] - 1e-6) & (z <= ends[1] + 1e-6)]
    x, true_x = (np.interp(z, points[:, 1], points[:, 0]) for points in (line, truth))
    return LateralErrors(z, np.abs(x - true_x))


@dataclass(frozen=True)
class Mean:
    """A mean of any number of values; means add up."""

    sum: float = 0.0
    count: int = 0

    def __add__(self, other: Mean) -> Mean:
        return Mean(self.sum + other.sum, self.count + other.count)

    @property
    def value(self) -> float:
        """The mean, NaN of nothing."""
        return self.sum / self.count if self.count else float("nan")


@dataclass(frozen=True)
class LateralSummary:
    """Mean lateral errors [m] of any number of lines: 6 to 12 m, 12 to 25 m, at 10 m and at 25 m of depth."""

    near: Mean = field(default_factory=Mean)
    far: Mean = field(default_factory=Mean)
    at_10: Mean = field(default_factory=Mean)
    at_25: Mean = field(default_factory=Mean)

    @classmethod
    def of(cls, errors: LateralErrors) -> LateralSummary:
        """Return the summary of one line."""
        values = errors.near, errors.far, *map(errors.at, AT)
        return cls(*(Mean() if value is None else Mean(value, 1) for value in values))

    def __add__(self, other: LateralSummary) -> LateralSummary:
        return LateralSummary(
            self.near + other.near, self.far + other.far, self.at_10 + other.at_10, self.at_25 + other.at_25
        )
