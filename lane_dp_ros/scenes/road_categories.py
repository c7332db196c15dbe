# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The named categories of scenes that are special by their road's course or by its lines."""

from __future__ import annotations

from dataclasses import replace

from lane_dp_ros.scenes import marks
from lane_dp_ros.scenes.category_parts import (
    EDGE,
    LONG_DASHED,
    NARROW_DASHED,
    SHORT_DASHED,
    WIDE_DASHED,
    Make,
    Rng,
    aged,
    drive,
    side,
    weather,
)
from lane_dp_ros.scenes.road import DASHED, SOLID, UNPAINTED, Line, Road
from lane_dp_ros.scenes.scene import Motion, Scene


def _straight(rng: Rng) -> Scene:
    return Scene(Road(swing=0), weather(rng), motion=drive(rng))


def _curve(rng: Rng) -> Scene:
    road = Road(curvature=side(rng) / rng.uniform(120, 250), swing=0, verge="forest")
    return Scene(road, weather(rng), motion=drive(rng))


def _tight_curve(rng: Rng) -> Scene:
    road = Road(curvature=side(rng) / rng.uniform(60, 80), swing=0, asphalt=98)
    return Scene(road, weather(rng), motion=drive(rng, speed=9.0))


def _s_curve(rng: Rng) -> Scene:
    road = Road(swing=0.012 * side(rng), swing_length=110)
    return Scene(road, weather(rng), motion=Motion(start=float(rng.uniform(45, 55)), speed=11.0))


def _crest(rng: Rng) -> Scene:
    road = Road(hill=rng.uniform(4, 6), hill_length=160, curvature=0.002 * side(rng), swing=0)
    return Scene(road, weather(rng), motion=Motion(start=float(rng.uniform(38, 52))))


def _dip(rng: Rng) -> Scene:
    road = Road(hill=rng.uniform(4, 6), hill_length=160, curvature=0.002 * side(rng), swing=0)
    return Scene(road, weather(rng), motion=Motion(start=float(rng.uniform(128, 142))))


def _roll(rng: Rng) -> Scene:
    return Scene(Road(roll=0.05 * side(rng), swing=0.003), weather(rng), motion=drive(rng))


def _shaking_camera(rng: Rng) -> Scene:
    return Scene(
        Road(swing=0.003, asphalt=100), weather(rng), motion=drive(rng, nod=0.012, turn=0.03, sway=0.3)
    )


def _motorway(rng: Rng) -> Scene:
    lines = (EDGE, WIDE_DASHED, WIDE_DASHED, EDGE)
    road = Road(
        curvature=rng.uniform(-1, 1) / 700,
        swing=0,
        lane_widths=(3.75,) * 3,
        lines=lines,
        driven=int(rng.integers(3)),
        shoulder=2.6,
    )
    return Scene(road, weather(rng), motion=drive(rng, speed=30.0))


def _narrow_road(rng: Rng) -> Scene:
    lines = (
        Line("dashed", width=0.12, dash=1.0, gap=1.0),
        UNPAINTED,
        Line("dashed", width=0.12, dash=1, gap=1),
    )
    road = Road(swing=0.004, lane_widths=(2.6, 2.6), lines=lines, shoulder=0.35, asphalt=120, verge="forest")
    return Scene(road, weather(rng), motion=drive(rng, speed=12.0))


def _thin_lines(rng: Rng) -> Scene:
    lines = (Line(width=0.10), LONG_DASHED, LONG_DASHED, Line(width=0.10))
    road = Road(swing=0.002, lane_widths=(3.66,) * 3, lines=lines, driven=1, asphalt=128)
    return Scene(road, weather(rng), motion=drive(rng))


def _wide_dashes(rng: Rng) -> Scene:
    lines = (EDGE, NARROW_DASHED, SHORT_DASHED, Line(width=0.30))
    road = Road(swing=0.002, lane_widths=(3.5,) * 3, lines=lines, driven=1)
    return Scene(road, weather(rng), motion=drive(rng))


def _double_lines(rng: Rng) -> Scene:
    line = Line(width=0.12)
    more = ((-1.88, line), (-1.62, line))
    road = Road(swing=0.004, lines=(EDGE, UNPAINTED, EDGE), more_lines=more, verge="forest")
    return Scene(road, weather(rng), motion=drive(rng))


def _yellow_lines(rng: Rng) -> Scene:
    yellow, white = Line(width=0.12, colour="yellow"), Line(width=0.12)
    road = Road(
        swing=0.003,
        lines=(white, UNPAINTED, white),
        more_lines=((-1.87, yellow), (-1.60, replace(yellow, painted="dashed", dash=3.0, gap=9.0))),
        asphalt=104,
    )
    return Scene(road, weather(rng), motion=drive(rng))


def _road_works(rng: Rng) -> Scene:
    """Yellow lines over white ones that are still there."""
    yellow = Line(width=0.15, colour="yellow")
    road = Road(
        swing=0.002,
        lane_widths=(3.5,) * 3,
        lines=(SOLID, DASHED, DASHED, SOLID),
        more_lines=((-1.35, yellow), (1.25, replace(yellow, painted="dashed", dash=1.0, gap=1.5))),
        asphalt=106,
    )
    return Scene(road, weather(rng), motion=drive(rng))


def _worn_paint(rng: Rng) -> Scene:
    lines = tuple(replace(line, wear=rng.uniform(0.4, 0.62)) for line in (SOLID, NARROW_DASHED, SOLID))
    return Scene(Road(swing=0.003, lines=lines, asphalt=122), weather(rng), motion=drive(rng))


def _merging_lines(rng: Rng) -> Scene:
    """The lane on the right ends: its outer line comes in until it is this lane's border."""
    outer = replace(SOLID, bend=-3.5, bend_at=12.0, bend_over=50.0)
    inner = replace(SHORT_DASHED, end=38.0)
    road = Road(
        swing=0, lane_widths=(3.5,) * 3, lines=(SOLID, DASHED, inner, outer), driven=1, verge="forest"
    )
    return Scene(road, weather(rng), motion=Motion(start=float(rng.uniform(0, 8))))


def _splitting_lines(rng: Rng) -> Scene:
    """A lane leaves to the right: a line parts from the border, with hatching between."""
    leaving = replace(SOLID, bend=4.5, bend_at=14.0, bend_over=60.0)
    road = Road(
        swing=0,
        curvature=0.0015,
        lines=(SOLID, DASHED, replace(SHORT_DASHED, end=20.0)),
        more_lines=((1.75, replace(SOLID, begin=20.0)), (2.05, replace(leaving, begin=20.0))),
        marks=(marks.gore(24.0, 74.0, 1.9, 4.3),),
        shoulder=4.5,
    )
    return Scene(road, weather(rng), motion=Motion(start=float(rng.uniform(8, 16))))


ROAD_CATEGORIES: dict[str, Make] = {
    name: aged(make)
    for name, make in {
        "straight": _straight,
        "curve": _curve,
        "tight_curve": _tight_curve,
        "s_curve": _s_curve,
        "crest": _crest,
        "dip": _dip,
        "roll": _roll,
        "shaking_camera": _shaking_camera,
        "motorway": _motorway,
        "narrow_road": _narrow_road,
        "thin_lines": _thin_lines,
        "wide_dashes": _wide_dashes,
        "double_lines": _double_lines,
        "yellow_lines": _yellow_lines,
        "road_works": _road_works,
        "worn_paint": _worn_paint,
        "merging_lines": _merging_lines,
        "splitting_lines": _splitting_lines,
    }.items()
}
