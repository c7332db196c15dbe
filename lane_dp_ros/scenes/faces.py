# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The flat faces of which solid things on a rendered road are made, and how a camera sees them.

Places on the road are (s, n, above) [m]: along it from its start, right of its axis, above the ground there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.scenes.view import View

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]
Mask = NDArray[np.bool_]

NEAREST = 0.6  # [m] before the camera: a face that comes nearer is not drawn
UPWARD = np.array([0, 0.8, -0.6], np.float32)  # the way leaves look, in the world
SAME_PLACE = 0.02  # share of the distance by which a thing may lie behind what it stands on


def linear(colour: Singles) -> Singles:
    """Return the light, 1 for white, of grey levels 0 to 255, which go with its root."""
    return np.square(np.asarray(colour, np.float32) / 255)


@dataclass(frozen=True)
class Picture:
    """A picture to put on a face: BGRA (h, w, 4), linear, colour times opacity, at falling sizes."""

    pyramid: tuple[Singles, ...]

    @classmethod
    def of(cls, image: Singles) -> Picture:
        """Make the pyramid of BGR 0 to 255 with opacity 0 to 1, (h, w, 4)."""
        image = np.dstack([linear(image[..., :3]) * image[..., 3:], image[..., 3:]]).astype(np.float32)
        pyramid = [image]
        while min(pyramid[-1].shape[:2]) >= 4:
            height, width = pyramid[-1].shape[:2]
            smaller = cv2.resize(pyramid[-1], (width // 2, height // 2), interpolation=cv2.INTER_AREA)
            pyramid.append(np.asarray(smaller, np.float32))
        return cls(tuple(pyramid))

    @classmethod
    def plain(cls, colour: Sequence[float]) -> Picture:
        """Return one opaque colour, BGR 0 to 255."""
        return cls.of(np.array([[[*colour, 1]]], np.float32))

    def part(self, left: float, right: float) -> Picture:
        """Return the part of the picture between two shares, 0 to 1, of its width."""
        return Picture(
            tuple(
                a[:, min(int(left * a.shape[1]), a.shape[1] - 1) : max(1, round(right * a.shape[1]))]
                for a in self.pyramid
            )
        )

    def for_size(self, width: float, height: float) -> Singles:
        """Return the smallest size that is no smaller than it will be drawn (the first if none is)."""
        large = [a for a in self.pyramid if a.shape[1] >= width and a.shape[0] >= height]
        return large[-1] if large else self.pyramid[0]


@dataclass(frozen=True, eq=False)
class Face:
    """A flat quadrangle: `corners` (4, 3) on the road, clockwise from the upper left as seen from outside.

    `glow`: how much light its picture gives off by itself, 1 for as much as a white sheet in daylight.
    Faces seen from `both` sides are drawn from behind as well; `leafy` ones are lit from above, as leaves.
    """

    corners: Floats
    picture: Picture
    glow: float = 0.0
    both: bool = False
    leafy: bool = False

    def mirrored(self) -> Face:
        """Return the face as a wet road shows it."""
        return replace(self, corners=self.corners * (1, 1, -1), both=True)


@dataclass(frozen=True, eq=False)
class Seen:
    """A face as a camera sees it: `corners` (4, 2) [px]; 1 over the depth is `plane` . (u, v, 1) [1/m]."""

    face: Face
    corners: Floats
    plane: Floats
    mean_nearness: float
    normal: Singles  # in the world, towards the camera


def see(view: View, faces: Sequence[Face]) -> list[Seen]:
    """Return how a camera sees faces, without what it sees from behind and what is too near."""
    _, depth = _placed(view, faces)
    before = [cut for face, d in zip(faces, depth[..., 2], strict=True) if (cut := _cut(face, d))]
    if not before:
        return []
    world, points = _placed(view, before)
    pixels = view.camera.project(points.reshape(-1, 3)).reshape(-1, 4, 2)
    every = zip(before, world, points, pixels, strict=True)
    return [seen for one in every if (seen := _seen(view, *one))]


def _placed(view: View, faces: Sequence[Face]) -> tuple[Floats, Floats]:
    """Return the corners of faces (N, 4, 3) in the world and in the camera's optical frame."""
    s, n, above = np.concatenate([face.corners for face in faces]).T
    world = view.course.points(s - view.course.position, n, above)
    return world.reshape(-1, 4, 3), view.optical(world).reshape(-1, 4, 3)


def _cut(face: Face, depth: Floats) -> Face | None:
    """Return what is left of a face, whose corners have these depths (4,) [m], before the camera.

    It is cut from side to side of its picture only: what is too near at both sides is left out.
    """
    left, right = depth[[0, 3]], depth[[1, 2]]
    if depth.min() >= NEAREST:
        return face
    if left.min() < NEAREST and right.min() < NEAREST:
        return None
    share = float(((NEAREST - left) / (right - left)).max() if left.min() < NEAREST else 0)
    end = float(((NEAREST - left) / (right - left)).min() if right.min() < NEAREST else 1)
    (a, b, c, d), ends = face.corners, (share, end)
    top, bottom = ([p + t * (q - p) for t in ends] for p, q in ((a, b), (d, c)))
    return replace(face, corners=np.array([*top, *bottom[::-1]]), picture=face.picture.part(share, end))


def _seen(view: View, face: Face, world: Floats, points: Floats, pixels: Floats) -> Seen | None:
    """Return how a face at these corners is seen, if not from behind.

    The points X of its plane, N . X = D, have 1 / z = N . (ray of the pixel) / D.
    """
    turn = _turn(pixels)
    if turn <= 0 and not (face.both and turn < 0):
        return None
    camera, (a, b, c) = view.camera, np.cross(points[2] - points[0], points[3] - points[1])
    distance = np.array([a, b, c]) @ points.mean(axis=0)
    plane = np.array(
        [a / camera.fx, b / camera.fy, c - a * camera.cx / camera.fx - b * camera.cy / camera.fy]
    )
    plane /= distance
    nearness = float(plane[:2] @ pixels.mean(axis=0) + plane[2])
    normal = UPWARD if face.leafy else np.sign(turn) * _normal(world)
    return Seen(face, pixels, plane, nearness, normal)


def _turn(pixels: Floats) -> float:
    """Return twice the area of a quadrangle, positive when its corners go clockwise in the picture."""
    (u0, v0), (u1, v1) = pixels[2] - pixels[0], pixels[3] - pixels[1]
    return float(u0 * v1 - u1 * v0)


def _normal(world: Floats) -> Singles:
    normal = np.cross(world[2] - world[0], world[3] - world[1])
    return (normal / max(float(np.linalg.norm(normal)), 1e-9)).astype(np.float32)


def hides(seen: Seen, pixels: Floats, depth: Floats) -> Mask:
    """Return which points, at pixels (N, 2) and depth (N,) [m], lie behind an opaque part of a face."""
    texels = seen.face.picture.pyramid[0]
    H = cv2.getPerspectiveTransform(seen.corners.astype(np.float32), texel_corners(texels))
    at = np.rint(cv2.perspectiveTransform(pixels[None], H)[0])
    inside = np.all((at >= 0) & (at < texels.shape[1::-1]), axis=1)
    column, row = np.where(inside[:, None], at, 0).astype(int).T
    nearness = pixels @ seen.plane[:2] + seen.plane[2]
    return np.asarray(inside & (texels[row, column, 3] > 0.5) & (nearness * depth > 1 + SAME_PLACE))


def texel_corners(texels: Singles) -> Singles:
    """Return the corners (4, 2) of a picture in its own texels."""
    h, w = texels.shape[:2]
    return np.array([[0, 0], [w, 0], [w, h], [0, h]], np.float32) - np.float32(0.5)  # texel centres are whole
