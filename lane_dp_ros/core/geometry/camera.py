# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The rectified stereo camera."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]

ROW_TOLERANCE = 1.0  # px; more between the rows of left and right, and nothing matches
FOCAL_TOLERANCE = 0.01  # of the focal length
SKEW_MAX = 0.5  # px; calibrations that are written with rounded numbers stay far within
ROUNDING = 1e-6  # of the third row
BASELINES = (0.01, 4.0)  # m; a camera module for the palm of a hand, the mirrors of a lorry
UNITS = {"mm": 1e-3, "cm": 1e-2, "km": 1e3}  # m


@dataclass(frozen=True)
class StereoCamera:
    """A rectified stereo pair of pinhole cameras.

    `fx, fy, cx, cy` [px] are the left camera's; `baseline` [m] is positive with the right camera on the
    right. `disparity_offset` [px] is cx_left - cx_right (zero in most calibrations): a point at depth z
    has u_left - u_right = fx * baseline / z + disparity_offset. `left_translation` [m] is K^-1 P_left[:, 3]:
    where the frame of the projection matrices lies, seen from the left camera (KITTI's colour cameras
    stand 6 cm beside it).

    Raises ValueError when a value cannot be that of a rectified stereo camera.
    """

    fx: float
    fy: float
    cx: float
    cy: float
    baseline: float
    disparity_offset: float = 0.0
    left_translation: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        for name in ("fx", "fy"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0):
                raise ValueError(
                    f"{name} is {value}, expected a focal length > 0 px (camera not calibrated?)"
                )
        if not np.all(np.isfinite([self.cx, self.cy, self.disparity_offset, *self.left_translation])):
            raise ValueError("a projection matrix holds values that are not finite numbers")
        _check_baseline(self.baseline, self.fx)

    @classmethod
    def from_projections(cls, P_left: ArrayLike, P_right: ArrayLike) -> StereoCamera:
        """Build the camera from two 3x4 projection matrices (12 values each, row by row).

        baseline = (P_left[0,3] - P_right[0,3]) / fx; both P[0,3] may be non-zero.
        Raises ValueError for matrices of another size or values that make no stereo camera.
        """
        left, right = (_projection(P, side) for P, side in ((P_left, "left"), (P_right, "right")))
        _check_rectified(left, right)
        fx = float(left[0, 0])
        t_x, t_y, t_z = np.linalg.solve(left[:, :3], left[:, 3])
        return cls(
            fx=fx,
            fy=float(left[1, 1]),
            cx=float(left[0, 2]),
            cy=float(left[1, 2]),
            baseline=float(left[0, 3] - right[0, 3]) / fx,
            disparity_offset=float(left[0, 2] - right[0, 2]),
            left_translation=(float(t_x), float(t_y), float(t_z)),
        )

    @property
    def P_left(self) -> Floats:
        """The left projection matrix, 3x4."""
        K = np.array([[self.fx, 0, self.cx], [0, self.fy, self.cy], [0, 0, 1.0]])
        return np.hstack([K, K @ np.reshape(self.left_translation, (3, 1))])

    def project(self, points: ArrayLike) -> Floats:
        """Return the pixels (N, 2) of points (N, 3) [m] in the left optical frame (that of P_left)."""
        xyz = np.asarray(points, dtype=np.float64).reshape(-1, 3) + self.left_translation
        return np.column_stack(
            [self.cx + self.fx * xyz[:, 0] / xyz[:, 2], self.cy + self.fy * xyz[:, 1] / xyz[:, 2]]
        )

    def back_project(self, pixels: ArrayLike, depth: ArrayLike) -> Floats:
        """Return the points (N, 3) [m], in the left optical frame, of pixels (N, 2) at `depth` (N,) [m].

        `depth` is measured from the left camera, as fx * baseline / disparity gives it.
        """
        uv = np.asarray(pixels, dtype=np.float64).reshape(-1, 2)
        z = np.asarray(depth, dtype=np.float64)
        xyz = np.column_stack([(uv[:, 0] - self.cx) * z / self.fx, (uv[:, 1] - self.cy) * z / self.fy, z])
        points: Floats = xyz - np.asarray(self.left_translation)
        return points


