# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The borders of a rendered carriageway as a careful person would label them, but exact."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.scenes.objects import SceneObject
from lane_dp_ros.scenes.road import Road
from lane_dp_ros.scenes.seen_part import Places, exact, fitted_ground, on_ground, seen_part, steps_ahead
from lane_dp_ros.scenes.structures import Island
from lane_dp_ros.scenes.surface import Surface
from lane_dp_ros.scenes.view import View
from lane_dp_ros.scenes.visibility import visible_border
from lane_dp_ros.tools.evaluation.annotations import Label

GUTTER = 0.2  # [m] wide at least is what lies along a border to be a gutter
GUTTER_GAP = 0.05  # [m] from a gutter to the road's border, at most


@dataclass(frozen=True)
class Border:
    """A border of the carriageway, `n` [m] right of the road's axis, from `begin` to `end` [m] along it.

    `outward` is 1 where the road lies left of it, -1 where it lies right of it; `what` ends it there.
    """

    id: str
    what: str
    n: float
    outward: int
    begin: float = -np.inf
    end: float = np.inf


def edge_labels(
    view: View, surface: Surface, image: NDArray[np.uint8], objects: tuple[SceneObject, ...]
) -> tuple[Label, ...]:
    """Return the labels, of kind "edge", of the carriageway's borders that the left camera sees.

    `image` (H, W, 3) BGR is the left picture, `surface` what it shows. They run along the foot of a kerb or
    of a traffic island, and where the asphalt or its gutter ends in the verge, up to 45 m ahead; not where
    something hides or covers them. One of which less than half can be told from the road is not sure.
    """
    ground = fitted_ground(view, surface)
    every = (_label(view, surface, image, border, ground) for border in borders(view.road, objects))
    return tuple(label for label in every if label)


def borders(road: Road, objects: tuple[SceneObject, ...]) -> Iterator[Border]:
    """Yield both borders of a road, then those of the traffic islands on it."""
    for n, side, name in zip(road.borders, (-1, 1), ("left", "right"), strict=True):
        yield Border(f"edge_{name}", _what_ends(road, n), n, side)
    for i, island in enumerate(each for each in objects if isinstance(each, Island)):
        for side, name in ((1, "left"), (-1, "right")):  # of the island: there the road lies
            n, end = island.n - side * island.width / 2, island.s + island.length
            yield Border(f"island{i}_{name}", "island", n, side, island.s, end)


def _what_ends(road: Road, n: float) -> str:
    """Return what ends the asphalt at its border n [m]: a kerb, a gutter, the verge."""
    if road.kerb:
        return "kerb"
    outer = (abs(abs(at - n) - strip.width / 2) for at, strip in road.strips if strip.width >= GUTTER)
    return "gutter" if min(outer, default=np.inf) < GUTTER_GAP else "verge"


def _label(
    view: View, surface: Surface, image: NDArray[np.uint8], border: Border, ground: NDArray[np.float64]
) -> Label | None:
    s = steps_ahead()
    along = s + view.course.position
    places = Places.of(view, s, np.full_like(s, border.n))
    there = (along >= border.begin) & (along <= border.end)
    _, v, u = places.pixels(view)
    bare = cv2.dilate(surface.ground.astype(np.uint8), np.ones((3, 3), np.uint8)) > 0
    in_sight = there & places.unhidden(view, surface) & bare[v, u]
    visible = visible_border(image, view, (border.n, border.outward), s, in_sight)
    part, sure = seen_part(s, there, in_sight, visible)
    uv = places.uv[part]
    xz = on_ground(uv, ground, view.camera)
    if len(xz) < 2:
        return None
    return Label(border.id, "edge", sure, uv, xz, exact(places.points[part]), border=border.what)
