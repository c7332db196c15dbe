# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The named categories of scenes that are hard by their light, by what stands on the road, by the camera."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from lane_dp_ros.scenes.barriers import Grass, GuardRail, Posts
from lane_dp_ros.scenes.light import Light
from lane_dp_ros.scenes.objects import SceneObject
from lane_dp_ros.scenes.road import Line, Road
from lane_dp_ros.scenes.scene import Motion, Scene
from lane_dp_ros.scenes.sensor import Sensor
from lane_dp_ros.scenes.structures import Bridge, Island
from lane_dp_ros.scenes.vehicles import CAR, ESTATE, LORRY, VAN, Vehicle

Rng = np.random.Generator

COLOURS = (
    (46.0, 44.0, 42.0), (132.0, 128.0, 124.0), (205.0, 206.0, 206.0), (92.0, 54.0, 34.0), (38.0, 34.0, 112.0),
    (70.0, 66.0, 62.0), (84.0, 92.0, 60.0),
)  # fmt: skip
NEAR_SIDE, FAR_SIDE = 0.0, -3.5  # [m] the middles of the driven lane and of the one left of it


def _sunny(rng: Rng, **fields: object) -> Light:
    """Return clear weather: shadows are six times darker than what lies in the sun."""
    azimuth, elevation = float(rng.uniform(60, 150) * rng.choice([-1, 1])), float(rng.uniform(30, 48))
    clear: dict = {"sky": 0.22, "sun": 1.9, "azimuth": azimuth, "elevation": elevation, "haze_length": 1500.0}
    return Light(**(clear | fields))


def _low_sun(rng: Rng, elevation: float, **fields: object) -> Light:
    """Return a sun that stands low, nearly straight ahead."""
    low: dict = {"sky": 0.22, "sun": 1.1, "azimuth": float(rng.uniform(-12, 12)), "haze_length": 700.0}
    return Light(elevation=elevation, **(low | fields))


def _drive(rng: Rng, speed: float = 14.0) -> Motion:
    return Motion(start=float(rng.uniform(100, 600)), speed=speed, lateral=float(rng.uniform(-0.25, 0.25)))


def _vehicle(rng: Rng, s: float, n: float, speed: float = 0.0, **fields: object) -> Vehicle:
    """Return a vehicle of any kind and colour."""
    model = (CAR, ESTATE, CAR, VAN)[rng.integers(4)]
    chosen: dict = {"model": model, "colour": COLOURS[rng.integers(len(COLOURS))]}
    return Vehicle(s, n, speed=speed, **(chosen | fields))


def _traffic(rng: Rng, motion: Motion, lamps: float = 0.0) -> tuple[SceneObject, ...]:
    """Return a vehicle ahead, and some that come towards the camera."""
    ahead = _vehicle(rng, motion.start + rng.uniform(16, 26), NEAR_SIDE, motion.speed + 1, lamps=0.4 * lamps)
    coming = [
        _vehicle(rng, motion.start + s + rng.uniform(-8, 8), FAR_SIDE, -13.0, oncoming=True, lamps=lamps)
        for s in (38, 70, 105)
    ]
    return (ahead, *coming)


def _over_exposure(rng: Rng) -> Scene:
    """The exposure suits the dark wood: sunlit road and paint are nearly white alike."""
    light = _sunny(
        rng, leaves=(2.6, 60.0), roughness=0.33, azimuth=float(rng.uniform(30, 55)), elevation=28.0
    )
    road = Road(swing=0.003, asphalt=142, verge="forest")
    sensor = Sensor(exposure=float(rng.uniform(2.4, 3.0)), flare=0.10)
    return Scene(road, light, sensor=sensor, motion=_drive(rng))


def _low_sun_glare(rng: Rng) -> Scene:
    light = _low_sun(rng, elevation=float(rng.uniform(13, 20)), roughness=0.42)
    motion = _drive(rng)
    sensor = Sensor(exposure=1.1, flare=0.08)
    return Scene(Road(swing=0.002, asphalt=104), light, _traffic(rng, motion)[1:], sensor, motion)