def _projection(P: ArrayLike, side: str) -> Floats:
    matrix = np.asarray(P, dtype=np.float64)
    if matrix.size != 12:
        raise ValueError(f"P of the {side} camera has {matrix.size} values, expected 12 (3x4)")
    return matrix.reshape(3, 4)


def _check_baseline(baseline: float, fx: float) -> None:
    """Raise ValueError, with what may have been meant, for a baseline [m] that no vehicle's camera has."""
    lowest, highest = BASELINES
    if not np.isfinite(baseline) or baseline < 0:
        raise ValueError(f"the baseline is {baseline:.4g} m, expected > 0 (left and right swapped?)")
    if lowest <= baseline <= highest:
        return
    if baseline == 0:
        hint = "P[0,3] is equal left and right, expected -fx * baseline [px m] for the right camera"
    else:
        hint = _unit_hint(baseline, fx)
    raise ValueError(
        f"the baseline is {baseline:.4g} m, expected {lowest:g} to {highest:g} m on a vehicle ({hint})"
    )


def _unit_hint(baseline: float, fx: float) -> str:
    """Return in which unit a baseline outside `BASELINES` would be one."""

    def fits(factor: float) -> bool:
        """Whether the baseline times a factor is one of a vehicle."""
        return BASELINES[0] <= baseline * factor <= BASELINES[1]

    units = " or ".join(f"px {name}" for name, factor in UNITS.items() if fits(factor))
    meant = [f"in {units}"] if units else []
    meant += ["without its factor fx"] if fits(fx) else []
    return f"is P[0,3] {', or '.join(meant)}?" if meant else "P[0,3] is -fx * baseline [px m]"


def _check_rectified(left: Floats, right: Floats) -> None:
    """Raise ValueError where two projection matrices are not those of a rectified pair, side by side."""
    for P, side in ((left, "left"), (right, "right")):
        _check_pinhole(P, side)
    for row, name in enumerate(("fx", "fy")):
        values = left[row, row], right[row, row]
        if abs(values[1] - values[0]) > FOCAL_TOLERANCE * values[0]:
            raise ValueError(
                f"{name} is {values[0]:g} px left and {values[1]:g} px right, "
                "expected equal (a rectified pair)"
            )
    if abs(right[1, 2] - left[1, 2]) > ROW_TOLERANCE:
        raise ValueError(
            f"cy is {left[1, 2]:g} px left and {right[1, 2]:g} px right, expected equal (a rectified pair)"
        )
    if abs(right[1, 3] - left[1, 3]) > abs(right[0, 3] - left[0, 3]):
        raise ValueError("the right camera stands above or below the left one, expected beside it")


def _check_pinhole(P: Floats, side: str) -> None:
    """Raise ValueError where a projection matrix is not that of a rectified camera."""
    fx, fy = P[0, 0], P[1, 1]
    if not (np.isfinite(fx) and fx > 0 and np.isfinite(fy) and fy > 0):
        raise ValueError(
            f"P of the {side} camera has fx = {fx:g}, fy = {fy:g}, expected > 0 (not calibrated?)"
        )
    if not np.all(np.isfinite(P)):
        raise ValueError(f"P of the {side} camera holds values that are not finite numbers")
    for skew, place in ((P[0, 1], "P[0,1]"), (P[1, 0], "P[1,0]")):
        if abs(skew) > SKEW_MAX:
            raise ValueError(
                f"P of the {side} camera has a skew of {skew:g} px ({place}), expected 0 (a rectified camera)"
            )
    if not np.allclose(P[2, :3], [0, 0, 1], rtol=0, atol=ROUNDING):
        raise ValueError(
            f"P of the {side} camera has the third row {P[2]}, expected 0 0 1 t (a rectified camera)"
        )
