# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What goes into the detector and what comes out: stereo frames, the prior, lanes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal, Protocol

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.geometry.road_axis import RoadAxis
from lane_dp_ros.core.geometry.road_surface import RoadSurface

Image = NDArray[np.uint8]
LaneRole = Literal["ego_left", "ego_right", "other"]
LaneKind = Literal["solid", "dashed", "double", "edge", ""]
PaintColour = Literal["white", "yellow", ""]
RoadSource = Literal["measured", "last", "nominal", "none"]


@dataclass(frozen=True, eq=False)
class StereoFrame:
    """A rectified stereo pair: uint8 images (H, W) grey or (H, W, 3) BGR of equal size.

    `right` is None where the left image is alone.
    Raises ValueError for images of different size or of another shape or type.
    """

    left: Image
    right: Image | None = None

    def __post_init__(self) -> None:
        _check_image(self.left, "left")
        if self.right is None:
            return
        _check_image(self.right, "right")
        left, right = (f"{image.shape[1]}x{image.shape[0]}" for image in (self.left, self.right))
        if left != right:
            raise ValueError(f"the images differ in size: left {left}, right {right}, expected equal")

    def grey(self) -> StereoFrame:
        """Return the pair in grey, (H, W) each."""
        return StereoFrame(_grey(self.left), None if self.right is None else _grey(self.right))


@dataclass(frozen=True)
class RoadEstimate:
    """The road's surface that serves for a frame: the measured one, the last one, the nominal one, or none.

    `surface` is None where there is none; `reason` says what contradicts a surface that was measured but
    does not serve, empty otherwise.
    """

    surface: RoadSurface | None
    source: RoadSource = "measured"
    reason: str = ""


class RoadGate(Protocol):
    """Decides what surface serves in place of the one measured in this frame."""

    def __call__(self, measured: RoadSurface | None) -> RoadEstimate:
        """Return what serves; `measured` is None where the disparity shows no road."""


def as_measured(measured: RoadSurface | None) -> RoadEstimate:
    """Return the measured surface: the gate of frames before which nothing is known."""
    return RoadEstimate(measured, "none" if measured is None else "measured")


@dataclass(frozen=True, eq=False)
class Prior:
    """What the frames before say of this one.

    `road` decides which surface of the road serves; `surface` is the one that was measured a moment ago, and
    `axis` the road's axis then: both are where the search in this frame begins. `paint` are the net metres of
    it that there were along the axis; with much less there, or None, the edges vote for another one.
    """

    road: RoadGate = as_measured
    surface: RoadSurface | None = None
    axis: RoadAxis | None = None
    paint: float | None = None


@dataclass(frozen=True, eq=False)
class Lane:
    """One painted line, or one border of the carriageway that is not painted (kind "edge").

    `points` (N, 3) [m] lie on the centre of the paint, or on the border, on the road's surface, in the left
    optical frame (x right, y down, z forward; the frame of P_left), ordered from near to far, at most 0.5 m
    apart. `confidence` is in (0, 1]; `paint_width` [m] is 0 for a border; `curvature` [1/m] is positive where
    the line bends to the right; `lateral_offset` [m] is the line's distance right of the camera at the
    vehicle (negative: left). `id` is the line's identity over time, -1 before tracking.
    `kind` is that of the paint, or "edge" for a border; "double" is one of two lines side by side, whose own
    kinds, left and right, are its `sides`. `colour` is that of the paint. Either is empty where it is not
    known, as the colour in a grey picture is.
    """

    points: NDArray[np.float64]
    confidence: float
    paint_width: float
    role: LaneRole
    curvature: float
    lateral_offset: float
    id: int = -1
    kind: LaneKind = ""
    colour: PaintColour = ""
    sides: tuple[LaneKind, LaneKind] | None = None

    @property
    def extent(self) -> tuple[float, float]:
        """Depth [m] of its nearest and farthest point."""
        return float(self.points[0, 2]), float(self.points[-1, 2])


def ego_roles(offsets: Sequence[float]) -> list[LaneRole]:
    """Return the role of each lateral offset [m]: the nearest on each side of the vehicle are ego lines."""
    roles: list[LaneRole] = ["other"] * len(offsets)
    left = [i for i, n in enumerate(offsets) if n < 0]
    right = [i for i, n in enumerate(offsets) if n >= 0]
    if left:
        roles[max(left, key=lambda i: offsets[i])] = "ego_left"
    if right:
        roles[min(right, key=lambda i: offsets[i])] = "ego_right"
    return roles


def with_roles(lanes: Sequence[Lane]) -> tuple[Lane, ...]:
    """Return lanes with the roles that they have beside one another; so have road edges among themselves."""
    roles: dict[int, LaneRole] = {}
    for edges in (False, True):
        alike = [i for i, lane in enumerate(lanes) if (lane.kind == "edge") == edges]
        offsets = [lanes[i].lateral_offset for i in alike]
        roles.update(zip(alike, ego_roles(offsets), strict=True))
    return tuple(
        lane if lane.role == roles[i] else replace(lane, role=roles[i]) for i, lane in enumerate(lanes)
    )


def _check_image(image: object, side: str) -> None:
    if not isinstance(image, np.ndarray):  # None, when cv2.imread finds no picture
        raise ValueError(f"the {side} image is {type(image).__name__}, expected an array (picture not read?)")
    if image.dtype != np.uint8 or image.ndim not in (2, 3) or (image.ndim == 3 and image.shape[2] != 3):
        raise ValueError(
            f"the {side} image is {image.dtype} {image.shape}, expected uint8 (H, W) or (H, W, 3)"
        )
    if image.size == 0:
        raise ValueError(f"the {side} image is empty: {image.shape}")


def _grey(image: Image) -> Image:
    return np.ascontiguousarray(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY) if image.ndim == 3 else image)
