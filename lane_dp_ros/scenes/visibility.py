# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Where a careful person sees paint, or the road's border, in a picture: measured in the picture itself."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.scenes.road import Line
from lane_dp_ros.scenes.view import View

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]
Mask = NDArray[np.bool_]

VISIBLE_CONTRAST = 0.05  # Weber contrast at which things are just made out: the WMO's visual range goes by it
CERTAIN = 5.0  # contrast over its noise at which one is sure of it: A. Rose, J. Opt. Soc. Am. 38 (1948) 196
PIECE = 3.0  # [m] of paint over which the eye averages
VEIL = 0.005  # light of a screen where it is black; white is 1
GREY_LEVEL = 1 / 255  # least spread of a contrast: pictures are rounded
FINE = 10  # samples along the line in each step of its places
BAND = np.linspace(-0.6, 0.6, 5)  # samples across the paint, in halves of its width
BLUR = 1.0  # [px] beside the paint over which lens and sensor mix it with the road
FLANK = np.linspace(0.03, 0.15, 5)  # [m] beyond that: the road that the paint is compared with
INNER = np.linspace(-0.2, -0.03, 5)  # [m] inside a border: the road that what lies beyond is compared with
FACE = np.linspace(0.01, 0.07, 3)  # [m] beyond it: a kerb's face
BEYOND = np.linspace(0.1, 0.3, 5)  # [m] beyond it: stones, or the verge
NEAREST = 0.5  # [m] ahead of the camera; what is nearer is in no picture


def visible_paint(
    image: NDArray[np.uint8], view: View, placed: tuple[float, Line], s: Floats, in_sight: Mask
) -> Mask:
    """Return at which places s (N,) [m] ahead, evenly spaced, the paint of a line stands out in the picture.

    `image` (H, W, 3) BGR is that of `view`; `placed` how far right of the axis the line runs [m], and the
    line; `in_sight` (N,) where nothing is before it. Paint stands out where its contrast against the road on
    either side, averaged over 3 m of paint, is a visible one of the same sign, and certain in view of how
    much the road's two sides differ from each other.
    """
    n, line = placed
    along = _fine(s)
    samples = _Samples(view, along, np.asarray(n + line.aside(along + view.course.position), np.float64))
    light = _light(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY))
    paint = samples.mean_light(light, BAND * line.width / 2)
    border = line.width / 2 + samples.blur
    sides = [samples.mean_light(light, (side * (border + flank) for flank in FLANK)) for side in (-1, 1)]
    inside = np.isfinite(paint + sides[0] + sides[1])
    contrasts = [np.where(inside, np.log(paint / side), 0) for side in sides]
    used = line.is_painted(along + view.course.position) & np.repeat(in_sight, FINE) & inside
    pieces = _Pieces(s, used, samples.pixels_apart)
    left, right = map(pieces.mean, contrasts)
    least = np.where(left * right > 0, np.minimum(np.abs(left), np.abs(right)), 0)
    return np.asarray(in_sight & pieces.stand_out(least, contrasts[0] - contrasts[1]))


def visible_border(
    image: NDArray[np.uint8], view: View, border: tuple[float, int], s: Floats, in_sight: Mask
) -> Mask:
    """Return at which places s (N,) [m] ahead, evenly spaced, a border of the road is told from the road.

    `image` (H, W, 3) BGR is that of `view`; `border` how far right of the axis it runs [m], and on which side
    of it the road ends: 1, the right, or -1. It is told where what lies beyond, its face or what comes
    after, has a visible contrast against the road, averaged over 3 m, in any of the three colours, that is
    certain in view of how much the contrast changes along the border.
    """
    n, outward = border
    along = _fine(s)
    samples = _Samples(view, along, np.full_like(along, n))
    told = np.zeros(len(s), bool)
    for light in (_light(image[..., channel]) for channel in range(3)):
        road = samples.mean_light(light, (outward * (inner - samples.blur) for inner in INNER))
        for beyond in (FACE, BEYOND):
            other = samples.mean_light(light, (outward * (outer + samples.blur) for outer in beyond))
            inside = np.isfinite(road + other)
            pieces = _Pieces(s, np.repeat(in_sight, FINE) & inside, samples.pixels_apart)
            here, there = (np.maximum(pieces.mean(np.where(inside, each, 0)), VEIL) for each in (road, other))
            noisy = np.where(inside, other - road, 0) / np.repeat(here, FINE)
            told |= pieces.stand_out(np.abs(np.log(there / here)), noisy)
    return np.asarray(told & in_sight)


