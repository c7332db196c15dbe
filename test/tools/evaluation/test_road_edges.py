# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Road edges, lanes that run along them, and what lies beyond the labels, judged on a flat road by hand."""

import numpy as np
import pytest

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.types import Lane
from lane_dp_ros.tools.evaluation.annotations import Label, LabelledFrame
from lane_dp_ros.tools.evaluation.json_file import as_json
from lane_dp_ros.tools.evaluation.matching import judge, judge_unpainted
from lane_dp_ros.tools.evaluation.summary import Summary, summarise
from lane_dp_ros.tools.evaluation.text import tables

CAMERA = StereoCamera(700.0, 700.0, 600.0, 180.0, 0.54)
GROUND = np.array([0.0, 100 * 0.54 / 1.65, 0.0, 0.0])  # a plane 1.65 m below the camera


def line(x):
    z = np.arange(5.0, 30.01, 0.5)
    return np.column_stack([np.full_like(z, x), np.full_like(z, 1.65), z])


def label(name, x, kind="edge", sure=True):
    return Label(name, kind, sure, CAMERA.project(line(x)), line(x)[:, [0, 2]])


def lanes(*places, confidence=0.9):
    return [Lane(line(x), confidence, 0.12, "other", 0.0, 0.0) for x in places]


def judged(labels, found=(), edges=None):
    """Return the score of a frame with lines at `found` and road edges at `edges` [m]."""
    frame = LabelledFrame("a/0", CAMERA, (1200, 370), GROUND, tuple(labels), None, None)
    return judge(frame, lanes(*found), CAMERA, road_edges=None if edges is None else lanes(*edges))


PAINT, KERB = label("P", -1.8, "solid"), label("K", 3.0)


def verdicts(detections):
    return [detection.verdict for detection in detections]


def test_a_line_more_than_9_m_aside_is_not_judged():
    score = judged([PAINT], [-1.8, 8.9, 9.1, -9.1])
    assert verdicts(score.detections) == ["match", "false", "beyond", "beyond"]
    total = summarise([score])
    assert (total.detections, total.false_lanes, total.detection_precision) == (2, 1, 0.5)
    assert score.confidences == ((0.9, True), (0.9, False))
    assert (total.culane.tp, total.culane.fp) == (1, 1)


def test_a_line_more_than_9_m_aside_that_is_labelled_is_found():
    score = judged([label("far", 9.5, "solid")], [9.5, 9.6])
    assert verdicts(score.detections) == ["match", "beyond"]
    assert summarise([score]).lane_recall == 1.0


def test_the_mean_over_its_points_counts():
    slanting = line(0.0)
    slanting[:, 0] = np.linspace(6.0, 14.0, len(slanting))  # 10 m on average
    frame = LabelledFrame("a/0", CAMERA, (1200, 370), GROUND, (PAINT,), None, None)
    for shift, verdict in ((0.0, "beyond"), (-1.1, "false")):
        (detection,) = judge(
            frame, [Lane(slanting + np.array([shift, 0, 0]), 1, 0.1, "other", 0, 0)], CAMERA
        ).detections
        assert detection.verdict == verdict


@pytest.mark.parametrize(
    ("places", "false", "strict"),
    [
        ([-1.8, 3.0], 0, 1),  # matches the edge's label
        ([-1.8, 3.3], 0, 1),  # runs beside it
        ([-1.8, 3.4], 1, 1),  # 0.4 m: too far to mean it
        ([-1.8, 3.0, 3.1], 0, 2),  # a duplicate is a false lane there
        ([-1.8], 0, 0),
    ],
)
def test_a_line_along_an_edge_is_strictly_a_false_lane(places, false, strict):
    total = summarise([judged([PAINT, KERB], places)])
    assert (total.false_lanes, total.false_lanes_strict) == (false, strict)
    assert total.strict_detection_precision == (len(places) - strict) / len(places)
    assert total.strict_false_lanes_per_frame == strict


