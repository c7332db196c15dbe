# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""From lines on the road to lanes in the camera's frame."""

from dataclasses import fields, replace

import numpy as np
import pytest

from lane_dp_ros.core.geometry.road_axis import RoadAxis
from lane_dp_ros.core.lanes.candidate import Candidate, LaneEvidence, LaneLine, Marking
from lane_dp_ros.core.lanes.lifting import to_lanes, to_road_edges
from lane_dp_ros.core.types import ego_roles

AXES = {"straight": RoadAxis(), "right bend": RoadAxis(-0.1, 0.05), "left bend": RoadAxis(0.1, -0.05)}
CAMERA_HEIGHT = 1.65  # m, of painted roads


def evidence(paint_width=0.15):
    """Return evidence of which the width alone matters here."""
    rest = {field.name: 0 for field in fields(LaneEvidence)}
    return LaneEvidence(**{**rest, "paint_width": paint_width})


def candidate_at(view, n, score=10.0, bend=0.0, paint_width=0.15):
    rows = np.arange(len(view.s))[::-1]
    line = LaneLine(rows, view.s[rows], np.full(len(rows), float(n)), bend, score)
    return Candidate(line, evidence(paint_width))


@pytest.mark.parametrize(
    ("offsets", "roles"),
    [
        ([], []),
        ([-1.7], ["ego_left"]),
        ([1.7], ["ego_right"]),
        ([0.0], ["ego_right"]),
        ([-5.2, -1.7, 1.8, 5.3], ["other", "ego_left", "ego_right", "other"]),
        ([5.3, 1.8, -1.7, -5.2], ["other", "ego_right", "ego_left", "other"]),
        ([1.8, 5.3], ["ego_right", "other"]),
        ([-5.2, -1.7], ["other", "ego_left"]),
    ],
)
def test_the_nearest_line_on_each_side_is_an_ego_line(offsets, roles):
    assert ego_roles(offsets) == roles


def test_lanes_come_from_left_to_right_with_their_own_evidence(painted_road):
    view = painted_road().view()
    placed = [(1.75, 0.3), (-4.5, 0.1), (-1.75, 0.2)]
    lanes = to_lanes([candidate_at(view, n, paint_width=width) for n, width in placed], view)
    assert [lane.lateral_offset for lane in lanes] == [-4.5, -1.75, 1.75]
    assert [lane.role for lane in lanes] == ["other", "ego_left", "ego_right"]
    assert [lane.paint_width for lane in lanes] == [0.1, 0.2, 0.3]
    assert all(lane.id == -1 for lane in lanes)


def test_lanes_have_the_kind_and_colour_of_their_paint(painted_road):
    view = painted_road().view()
    marking = Marking("double", "yellow", ("solid", "dashed"))
    (lane,) = to_lanes([replace(candidate_at(view, 1.75), marking=marking)], view)
    assert (lane.kind, lane.colour, lane.sides) == ("double", "yellow", ("solid", "dashed"))
    (unknown,) = to_lanes([candidate_at(view, 1.75)], view)
    assert (unknown.kind, unknown.colour, unknown.sides) == ("", "", None)


def test_no_lines_no_lanes(painted_road):
    assert to_lanes([], painted_road().view()) == ()


@pytest.mark.parametrize("axis", AXES.values(), ids=AXES)
@pytest.mark.parametrize("n", [-4.9, 0.0, 4.9])
def test_points_go_from_near_to_far_in_steps_of_at_most_half_a_metre(painted_road, axis, n):
    view = painted_road(axis=axis).view()
    points = to_lanes([candidate_at(view, n)], view)[0].points
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    assert steps.max() <= 0.5
    assert np.all(np.diff(points[:, 2]) > 0)
    s, found = view.to_road(points)
    np.testing.assert_allclose(found, n, atol=1e-9)
    np.testing.assert_allclose(s[[0, -1]], [4.125, 23.875])
    np.testing.assert_allclose(
        points[:, 1], CAMERA_HEIGHT
    )  # on the road below a camera that looks straight on


@pytest.mark.parametrize("axis", AXES.values(), ids=AXES)
def test_projected_points_fall_on_the_drawn_paint(painted_road, axis):
    road = painted_road(axis=axis).line(1.725)
    view = road.view()
    lane = to_lanes([candidate_at(view, 1.725)], view)[0]
    pixels = view.road_surface.camera.project(lane.points)
    for pixel in pixels:
        nearest = np.argmin((view.map_u - pixel[0]) ** 2 + (view.map_v - pixel[1]) ** 2)
        assert view.image.flat[nearest] == 170  # paint on asphalt


def test_a_short_line_has_two_points_at_least(painted_road):
    view = painted_road().view()
    line = LaneLine(np.array([79, 78]), view.s[[79, 78]], np.zeros(2), 0.0, 1.0)
    assert len(to_lanes([Candidate(line, evidence())], view)[0].points) == 2


@pytest.mark.parametrize(
    ("probability", "of_lane", "of_edge"), [((0.9, 0.05), 0.9, 0.05), ((0.0, 1.0), 0.01, 1.0)]
)
def test_confidence_is_the_probability_of_what_it_is(painted_road, probability, of_lane, of_edge):
    """It is never so small that nobody could see it drawn."""
    view = painted_road().view()
    candidate = replace(candidate_at(view, 0), probability=probability)
    assert to_lanes([candidate], view)[0].confidence == of_lane
    assert to_road_edges([candidate], view)[0].confidence == of_edge


def test_road_edges_come_from_left_to_right_without_paint(painted_road):
    view = painted_road().view()
    edges = to_road_edges([candidate_at(view, n) for n in (3.5, -2.5, 4.5)], view)
    assert [edge.lateral_offset for edge in edges] == [-2.5, 3.5, 4.5]
    assert [edge.role for edge in edges] == ["ego_left", "ego_right", "other"]
    assert {(edge.kind, edge.paint_width, edge.colour) for edge in edges} == {("edge", 0.0, "")}


def test_curvature_is_that_of_the_concentric_arc_and_the_lines_own(painted_road):
    """The axis has a radius of 20 m to the right: 4 m farther right the radius is 16 m."""
    view = painted_road(axis=RoadAxis(0.0, 0.05)).view()
    lane = to_lanes([candidate_at(view, 4.0, bend=0.01)], view)[0]
    assert lane.curvature == pytest.approx(1 / 16 + 0.01)
    straight = painted_road().view()
    assert to_lanes([candidate_at(straight, 4.0)], straight)[0].curvature == 0
