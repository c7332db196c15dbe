# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""A picture as HTML: a small JPEG as data URI, and lines over it as SVG."""

from __future__ import annotations

import base64
from collections.abc import Iterable
from dataclasses import dataclass, replace
from html import escape

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.messages.image import Image8

Floats = NDArray[np.float64]

QUALITIES = (85, 75, 65, 50, 35)  # of JPEG, the best that is small enough
FAILURES = ("missed", "incorrect", "not-found", "false", "duplicate")  # states of lines

# Of a tag in high and in wide pictures, in percent: its width and height, and from where on it stands on
# the left of its line.
TAG_SHARE = {False: (22, 5, 70), True: (18, 9, 75)}


@dataclass(frozen=True, eq=False)
class Line:
    """A line in a picture: points (N, 2) in its units, classes of the style sheet, and what names it.

    The last class is its state, such as "false".
    """

    points: Floats
    style: str
    name: str = ""

    @property
    def state(self) -> str:
        """What became of it."""
        return self.style.rpartition(" ")[2]

    @property
    def is_failure(self) -> bool:
        """Whether it shows a failure."""
        return self.state in FAILURES


def data_uri(image: Image8, limit: int) -> str:
    """Return a JPEG as data URI, as good as goes into `limit` bytes; at half the size where none does."""
    for quality in QUALITIES:
        done, data = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, quality])
        if not done:
            raise CommandError(f"a picture of shape {image.shape} cannot be written as JPEG")
        if data.size <= limit:
            return "data:image/jpeg;base64," + base64.b64encode(data.tobytes()).decode("ascii")
    half = (max(1, image.shape[1] // 2), max(1, image.shape[0] // 2))
    return data_uri(np.asarray(cv2.resize(image, half, interpolation=cv2.INTER_AREA), np.uint8), limit)


def figure(
    style: str,
    title: str,
    size: tuple[float, float],
    uri: str,
    lines: Iterable[Line],
    marks: Iterable[tuple[str, float]] = (),
) -> str:
    """Return a picture, `size` in the lines' units, with lines over it.

    `marks` are texts at the left border and how far down they stand, as a share. Without `uri` it is dark.
    """
    width, height = size
    lines = [replace(line, points=_inside(line.points, size)) for line in lines]
    drawn = "".join(_polyline(line, width) for line in lines if len(line.points) > 1)
    image = f'<img src="{uri}" alt="" loading="lazy">' if uri else ""
    ticks = "".join(
        f'<i class="mark" style="top:{100 * y:.1f}%">{text}</i>' for text, y in marks if 0 < y < 1
    )
    return (
        f'<figure class="{style}" style="--ratio:{width / height:.4f}" tabindex="0" role="button" '
        f'aria-label="enlarge: {escape(title)}"><div class="canvas">{image}'
        f'<svg viewBox="0 0 {width:g} {height:g}" preserveAspectRatio="none" aria-hidden="true">{drawn}</svg>'
        f"{ticks}{_tags(lines, size)}</div><figcaption>{escape(title)}</figcaption></figure>"
    )


def _inside(points: Floats, size: tuple[float, float]) -> Floats:
    """Return the points within a picture and one beyond each end, so that lines run to its border."""
    inside = np.all((points >= 0) & (points <= size) & np.isfinite(points), axis=1)
    near = inside.copy()
    near[1:] |= inside[:-1]
    near[:-1] |= inside[1:]
    return points[near & np.all(np.isfinite(points), axis=1)]


def _polyline(line: Line, width: float) -> str:
    digits = 1 if width > 100 else 2
    points = " ".join(f"{x:.{digits}f},{y:.{digits}f}" for x, y in line.points)
    casing = f'<polyline class="casing {line.style}" points="{points}"/>' if line.is_failure else ""
    return f'{casing}<polyline class="{line.style}" points="{points}"/>'


def _tags(lines: Iterable[Line], size: tuple[float, float]) -> str:
    """Return a tag for each failure, near the middle of its line, moved up where it would hide another.

    In a wide picture it says what became of the line; a high one has room for the name only.
    """
    is_wide = size[0] > size[1]
    width, height, last = TAG_SHARE[is_wide]
    taken: list[tuple[float, float]] = []
    tags = ""
    for line in lines:
        if line.is_failure and line.name and len(line.points) > 1:
            x, y = 100 * _anchor(line.points, size)
            while any(abs(x - a) < width and abs(y - b) < height for a, b in taken) and y > height:
                y -= height
            taken.append((x, y))
            words = f"{line.state.replace('-', ' ')} {line.name}" if is_wide else line.name
            style, place = f"tag {line.style}{' flip' if x > last else ''}", f"left:{x:.1f}%;top:{y:.1f}%"
            tags += f'<b class="{style}" style="{place}">{escape(words)}</b>'
    return tags


def _anchor(points: Floats, size: tuple[float, float]) -> Floats:
    """Return a place, as shares of the picture, in the middle between the ends of a line within it."""
    shares = np.clip(points / size, 0, 1)
    middle = (shares[0, 1] + shares[-1, 1]) / 2
    return np.clip(shares[np.argmin(np.abs(shares[:, 1] - middle))], 0.01, 0.93)
