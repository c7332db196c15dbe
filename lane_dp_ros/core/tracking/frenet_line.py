# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The course of a line over the ground, straightened, so that lines are compared and moved side by side."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.geometry.road_axis import RoadAxis

Floats = NDArray[np.float64]

SHARED = 3.0  # m that two lines must share to be compared there
NEAREST = 1.0  # m; no camera sees the road nearer
ROWS = 16  # of the picture, in which lines are compared
SAMPLES = 8  # of a line: enough for its shape
SURFACE_SIGMA = np.array([0.05, 0.01, 0.01])  # m, 1, 1: so height, pitch and roll change from frame to frame
DOWN_SIGMA = 0.02  # m, of a point
POINT_SIGMA = 0.02  # m; the samples of a line err together
FAR = 20.0  # m at which a point's sigma is twice as large
AXIS_STEPS = 4  # each straightens better than the one before
AXIS_SIGMA = np.array([0.3, 0.03])  # rad, 1/m; of roads
AXIS_MAX = np.array([0.8, 0.06])  # rad, 1/m; more is no road
DIRECTION_SIGMA = 0.05  # m, of a point of a line beside a common axis


@dataclass(frozen=True, eq=False)
class FrenetLine:
    """Where a line runs: s (N,) and y (N,) [m], straightened by an axis, and how far `down` (N,) [m].

    y = n + heading s + curvature s^2 / 2, with the axis's road coordinates, heading and curvature: so a line
    that is concentric with the axis has its heading and curvature, whatever its own radius. `down` is the
    y of the optical frame.
    """

    s: Floats
    y: Floats
    down: Floats

    @classmethod
    def of(cls, points: Floats, axis: RoadAxis) -> FrenetLine:
        """Return the course of points (N, 3) [m] in the left optical frame, N > 0."""
        s, n = axis.from_ground(points[:, 0], points[:, 2])
        return cls(s, n + _bend(s, axis), points[:, 1])

    def points(self, axis: RoadAxis) -> Floats:
        """Return its points (N, 3) [m] in the left optical frame."""
        x, z = axis.to_ground(self.s, self.offsets(axis))
        return np.array([x, self.down, z]).T

    def offsets(self, axis: RoadAxis) -> Floats:
        """Return n (N,) [m] along it."""
        return np.asarray(self.y - _bend(self.s, axis))

    @cached_property
    def sampled(self) -> FrenetLine:
        """A few of its points."""
        count = len(self.s)
        rows = (
            range(count) if count <= SAMPLES else [i * (count - 1) // (SAMPLES - 1) for i in range(SAMPLES)]
        )
        return FrenetLine(self.s[rows], self.y[rows], self.down[rows])

    def sigma(self) -> Floats:
        """Return the standard deviation [m] of its points if each erred by itself."""
        return np.asarray(POINT_SIGMA * (1 + np.abs(self.s) / FAR))

    def moved(self, by: Floats) -> FrenetLine:
        """Return it moved aside by offset, heading and curvature (3,)."""
        return FrenetLine(self.s, self.y + by[0] + self.s * (by[1] + self.s * (by[2] / 2)), self.down)

    def within(self, other: FrenetLine) -> FrenetLine | None:
        """Return samples of the part beside another; None where they share too little to be compared."""
        few = self.sampled
        inside = (few.s >= other.s[0]) & (few.s <= other.s[-1])
        part = FrenetLine(few.s[inside], few.y[inside], few.down[inside])
        return part if inside.any() and part.s[-1] - part.s[0] >= SHARED else None

    def lever(self, axis: RoadAxis) -> Floats:
        """Return how far right of the camera (N,) [m] it runs, square to the axis's direction there."""
        x, z = axis.to_ground(self.s, self.offsets(axis))
        direction = axis.heading + axis.curvature * self.s
        return np.asarray(x * np.cos(direction) - z * np.sin(direction))

    def slid(self, slide: Floats, axis: RoadAxis) -> FrenetLine:
        """Return it where its points are once they have slid along their rays, see `MotionFilter.slide`."""
        return replace(self, y=self.y + self.lever(axis) * (slide[0] + slide[1] * self.s))

    def onto(self, other: FrenetLine) -> FrenetLine:
        """Return it moved aside, by offset and heading, to another of which it shares a part.

        Its own bend stays: in one frame that is seen better than a parabola has it.
        """
        part = self.within(other)
        if part is None:
            return self
        rows = np.array([np.ones_like(part.s), part.s]).T
        weighted = rows / part.sigma()[:, None] ** 2
        aside = np.interp(part.s, other.s, other.y) - part.y
        offset, heading = np.linalg.solve(weighted.T @ rows, weighted.T @ aside)
        return replace(self, y=self.y + offset + heading * np.clip(self.s, part.s[0], part.s[-1]))

    def lowered(self, surface: Floats) -> FrenetLine:
        """Return it on a surface that has changed, see `surface_change`."""
        return replace(self, down=self.down + surface[0] + surface[1] * self.s + surface[2] * self.y)

    def place(self, axis: RoadAxis) -> float:
        """Return n [m], on the whole: on the average over the picture's rows."""
        s = picture_rows(self.s[0], self.s[-1])
        return float(np.mean(np.interp(s, self.s, self.offsets(axis))))

    def aside(self, other: FrenetLine, shared: float = 0.0) -> Floats:
        """Return samples [m] of how far right of another it runs; none where they share less than that."""
        first, last = max(self.s[0], other.s[0]), min(self.s[-1], other.s[-1])
        s = np.linspace(first, last, SAMPLES if last - first >= shared else 0)
        return np.asarray(np.interp(s, self.s, self.y) - np.interp(s, other.s, other.y))

    def strays(self, axis: RoadAxis) -> float:
        """Return the angle [rad] by which it leaves the axis's direction from end to end."""
        n = self.offsets(axis)
        return float(np.arctan2(abs(n[-1] - n[0]), abs(self.s[-1] - self.s[0])))


def _bend(s: Floats, axis: RoadAxis) -> Floats:
    return np.asarray(s * (axis.heading + s * (axis.curvature / 2)))


def picture_rows(first: float, last: float) -> Floats:
    """Return s [m] from first to last [m] in equal steps of the picture's rows, of 1/s."""
    return np.asarray(1 / np.linspace(1 / max(first, NEAREST), 1 / max(last, NEAREST), ROWS))


def first_axis(lines: Sequence[Floats]) -> RoadAxis:
    """Return the axis with which lines, points (N, 3) [m] each, are concentric as well as may be."""
    axis = RoadAxis()
    for _ in range(AXIS_STEPS):
        axis = common_axis([FrenetLine.of(points, axis) for points in lines])
    return axis


def common_axis(courses: Sequence[FrenetLine]) -> RoadAxis:
    """Return the axis of lines that one much like it has straightened: parabolas but for their offsets."""
    few = [course.sampled for course in courses]
    line = np.repeat(np.arange(len(few)), [len(course.s) for course in few])
    s, y = (np.concatenate([getattr(course, name) for course in few] or [[]]) for name in ("s", "y"))
    columns = np.column_stack([s, s**2 / 2, line[:, None] == np.arange(len(few))])
    prior = np.eye(2, columns.shape[1]) * DIRECTION_SIGMA / AXIS_SIGMA[:, None]
    fitted = np.linalg.lstsq(np.vstack([prior, columns]), np.append([0.0, 0.0], y), rcond=None)[0]
    heading, curvature = np.clip(fitted[:2], -AXIS_MAX, AXIS_MAX)
    return RoadAxis(float(heading), float(curvature))


def surface_change(pairs: Iterable[tuple[FrenetLine, FrenetLine]]) -> Floats:
    """Return how the road's surface has moved against the camera: down = c0 + c1 s + c2 y [m].

    `pairs` are courses of the same lines in the frame before and now; without any nothing has moved.
    """
    rows, moved = [np.diag(DOWN_SIGMA / SURFACE_SIGMA)], [np.zeros(3)]
    for before, now in pairs:
        few = now.sampled
        inside = (few.s >= before.s[0]) & (few.s <= before.s[-1])
        s, y = few.s[inside], few.y[inside]
        rows.append(np.array([np.ones_like(s), s, y]).T)
        moved.append(few.down[inside] - np.interp(s, before.s, before.down))
    return np.asarray(np.linalg.lstsq(np.vstack(rows), np.concatenate(moved), rcond=None)[0])
