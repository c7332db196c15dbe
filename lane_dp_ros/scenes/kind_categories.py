# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The named categories of scenes with each kind of line: two side by side, yellow ones, of several widths."""

from __future__ import annotations

from dataclasses import replace

from lane_dp_ros.scenes.category_parts import Make, Rng, aged, drive, weather
from lane_dp_ros.scenes.road import UNPAINTED, Colour, Line, Road
from lane_dp_ros.scenes.scene import Scene

WIDTHS = (0.10, 0.12, 0.15, 0.20, 0.25, 0.30)  # [m] that road authorities ask for
DASHES = ((3.0, 6.0), (6.0, 12.0), (3.0, 9.0), (4.0, 8.0), (1.5, 1.5))  # [m] of paint, without


def _double(rng: Rng, left: Line, right: Line) -> Scene:
    """Return a road whose directions are parted by two lines, of one colour and width."""
    colour: Colour = "yellow" if rng.uniform() < 0.4 else "white"
    width = float(rng.choice(WIDTHS[:3]))
    apart = width + float(rng.uniform(0.08, 0.2))
    lane = float(rng.uniform(3.1, 3.7))
    pair = [replace(line, width=width, colour=colour) for line in (left, right)]
    edge = Line(width=float(rng.choice(WIDTHS[1:])))
    return Scene(
        Road(
            curvature=float(rng.uniform(-0.004, 0.004)),
            swing=0.002,
            lane_widths=(lane, lane),
            lines=(edge, UNPAINTED, edge),
            more_lines=((-(lane + apart) / 2, pair[0]), (-(lane - apart) / 2, pair[1])),
            verge=("fields", "forest")[rng.integers(2)],
        ),
        weather(rng),
        motion=drive(rng),
    )


def _double_solid(rng: Rng) -> Scene:
    return _double(rng, Line(), Line())


def _double_mixed(rng: Rng) -> Scene:
    """A solid line beside a dashed one: whoever has the dashes on his side may cross."""
    dash, gap = DASHES[rng.integers(len(DASHES))]
    solid, dashed = Line(), Line("dashed", dash=dash, gap=gap)
    return _double(rng, *((solid, dashed) if rng.uniform() < 0.5 else (dashed, solid)))


def _yellow_widths(rng: Rng) -> Scene:
    """Yellow lines on one side of the lane or on both, each of another width."""
    dash, gap = DASHES[rng.integers(len(DASHES))]
    kinds = [Line(), Line("dashed", dash=dash, gap=gap), Line()]
    yellow = ((True, True, True), (False, True, False), (True, False, True), (False, True, True))[
        rng.integers(4)
    ]
    lines = tuple(
        replace(line, width=float(rng.choice(WIDTHS)), colour="yellow" if is_yellow else "white")
        for line, is_yellow in zip(kinds, yellow, strict=True)
    )
    road = Road(curvature=float(rng.uniform(-0.004, 0.004)), swing=0.002, lines=lines)
    return Scene(road, weather(rng), motion=drive(rng))


KIND_CATEGORIES: dict[str, Make] = {
    name: aged(make)
    for name, make in {
        "double_solid": _double_solid,
        "double_mixed": _double_mixed,
        "yellow_widths": _yellow_widths,
    }.items()
}
