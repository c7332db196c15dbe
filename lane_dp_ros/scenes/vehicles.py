# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Vehicles that drive or stand on a rendered road: a profile, drawn out to a width, with pictures on it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.scenes import vehicle_pictures as pictures
from lane_dp_ros.scenes.faces import Face, Picture
from lane_dp_ros.scenes.vehicle_pictures import Colour, Model

Floats = NDArray[np.float64]

# Each profile goes from the rear bumper over the roof to the front bumper, (ahead, up) [m].
CAR = Model(
    profile=((0.05, 0.26), (0.0, 0.56), (0.07, 0.95), (0.55, 1.38), (0.95, 1.45), (2.05, 1.44), (2.95, 0.97),
             (3.95, 0.80), (4.12, 0.58), (4.10, 0.24)),
    width=1.72, lean=0.36, belt=0.93, wheels=(0.78, 3.32), radius=0.31,
)  # fmt: skip
ESTATE = Model(
    profile=((0.05, 0.28), (0.0, 0.58), (0.05, 0.98), (0.30, 1.44), (0.50, 1.50), (2.35, 1.48), (3.25, 0.99),
             (4.35, 0.82), (4.55, 0.58), (4.52, 0.25)),
    width=1.80, lean=0.33, belt=0.96, wheels=(0.85, 3.62), radius=0.32,
)  # fmt: skip
VAN = Model(
    profile=((0.02, 0.34), (0.0, 0.62), (0.02, 1.12), (0.08, 1.84), (0.25, 1.97), (3.55, 1.97), (4.35, 1.18),
             (4.95, 0.96), (5.10, 0.62), (5.05, 0.28)),
    width=1.95, lean=0.07, belt=1.12, wheels=(1.05, 4.25), radius=0.34,
)  # fmt: skip
LORRY = Model(
    profile=((0.10, 0.45), (0.0, 0.90), (0.0, 1.05), (0.0, 3.60), (0.05, 3.65), (9.3, 3.65), (9.5, 1.60),
             (9.6, 1.30), (9.6, 0.70), (9.6, 0.35)),
    width=2.50, lean=0.0, belt=1.05, wheels=(2.2, 8.2), radius=0.50,
)  # fmt: skip
ROOF = 4  # the strip of a profile that is the roof: those before it look back, those after it forward


@dataclass(frozen=True)
class Vehicle:
    """A vehicle whose nearer end is `s` [m] along the road at time 0, its middle `n` [m] right of the axis.

    `speed` [m/s] is along the road, negative when it comes towards the camera; `oncoming` ones show their
    front. `colour` is the paint's, BGR; `lamps` is how bright its lights shine, 0 to 1.
    """

    s: float
    n: float
    model: Model = CAR
    colour: Colour = (70.0, 62.0, 58.0)
    speed: float = 0.0
    oncoming: bool = False
    lamps: float = 0.0

    def at(self, seconds: float) -> Vehicle:
        """Return the vehicle where it is after this time."""
        return replace(self, s=self.s + self.speed * seconds)

    def things(self, s: float, reach: float) -> Iterator[tuple[Face, ...]]:
        """Yield its faces, body and wheels, if any of it is from s to s + reach [m] along the road."""
        if s - self.model.length < self.s < s + reach:
            parts = _parts(self.model, self.colour, self.lamps > 0)
            yield tuple(
                Face(self._placed(part.corners), part.picture, part.glow * self.lamps, part.both)
                for part in parts
            )

    def outlines(self, s: float, reach: float) -> Iterator[Floats]:
        """Yield convex outlines (N, 3) that throw its shadow."""
        model = self.model
        if not s - model.length < self.s < s + reach:
            return
        low, waist = (_level(model.length, model.width, up) for up in (0.15, model.belt))
        yield self._placed(np.vstack([low, waist]))
        if model.lean > 0:
            cabin = _level(0.5 * model.length, 0.85 * model.width, model.height)
            cabin[:, 0] += 0.12 * model.length
        else:
            cabin = _level(model.length, model.width, model.height)
        yield self._placed(np.vstack([waist, cabin]))

    def roofs(self) -> tuple[Floats, ...]:
        """Return the outline (4, 3) of the ground that it keeps the sky from."""
        return (self._placed(_level(self.model.length, self.model.width, 0.0)),)

    def head_lamps(self) -> tuple[float, float, float]:
        """Return the place between its head lamps (s, n, above) [m]."""
        return self.s + (0.0 if self.oncoming else self.model.length), self.n, 0.65

    def _placed(self, corners: Floats) -> Floats:
        if self.oncoming:  # turned about its upright axis
            corners = corners * (-1, -1, 1) + np.array([self.model.length, 0, 0])
        return corners + np.array([self.s, self.n, 0])


@dataclass(frozen=True, eq=False)
class _Part:
    """A face of a vehicle that stands at s = n = 0; `both` sides are seen."""

    corners: Floats
    picture: Picture
    glow: float = 0.0
    both: bool = False


def _level(length: float, width: float, up: float) -> Floats:
    half = width / 2
    return np.array([(0, -half, up), (length, -half, up), (length, half, up), (0, half, up)])


@cache
def _parts(model: Model, colour: Colour, lit: bool) -> tuple[_Part, ...]:
    strips = [_strip(model, colour, i, lit) for i in range(len(model.profile) - 1)]
    sides = [part for side in (-1, 1) for part in _side(model, colour, side)]
    return (*_underneath(model), *strips, *sides)


def _strip(model: Model, colour: Colour, i: int, lit: bool) -> _Part:
    """Return what lies between two points of the profile, over the whole width."""
    upper, lower, left = (i + 1, i, -1) if i <= ROOF else (i, i + 1, 1)  # left: as seen from outside
    corners = [
        (model.profile[k][0], side * model.half_width(model.profile[k][1]), model.profile[k][1])
        for k, side in ((upper, left), (upper, -left), (lower, -left), (lower, left))
    ]
    glow = 1.0 if i in pictures.LAMP_STRIPS else 0.0
    return _Part(np.array(corners), pictures.strip(model, colour, i, lit), glow)


def _side(model: Model, colour: Colour, side: int) -> tuple[_Part, _Part]:
    """Return the lower side with its wheels, and the cabin's side, which leans in."""
    left, right = (0.0, model.length) if side > 0 else (model.length, 0.0)
    n, top_n = side * model.width / 2, side * model.half_width(model.height)
    low, high = pictures.sides(model, colour, mirrored=side < 0)
    lower = [(left, n, model.belt), (right, n, model.belt), (right, n, 0), (left, n, 0)]
    roof = [(left, top_n, model.height), (right, top_n, model.height)]
    upper = [*roof, *lower[1::-1]]
    return _Part(np.array(lower), low), _Part(np.array(upper), high)


def _underneath(model: Model) -> list[_Part]:
    """Return the tyres as they are seen from behind and before, and the dark between them."""
    picture = pictures.underneath(model)
    ends = (model.wheels[0] - 0.8 * model.radius, model.wheels[1] + 0.8 * model.radius)
    return [
        _Part(_upright(s, 0.0, model.width - 0.08, (0.0, 1.4 * model.radius)), picture, both=True)
        for s in ends
    ]


def _upright(s: float, n: float, width: float, up: tuple[float, float]) -> Floats:
    left, right = n - width / 2, n + width / 2
    return np.array([(s, left, up[1]), (s, right, up[1]), (s, right, up[0]), (s, left, up[0])])
