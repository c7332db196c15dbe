# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Small charts as inline SVG; colours and sizes are the style sheet's."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from html import escape

WIDTH, HEIGHT = 380, 256
LEFT, RIGHT, TOP, BOTTOM = 60, 12, 26, 46  # of the frame
TICKS = 5  # about so many on an axis


@dataclass(frozen=True)
class Axis:
    """What an axis says, from `low` to `high`, and where its ticks are."""

    text: str
    low: float
    high: float
    ticks: Sequence[float]

    def place(self, value: float) -> float:
        """Return where a value lies, 0 at `low`, 1 at `high`."""
        return (value - self.low) / (self.high - self.low)


@dataclass
class Chart:
    """A chart of `x` and `y`; what is added later lies above. Values that are nan are left out."""

    title: str
    x: Axis
    y: Axis
    _parts: list[str] = field(default_factory=list)

    def line(self, xs: Iterable[float], ys: Iterable[float], style: str) -> None:
        """Add a polyline, broken where y is nan."""
        command, path = "M", ""
        for x, y in zip(xs, ys, strict=True):
            if math.isfinite(x) and math.isfinite(y):
                path += f"{command}{self._x(x):.1f} {self._y(y):.1f}"
                command = "L"
            else:
                command = "M"
        self._parts.append(f'<path class="{style}" d="{path}"/>')

    def band(self, xs: Iterable[float], lows: Iterable[float], highs: Iterable[float], style: str) -> None:
        """Add the area between two polylines, broken where one of them is nan."""
        path, run = "", list[tuple[float, float, float]]()
        for x, low, high in [*zip(xs, lows, highs, strict=True), (math.nan,) * 3]:
            if math.isfinite(x + low + high):
                run.append((self._x(x), self._y(low), self._y(high)))
            elif run:
                outline = [(x, high) for x, _, high in run] + [(x, low) for x, low, _ in reversed(run)]
                path += "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in outline) + "Z"
                run = []
        self._parts.append(f'<path class="{style}" d="{path}"/>')

    def bar(self, left: float, right: float, y: float, style: str) -> None:
        """Add a bar from 0 up to y, with a gap to the next one."""
        if math.isfinite(y):
            x, width = self._x(left) + 1, self._x(right) - self._x(left) - 2
            height = self._y(self.y.low) - self._y(y)
            box = f'x="{x:.1f}" y="{self._y(y):.1f}" width="{width:.1f}" height="{height:.1f}"'
            self._parts.append(f'<rect class="{style}" {box}/>')

    def whisker(self, x: float, low: float, high: float, style: str) -> None:
        """Add an upright line."""
        if math.isfinite(low) and math.isfinite(high):
            path = f"M{self._x(x):.1f} {self._y(low):.1f}V{self._y(high):.1f}"
            self._parts.append(f'<path class="{style}" d="{path}"/>')

    def dot(self, x: float, y: float, style: str) -> None:
        """Add a dot."""
        if math.isfinite(x) and math.isfinite(y):
            self._parts.append(f'<circle class="{style}" cx="{self._x(x):.1f}" cy="{self._y(y):.1f}" r="4"/>')

    def text(self, x: float, y: float, words: str, style: str = "value", lift: float = 4) -> None:
        """Add words centred over a place, `lift` above it."""
        if math.isfinite(x) and math.isfinite(y):
            place = f'x="{self._x(x):.1f}" y="{self._y(y) - lift:.1f}"'
            self._parts.append(f'<text class="{style}" {place} text-anchor="middle">{escape(words)}</text>')

    def document(self, css: str) -> str:
        """Return the chart as a file of its own, with a style sheet."""
        head = f'<svg xmlns="http://www.w3.org/2000/svg" width="{2 * WIDTH}" height="{2 * HEIGHT}"'
        return self.svg().replace("<svg", head, 1).replace(">", f"><style>{css}</style>", 1) + "\n"

    def svg(self) -> str:
        """Return the chart."""
        box = f'class="chart" viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="{escape(self.title)}"'
        return f"<svg {box}>{self._frame()}{''.join(self._parts)}</svg>"

    def _frame(self) -> str:
        """Return grid, ticks and the axes' texts."""
        left, right, bottom = LEFT, WIDTH - RIGHT, HEIGHT - BOTTOM
        rows = "".join(
            f'<path class="grid" d="M{left} {self._y(y):.1f}H{right}"/>'
            f'<text x="{left - 6}" y="{self._y(y) + 4:.1f}" text-anchor="end">{y:g}</text>'
            for y in self.y.ticks
        )
        columns = "".join(
            f'<path class="tick" d="M{self._x(x):.1f} {bottom}v4"/>'
            f'<text x="{self._x(x):.1f}" y="{bottom + 17}" text-anchor="middle">{x:g}</text>'
            for x in self.x.ticks
        )
        middle_x, middle_y = (left + right) / 2, (TOP + bottom) / 2
        return (
            f'{rows}{columns}<path class="axis" d="M{left} {bottom}H{right}"/>'
            f'<text x="{middle_x}" y="{HEIGHT - 8}" text-anchor="middle">{escape(self.x.text)}</text>'
            f'<text transform="translate(13 {middle_y}) rotate(-90)" text-anchor="middle">'
            f"{escape(self.y.text)}</text>"
        )

    def _x(self, value: float) -> float:
        return LEFT + self.x.place(value) * (WIDTH - LEFT - RIGHT)

    def _y(self, value: float) -> float:
        return HEIGHT - BOTTOM - self.y.place(value) * (HEIGHT - TOP - BOTTOM)


def scale(highest: float) -> tuple[float, list[float]]:
    """Return an axis' end at or above `highest` > 0, and its ticks, round numbers."""
    power = 10.0 ** math.floor(math.log10(highest / TICKS))
    step = next(each * power for each in (1, 2, 5, 10) if each * power * TICKS >= highest)
    count = math.ceil(highest / step - 1e-9)
    return count * step, [i * step for i in range(count + 1)]
