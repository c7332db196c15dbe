# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What scenes of the named categories have in common: standard lines, the weather, the drive."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from lane_dp_ros.scenes.light import Light
from lane_dp_ros.scenes.road import UNPAINTED, Line
from lane_dp_ros.scenes.scene import Motion, Scene

Rng = np.random.Generator
Make = Callable[[Rng], Scene]

NARROW_DASHED = Line("dashed", width=0.12, dash=3.0, gap=6.0)
WIDE_DASHED = Line("dashed", width=0.15, dash=6.0, gap=12.0)  # motorways
SHORT_DASHED = Line("dashed", width=0.30, dash=3.0, gap=3.0)  # beside turning and leaving lanes
LONG_DASHED = Line("dashed", width=0.10, dash=3.05, gap=9.14)  # 10 and 30 feet
EDGE = Line("solid", width=0.25)
NO_LINES = (UNPAINTED, UNPAINTED, UNPAINTED)


def side(rng: Rng) -> int:
    """Return -1 (left) or 1 (right)."""
    return int(rng.choice([-1, 1]))


def weather(rng: Rng) -> Light:
    """Return an overcast sky, or the sun from anywhere but straight ahead, in clear or in hazy air."""
    if rng.uniform() < 0.4:
        return Light(sky=float(rng.uniform(0.85, 1.05)), haze_length=float(rng.choice([250.0, 450.0])))
    azimuth = float(rng.uniform(50, 180) * side(rng))
    sky, sun = (float(rng.uniform(low, high)) for low, high in ((0.3, 0.45), (1.0, 1.35)))
    haze = float(rng.choice([500.0, 1500.0]))
    return Light(sky=sky, sun=sun, azimuth=azimuth, elevation=float(rng.uniform(25, 50)), haze_length=haze)


def drive(rng: Rng, **fields: float) -> Motion:
    """Return a drive that begins anywhere on a road on which every place is alike."""
    return Motion(start=float(rng.uniform(0, 600)), lateral=float(rng.uniform(-0.3, 0.3)), **fields)


def aged(make: Make) -> Make:
    """Return a category whose asphalt is darker or lighter from seed to seed."""

    def aged(rng: Rng) -> Scene:
        """Make the scene and change its asphalt."""
        scene = make(rng)
        return replace(scene, road=replace(scene.road, asphalt=scene.road.asphalt * rng.uniform(0.8, 1.15)))

    return aged
