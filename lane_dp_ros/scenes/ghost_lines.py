# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What is left on a rendered road of lines that were taken off it."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

from lane_dp_ros.scenes.category_parts import Rng, side
from lane_dp_ros.scenes.road import Line, Road
from lane_dp_ros.scenes.strips import beside_paint, grey

KINDS: tuple[Literal["solid", "dashed"], ...] = ("solid", "dashed")


def ghost_lines(rng: Rng, road: Road) -> Road:
    """Lay what is left of one to three old lines: milled off, worn nearly away, or painted over in black."""
    remains = (_milled, _worn_away, _blacked_out)
    ghosts: list[tuple[float, Line]] = []
    for _ in range(int(rng.integers(1, 4))):
        n, painted = beside_paint(rng, road), KINDS[rng.integers(2)]
        old = Line(painted, width=float(rng.uniform(0.12, 0.22)), dash=float(rng.choice([3, 6])), gap=6.0)
        if rng.uniform() < 0.3:  # the lane was led past something
            bend = float(rng.uniform(0.8, 2.0) * side(rng))
            old = replace(old, bend=bend, bend_at=float(rng.uniform(0, 600)), bend_over=60.0)
        ghosts += [(n, part) for part in remains[rng.integers(len(remains))](rng, old, road.asphalt)]
    return replace(road, strips=(*road.strips, *ghosts))


def _milled(rng: Rng, old: Line, asphalt: float) -> list[Line]:
    """Return the rough groove in which the line was: paler, for its stones are fresh."""
    tone, wear = grey(asphalt * float(rng.uniform(1.12, 1.4))), float(rng.uniform(0.2, 0.4))
    return [replace(old, width=old.width + 0.04, colour=tone, wear=wear, ragged=0.02, grain=0.22)]


def _worn_away(rng: Rng, old: Line, asphalt: float) -> list[Line]:
    """Return flakes of the paint, over a bed that was scratched pale."""
    bed = replace(old, colour=grey(asphalt * float(rng.uniform(1.04, 1.15))), wear=0.2, grain=0.2)
    return [bed, replace(old, wear=float(rng.uniform(0.62, 0.78)), ragged=0.015)]


def _blacked_out(rng: Rng, old: Line, asphalt: float) -> list[Line]:
    """Return a black line over the old one, wider, but worn here and there."""
    black = grey(asphalt * float(rng.uniform(0.45, 0.65)))
    return [
        replace(old, wear=float(rng.uniform(0.55, 0.65))),
        replace(old, width=old.width + 0.06, colour=black, wear=float(rng.uniform(0.05, 0.25)), grain=0.03),
    ]