class _Pieces:
    """Pieces of 3 m about each of the places `s` (N,), of the samples (N * FINE,) that are `used`.

    `pixels_apart` (N * FINE,) are from one sample to the next: nearer ones are not independent.
    """

    def __init__(self, s: Floats, used: Mask, pixels_apart: Floats) -> None:
        self._used, self._reach = used, round(PIECE / (s[1] - s[0])) | 1
        self._samples = np.maximum(_sums(used, self._reach), 1)
        independent = _sums(used * pixels_apart, self._reach)
        self._independent = np.maximum(np.minimum(self._samples, independent), 1)

    def mean(self, values: Floats) -> Floats:
        """Return the mean (N,) of values at the samples."""
        return _sums(self._used * values, self._reach) / self._samples

    def stand_out(self, contrast: Floats, noisy: Floats) -> Mask:
        """Return where a contrast (N,) is visible, and certain over the spread of samples of noise."""
        spread = np.maximum(self.mean(noisy**2) - self.mean(noisy) ** 2, 0) + GREY_LEVEL**2
        visible, certain = np.log1p(VISIBLE_CONTRAST), CERTAIN * np.sqrt(spread / self._independent)
        return np.asarray(contrast > np.maximum(visible, certain))


class _Samples:
    """Places `along` (N,) [m] ahead on a line that runs `middle` (N,) [m] right of the axis.

    `blur` (N,) [m]: how far lens and sensor mix what lies side by side there; `pixels_apart` (N,): from one
    place to the next.
    """

    def __init__(self, view: View, along: Floats, middle: Floats) -> None:
        self._view, self._along, self._middle = view, along, middle
        centre, depth = self._pixels(0.0)
        self.blur = BLUR * np.maximum(depth, 1) / view.camera.fx
        self.pixels_apart = np.linalg.norm(np.diff(centre, axis=0, append=centre[-1:]), axis=1)

    def _pixels(self, beside: Floats | float) -> tuple[Floats, Floats]:
        """Return the pixels (N, 2) `beside` [m] the line, and their depth (N,) [m]."""
        view = self._view
        points = view.optical(view.course.points(self._along, self._middle + beside))
        in_front = points[:, 2] > NEAREST
        points = np.where(in_front[:, None], points, [0, -1e6, NEAREST])  # far above the picture
        return view.camera.project(points), points[:, 2]

    def mean_light(self, light: Singles, besides: Iterable[Floats | float]) -> Floats:
        """Return the mean light (N,) of places beside the line, NaN outside the picture."""
        across = []
        for beside in besides:
            u, v = self._pixels(beside)[0].astype(np.float32).T
            seen = cv2.remap(light, u[:, None], v[:, None], cv2.INTER_LINEAR, borderValue=np.nan)
            across.append(seen.ravel().astype(np.float64))
        return np.asarray(np.mean(across, axis=0))


def _light(grey: NDArray[Any]) -> Singles:
    """Return the light (H, W) of a screen that shows these grey levels."""
    return np.square(grey.astype(np.float32) / 255) + np.float32(VEIL)


def _fine(s: Floats) -> Floats:
    """Return the samples (N * FINE,) [m] ahead about the places s (N,)."""
    return (s[:, None] + ((np.arange(FINE) + 0.5) / FINE - 0.5) * (s[1] - s[0])).ravel()


def _sums(values: NDArray, reach: int) -> Floats:
    """Return the sums (N,) of the samples (N * FINE,) within `reach` places about each."""
    places = values.reshape(-1, FINE).sum(axis=1, dtype=np.float64)
    return np.convolve(places, np.ones(reach), mode="same")
