# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The report's curves for known input, the classes of failures, the order of frames, the charts."""

import math
import re
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest

from lane_dp_ros.scenes.categories import CATEGORIES
from lane_dp_ros.tools.evaluation.depth import CURVE_DEPTHS, NO_SURFACE, DepthErrors
from lane_dp_ros.tools.evaluation.failures import Failure, counts_by_reason, failures, reason, worst_first
from lane_dp_ros.tools.evaluation.reliability import confidences, reliability
from lane_dp_ros.tools.evaluation.scores import FrameScore
from lane_dp_ros.tools.evaluation.summary import summarise
from lane_dp_ros.tools.report.chart import Axis, Chart
from lane_dp_ros.tools.report.curves import error_over_distance, threshold_curve
from lane_dp_ros.tools.report.depth_plot import depth_chart
from lane_dp_ros.tools.report.plots import plots, surface_plots
from lane_dp_ros.tools.report.tables import frames_by_depth_error


def test_precision_and_recall_over_the_confidence(results):
    curve, total = threshold_curve(results), summarise(results)
    at = {round(t, 2): i for i, t in enumerate(curve.thresholds)}
    assert curve.precision[0] == pytest.approx(total.detection_precision) == pytest.approx(9 / 11)
    assert curve.recall[0] == pytest.approx(total.lane_recall) == pytest.approx(9 / 12)
    assert curve.precision[at[0.5]] == pytest.approx(9 / 10)  # without the duplicate
    assert curve.precision[at[0.7]] == 1.0  # without the false line and one that is right
    assert curve.recall[at[0.7]] == pytest.approx(8 / 12)
    assert (curve.precision[-1], curve.recall[-1]) == (1.0, pytest.approx(1 / 12))


def test_thresholds_above_all_lines_have_no_precision(results):
    curve = threshold_curve(results[1:2])
    assert math.isnan(curve.precision[-1]) and curve.recall[-1] == 0


def test_reliability(results):
    bins = reliability(*confidences(results))
    assert bins.counts.tolist() == [0, 0, 0, 1, 0, 0, 2, 0, 3, 5]  # confidence 1 is in the last one
    np.testing.assert_allclose(bins.share[[3, 6, 8, 9]], [0, 0.5, 1, 1])
    np.testing.assert_allclose(bins.confidence[[3, 6, 8, 9]], [0.35, 0.65, 0.85, 0.96])
    assert np.isnan(bins.share[0]) and np.isnan(bins.low[0])
    # Wilson's interval of 1 of 2: (0.5 + 0.9604) / 2.9208 +- 1.96 / 2.9208 * sqrt(0.125 + 0.2401)
    assert (bins.low[6], bins.high[6]) == (pytest.approx(0.0945, abs=1e-3), pytest.approx(0.9055, abs=1e-3))
    assert bins.error == pytest.approx((0.35 + 2 * 0.15 + 3 * 0.15 + 5 * 0.04) / 11)


def test_nothing_published_has_no_reliability():
    assert math.isnan(reliability([], []).error)
    assert "<svg" in plots([])


def test_error_over_distance(results):
    bins = error_over_distance(results)
    assert bins.edges.tolist() == [6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 25]
    assert bins.counts.tolist() == [4 * 9] * 9 + [3 * 9]  # every 0.5 m, nine matches; 24, 24.5 and 25 m
    np.testing.assert_allclose(bins.mean, 0.05 / 9, atol=1e-9)  # one of the nine is 0.05 m aside
    # Of 36 errors, the last four 0.05 m, it lies between the 32nd and the 33rd; of 27, 0.4 of the way from
    # the 24th to the 25th.
    np.testing.assert_allclose(bins.percentile_90, [0.025] * 9 + [0.02], atol=1e-9)


def test_error_without_matches_is_nan():
    bins = error_over_distance([])
    assert np.isnan(bins.mean).all() and not bins.counts.any()


def test_failures(results):
    fine, blind, wrong, plain = map(failures, results)
    assert fine == ()
    assert blind == (Failure("missed", "L", "over-exposure"), Failure("not found", "LL", "over-exposure"))
    assert wrong == (Failure("false", 3, "similar objects"), Failure("duplicate", 4, "similar objects"))
    assert plain == (Failure("not found", "LL", "not known"),)


@pytest.mark.parametrize(
    ("kind", "category", "expected"),
    [
        ("missed", "over_exposure", "over-exposure"),
        ("missed", "low_sun", "over-exposure"),
        ("missed", "grass_over_the_line", "occlusion"),
        ("not found", "s_curve", "curvature"),
        ("missed", "vehicle_shadows", "other: vehicle_shadows"),
        ("incorrect", "vehicle_shadows", "shadow"),
        ("false", "guard_rails", "similar objects"),
        ("false", "no_paint_kerbs", "similar objects"),
        ("false", "Curve", "other: Curve"),
        ("missed", "", "not known"),
    ],
)
def test_the_papers_classes(kind, category, expected):
    assert reason(kind, category) == expected


def test_rendered_scenes_of_every_class_of_the_paper_are_known():
    classes = {reason(kind, category) for kind in ("missed", "false") for category in CATEGORIES}
    assert {"over-exposure", "occlusion", "curvature", "similar objects", "shadow"} <= classes


def test_counts_by_reason_name_the_papers_classes_first(results):
    counts = counts_by_reason(results)
    assert list(counts) == ["over-exposure", "similar objects", "not known"]
    assert counts["over-exposure"] == {"missed": 1, "not found": 1}


