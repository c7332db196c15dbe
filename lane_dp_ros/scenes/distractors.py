# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What lies along a rendered road as a line would, but is no lane line: each is laid on any road."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import numpy as np

from lane_dp_ros.scenes import marks
from lane_dp_ros.scenes.category_parts import Rng, side
from lane_dp_ros.scenes.ghost_lines import ghost_lines
from lane_dp_ros.scenes.road import Line, Mark, Road
from lane_dp_ros.scenes.strips import across, beside_paint, grey, shifted

Lay = Callable[[Rng, Road], Road]
Placed = tuple[float, Line]

ASPHALT_GRAIN = 0.15  # share by which the grain of asphalt that was filled in shows
GAUGE = 1.435  # [m] between tram rails
SLUSH = np.array([212.0, 206.0, 200.0])  # BGR grey levels of trodden snow
PATHS = ((126.0, 130.0, 132.0), (92.0, 90.0, 88.0), (84.0, 92.0, 142.0))  # paving, asphalt, a red cycle path
SEAL = (44.0, 43.0, 42.0)  # fresh bitumen


def light_strip(rng: Rng, road: Road) -> Road:
    """Lay the filled trench of a cable along a lane: new asphalt, lighter than the old, with sawn borders.

    Some have a joint of bitumen on both sides, some a trench to a house that branches off.
    """
    n, width = beside_paint(rng, road), float(rng.uniform(0.2, 0.3))
    tone = grey(road.asphalt * float(rng.uniform(1.12, 1.4)))
    filled = Line(width=width, colour=tone, wobble=float(rng.uniform(0, 0.02)), grain=ASPHALT_GRAIN)
    strips = [(n, shifted(rng, filled))]
    if rng.uniform() < 0.4:
        seam = replace(strips[0][1], width=0.025, colour="tar", wear=0.15)
        strips += [(n + aside * width / 2, seam) for aside in (-1, 1)]
    branches: tuple[Mark, ...] = ()
    if rng.uniform() < 0.4:
        kerb = float(rng.choice(road.borders))
        branch = marks.bar(float(rng.uniform(0, 40)), width, min(n, kerb), max(n, kerb), tone)
        branches = (replace(branch, repeat=40.0, grain=ASPHALT_GRAIN),)
    return replace(road, strips=(*road.strips, *strips), marks=(*road.marks, *branches))


def slush(rng: Rng, road: Road) -> Road:
    """Lay ridges of snow between the wheel tracks of a road, some over its lines, and snow on its verge."""
    left, right = road.borders
    middles = (road.offsets[1:] + road.offsets[:-1]) / 2
    between = [(n, float(rng.uniform(0.2, 0.6))) for n in middles.tolist()]
    over_lines = [
        (n + float(rng.uniform(-0.2, 0.2)), float(rng.uniform(0.2, 0.5))) for n in road.offsets.tolist()
    ]
    ridges = tuple((n, _ridge(rng, width)) for n, width in (*between, *over_lines) if rng.uniform() < 0.8)
    banks = tuple((n, _ridge(rng, float(rng.uniform(0.3, 0.8)))) for n in (left - 0.15, right + 0.15))
    return replace(
        road,
        covers=(*road.covers, *ridges, *banks),
        snow=float(rng.uniform(0.6, 1.1)),
    )


def tram_rails(rng: Rng, road: Road) -> Road:
    """Lay the two rails of a tram in the driven lane, in their grooves, and often in a bed of their own."""
    middle = float(rng.uniform(-0.3, 0.3))
    groove, steel = (
        Line(width=0.13, colour="tar"),
        Line(width=float(rng.uniform(0.055, 0.075)), colour="steel"),
    )
    rails = [(middle + rail * GAUGE / 2, part) for rail in (-1, 1) for part in (groove, steel)]
    bed = Line(width=2.3, colour=("patch", grey(road.asphalt * 1.12))[rng.integers(2)], wear=0.15)
    beds = [(middle, bed)] if rng.uniform() < 0.6 else []
    return replace(road, strips=(*road.strips, *beds, *rails))


def cracks(rng: Rng, road: Road) -> Road:
    """Lay open cracks that run along the road, thin and ragged, some of them two by two."""
    strips: list[Placed] = []
    for _ in range(int(rng.integers(2, 5))):
        n, wobble = across(rng, road), float(rng.uniform(0.04, 0.15))
        crack = Line(
            width=float(rng.uniform(0.012, 0.03)), colour="tar", wobble=wobble, ragged=0.012, wear=0.15
        )
        strips.append((n, shifted(rng, crack)))
        if rng.uniform() < 0.4:
            strips.append((n + float(rng.uniform(0.15, 0.4)), strips[-1][1]))
    return replace(road, strips=(*road.strips, *strips), marks=(*road.marks, *marks.seams(rng)[:3]))


