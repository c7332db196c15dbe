# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Where strips that are no lane lines lie on a rendered road, and their greys."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from lane_dp_ros.scenes.category_parts import Rng
from lane_dp_ros.scenes.road import Line, Road

BESIDE_PAINT = 0.45  # [m] from the middle of a line to a strip that is seen beside it


def across(rng: Rng, road: Road) -> float:
    """Return any place across the road [m], not at its very border."""
    left, right = road.borders
    return float(rng.uniform(left + 0.3, right - 0.3))


def beside_paint(rng: Rng, road: Road) -> float:
    """Return a place [m] in or near the driven lane, beside its lines; any where there are too many."""
    left, right = road.borders
    places = rng.uniform(max(left + 0.4, -3.0), min(right - 0.4, 3.0), 20)
    apart = np.array([[abs(n - line) for line, _ in road.placed_lines] or [np.inf] for n in places]).min(
        axis=1
    )
    return float(places[np.argmax(apart > BESIDE_PAINT)])


def shifted(rng: Rng, line: Line) -> Line:
    """Return a line that wavers at a place of its own."""
    return replace(line, phase=float(rng.uniform(0, 500)))


def grey(level: float) -> tuple[float, float, float]:
    """Return a grey that is as warm as asphalt, BGR, at most as bright as paint."""
    level = min(level, 215.0)
    return level, 0.995 * level, 0.985 * level
