# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The curves of the report as HTML: charts, each with what it says in words."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

import numpy as np

from lane_dp_ros.tools.evaluation.depth import DepthSummary
from lane_dp_ros.tools.evaluation.reliability import (
    CONFIDENCE_BINS,
    confidences,
    reliability,
    road_edge_scores,
)
from lane_dp_ros.tools.evaluation.scores import FrameScore
from lane_dp_ros.tools.evaluation.summary import summarise
from lane_dp_ros.tools.report.chart import Axis, Chart, scale
from lane_dp_ros.tools.report.curves import error_over_distance, threshold_curve
from lane_dp_ros.tools.report.depth_plot import TITLE, depth_chart
from lane_dp_ros.tools.report.tables import number


def plots(results: Sequence[FrameScore]) -> str:
    """Return the curves, each with what it says in words; that of the depth where a surface is known."""
    charts = [_threshold_chart(results), _reliability_chart(results), _error_chart(results)]
    return "".join(plot(*chart) for chart in charts) + surface_plots(results)


def surface_plots(results: Sequence[FrameScore]) -> str:
    """Return the curve of the depth alone, empty where no frame has a surface."""
    depth = summarise(results).depth
    return plot(*_depth_chart(depth)) if depth.rows else ""


def plot(title: str, svg: str, words: str) -> str:
    """Return a chart as HTML with its title and what it says in `words`, which are HTML."""
    return (
        f'<figure class="plot"><figcaption><h3>{escape(title)}</h3></figcaption>{svg}<p>{words}</p></figure>'
    )


def _threshold_chart(results: Sequence[FrameScore]) -> tuple[str, str, str]:
    curve = threshold_curve(results)
    title = "Precision and recall over confidence"
    chart = Chart(title, share_axis("publish only lines of at least this confidence"), share_axis("share"))
    chart.line(curve.thresholds, curve.precision, "series one")
    chart.line(curve.thresholds, curve.recall, "series two")
    words = (
        '<span class="key one"></span>precision: lines that are right, of those published'
        '<br><span class="key two"></span>recall: labels found, of all that had to be'
    )
    return title, chart.svg(), words


def _reliability_chart(results: Sequence[FrameScore]) -> tuple[str, str, str]:
    bins = reliability(*confidences(results))
    title = "Is the confidence right?"
    chart = Chart(title, share_axis("confidence"), share_axis("share of lines that are right"))
    chart.line((0, 1), (0, 1), "ideal")
    for i in np.flatnonzero(bins.counts):
        chart.whisker(bins.confidence[i], bins.low[i], bins.high[i], "whisker")
        chart.text(float(CONFIDENCE_BINS[i : i + 2].mean()), 1.0, f"{bins.counts[i]}", lift=8)
    chart.line(bins.confidence, bins.share, "series one")
    for x, y in zip(bins.confidence, bins.share, strict=True):
        chart.dot(x, y, "point one")
    words = (
        f"Of the lines published with confidence p about p should be right (dashed); on average the two lie "
        f"<b>{number(bins.error)}</b> apart (expected calibration error). Bars: 95 % interval; above: number "
        f"of lines."
    )
    edges = reliability(*confidences(road_edge_scores(results)))
    if edges.counts.any():
        words += f" Of the {edges.counts.sum()} road edges, not drawn: <b>{number(edges.error)}</b>."
    return title, chart.svg(), words


def _error_chart(results: Sequence[FrameScore]) -> tuple[str, str, str]:
    bins = error_over_distance(results)
    title = "Lateral error over distance"
    highest = np.nanmax(bins.percentile_90) if np.isfinite(bins.percentile_90).any() else 0.1
    top, ticks = scale(float(highest) * 1.1)
    edges = bins.edges
    chart = Chart(
        title,
        Axis("distance ahead [m]", edges[0], edges[-1], list(edges[::2])),
        Axis("lateral error [m]", 0, top, ticks),
    )
    for i, mean in enumerate(bins.mean):
        chart.bar(edges[i], edges[i + 1], mean, "bar one")
        centre = (edges[i] + edges[i + 1]) / 2
        chart.whisker(centre, mean, bins.percentile_90[i], "whisker")
        if bins.counts[i]:
            chart.text(centre, top, f"{bins.counts[i]}", lift=8)
    return (
        title,
        chart.svg(),
        "Mean of the lines that were found, and 90th percentile; above: number of samples.",
    )


def share_axis(text: str) -> Axis:
    """Return an axis from 0 to 1."""
    return Axis(text, 0, 1, (0, 0.2, 0.4, 0.6, 0.8, 1))


def _depth_chart(depth: DepthSummary) -> tuple[str, str, str]:
    words = (
        '<span class="key one"></span>how much too deep the measured surface is straight ahead: median of '
        f"the frames, and the band in which nine of ten lie; {len(depth.rows)} frames with a surface, "
        f"{depth.no_surface} without"
    )
    return TITLE, depth_chart([depth.curve()]).svg(), words