def test_the_worst_frames_come_first(results):
    # A missed line beside the vehicle and another; a false one and a duplicate, equal but for the error.
    names = [result.name for result in worst_first(results)]
    assert names == ["drive/<b>&", "drive/blind", "drive/plain", "drive/fine"]


def test_the_worst_frame_of_each_sequence_comes_before_the_second_of_any(results):
    drive = [replace(result, sequence="other") for result in results]
    twice = [*results, *(replace(result, name=f"other/{result.name}") for result in drive)]
    sequences = [result.sequence for result in worst_first(twice)]
    assert sequences == ["drive", "other"] * 3 + ["drive", "other"]
    loose = [replace(result, stamp_ns=None) for result in results]  # single frames are no sequence
    assert worst_first(loose)[1].name == "drive/blind"


def test_a_line_is_broken_where_there_is_no_value():
    chart = Chart("c", Axis("x", 0, 4, ()), Axis("y", 0, 1, ()))
    chart.line((0, 1, 2, 3, 4), (0, 1, math.nan, 1, 0.5), "series")
    (path,) = re.findall(r'class="series" d="([^"]+)"', chart.svg())
    assert re.findall("[ML]", path) == ["M", "L", "M", "L"]
    xs = [float(x) for x in re.findall(r"[ML]([\d.]+)", path)]
    assert (
        xs[1] - xs[0]
        == pytest.approx(xs[3] - xs[2], abs=0.11)
        == pytest.approx((xs[3] - xs[0]) / 4, abs=0.11)
    )


def test_a_band_is_an_area_for_each_piece_without_a_gap():
    chart = Chart("c", Axis("x", 0, 4, ()), Axis("y", -1, 1, (-1, 0, 1)))
    chart.band((0, 1, 2, 3, 4), (-1, 0, math.nan, 0, 0), (1, 1, 1, math.nan, 1), "band")
    (path,) = re.findall(r'class="band" d="([^"]+)"', chart.svg())
    left, right, _ = path.split("Z")
    rows = re.findall(r'class="grid" d="M\d+ ([\d.]+)H', chart.svg())
    bottom, middle, top = map(float, rows)
    corners = [(float(x), float(y)) for x, y in re.findall(r"[ML]([\d.]+) ([\d.]+)", left)]
    assert [y for _, y in corners] == [top, top, middle, bottom]
    assert corners[0][0] == corners[3][0] < corners[1][0] == corners[2][0]
    assert right.count("L") == 1  # one place alone


def test_a_chart_as_a_file_of_its_own():
    chart = Chart("<c>", Axis("x", 0, 1, ()), Axis("y", 0, 1, ()))
    root = ElementTree.fromstring(chart.document(".grid { stroke: red; }"))
    assert root.tag == "{http://www.w3.org/2000/svg}svg" and root.attrib["aria-label"] == "<c>"
    assert root[0].text == ".grid { stroke: red; }"


def depth_scores(*errors):
    return [
        FrameScore(f"a/{i}", "a", "", None, (), depth=DepthErrors((error,) * len(CURVE_DEPTHS)))
        for i, error in enumerate(errors)
    ]


def test_the_depth_over_distance():
    curve = summarise(depth_scores(-0.01, 0.02, 0.04)).depth.curve()
    chart = depth_chart([curve, curve])
    svg = chart.svg()
    assert (chart.x.low, chart.x.high, list(chart.x.ticks)) == (6, 30, [8, 12, 16, 20, 24, 28])
    assert list(chart.y.ticks) == [-4, -3, -2, -1, 0, 1, 2, 3, 4] and chart.y.high == 4  # band to 3.8 %
    assert [svg.count(f'class="{style}"') for style in ("band one", "series two", "ideal")] == [1, 1, 1]
    (line,) = re.findall(r'class="series one" d="([^"]+)"', svg)
    heights = {float(y) for y in re.findall(r"[ML][\d.]+ ([\d.]+)", line)}
    rows = [float(y) for y in re.findall(r'class="grid" d="M\d+ ([\d.]+)H', svg)]
    assert heights == {rows[6]}  # at 2 %
    with pytest.raises(ValueError, match="5 curves in one chart, expected at most 4"):
        depth_chart([curve] * 5)


def test_no_curve_of_the_depth_without_a_surface(results):
    assert "Depth error" not in plots(results)
    assert surface_plots(results) == surface_plots([]) == ""
    assert "3 frames with a surface, 0 without" in plots(depth_scores(0.0, 0.0, 0.0))


def test_frames_by_their_depth_error():
    scores = [*depth_scores(0.01, -0.03), replace(depth_scores(0.0)[0], name="b/0", depth=NO_SURFACE)]
    table = re.sub("<wbr>", "", frames_by_depth_error(scores))
    assert re.findall(r'<th scope="row">([^<]+)<', table) == ["b/0", "a/1", "a/0"]
    assert "<td>-3.00</td>" in table and "<td>-</td>" in table


def test_a_bar_reaches_from_0_to_its_value():
    chart = Chart("c", Axis("x", 0, 1, ()), Axis("y", 0, 2, (0, 1, 2)))
    chart.bar(0, 1, 1, "bar")
    chart.bar(0, 1, math.nan, "bar")
    ((top, height),) = re.findall(r'class="bar" .*?y="([\d.]+)" .*?height="([\d.]+)"', chart.svg())
    zero, one, two = (float(y) for y in re.findall(r'class="grid" d="M\d+ ([\d.]+)H', chart.svg()))
    assert float(top) == pytest.approx(one) == pytest.approx((zero + two) / 2)
    assert float(top) + float(height) == pytest.approx(zero)
