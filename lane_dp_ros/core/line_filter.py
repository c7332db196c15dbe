# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""How the vehicle moves against painted lines, and each line by itself: a Kalman filter over the frames."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

# The motion against the road, common to all lines: how fast they move aside [m/s], turn [rad/s] and bend
# [1/(m s)] together, and the vehicle's speed [m/s].
ASIDE, TURN, BEND, SPEED = range(4)
MOTION = 4
SHAPE = 3  # of a line: its offset [m], heading [rad] and curvature [1/m]

FIRST_MOTION = np.array([0.0, 0.0, 0.0, 12.0])
FIRST_MOTION_SIGMA = np.array([1.0, 0.2, 0.03, 6.0])
MOTION_NOISE = np.array([1.0, 0.3, 0.02, 1.0])  # a root second: turning in, bends that begin
COMMON_NOISE = np.array([0.03, 0.008, 0.001])  # a root second, of all lines: a camera that shakes
OWN_NOISE = np.array([0.06, 0.008, 0.0012])  # a root second, of each line: paint that is not parallel
BENDING = 0.001  # 1/m; on such a bend a line's own noise doubles: real bends are no arcs about one centre
FIRST_SHAPE_SIGMA = np.array([0.03, 0.003, 0.0005])  # of a line's course when it is first seen
GATE = 1.0  # mean squared innovation over what is expected, from which on a line is believed to have moved
SPEED_MAX = 70.0  # m/s


class LineFilter:
    """The joint state of the vehicle's motion and of what each line's course is off by.

    A course is moved by a + h s + k s^2 / 2 (straightened, see `Course`). All lines move together, because
    it is the vehicle that moves; so a line that is not observed follows those that are. On a road of constant
    curvature forward motion is invisible; where lines are not parallel the speed carries them on.
    """

    def __init__(self) -> None:
        self._ids: list[int] = []
        self._mean = FIRST_MOTION.copy()
        self._covariance = np.diag(FIRST_MOTION_SIGMA**2)

    def predict(self, seconds: float, shapes: Mapping[int, Floats], road_curvature: float) -> None:
        """Move on in time; `shapes` are offset, heading and curvature (3,) of the lines against the axis."""
        distance = self._mean[SPEED] * seconds
        size, count = len(self._mean), len(self._ids)
        transition, noise = np.eye(size), np.zeros((size, size))
        noise[:MOTION, :MOTION] = np.diag(MOTION_NOISE**2)
        noise[MOTION:, MOTION:] = np.kron(np.ones((count, count)), np.diag(COMMON_NOISE**2))
        own_noise = OWN_NOISE * (1 + abs(road_curvature) / BENDING)
        noise[MOTION:, MOTION:] += np.kron(np.eye(count), np.diag(own_noise**2))
        for identity in self._ids:
            _, heading, curvature = shapes[identity]
            own = self._slice(identity)
            transition[own, own] = [[1, distance, distance**2 / 2], [0, 1, distance], [0, 0, 1]]
            transition[own, [ASIDE, TURN, BEND]] = np.eye(SHAPE) * seconds
            transition[own, SPEED] = np.array([heading + curvature * distance, curvature, 0.0]) * seconds
            self._mean[own] += [heading * distance + curvature * distance**2 / 2, curvature * distance, 0.0]
            self._mean[own] += self._mean[[ASIDE, TURN, BEND]] * seconds
        self._covariance = transition @ self._covariance @ transition.T + noise * seconds

    def begin(self, identity: int) -> None:
        """Begin a line, at the course that was found for it; one that is known begins anew."""
        if identity in self._ids:
            self.forget(identity)
        size = len(self._mean)
        covariance = np.diag(np.append(np.zeros(size), FIRST_SHAPE_SIGMA**2))
        covariance[:size, :size] = self._covariance
        self._covariance = covariance
        self._mean = np.append(self._mean, np.zeros(SHAPE))
        self._ids.append(identity)

    def forget(self, identity: int) -> None:
        """Drop a line."""
        gone = self._slice(identity)
        self._ids.remove(identity)
        self._mean = np.delete(self._mean, gone)
        self._covariance = np.delete(np.delete(self._covariance, gone, 0), gone, 1)

    def observe(self, identity: int, s: Floats, aside: Floats, sigma: Floats) -> None:
        """Take in how far right of its course a line is: `aside` (N,) at `s` (N,), within `sigma` [m]."""
        own = self._slice(identity)
        rows = np.zeros((len(s), len(self._mean)))
        rows[:, own] = np.array([np.ones_like(s), s, s**2 / 2]).T
        innovation, noise = aside - rows @ self._mean, np.diag(sigma**2)
        weight = np.linalg.inv(rows @ self._covariance @ rows.T + noise)
        surprise = float(innovation @ weight @ innovation) / len(s)
        if surprise > GATE:
            # It went where neither its past nor the other lines lead: it alone, and at once.
            self._covariance[own, own] += np.diag(FIRST_SHAPE_SIGMA**2) * surprise
            weight = np.linalg.inv(rows @ self._covariance @ rows.T + noise)
        gain = self._covariance @ rows.T @ weight
        self._mean = self._mean + gain @ innovation
        self._mean[SPEED] = np.clip(self._mean[SPEED], 0.0, SPEED_MAX)
        kept = np.eye(len(self._mean)) - gain @ rows
        self._covariance = kept @ self._covariance @ kept.T + gain @ noise @ gain.T

    def take_moves(self) -> dict[int, Floats]:
        """Return by how much each line's course is to be moved (3,), and count it as done."""
        moves = {identity: self._mean[self._slice(identity)].copy() for identity in self._ids}
        self._mean[MOTION:] = 0.0
        return moves

    def _slice(self, identity: int) -> slice:
        first = MOTION + SHAPE * self._ids.index(identity)
        return slice(first, first + SHAPE)
