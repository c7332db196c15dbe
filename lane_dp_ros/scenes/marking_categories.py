# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The named categories of scenes with other marks than lines, with seams and rails, without any paint."""

from __future__ import annotations

from dataclasses import replace

from lane_dp_ros.scenes import marks
from lane_dp_ros.scenes.category_parts import (
    EDGE,
    NARROW_DASHED,
    NO_LINES,
    WIDE_DASHED,
    Make,
    Rng,
    aged,
    drive,
    weather,
)
from lane_dp_ros.scenes.road import DASHED, SOLID, UNPAINTED, Line, Road
from lane_dp_ros.scenes.scene import Motion, Scene


def _hatching(rng: Rng) -> Scene:
    """A painted island between the directions, as before a turning lane."""
    road = Road(
        swing=0,
        curvature=rng.uniform(-0.002, 0.002),
        lane_widths=(3.5, 2.6, 3.5),
        lines=(SOLID, SOLID, SOLID, SOLID),
        driven=2,
        marks=(marks.island(0, 5000, -4.35, -1.75, chevron=bool(rng.integers(2))),),
    )
    return Scene(road, weather(rng), motion=drive(rng))


def _arrows(rng: Rng) -> Scene:
    shapes = (*marks.arrow(14.0, 0.0, "ahead", 34.0), *marks.arrow(14.0, -3.5, "left", 34.0))
    more = marks.arrow(14.0, 3.5, "right", 34.0)
    road = Road(
        swing=0,
        lane_widths=(3.5,) * 3,
        lines=(SOLID, NARROW_DASHED, NARROW_DASHED, SOLID),
        driven=1,
        marks=(*shapes, *more),
        kerb=0.12,
        shoulder=0.4,
        verge="town",
    )
    return Scene(road, weather(rng), motion=Motion(start=float(rng.uniform(-3, 4)), speed=10.0))


def _stop_line(rng: Rng) -> Scene:
    road = Road(
        swing=0,
        lines=(SOLID, replace(SOLID, width=0.12, end=28.0), SOLID),
        marks=(marks.bar(28.0, 0.5, -1.75, 1.75), marks.give_way(46.0, -5.2, -1.8)),
        kerb=0.12,
        shoulder=0.3,
        verge="town",
    )
    return Scene(road, weather(rng), motion=Motion(start=float(rng.uniform(3, 10)), speed=8.0))


def _zebra(rng: Rng) -> Scene:
    ends = replace(NARROW_DASHED, dash=3.0, gap=3.0)
    road = Road(
        swing=0,
        lane_widths=(3.3, 3.3),
        lines=(UNPAINTED, ends, UNPAINTED),
        marks=(marks.zebra(22.0, 4.0, -5.2, 1.9), marks.bar(20.5, 0.3, -1.6, 1.8)),
        kerb=0.12,
        shoulder=0.3,
        verge="town",
    )
    return Scene(road, weather(rng), motion=Motion(start=float(rng.uniform(2, 9)), speed=8.0))


def _tar_seams(rng: Rng) -> Scene:
    tar = Line(width=0.06, colour="tar", wobble=0.05, wear=0.2)
    places = ((-3.1, 0.3), (-1.3, 0.06), (0.35, 0.12), (1.1, 0.25), (2.0, 0.03))
    strips = tuple((n, replace(tar, width=rng.uniform(0.04, 0.11), wobble=w)) for n, w in places)
    patch = Line(width=0.9, colour="patch", begin=0, end=1e4)
    road = Road(
        swing=0.003, strips=((-2.6, patch), *strips), marks=marks.seams(rng), asphalt=118, overgrowth=0.08
    )
    return Scene(road, weather(rng), motion=drive(rng))


def _tram_rails(rng: Rng) -> Scene:
    bed = Line(width=2.3, colour="patch", wear=0.15)
    groove, steel = Line(width=0.13, colour="tar"), Line(width=0.065, colour="steel")
    rails = [(n, kind) for n in (-0.52, 0.95, -4.02, -2.55) for kind in (groove, steel)]
    road = Road(
        swing=0.003,
        strips=((0.21, bed), (-3.29, bed), *rails),
        lines=(SOLID, replace(NARROW_DASHED, width=0.10), SOLID),
        kerb=0.12,
        shoulder=0.5,
        verge="town",
    )
    return Scene(road, weather(rng), motion=drive(rng, speed=10.0))


def _kerbs(rng: Rng) -> Scene:
    road = Road(
        swing=0.004, lines=(UNPAINTED, DASHED, UNPAINTED), kerb=0.14, shoulder=0.15, verge="town", asphalt=104
    )
    return Scene(road, weather(rng), motion=drive(rng, speed=11.0))


def _concrete(rng: Rng) -> Scene:
    """Light slabs with dark joints, on which white paint hardly stands out."""
    joint = Line(width=0.03, colour="tar")
    road = Road(
        swing=0.001,
        lane_widths=(3.75,) * 2,
        lines=(EDGE, WIDE_DASHED, EDGE),
        strips=((-1.6, joint), (2.2, joint), (-5.6, joint)),
        marks=(marks.joint(5.0, -9.0, 6.0),),
        asphalt=168,
        shoulder=2.5,
    )
    return Scene(road, weather(rng), motion=drive(rng, speed=25.0))


def _no_paint_verge(rng: Rng) -> Scene:
    road = Road(
        swing=0.005, lane_widths=(2.7, 2.7), lines=NO_LINES, shoulder=0.2, overgrowth=0.15, verge="forest"
    )
    return Scene(road, weather(rng), motion=drive(rng, speed=12.0))


def _no_paint_kerbs(rng: Rng) -> Scene:
    gutter = Line(width=0.3, colour="concrete")
    road = Road(
        swing=0.003,
        lane_widths=(3.0, 3.0),
        lines=NO_LINES,
        strips=((-4.55, gutter), (1.55, gutter)),
        kerb=0.14,
        shoulder=0.2,
        verge="town",
    )
    return Scene(road, weather(rng), motion=drive(rng, speed=10.0))


def _no_paint_cracks(rng: Rng) -> Scene:
    scene = _tar_seams(rng)
    return replace(scene, road=replace(scene.road, lines=NO_LINES, asphalt=124))


MARKING_CATEGORIES: dict[str, Make] = {
    name: aged(make)
    for name, make in {
        "hatching": _hatching,
        "arrows": _arrows,
        "stop_line": _stop_line,
        "zebra": _zebra,
        "tar_seams": _tar_seams,
        "tram_rails": _tram_rails,
        "kerbs": _kerbs,
        "concrete": _concrete,
        "no_paint_verge": _no_paint_verge,
        "no_paint_kerbs": _no_paint_kerbs,
        "no_paint_cracks": _no_paint_cracks,
    }.items()
}