def _night(rng: Rng) -> Scene:
    motion = _drive(rng)
    light = Light(sky=0.0025, head_lamps=0.55, roughness=0.42, haze_length=900.0)
    sensor = Sensor(exposure=3.5, flare=0.06, full_well=900, dark=9.0, blur=0.8)
    return Scene(Road(swing=0.003, asphalt=92), light, _traffic(rng, motion, lamps=1.0), sensor, motion)


def _night_in_town(rng: Rng) -> Scene:
    motion = _drive(rng, speed=10.0)
    light = Light(sky=0.006, head_lamps=0.25, street_lamps=0.22, roughness=0.40, haze_length=900.0)
    sensor = Sensor(exposure=4.0, flare=0.06, full_well=1200, dark=8.0, blur=0.7)
    road = Road(swing=0.001, verge="town", kerb=0.12, lane_widths=(3.25, 3.25))
    return Scene(road, light, (Posts(5.5, 30.0), *_traffic(rng, motion, lamps=0.8)), sensor, motion)


def _tree_shadows(rng: Rng) -> Scene:
    light = _sunny(rng, leaves=(-60.0, 60.0))
    return Scene(Road(swing=0.004, verge="forest"), light, sensor=Sensor(exposure=1.1), motion=_drive(rng))


def _shade_along_the_road(rng: Rng) -> Scene:
    """Trees before the sun, on the right: the border of their shade runs along the lane, as a line would."""
    border, azimuth = float(rng.uniform(-0.8, 1.2)), float(rng.uniform(60, 120))
    light = _sunny(rng, leaves=(border, 60.0), azimuth=azimuth)
    return Scene(Road(swing=0.003, verge="forest"), light, sensor=Sensor(), motion=_drive(rng))


def _vehicle_shadows(rng: Rng) -> Scene:
    motion = _drive(rng)
    light = _sunny(rng, elevation=22.0, azimuth=float(rng.choice([-80, 75])))
    lorry = Vehicle(motion.start + 14, -3.4, LORRY, (150.0, 140.0, 120.0), speed=motion.speed + 1.5)
    road = Road(
        swing=0.002, lane_widths=(3.5, 3.5, 3.5), lines=(Line(), Line("dashed"), Line("dashed"), Line())
    )
    parked = [_vehicle(rng, motion.start + s, 3.9) for s in (9, 17, 40)]
    return Scene(road, light, (lorry, *parked, *_traffic(rng, motion)[:1]), Sensor(), motion)


def _bridge(rng: Rng) -> Scene:
    motion = _drive(rng)
    bridges = tuple(Bridge(motion.start + s) for s in (24, 120))
    return Scene(Road(swing=0.001), _sunny(rng), (*bridges, GuardRail(4.2)), Sensor(metering=0.17), motion)


def _wet(rng: Rng) -> Scene:
    motion = _drive(rng)
    light = Light(sky=0.8, wetness=float(rng.uniform(0.6, 0.9)), roughness=0.25, haze_length=220.0)
    return Scene(Road(swing=0.003), light, _traffic(rng, motion, lamps=0.25), Sensor(flare=0.04), motion)


def _wet_night(rng: Rng) -> Scene:
    motion = _drive(rng, speed=10.0)
    light = Light(
        sky=0.006,
        head_lamps=0.3,
        street_lamps=0.12,
        wetness=0.8,
        roughness=0.2,
        haze_length=500.0,
    )
    sensor = Sensor(exposure=4.0, flare=0.06, full_well=1000, dark=9.0, blur=0.8)
    objects = (Posts(5.5, 30.0), *_traffic(rng, motion, lamps=0.8))
    return Scene(Road(swing=0.002, verge="town", kerb=0.12), light, objects, sensor, motion)


