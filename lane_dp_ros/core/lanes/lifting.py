# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""From lines in road coordinates to lanes in the left optical frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from lane_dp_ros.core.birdseye.birds_eye import BirdsEyeView
from lane_dp_ros.core.lanes.candidate import Candidate, LaneLine
from lane_dp_ros.core.types import Lane, LaneRole, ego_roles

SPACING = 0.25  # m along the axis; on the outside of the sharpest bend points are still within 0.5 m
MIN_RADIUS = 0.1  # of the axis's; a line nearer to the centre of the bend is none
FAINTEST = 0.01  # of opacity; what is told can be seen


def left_to_right(candidates: Sequence[Candidate]) -> list[Candidate]:
    """Return candidates in the order in which they lie at their nearest points."""
    return sorted(candidates, key=lambda candidate: float(candidate.line.n[0]))


def to_lanes(candidates: Sequence[Candidate], view: BirdsEyeView) -> tuple[Lane, ...]:
    """Return the lanes of candidates, from left to right."""
    ordered = left_to_right(candidates)
    roles = ego_roles([float(candidate.line.n[0]) for candidate in ordered])
    return tuple(_lane(candidate, view, role) for candidate, role in zip(ordered, roles, strict=True))


def to_road_edges(candidates: Sequence[Candidate], view: BirdsEyeView) -> tuple[Lane, ...]:
    """Return the road edges of candidates, from left to right, the nearest on each side with an ego role."""
    probable = (max(candidate.probability[1], FAINTEST) for candidate in left_to_right(candidates))
    return tuple(
        replace(edge, kind="edge", paint_width=0.0, confidence=confidence)
        for edge, confidence in zip(to_lanes(candidates, view), probable, strict=True)
    )


def _lane(candidate: Candidate, view: BirdsEyeView, role: LaneRole) -> Lane:
    line, marking = candidate.line, candidate.marking
    first, last = _seen(line, view)
    s = np.linspace(first, last, max(2, int(np.ceil((last - first) / SPACING)) + 1))
    radius = max(1 - view.axis.curvature * float(line.n[0]), MIN_RADIUS)
    return Lane(
        points=view.to_points(s, np.interp(s, line.s, line.n)),
        confidence=max(candidate.probability[0], FAINTEST),
        paint_width=candidate.evidence.paint_width,
        role=role,
        curvature=view.axis.curvature / radius + line.bend,
        lateral_offset=float(line.n[0]),
        kind=marking.kind,
        colour=marking.colour,
        sides=marking.sides,
    )


def _seen(line: LaneLine, view: BirdsEyeView) -> tuple[float, float]:
    """Return s [m] between which a line lies in the picture; all of it where the view is too coarse."""
    s = line.s[view.seen[line.rows, view.nearest_columns(line.n)]]
    return (float(s[0]), float(s[-1])) if len(s) > 1 else (float(line.s[0]), float(line.s[-1]))
