# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The curves of two evaluations in the same charts."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from lane_dp_ros.tools.evaluation.changes import Comparison
from lane_dp_ros.tools.evaluation.reliability import confidences, reliability
from lane_dp_ros.tools.evaluation.scores import FrameScore
from lane_dp_ros.tools.report.chart import Axis, Chart, scale
from lane_dp_ros.tools.report.curves import error_over_distance, threshold_curve
from lane_dp_ros.tools.report.plots import plot, share_axis

SERIES = ("series two", "series one")  # A, B
KEYS = '<span class="key two"></span>A<br><span class="key one"></span>B'


def changes_plots(comparison: Comparison) -> str:
    """Return the curves as HTML, A dashed."""
    sides = comparison.before, comparison.after
    return _precision_over_recall(sides) + _reliability(sides) + _error_over_distance(sides)


def _precision_over_recall(sides: Sequence[Sequence[FrameScore]]) -> str:
    title = "Precision over recall"
    chart = Chart(title, share_axis("recall"), share_axis("detection precision"))
    for results, style in zip(sides, SERIES, strict=True):
        curve = threshold_curve(results)
        chart.line(curve.recall, curve.precision, style)
    return plot(title, chart.svg(), f"{KEYS}<br>By the confidence from which lines are published.")


def _reliability(sides: Sequence[Sequence[FrameScore]]) -> str:
    title = "Is the confidence right?"
    chart = Chart(title, share_axis("confidence"), share_axis("share of lines that are right"))
    chart.line((0, 1), (0, 1), "ideal")
    errors = []
    for results, style in zip(sides, SERIES, strict=True):
        bins = reliability(*confidences(results))
        chart.line(bins.confidence, bins.share, style)
        errors.append("none" if np.isnan(bins.error) else f"{bins.error:.3f}")
    return plot(title, chart.svg(), f"{KEYS}<br>Expected calibration error: A {errors[0]}, B {errors[1]}.")


def _error_over_distance(sides: Sequence[Sequence[FrameScore]]) -> str:
    title = "Lateral error over distance"
    found = [error_over_distance(results) for results in sides]
    known = np.concatenate([bins.mean[np.isfinite(bins.mean)] for bins in found])
    top, ticks = scale(float(known.max(initial=0.01)) * 1.1)
    edges = found[0].edges
    chart = Chart(
        title,
        Axis("distance ahead [m]", edges[0], edges[-1], list(edges[::2])),
        Axis("mean lateral error [m]", 0, top, ticks),
    )
    for bins, style in zip(found, SERIES, strict=True):
        chart.line((edges[:-1] + edges[1:]) / 2, bins.mean, style)
    return plot(title, chart.svg(), f"{KEYS}<br>Of the lines that each found.")
