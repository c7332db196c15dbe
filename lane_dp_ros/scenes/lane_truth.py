# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The lane lines of a rendered scene as a careful person would label them, but exact."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.types import PaintColour
from lane_dp_ros.scenes.road import Line
from lane_dp_ros.scenes.seen_part import (
    SHORT,
    STEP,
    Places,
    exact,
    fitted_ground,
    on_ground,
    seen_part,
    steps_ahead,
)
from lane_dp_ros.scenes.surface import Surface
from lane_dp_ros.scenes.view import View
from lane_dp_ros.scenes.visibility import visible_paint
from lane_dp_ros.tools.evaluation.annotations import Kind, Label

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]

PAINT_SEEN = 0.3  # share of the paint of a whole line that must be left for it to be seen
EGO_BEGINS = 15.0  # [m] ahead by which a line beside the vehicle must have begun
EGO_AT = 8.0  # [m] ahead where the lines beside the vehicle are told
DOUBLE_APART = 0.75  # [m] between the middles of two lines side by side, at most


@dataclass(frozen=True)
class _Seen:
    """The part of a line that is seen: `s` ahead and `aside` right of the axis (N,) [m], its label."""

    s: Floats
    aside: Floats
    label: Label

    @property
    def beside(self) -> float:
        """How far right of the road's axis [m] it is at EGO_AT, or where it begins beyond that."""
        return float(np.interp(EGO_AT, self.s, self.aside))

    def is_double_with(self, other: _Seen) -> bool:
        """Whether both are sure and run side by side over as much as one is sure of."""
        start, end = max(self.s[0], other.s[0]), min(self.s[-1], other.s[-1])
        if other is self or not (self.label.sure and other.label.sure) or end - start < SHORT:
            return False
        s = np.arange(start, end, STEP)
        apart = np.interp(s, self.s, self.aside) - np.interp(s, other.s, other.aside)
        return bool(np.median(np.abs(apart)) < DOUBLE_APART)


def lane_labels(
    view: View, surface: Surface, image: NDArray[np.uint8]
) -> tuple[tuple[Label, ...], list[str | None]]:
    """Return the labels of the lines that the left camera sees, and the ids left and right of the vehicle.

    `image` (H, W, 3) BGR is the left picture, `surface` what it shows. Lines end where their paint does, at
    the picture's border, and where they are hidden or no longer stand out from the road. A line of which less
    than half can be seen is not sure; one that cannot be seen at all is given as far as it lies in sight.
    """
    ground = fitted_ground(view, surface)
    every = (_seen(view, surface, image, i, ground) for i in range(len(view.road.placed_lines)))
    seen = [line for line in every if line]
    labels = tuple(
        replace(line.label, double=any(line.is_double_with(other) for other in seen)) for line in seen
    )
    return labels, _egos(seen, view.pose.lateral)


def _egos(seen: Sequence[_Seen], lateral: float) -> list[str | None]:
    """Return the ids of the lines left and right of the vehicle, which is `lateral` [m] right of the axis."""
    beside = [(line.beside - lateral, line.label.id) for line in seen if line.s[0] < EGO_BEGINS]
    left = max((each for each in beside if each[0] < 0), default=(0.0, None))
    right = min((each for each in beside if each[0] >= 0), default=(0.0, None))
    return [left[1], right[1]]


def _seen(
    view: View, surface: Surface, image: NDArray[np.uint8], number: int, ground: Floats
) -> _Seen | None:
    n, line = view.road.placed_lines[number]
    s = steps_ahead()
    along = s + view.course.position
    places = Places.of(view, s, np.asarray(n + line.aside(along), np.float64))
    painted = line.is_painted(along)
    in_sight = painted & _is_in_sight(view, surface, places, line)
    visible = visible_paint(image, view, (n, line), s, in_sight)
    part, sure = seen_part(s, painted, in_sight, visible, line.gap if line.painted == "dashed" else 0.0)
    uv, xyz = places.uv[part], places.points[part]
    xz = on_ground(uv, ground, view.camera)
    if len(xz) < 2:
        return None
    kind: Kind = "dashed" if line.painted == "dashed" else "solid"
    colour: PaintColour = line.colour if line.colour in ("white", "yellow") else ""
    label = Label(f"line{number}", kind, sure, uv, xz, exact(xyz), colour=colour, width=line.width)
    return _Seen(s[part], places.aside[part], label)


def _is_in_sight(view: View, surface: Surface, places: Places, line: Line) -> Mask:
    """Return which places (N,) of a line lie in the picture, before nothing, with paint on them."""
    _, v, u = places.pixels(view)
    paint = cv2.dilate(surface.paint, np.ones((5, 3), np.uint8))
    whole = np.minimum(1, view.camera.fx * line.width / np.maximum(places.points[:, 2], 1))
    return places.unhidden(view, surface) & (paint[v, u] > PAINT_SEEN * whole)
