# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""How the vehicle moves against painted lines, and each line by itself: a Kalman filter over the frames."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

# The motion of the vehicle against the road: all lines move aside [m/s], turn [rad/s] and bend [1/(m s)].
MOTION = 3
# By what part this frame's surface is measured farther off than the last one's: at the camera, and more each
# metre ahead [1/m]. All lines slide along their rays then; in the picture, they stay where they are.
SURFACE_SIGMA = np.array([0.01, 0.001])
COMMON = MOTION + len(SURFACE_SIGMA)
FIRST_MOTION_SIGMA = np.array([1.0, 0.2, 0.03])
MOTION_NOISE = np.array([1.0, 0.3, 0.02])  # a root second: turning in, bends that begin
SHAKE_NOISE = np.array([0.03, 0.008, 0.001])  # m, rad, 1/m a root second: a camera that shakes

# Of each line: offset [m], heading [rad] and curvature [1/m], by which its course is off, and how fast offset
# and heading drift against the other lines [m/s, rad/s], as those of lines do that are not parallel.
SHAPE = 3
LINE = 5
FIRST_SIGMA = np.array([0.03, 0.003, 0.0005, 0.5, 0.03])
OWN_NOISE = np.array([0.03, 0.004, 0.0006, 0.3, 0.03])  # a root second
BENDING = 0.01  # 1/m; on such a bend a line's own noise doubles: real bends are no arcs about one centre
GATE = 1.0  # mean squared innovation over what is expected, from which on a line is believed to have moved


@dataclass(frozen=True)
class Aside:
    """How far right of its course a line is, `aside` (N,) [m] at `s` (N,) [m], and its `sigma` (N,) [m].

    `lever` (N,) [m] is how far it runs right of the camera, square to its direction there.
    """

    s: Floats
    aside: Floats
    sigma: Floats
    lever: Floats


class MotionFilter:
    """The joint state of the vehicle's motion and of what each line's course is off by.

    A course is moved by a + h s + k s^2 / 2 (straightened, see `FrenetLine`). All move together, because
    it is the vehicle that moves; so a line that is not observed follows those that are, and drifts on as it
    did. What an error of the road's surface moves is told from that, and not remembered. On a road of
    constant curvature forward motion cannot be seen, and need not be known.
    """

    def __init__(self) -> None:
        self._ids: list[int] = []
        self._mean: Floats = np.zeros(COMMON)
        self._covariance: Floats = np.diag(np.append(FIRST_MOTION_SIGMA, SURFACE_SIGMA) ** 2)

    def predict(self, seconds: float, road_curvature: float) -> None:
        """Move on in time; `road_curvature` [1/m] says how far the road is from straight."""
        size, count = len(self._mean), len(self._ids)
        transition, noise = np.eye(size), np.zeros((size, size))
        noise[:MOTION, :MOTION] = np.diag(MOTION_NOISE**2)
        common = np.diag(np.append(SHAKE_NOISE, np.zeros(LINE - SHAPE)) ** 2)
        own = np.diag((OWN_NOISE * (1 + abs(road_curvature) / BENDING)) ** 2)
        transition[MOTION:COMMON, MOTION:COMMON] = 0
        noise[COMMON:, COMMON:] = np.kron(np.ones((count, count)), common) + np.kron(np.eye(count), own)
        for first in range(COMMON, size, LINE):
            transition[first : first + SHAPE, :MOTION] = np.eye(SHAPE) * seconds
            transition[[first, first + 1], [first + SHAPE, first + SHAPE + 1]] = seconds
        self._mean = transition @ self._mean
        self._covariance = transition @ self._covariance @ transition.T + noise * seconds
        self._covariance[MOTION:COMMON, MOTION:COMMON] = np.diag(SURFACE_SIGMA**2)

    def initialise(self, identity: int) -> None:
        """Begin a line at the course that was found for it; one that is known begins anew."""
        if identity in self._ids:
            self.remove(identity)
        size = len(self._mean)
        covariance = np.diag(np.append(np.zeros(size), FIRST_SIGMA**2))
        covariance[:size, :size] = self._covariance
        self._covariance = covariance
        self._mean = np.append(self._mean, np.zeros(LINE))
        self._ids.append(identity)

    def remove(self, identity: int) -> None:
        """Drop a line."""
        first = self._first(identity)
        gone = slice(first, first + LINE)
        self._ids.remove(identity)
        self._mean = np.delete(self._mean, gone)
        self._covariance = np.delete(np.delete(self._covariance, gone, 0), gone, 1)

    def surprise(self, identity: int, seen: Aside) -> float:
        """Return the mean squared innovation of a line's observation over what is expected of it."""
        rows = self._rows(identity, seen)
        innovation = seen.aside - rows @ self._mean
        return float(innovation @ self._weight(rows, seen) @ innovation) / len(seen.s)

    def update(self, identity: int, seen: Aside) -> None:
        """Take in how far a line is from its course."""
        surprise = self.surprise(identity, seen)
        if surprise > GATE:
            # It went where neither its past nor the other lines lead: it alone, and at once. So where it
            # is by now says the less of how it drifts, and of how the vehicle moves.
            own = self._shape(identity)
            itself = self._covariance[own, own] + np.diag(FIRST_SIGMA[:SHAPE] ** 2) * surprise
            self._covariance[own] /= surprise
            self._covariance[:, own] /= surprise
            self._covariance[own, own] = itself
        rows = self._rows(identity, seen)
        gain = self._covariance @ rows.T @ self._weight(rows, seen)
        kept = np.eye(len(self._mean)) - gain @ rows
        self._mean = self._mean + gain @ (seen.aside - rows @ self._mean)
        self._covariance = kept @ self._covariance @ kept.T + (gain * seen.sigma**2) @ gain.T

    def take_moves(self) -> dict[int, Floats]:
        """Return by how much each line's course is to be moved (3,), and count it as done."""
        moves = {identity: self._mean[self._shape(identity)].copy() for identity in self._ids}
        for identity in self._ids:
            self._mean[self._shape(identity)] = 0.0
        return moves

    def slide(self) -> Floats:
        """Return by what part (2,) [1, 1/m] points have slid along their rays with this frame's surface."""
        return self._mean[MOTION:COMMON].copy()

    def _weight(self, rows: Floats, seen: Aside) -> Floats:
        """Return the inverse of the innovation's covariance."""
        return np.asarray(np.linalg.inv(rows @ self._covariance @ rows.T + np.diag(seen.sigma**2)))

    def _rows(self, identity: int, seen: Aside) -> Floats:
        rows = np.zeros((len(seen.s), len(self._mean)))
        rows[:, MOTION] = seen.lever
        rows[:, MOTION + 1] = seen.lever * seen.s
        rows[:, self._shape(identity)] = np.array([np.ones_like(seen.s), seen.s, seen.s**2 / 2]).T
        return rows

    def _shape(self, identity: int) -> slice:
        first = self._first(identity)
        return slice(first, first + SHAPE)

    def _first(self, identity: int) -> int:
        return COMMON + LINE * self._ids.index(identity)