def _vehicles(rng: Rng) -> Scene:
    """Vehicles hide paint: one drives on the line, one beside it, others come towards the camera."""
    motion = _drive(rng)
    crossing = _vehicle(rng, motion.start + 11, 1.5, motion.speed + 1.2)
    beside = _vehicle(rng, motion.start + 30, 3.5, motion.speed - 1)
    road = Road(
        swing=0.002, lane_widths=(3.5, 3.5, 3.5), lines=(Line(), Line("dashed"), Line("dashed"), Line())
    )
    light = _sunny(rng, sky=0.3, sun=1.6)
    return Scene(road, light, (crossing, beside, *_traffic(rng, motion)), Sensor(), motion)


def _parked_cars(rng: Rng) -> Scene:
    motion = _drive(rng, speed=9.0)
    places = motion.start + np.cumsum(rng.uniform(5.2, 8.0, 14))
    parked = tuple(_vehicle(rng, float(s), float(rng.uniform(2.45, 2.65))) for s in places)
    lines = (Line("none"), Line("dashed", dash=3.0, gap=6.0), Line(width=0.12))
    road = Road(swing=0.001, lane_widths=(3.1, 3.1), lines=lines, shoulder=2.2, kerb=0.12, verge="town")
    return Scene(road, _sunny(rng), (*parked, *_traffic(rng, motion)[1:]), Sensor(), motion)


def _grass_over_the_line(rng: Rng) -> Scene:
    grass = tuple(
        Grass(n, height, 0.9, seed)
        for seed, (n, height) in enumerate([(1.93, 0.30), (2.15, 0.42), (-5.4, 0.38), (-5.55, 0.45)])
    )
    road = Road(
        swing=0.004,
        shoulder=0.15,
        overgrowth=0.12,
        lines=(Line(width=0.12), Line("dashed"), Line(width=0.12)),
    )
    return Scene(road, _sunny(rng, sky=0.35, sun=1.6), grass, Sensor(), _drive(rng))


def _guard_rails(rng: Rng) -> Scene:
    motion = _drive(rng, speed=22.0)
    rails = (GuardRail(2.9), GuardRail(-6.6))
    road = Road(curvature=0.002 * rng.choice([-1, 1]), swing=0.001, shoulder=1.0)
    return Scene(road, _sunny(rng), (*rails, *_traffic(rng, motion)), Sensor(), motion)


def _traffic_island(rng: Rng) -> Scene:
    motion = _drive(rng, speed=10.0)
    islands = tuple(Island(motion.start + s, -2.2, width=1.0) for s in (13, 60))
    road = Road(swing=0.001, lane_widths=(3.5, 3.9), kerb=0.12, verge="town")
    return Scene(road, _sunny(rng), (*islands, Posts(4.5, 28.0)), Sensor(), motion)


def _unequal_cameras(rng: Rng) -> Scene:
    """The right camera takes half as much light again, or a third less, and both are out of focus."""
    sensor = Sensor(blur=1.1, shake=1.0, right_gain=float(rng.choice([0.65, 1.5])), vignette=0.5, jpeg=75)
    motion = _drive(rng)
    return Scene(Road(swing=0.003), _sunny(rng), _traffic(rng, motion)[:1], sensor, motion)


CONDITION_CATEGORIES: dict[str, Callable[[np.random.Generator], Scene]] = {
    "over_exposure": _over_exposure,
    "low_sun": _low_sun_glare,
    "night": _night,
    "night_in_town": _night_in_town,
    "tree_shadows": _tree_shadows,
    "shade_along_the_road": _shade_along_the_road,
    "vehicle_shadows": _vehicle_shadows,
    "bridge": _bridge,
    "wet": _wet,
    "wet_night": _wet_night,
    "vehicles": _vehicles,
    "parked_cars": _parked_cars,
    "grass_over_the_line": _grass_over_the_line,
    "guard_rails": _guard_rails,
    "traffic_island": _traffic_island,
    "unequal_cameras": _unequal_cameras,
}
