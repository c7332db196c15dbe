# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Marks on a rendered road that are no lane lines, each from where it is and how large. All lengths in m."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np

from lane_dp_ros.scenes.road import Colour, Mark

STRIPE, STRIPE_GAP = 0.5, 1.0  # of hatching


def bar(s: float, length: float, left: float, right: float, colour: Colour = "white") -> Mark:
    """Return a rectangle across the road, such as a stop line, from s on."""
    return Mark((s, s + length), (left, left), (right, right), colour)


def zebra(s: float, length: float, left: float, right: float) -> Mark:
    """Return a crossing: stripes 0.5 wide along the road."""
    return replace(bar(s, length, left, right), stripe=0.5, gap=0.5, slant=np.pi / 2)


def give_way(s: float, left: float, right: float) -> Mark:
    """Return a broken bar across the road: 0.5 of paint, 0.25 without."""
    return replace(bar(s, 0.5, left, right), stripe=0.5, gap=0.25, slant=np.pi / 2)


def island(s: float, length: float, left: float, right: float, chevron: bool) -> Mark:
    """Return hatching between two lines."""
    return replace(bar(s, length, left, right), stripe=STRIPE, gap=STRIPE_GAP, slant=0.9, chevron=chevron)


def gore(s: float, end: float, left: float, right: float) -> Mark:
    """Return hatching in the tip between two lines that part, from none at s to its full width at the end."""
    along = np.linspace(s, end, 12)
    part = (along - s) / (end - s)
    widening = (right - left) * part * part * (3 - 2 * part)
    return Mark(
        tuple(along.tolist()),
        (left,) * len(along),
        tuple((left + widening).tolist()),
        stripe=STRIPE,
        gap=STRIPE_GAP,
        slant=-0.8,
        chevron=True,
    )


def arrow(
    s: float, n: float, kind: Literal["ahead", "left", "right"], repeat: float = 0.0
) -> tuple[Mark, ...]:
    """Return an arrow 5 long that begins at s, in the middle n of a lane."""
    if kind == "ahead":
        outline = (s, s + 3.0, s + 3.0001, s + 5.0)
        half = np.array([0.08, 0.08, 0.35, 0.0])
        return (Mark(outline, tuple((n - half).tolist()), tuple((n + half).tolist()), repeat=repeat),)
    side = 1 if kind == "right" else -1
    shaft = (n - 0.35 * side, n - 0.2 * side)
    turn = (n - 0.35 * side, n + 0.1 * side)
    head_s = (s + 2.0, s + 3.25, s + 4.5)
    head = ((n + 0.1 * side,) * 3, (n + 0.1 * side, n + 0.75 * side, n + 0.1 * side))
    shapes = (
        ((s, s + 3.6), (shaft[0],) * 2, (shaft[1],) * 2),
        ((s + 2.9, s + 3.6), (turn[0],) * 2, (turn[1],) * 2),
    )
    marks = [Mark(along, *_sorted(a, b), repeat=repeat) for along, a, b in (*shapes, (head_s, *head))]
    return tuple(marks)


def joint(spacing: float, left: float, right: float) -> Mark:
    """Return joints right across the road, every `spacing`."""
    return replace(bar(0.0, 0.03, left, right, "tar"), repeat=spacing)


def seams(rng: np.random.Generator) -> tuple[Mark, ...]:
    """Return tar seams across the road and repaired patches, scattered over 80 m and again and again."""
    marks = [
        replace(bar(rng.uniform(0, 80), rng.uniform(0.04, 0.1), -5.5, 2.2, "tar"), repeat=80.0)
        for _ in range(5)
    ]
    for _ in range(4):
        left = rng.uniform(-5, 1)
        patch = bar(rng.uniform(0, 70), rng.uniform(1.5, 6), left, left + rng.uniform(0.6, 1.5), "patch")
        marks.append(replace(patch, repeat=80.0))
    return tuple(marks)


def _sorted(a: tuple[float, ...], b: tuple[float, ...]) -> tuple[tuple[float, ...], tuple[float, ...]]:
    return (a, b) if sum(a) < sum(b) else (b, a)
