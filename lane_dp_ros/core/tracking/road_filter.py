# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The road's surface over time: what a pair shows is held, and serves where the next ones show none."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.geometry.road_surface import RoadSurface, geometry
from lane_dp_ros.core.geometry.vertical_curve import VerticalCurve
from lane_dp_ros.core.types import RoadEstimate, RoadGate

NS_PER_S = 1_000_000_000
MEMORY_NS = NS_PER_S  # a longer jump of time, or one backwards, and everything is forgotten
HOLD_NS = 5 * NS_PER_S  # then the road that was measured is long behind the vehicle
CONVINCED_NS = NS_PER_S  # for which measured roads that contradict the held one must agree with one another

QUANTITIES = ("camera height", "pitch", "vertical curvature", "roll")
UNITS = ("m", "rad", "1/m", "rad")
# By how much a road, well measured, differs from frame to frame: load, bumps, ramps and hills stay within
# five times as much.
SPREAD = np.array([0.03, 0.008, 1.2e-3, 0.008])
GATE = 5.0  # standard deviations; an innovation that is farther out is another road
# s; load and cross slope last, the vehicle pitches in a fraction of a second, hills come and go
TIME_CONSTANTS = np.array([2.0, 0.2, 0.5, 2.0])
FRAME = 0.1  # s between frames that have these time constants

Floats = NDArray[np.float64]


class _Road:
    """A road over time: a Kalman filter for each of its quantities, as slow as that is by its nature."""

    def __init__(self, values: Floats, noise: Floats, stamp_ns: int) -> None:
        self.values = values
        self.first_ns = self.last_ns = stamp_ns
        self._variance = SPREAD**2 + noise

    def contradiction(self, values: Floats, noise: Floats) -> str:
        """Return what does not fit, empty where all does.

        A measurement that is less sure than roads are steady is believed no more for that.
        """
        innovation = np.abs(values - self.values)
        excess = innovation / (GATE * np.sqrt(SPREAD**2 + np.minimum(noise, SPREAD**2)))
        worst = int(excess.argmax())
        if excess[worst] <= 1:
            return ""
        held, found = self.values[worst], values[worst]
        return f"{QUANTITIES[worst]} {found:.3g} {UNITS[worst]} after {held:.3g}"

    def take_in(self, values: Floats, noise: Floats, stamp_ns: int) -> None:
        """Move towards the values of a frame: the less, the noisier they are."""
        elapsed = (stamp_ns - self.last_ns) / NS_PER_S
        self._variance = self._variance + SPREAD**2 * FRAME * elapsed / TIME_CONSTANTS**2
        gain = self._variance / (self._variance + SPREAD**2 + noise)
        self.values = self.values + gain * (values - self.values)
        self._variance = (1 - gain) * self._variance
        self.last_ns = stamp_ns


def _measured(surface: RoadSurface) -> tuple[Floats, Floats]:
    """Return the geometry (4,) of a surface, and the variance of its measurement."""
    noise = np.zeros(4) if surface.covariance is None else np.diag(surface.covariance)
    return geometry(surface), noise


class RoadFilter:
    """Tells which surface serves for each frame: the measured one, the last ones, or the nominal one.

    A measured surface that contradicts the held ones is not used, unless such surfaces agree with one another
    for a second: then it was the held one that was wrong. The held one serves for five seconds.
    """

    def __init__(self) -> None:
        self._held: _Road | None = None
        self._rival: _Road | None = None
        self._stamp_ns = 0
        self._nominal: RoadSurface | None = None

    def predict(self, nominal: RoadSurface, stamp_ns: int) -> RoadGate:
        """Move on to the frame of `stamp_ns`; return what tells which surface serves for it.

        `nominal` is the surface by the camera's nominal height and pitch.
        """
        jumped = not 0 <= stamp_ns - self._stamp_ns <= MEMORY_NS
        if jumped or self._nominal is None or nominal.camera != self._nominal.camera:
            self._held = self._rival = None
        elif self._held is not None and stamp_ns - self._held.last_ns > HOLD_NS:
            self._held = None
        self._stamp_ns, self._nominal = stamp_ns, nominal
        held = None if self._held is None else VerticalCurve.of_geometry(nominal.camera, self._held.values)

        def gate(measured: RoadSurface | None) -> RoadEstimate:
            """Return the measured surface unless it contradicts the held one; else that or the nominal."""
            reason = "" if measured is None else self._contradiction(*_measured(measured))
            if measured is not None and not reason:
                return RoadEstimate(measured, "measured")
            if held is None:
                return RoadEstimate(nominal, "nominal", reason)
            return RoadEstimate(held, "last", reason)

        return gate

    def update(self, measured: RoadSurface | None) -> None:
        """Take in what was measured in this frame, None for none."""
        if measured is None:
            return
        values, noise = _measured(measured)
        if self._contradiction(values, noise):
            self._take_in_rival(values, noise)
            return
        if self._held is None or self._held.contradiction(values, noise):
            self._held = _Road(values, noise, self._stamp_ns)
        else:
            self._held.take_in(values, noise, self._stamp_ns)
        self._rival = None

    def _contradiction(self, values: Floats, noise: Floats) -> str:
        """Return how a measured road contradicts the held one; empty where it does not or is believed."""
        reason = self._held.contradiction(values, noise) if self._held is not None else ""
        if not reason or self._rival is None or self._rival.contradiction(values, noise):
            return reason
        return "" if self._stamp_ns - self._rival.first_ns >= CONVINCED_NS else reason

    def _take_in_rival(self, values: Floats, noise: Floats) -> None:
        if self._rival is None or self._rival.contradiction(values, noise):
            self._rival = _Road(values, noise, self._stamp_ns)
        else:
            self._rival.take_in(values, noise, self._stamp_ns)
