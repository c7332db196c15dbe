# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Draw solid things into what a camera sees of a rendered road: finer than the picture, then averaged."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.scenes.faces import SAME_PLACE, Face, Picture, Seen, see, texel_corners
from lane_dp_ros.scenes.surface import Surface
from lane_dp_ros.scenes.view import View

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]

SUPERSAMPLING = 3  # a thing's border is drawn this much finer than the picture
BIG = 40_000  # [px] of a thing's frame from which on less must do
MOST_FACES = 250  # of a thing that are drawn at once: they are numbered in bytes


def draw(surface: Surface, view: View, faces: Sequence[Face]) -> None:
    """Draw one thing, wherever it is nearer than what the surface holds; what is drawn is no ground."""
    seen = see(view, faces)
    if not seen:
        return
    corners = np.concatenate([s.corners for s in seen])
    low = np.maximum(np.floor(corners.min(axis=0)).astype(int) - 1, 0)
    high = np.minimum(np.ceil(corners.max(axis=0)).astype(int) + 2, view.size)
    if np.any(high <= low):
        return
    for start in range(0, len(seen), MOST_FACES):
        _Layer.of(seen[start : start + MOST_FACES], low, high).put(surface, view)


@dataclass(frozen=True, eq=False)
class _Layer:
    """One thing, drawn finer than the picture, in the frame from pixel `low` to `high`."""

    low: NDArray[np.int64]
    high: NDArray[np.int64]
    scale: int
    faces: Sequence[Seen]  # the farthest first
    colour: Singles  # (h, w, 4), times opacity
    number: NDArray[np.uint8]  # (h, w), 1 + which of the faces is seen, 0 where there is none

    @classmethod
    def of(cls, faces: Sequence[Seen], low: NDArray[np.int64], high: NDArray[np.int64]) -> _Layer:
        """Return a layer with faces drawn on it, one over the other."""
        width, height = (int(n) for n in high - low)
        scale = SUPERSAMPLING if width * height < BIG else SUPERSAMPLING - 1
        shape = (height * scale, width * scale)
        far_to_near = sorted(faces, key=lambda face: face.mean_nearness)
        colour, number = np.zeros((*shape, 4), np.float32), np.zeros(shape, np.uint8)
        layer = cls(low, high, scale, far_to_near, colour, number)
        for i, face in enumerate(far_to_near):
            layer._add(face, i + 1)
        return layer

    def _add(self, seen: Seen, number: int) -> None:
        corners = (seen.corners - self.low + 0.5) * self.scale - 0.5
        limit = self.number.shape[::-1]
        left, top = np.clip(np.floor(corners.min(axis=0)).astype(int), 0, limit)
        right, bottom = np.clip(np.ceil(corners.max(axis=0)).astype(int) + 1, 0, limit)
        if right <= left or bottom <= top:
            return
        drawn = _drawn(seen.face.picture, corners - (left, top), (int(right - left), int(bottom - top)))
        opacity, part = drawn[..., 3:], (slice(top, bottom), slice(left, right))
        self.colour[part] *= 1 - opacity
        self.colour[part] += drawn
        np.copyto(self.number[part], np.uint8(number), where=opacity[..., 0] > 0.5)

    def put(self, surface: Surface, view: View) -> None:
        """Put the layer, averaged to the picture's size, before what is farther away."""
        (left, top), (right, bottom) = self.low, self.high
        part = (slice(top, bottom), slice(left, right))
        colour = self._small(self.colour)
        middle = self.scale // 2
        number = self.number[middle :: self.scale, middle :: self.scale]
        depth = self._depth(number)
        before = (colour[..., 3] > 0) & (depth <= surface.depth[part] * (1 + SAME_PLACE))
        opacity = colour[..., 3:] * before[..., None]
        for layer in (surface.albedo, surface.emission, surface.lamps):
            layer[part] *= 1 - opacity
        surface.albedo[part] += colour[..., :3] * before[..., None]
        surface.lamps[part] += self._lamps() * before[..., None]
        surface.paint[part] *= 1 - opacity[..., 0]
        solid = before & (opacity[..., 0] > 0.5) & (number > 0)
        rows, columns = np.nonzero(solid)
        at = (rows + top, columns + left)
        surface.depth[at] = depth[solid]
        surface.normal[at] = np.array([face.normal for face in self.faces])[number[solid] - 1]
        surface.position[at] = view.origin + view.rays[at] * depth[solid][:, None]
        surface.ground[at] = False

    def _small(self, fine: Singles) -> Singles:
        size = (int(self.high[0] - self.low[0]), int(self.high[1] - self.low[1]))
        return np.asarray(cv2.resize(fine, size, interpolation=cv2.INTER_AREA), np.float32)

    def _depth(self, number: NDArray[np.uint8]) -> Singles:
        """Return the depth (h, w) [m] of the face that each pixel sees; the nearest's where there is none."""
        nearest = max(face.mean_nearness for face in self.faces)
        a, b, c = np.array([(0, 0, nearest), *(face.plane for face in self.faces)], np.float32).T
        u, v = (
            np.arange(first, last, dtype=np.float32) for first, last in zip(self.low, self.high, strict=True)
        )
        return np.asarray(
            1 / np.maximum(a[number] * u + b[number] * v[:, None] + c[number], 1e-6), np.float32
        )

    def _lamps(self) -> Singles:
        glow = np.array([0, *(face.face.glow for face in self.faces)], np.float32)
        if not glow.any():
            return np.zeros((1, 1, 3), np.float32)
        return self._small(self.colour[..., :3] * glow[self.number][..., None])


def _drawn(picture: Picture, corners: Floats, size: tuple[int, int]) -> Singles:
    """Return a picture (h, w, 4), pressed into these corners; its border is hard, so that faces join."""
    texels = picture.for_size(*np.ptp(corners, axis=0))
    outline = np.rint(corners * 16).astype(np.int32)
    if texels.size == 4:
        image = np.zeros((size[1], size[0], 4), np.float32)
        cv2.fillConvexPoly(image, outline, texels[0, 0].tolist(), shift=4)
        return image
    H = cv2.getPerspectiveTransform(texel_corners(texels), corners.astype(np.float32))
    warped = cv2.warpPerspective(texels, H, size, flags=cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    inside = np.zeros(size[::-1], np.uint8)
    cv2.fillConvexPoly(inside, outline, 1, shift=4)
    return np.asarray(warped * inside[..., None], np.float32)
