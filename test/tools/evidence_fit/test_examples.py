# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What the labels of a frame tell of its candidates, on a road that is drawn by hand."""

from dataclasses import replace

import numpy as np
import pytest

from lane_dp_ros.core.birdseye.birds_eye import BirdsEyeView
from lane_dp_ros.core.detector import LaneDetection
from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.geometry.quadratic_surface import QuadraticSurface
from lane_dp_ros.core.geometry.road_axis import RoadAxis
from lane_dp_ros.core.lanes.candidate import Candidate, LaneEvidence, LaneLine
from lane_dp_ros.tools.evaluation.annotations import Label, LabelledFrame
from lane_dp_ros.tools.evidence_fit.examples import evidence_values, example

CAMERA = StereoCamera(700.0, 700.0, 600.0, 180.0, 0.54)
HEIGHT = 1.65  # m
GROUND = np.array([0.0, 100 * CAMERA.baseline / HEIGHT, 0.0, 0.0])
PAINT, EDGE, CLUTTER = (True, False, True), (False, True, True), (False, False, True)
ANYTHING, NO_PAINT = (True, True, True), (False, True, True)


def view():
    s, n = np.arange(30.125, 4.0, -0.25), np.arange(-11.975, 12.0, 0.05)
    surface = QuadraticSurface.plane(CAMERA, HEIGHT, 0.0)
    u, v = (
        each.astype(np.float32)
        for each in surface.ground_to_pixel(n[None] + 0 * s[:, None], s[:, None] + 0 * n)
    )
    shape, seen = u.shape, np.ones(u.shape, bool)
    image, height = np.zeros(shape, np.uint8), np.zeros(shape, np.float32)
    return BirdsEyeView(image, seen, seen, height, u, v, s, n, RoadAxis(), surface, surface)


VIEW = view()


def candidate(n, variant="path", score=10.0):
    rows = np.arange(len(VIEW.s))[::-1]
    line = LaneLine(rows, VIEW.s[rows], np.full(len(rows), float(n)), 0.0, score)
    return Candidate(line, LaneEvidence(26.0, 4.0, 0.0, score=score), variant)


def label(n, kind="solid", sure=True):
    z = np.arange(5.0, 30.01, 0.5)
    points = np.column_stack([np.full_like(z, n), np.full_like(z, HEIGHT), z])
    return Label(f"{kind}{n}", kind, sure, CAMERA.project(points), points[:, [0, 2]])


def told(candidates, labels, edges_known=True, category=""):
    """Return what each candidate may be, in their order, and which are told to be one line."""
    truth = LabelledFrame("a/0", CAMERA, (1200, 370), GROUND, tuple(labels), category=category)
    detection = LaneDetection(candidates=tuple(candidates), birds_eye=VIEW)
    found = example("a/0", "a", detection, truth, edges_known)
    return [tuple(row) for row in found.may_be.tolist()], found.found


def test_what_lies_on_a_label_may_be_paint_and_what_lies_on_none_is_clutter():
    may_be, found = told([candidate(-1.8), candidate(0.0), candidate(1.8)], [label(-1.8), label(1.8)])
    assert may_be == [PAINT, CLUTTER, PAINT]
    assert found == ((0,), (2,))


def test_several_on_one_label_are_one_line():
    may_be, found = told([candidate(-1.85), candidate(-1.75), candidate(1.8)], [label(-1.8)])
    assert may_be == [PAINT, PAINT, CLUTTER]
    assert found == ((0, 1),)


def test_candidates_come_from_left_to_right():
    detection = LaneDetection(
        candidates=(candidate(1.8, score=1.0), candidate(-1.8, score=2.0)), birds_eye=VIEW
    )
    truth = LabelledFrame("a/0", CAMERA, (1200, 370), GROUND, ())
    found = example("a/0", "a", detection, truth, True)
    assert [each.score for each in found.evidence] == [2.0, 1.0]
    assert found.neighbours.left.tolist() == [True, False]
    assert evidence_values([found, found], "score").tolist() == [2.0, 1.0, 2.0, 1.0]


def test_near_a_doubtful_label_nothing_is_told():
    may_be, found = told([candidate(-1.8), candidate(1.8)], [label(-1.8, sure=False)])
    assert may_be == [ANYTHING, CLUTTER]
    assert found == ()


def test_far_aside_nothing_is_told():
    assert told([candidate(-10.0), candidate(8.0)], [])[0] == [ANYTHING, CLUTTER]


def test_without_labels_of_borders_what_is_no_paint_may_be_one():
    may_be, _ = told([candidate(-1.8), candidate(3.5, "border")], [label(-1.8)], edges_known=False)
    assert may_be == [PAINT, EDGE]


def test_a_border_on_its_label_is_an_edge():
    borders = [candidate(-3.0, "border"), candidate(2.0, "border"), candidate(3.5)]
    may_be, found = told(borders, [label(-3.0, "edge"), label(3.5, "edge")])
    assert may_be == [EDGE, CLUTTER, EDGE]
    assert found == ((0,), (2,))


def test_of_a_doubtful_border_it_is_not_told_that_it_is_found():
    may_be, found = told([candidate(-3.0, "border")], [label(-3.0, "edge", sure=False)])
    assert may_be == [EDGE]
    assert found == ()


def test_a_path_along_a_border_is_never_paint_even_on_a_label_of_paint():
    may_be, found = told([candidate(-1.8), candidate(-1.75, "border")], [label(-1.8)])
    assert may_be == [PAINT, NO_PAINT]
    assert found == ((0,),)


def test_paint_on_a_border_stays_paint():
    may_be, found = told([candidate(-1.8)], [label(-1.8), label(-1.8, "edge")])
    assert may_be == [PAINT]
    assert found == ((0,),)


def test_a_frame_without_truth_has_no_paint():
    detection = LaneDetection(candidates=(candidate(-1.8), candidate(3.0, "border")), birds_eye=VIEW)
    found = example("a/0", "a", detection, None, False)
    assert [tuple(row) for row in found.may_be.tolist()] == [NO_PAINT, NO_PAINT]
    assert (found.found, found.category, found.rendered) == ((), "", False)


@pytest.mark.parametrize(("category", "rendered"), [("", False), ("kerbs", True)])
def test_a_frame_with_a_category_is_rendered(category, rendered):
    truth = replace(LabelledFrame("a/0", CAMERA, (1200, 370), GROUND, ()), category=category)
    found = example("a/0", "a", LaneDetection(), truth, True)
    assert found.rendered is rendered
    assert found.evidence == () and found.may_be.shape == (0, 3)
