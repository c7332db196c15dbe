# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The named categories of scenes with something along the road that looks like a lane line, but is none."""

from __future__ import annotations

from dataclasses import replace

from lane_dp_ros.scenes.category_parts import (
    EDGE,
    LONG_DASHED,
    NARROW_DASHED,
    Make,
    Rng,
    drive,
    side,
    weather,
)
from lane_dp_ros.scenes.distractors import DISTRACTORS, Lay, concrete_joints, footpath_border, light_strip
from lane_dp_ros.scenes.light import Light
from lane_dp_ros.scenes.road import DASHED, SOLID, UNPAINTED, Line, Road
from lane_dp_ros.scenes.scene import Scene
from lane_dp_ros.scenes.sensor import Sensor
from lane_dp_ros.scenes.structures import Island
from lane_dp_ros.scenes.vehicles import CAR, LORRY, VAN, Vehicle
from lane_dp_ros.scenes.wall_shapes import Verge

CENTRE_LINES = (DASHED, NARROW_DASHED, LONG_DASHED, SOLID, Line(width=0.12))
EDGE_LINES = (SOLID, Line(width=0.12), EDGE, UNPAINTED)

BOTH = ("light_strip", "ghost_lines", "crack_sealing", "concrete_joints", "light_gutter")
BESIDE_LINES = (*BOTH, "cracks", "footpath_border")  # and tram rails, among the markings
WITHOUT_LINES = (*BOTH, "tram_rails")  # and cracks, there too


def any_road(rng: Rng) -> Road:
    """Return a road of two lanes, slightly bent, with lines of any kind, between grass, woods or houses."""
    width = float(rng.uniform(3.1, 3.7))
    verge: Verge = ("fields", "forest", "town")[rng.integers(3)]
    edge = EDGE_LINES[rng.integers(len(EDGE_LINES))]
    return Road(
        curvature=float(rng.uniform(-0.002, 0.002)),
        swing=float(rng.uniform(0, 0.003)),
        lane_widths=(width, width),
        lines=(edge, CENTRE_LINES[rng.integers(len(CENTRE_LINES))], edge),
        shoulder=float(rng.uniform(0.3, 0.9)),
        kerb=0.12 if verge == "town" else 0.0,
        verge=verge,
        asphalt=float(rng.uniform(84, 128)),
    )


def unpainted(road: Road) -> Road:
    """Return a road without its lines."""
    return replace(road, lines=(UNPAINTED,) * len(road.lines), more_lines=())


def _with(lay: Lay, painted: bool = True) -> Make:
    """Return the category of any road with a distractor on it."""

    def make(rng: Rng) -> Scene:
        """Make the road and lay the distractor on it."""
        road = any_road(rng) if painted else unpainted(any_road(rng))
        if lay is concrete_joints:
            road = replace(road, asphalt=float(rng.uniform(142, 172)))
        return Scene(lay(rng, road), weather(rng), motion=drive(rng))

    return make


def _slush(rng: Rng) -> Scene:
    return _winter(rng, any_road(rng))


def _no_paint_slush(rng: Rng) -> Scene:
    return _winter(rng, unpainted(any_road(rng)))


def _winter(rng: Rng, road: Road) -> Scene:
    """Return a road with slush on it, wet and dark, under a grey sky."""
    road = replace(road, asphalt=float(rng.uniform(66, 86)))
    light = Light(sky=float(rng.uniform(0.8, 1.0)), wetness=float(rng.uniform(0.0, 0.35)), haze_length=200.0)
    return Scene(DISTRACTORS["slush"](rng, road), light, motion=drive(rng, speed=10.0))


def _wet_reflections(rng: Rng) -> Scene:
    """Dusk and rain: the lamps of vehicles ahead and oncoming ones stand as streaks in the road."""
    return _at_dusk(rng, any_road(rng))


def _no_paint_wet_reflections(rng: Rng) -> Scene:
    return _at_dusk(rng, unpainted(any_road(rng)))


def _at_dusk(rng: Rng, road: Road) -> Scene:
    motion = drive(rng, speed=10.0)
    ahead = Vehicle(
        motion.start + rng.uniform(13, 24), 0.0, (CAR, VAN, LORRY)[rng.integers(3)], speed=11.0, lamps=0.7
    )
    far_side = -road.lane_widths[0]
    coming = [
        Vehicle(motion.start + s, far_side, speed=-10.0, oncoming=True, lamps=1.0)
        for s in (rng.uniform(22, 34), rng.uniform(48, 60), 90.0)
    ]
    light = Light(
        sky=float(rng.uniform(0.05, 0.16)),
        head_lamps=0.12,
        roughness=0.2,
        wetness=float(rng.uniform(0.75, 1.0)),
        streak=float(rng.uniform(14, 26)),
        haze_length=400.0,
    )
    sensor = Sensor(metering=0.10, flare=0.05, full_well=1500, dark=9.0, blur=0.7)
    return Scene(road, light, (ahead, *coming), sensor, motion)


def _no_paint_traffic_island(rng: Rng) -> Scene:
    """Kerbed islands between the directions of a road without lines."""
    motion = drive(rng, speed=10.0)
    road = replace(unpainted(any_road(rng)), lane_widths=(3.5, 3.9), kerb=0.12, verge="town", swing=0.001)
    islands = tuple(
        Island(motion.start + s, -2.4, length=float(rng.uniform(8, 18)), width=1.1)
        for s in (rng.uniform(9, 14), 60.0)
    )
    return Scene(road, weather(rng), islands, motion=motion)


def _no_paint_footpath(rng: Rng) -> Scene:
    """A path on one side; on the other one, too, or a trench before it."""
    road = footpath_border(rng, unpainted(any_road(rng)))
    road = footpath_border(rng, road) if side(rng) > 0 else light_strip(rng, road)
    return Scene(road, weather(rng), motion=drive(rng))


DISTRACTOR_CATEGORIES: dict[str, Make] = {
    **{name: _with(DISTRACTORS[name]) for name in BESIDE_LINES},
    "slush": _slush,
    "wet_reflections": _wet_reflections,
    **{f"no_paint_{name}": _with(DISTRACTORS[name], painted=False) for name in WITHOUT_LINES},
    "no_paint_slush": _no_paint_slush,
    "no_paint_wet_reflections": _no_paint_wet_reflections,
    "no_paint_traffic_island": _no_paint_traffic_island,
    "no_paint_footpath": _no_paint_footpath,
}
