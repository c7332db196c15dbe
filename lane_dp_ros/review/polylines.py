# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Polylines as annotation tools have them, and what they must be to become lines."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import NamedTuple

Point = tuple[float, float]

CORNER = 0.5  # px; annotation tools count from the corner of the first pixel, lines from its centre
FAR_OUT = 2.0  # widths and heights about the picture's middle; farther out is no point of it
LARGEST = 100_000  # px; no picture is wider


class Polyline(NamedTuple):
    """One polyline: `points` (x, y) [px] from the corner of the first pixel; attributes as text, by name."""

    label: str
    attributes: Mapping[str, str]
    points: tuple[Point, ...]


class AnnotatedImage(NamedTuple):
    """The polylines of one image of `size` (width, height) [px]; `others` counts its other shapes."""

    name: str
    size: tuple[int, int]
    polylines: tuple[Polyline, ...]
    others: int = 0


def checked_points(values: Iterable[object], size: tuple[int, int], where: str) -> tuple[Point, ...]:
    """Return the points of numbers x, y, x, y, ... Raises ValueError, beginning with `where`."""
    numbers = [_number(value, where) for value in values]
    if len(numbers) < 4 or len(numbers) % 2:
        raise ValueError(f"{where} has {len(numbers)} numbers, expected x and y of two points or more")
    points = tuple(zip(numbers[::2], numbers[1::2], strict=True))
    for point in points:
        if any(abs(at - edge / 2) > FAR_OUT * edge for at, edge in zip(point, size, strict=True)):
            raise ValueError(
                f"{where} has the point {point[0]:g}, {point[1]:g}, "
                f"far outside of the {size[0]}x{size[1]} image"
            )
    return points


def checked_size(width: object, height: object, where: str) -> tuple[int, int]:
    """Return the size of an image [px]. Raises ValueError, beginning with `where`."""
    sizes = []
    for name, value in (("width", width), ("height", height)):
        number = _number(value, f"{where}: {name}")
        if not (1 <= number <= LARGEST and number.is_integer()):
            raise ValueError(f"{where}: {name} is {short(value)}, expected a whole number of pixels")
        sizes.append(int(number))
    return sizes[0], sizes[1]


def short(value: object) -> str:
    """Return a value as it is quoted in an error: its start."""
    text = repr(value)
    return text if len(text) <= 40 else f"{text[:37]}..."


def _number(value: object, where: str) -> float:
    try:
        if isinstance(value, (str, int, float)) and not isinstance(value, bool):
            number = float(value)
            if math.isfinite(number):
                return number
    except (ValueError, OverflowError):
        pass
    raise ValueError(f"{where} holds {short(value)}, expected a finite number")
