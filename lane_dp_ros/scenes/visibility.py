# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Where a careful person sees paint in a picture: measured in the picture, against the road on both sides."""

from __future__ import annotations

from collections.abc import Iterable

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.scenes.road import Line
from lane_dp_ros.scenes.view import View

Floats = NDArray[np.float64]
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
    along = (s[:, None] + ((np.arange(FINE) + 0.5) / FINE - 0.5) * (s[1] - s[0])).ravel()
    section = _Section(image, view, placed, along)
    used = placed[1].is_painted(along + view.course.position) & np.repeat(in_sight, FINE) & section.inside
    reach = round(PIECE / (s[1] - s[0])) | 1
    samples = np.maximum(_sums(used, reach), 1)
    independent = np.maximum(np.minimum(samples, _sums(used * section.pixels, reach)), 1)

    def mean(values: Floats) -> Floats:
        """Return the mean (N,) over 3 m of paint of values at the samples (N * FINE,)."""
        return _sums(used * values, reach) / samples

    left, right = (mean(contrast) for contrast in section.contrasts)
    difference = section.contrasts[0] - section.contrasts[1]
    spread = np.maximum(mean(difference**2) - mean(difference) ** 2, 0) + GREY_LEVEL**2
    least = np.where(left * right > 0, np.minimum(np.abs(left), np.abs(right)), 0)
    visible, certain = np.log1p(VISIBLE_CONTRAST), CERTAIN * np.sqrt(spread / independent)
    return np.asarray(in_sight & (least > np.maximum(visible, certain)))


class _Section:
    """The light across a line at each of its places `along` (N,) [m] ahead.

    `contrasts`: the logarithm of the paint's light over that of the road left and right of it, two of (N,);
    `inside` (N,): all of that lies in the picture; `pixels` (N,) from one place to the next.
    """

    def __init__(
        self, image: NDArray[np.uint8], view: View, placed: tuple[float, Line], along: Floats
    ) -> None:
        n, line = placed
        grey = cv2.cvtColor(image, cv2.COLOR_BGR2GRAY).astype(np.float32) / 255
        self._light = np.square(grey) + np.float32(VEIL)
        self._view, self._along = view, along
        self._middle = n + line.aside(along + view.course.position)
        paint = self._mean_light(BAND * line.width / 2)
        centre, depth = self._pixels(0.0)
        border = line.width / 2 + BLUR * np.maximum(depth, 1) / view.camera.fx
        sides = [self._mean_light(side * (border + flank) for flank in FLANK) for side in (-1, 1)]
        self.inside = np.isfinite(paint + sides[0] + sides[1])
        self.contrasts = [np.where(self.inside, np.log(paint / side), 0) for side in sides]
        self.pixels = np.linalg.norm(np.diff(centre, axis=0, append=centre[-1:]), axis=1)

    def _pixels(self, beside: Floats | float) -> tuple[Floats, Floats]:
        """Return the pixels (N, 2) `beside` [m] the line, and their depth (N,) [m]."""
        view = self._view
        points = view.optical(view.course.points(self._along, self._middle + beside))
        in_front = points[:, 2] > NEAREST
        points = np.where(in_front[:, None], points, [0, -1e6, NEAREST])  # far above the picture
        return view.camera.project(points), points[:, 2]

    def _mean_light(self, besides: Iterable[Floats | float]) -> Floats:
        """Return the mean light (N,) of places beside the line, NaN outside the picture."""
        across = []
        for beside in besides:
            u, v = self._pixels(beside)[0].astype(np.float32).T
            light = cv2.remap(self._light, u[:, None], v[:, None], cv2.INTER_LINEAR, borderValue=np.nan)
            across.append(light.ravel().astype(np.float64))
        return np.asarray(np.mean(across, axis=0))


def _sums(values: NDArray, reach: int) -> Floats:
    """Return the sums (N,) of the samples (N * FINE,) within `reach` places about each."""
    places = values.reshape(-1, FINE).sum(axis=1, dtype=np.float64)
    return np.convolve(places, np.ones(reach), mode="same")
