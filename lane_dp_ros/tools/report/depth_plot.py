# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The error of the road's depth over distance as a chart, of one evaluation or of several."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.tools.evaluation.depth import DepthCurve
from lane_dp_ros.tools.report.chart import Axis, Chart, scale

TITLE = "Depth error over distance"
LIMIT = 20.0  # %; larger errors lie on the chart's border: a road that was missed would flatten all else
SERIES = ("one", "two", "three", "four")  # classes of the style sheet


def depth_chart(curves: Sequence[DepthCurve]) -> Chart:
    """Return the median and the band of nine in ten frames of up to four curves.

    Raises ValueError for more.
    """
    if len(curves) > len(SERIES):
        raise ValueError(f"{len(curves)} curves in one chart, expected at most {len(SERIES)}")
    top, ticks = scale(1.05 * max(map(_largest, curves), default=0.1))
    depths = curves[0].depths if curves else np.array([0.0, 1.0])
    steps = [z for z in depths.tolist() if z % 4 == 0]
    chart = Chart(
        TITLE,
        Axis("distance ahead [m]", float(depths[0]), float(depths[-1]), steps),
        Axis("depth error [%]", -top, top, [-tick for tick in ticks[:0:-1]] + ticks),
    )
    for curve, style in zip(curves, SERIES, strict=False):
        chart.band(curve.depths, _percent(curve.low), _percent(curve.high), f"band {style}")
    chart.line((depths[0], depths[-1]), (0, 0), "ideal")
    for curve, style in zip(curves, SERIES, strict=False):
        chart.line(curve.depths, _percent(curve.bias), f"series {style}")
    return chart


def _percent(errors: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.clip(100 * errors, -LIMIT, LIMIT)


def _largest(curve: DepthCurve) -> float:
    """Return the largest error [%] that is drawn of a curve's band, at least 0.1."""
    values = np.abs(_percent(np.concatenate([curve.low, curve.high])))
    return max(0.1, float(np.max(values[np.isfinite(values)], initial=0)))