def test_a_found_line_beside_an_edge_is_right():
    total = summarise([judged([PAINT, label("gutter", -2.05)], [-1.8, -1.75])])
    assert (total.matched, total.duplicates, total.false_lanes_strict) == (1, 1, 1)
    assert total.strict_detection_precision == total.detection_precision == 0.5


def test_duplicates_count_against_the_strict_precision():
    total = summarise([judged([PAINT, KERB], [-1.8, -1.75])])
    assert total.strict_detection_precision == total.detection_precision == 0.5


def test_road_edges_are_matched_with_the_labels_of_edges():
    labels = [PAINT, KERB, label("verge", -4.0), label("unsure", 5.0, sure=False)]
    score = judged(labels, [-1.8], [3.1, 5.0, -1.8, 6.5, 3.0])
    edges = score.road_edges
    assert verdicts(edges.detections) == ["duplicate", "match", "ignored", "false", "match"]
    assert edges.labels == ("K", "verge")
    assert {match.label: match.counts for match in edges.matches} == {"K": True, "unsure": False}
    total = summarise([score])
    assert (total.detections, total.false_lanes, total.labels) == (1, 0, 1)  # lanes are lanes
    found = total.road_edges
    assert (found.frames, found.labels, found.matched, found.detections, found.false_edges) == (1, 2, 1, 5, 1)
    assert (found.recall, found.false_per_frame) == (0.5, 1.0)
    assert found.error.value == pytest.approx(0.0, abs=1e-9)
    assert score.road_edges.confidences == ((0.9, False), (0.9, True), (0.9, True), (0.9, False), (0.9, True))


def test_road_edges_keep_the_limits_of_lines():
    assert summarise([judged([KERB], edges=[3.19])]).road_edges.matched == 1
    beside = summarise([judged([KERB], edges=[3.21])]).road_edges
    assert (beside.matched, beside.false_edges) == (0, 0)
    assert judged([KERB], edges=[9.1]).road_edges.detections[0].verdict == "beyond"


def test_nothing_is_counted_where_no_road_edges_are_told_of():
    score = judged([KERB], [0.0])
    assert score.road_edges is None
    assert summarise([score]).road_edges == Summary().road_edges
    assert np.isnan(summarise([score]).road_edges.recall)
    assert "road edges" not in tables([score])
    assert as_json([score], ())["frames"][0]["road_edges"] is None


def test_false_lanes_of_frames_without_paint():
    bare = judged([KERB], [3.0, 0.0])
    painted = judged([label("unsure", 1.0, "solid", sure=False)], [-3.0])
    known = judge_unpainted("06/1", lanes(0.0), "06", 1)
    total = summarise([bare, painted, known])
    counts = total.unpainted_frames, total.unpainted_false_lanes, total.unpainted_false_lanes_strict
    assert counts == (2, 2, 3)
    assert total.false_lanes == 3
    assert "false lanes in 2 frames without paint: 2, strictly 3" in tables([bare, painted, known])
    assert "without paint" not in tables([painted])


def test_the_text_and_the_json_file_tell_of_road_edges():
    results = [judged([PAINT, KERB], [-1.8], [3.05, 6.0])]
    text = tables(results)
    lines, _, edges = (line.split() for line in text.splitlines() if line.startswith("total"))
    assert lines[6:10] == ["1.000", "1.000", "0.00", "0.00"]
    assert edges == ["total", "1", "1", "1.000", "2", "1", "1.00", "0.050"]
    assert "road edges right by confidence, from 0.9: 1 of 2; expected calibration error 0.400" in text
    found = as_json(results, ())
    assert found["total"]["road_edges"] == {
        "frames": 1, "labels": 1, "matched": 1, "detections": 2, "recall": 1.0, "false": 1,
        "false_per_frame": 1.0, "error": pytest.approx(0.05),
    }  # fmt: skip
    assert found["road_edge_reliability"]["expected_calibration_error"] == pytest.approx(0.4)
    frame = found["frames"][0]
    assert [edge["verdict"] for edge in frame["road_edges"]["detections"]] == ["match", "false"]
    assert frame["detections"][0]["strict_verdict"] == "match"