def crack_sealing(rng: Rng, road: Road) -> Road:
    """Lay bands of bitumen poured over cracks, which wander along and across the road, some sanded pale."""
    colour = SEAL if rng.uniform() < 0.65 else grey(road.asphalt * float(rng.uniform(1.15, 1.35)))
    strips = []
    for _ in range(int(rng.integers(2, 6))):
        wobble = float(rng.uniform(0.05, 0.3))
        band = Line(
            width=float(rng.uniform(0.05, 0.11)), colour=colour, wobble=wobble, ragged=0.01, wear=0.05
        )
        strips.append((across(rng, road), shifted(rng, band)))
    left, right = road.borders
    bars = [
        marks.bar(float(rng.uniform(0, 60)), float(rng.uniform(0.05, 0.1)), left, right, colour)
        for _ in range(3)
    ]
    return replace(
        road,
        strips=(*road.strips, *strips),
        marks=(*road.marks, *(replace(bar, repeat=60.0) for bar in bars)),
    )


def concrete_joints(rng: Rng, road: Road) -> Road:
    """Part a road into slabs of several tones, with joints along and across it, dark or filled pale."""
    joint = Line(
        width=float(rng.uniform(0.02, 0.06)),
        colour="tar" if rng.uniform() < 0.5 else grey(road.asphalt * float(rng.uniform(1.12, 1.28))),
        wear=0.05,
    )
    left, right = road.borders
    length, shift = float(rng.uniform(4.5, 6.0)), float(rng.uniform(-1.2, 1.2))
    joints = [float(n) for n in road.offsets + shift if left < n < right]
    slabs = _slabs(rng, [left, *joints, right], length, road.asphalt)
    cross = replace(marks.bar(0.0, joint.width, left, right, joint.colour), repeat=length)
    strips = tuple((n, joint) for n in joints)
    return replace(
        road,
        strips=(*road.strips, *strips),
        marks=(*slabs, *road.marks, cross),
        overgrowth=0.02,
    )


def footpath_border(rng: Rng, road: Road) -> Road:
    """Lay a footpath or a cycle path beside the road, between pale stones or a white border and stones."""
    where = side(rng)
    gap = float(rng.uniform(0.3, 1.6)) if not road.kerb else float(rng.uniform(0.4, 0.9))
    begin, width = road.borders[where > 0] + where * gap, float(rng.uniform(1.5, 2.2))
    paving = Line(width=width, colour=PATHS[rng.integers(len(PATHS))], grain=0.1)
    stone = Line(width=float(rng.uniform(0.08, 0.15)), colour=grey(float(rng.uniform(150, 190))), wear=0.05)
    painted = replace(
        stone, width=0.12, colour="white", painted=("solid", "dashed")[rng.integers(2)], gap=2.0, dash=2.0
    )
    near = painted if rng.uniform() < 0.4 else stone
    covers = ((begin + where * width / 2, paving), (begin, near), (begin + where * width, stone))
    return replace(road, covers=(*road.covers, *covers))


def light_gutter(rng: Rng, road: Road) -> Road:
    """Lay gutters of pale concrete along both borders of the road, each a metre's stones long."""
    width = float(rng.uniform(0.25, 0.35))
    stones = Line(width=width, colour=grey(float(rng.uniform(140, 190))), wear=0.05, grain=0.08)
    left, right = road.borders
    strips = ((left + width / 2, stones), (right - width / 2, stones))
    spacing = float(rng.choice([0.5, 1.0]))
    joint = replace(marks.bar(0.0, 0.015, 0.0, 0.0, "tar"), repeat=spacing)
    joints = (replace(joint, left=(n - width / 2,) * 2, right=(n + width / 2,) * 2) for n, _ in strips)
    return replace(road, strips=(*road.strips, *strips), marks=(*road.marks, *joints), overgrowth=0.02)


DISTRACTORS: dict[str, Lay] = {
    lay.__name__: lay
    for lay in (
        light_strip,
        ghost_lines,
        slush,
        tram_rails,
        cracks,
        crack_sealing,
        concrete_joints,
        footpath_border,
        light_gutter,
    )
}


def _ridge(rng: Rng, width: float) -> Line:
    colour = tuple((SLUSH * rng.uniform(0.78, 1.05)).tolist())
    wear, ragged = float(rng.uniform(0.28, 0.5)), float(rng.uniform(0.06, 0.16))
    return shifted(rng, Line(width=width, colour=colour, wear=wear, ragged=ragged, wobble=0.05, grain=0.1))


def _slabs(rng: Rng, borders: list[float], length: float, asphalt: float) -> tuple[Mark, ...]:
    """Return slabs of other tones: one of each row of eight between two joints, again and again."""
    slabs = []
    for left, right in pairwise(borders):
        for begin in rng.choice(8, 3, replace=False).tolist():
            tone = grey(asphalt * float(rng.uniform(0.88, 1.08)))
            slab = marks.bar(begin * length, length, left, right, tone)
            slabs.append(replace(slab, repeat=8 * length, grain=ASPHALT_GRAIN))
    return tuple(slabs)
