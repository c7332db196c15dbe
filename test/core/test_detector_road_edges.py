# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The road edges of the whole detector, on rendered roads between kerbs."""

import numpy as np
import pytest

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.detector import LaneDetector
from lane_dp_ros.core.geometry.quadratic_surface import QuadraticSurface
from lane_dp_ros.core.parameter import replaced
from lane_dp_ros.core.types import StereoFrame
from lane_dp_ros.scenes import CAMERA, Road
from lane_dp_ros.scenes.road import SOLID
from lane_dp_ros.scenes.scene import Motion, Scene, render_frame

pytestmark = pytest.mark.filterwarnings("error")

KERB = 0.14  # m
EDGE = 3.6 / 2 + 0.6  # m beside the vehicle; the borders of the asphalt


def road_with_kerbs(verge):
    return Road(
        swing=0,
        lane_widths=(3.6,),
        lines=(SOLID, SOLID),
        driven=0,
        kerb=KERB,
        shoulder=0.6,
        verge=verge,
    )


@pytest.fixture(scope="module", params=["fields", "town"])
def scene(request, rendered):
    """A road between kerbs, and its rendered frame."""
    road = road_with_kerbs(request.param)
    return road, rendered(render_frame, Scene(road, motion=Motion(start=4.0)), 0, 1)


@pytest.fixture(scope="module")
def detection(scene):
    return LaneDetector(CAMERA).detect(StereoFrame(scene[1].left, scene[1].right))


def offsets(road, lane):
    """Return x and z [m] of a lane's pixels on the rendered road."""
    ground = QuadraticSurface.plane(CAMERA, road.camera_height, road.pitch)
    return ground.pixel_to_ground(*CAMERA.project(lane.points).T)


def test_kerbs_are_the_edges_of_the_road(scene, detection):
    assert len(detection.road_edges) == 2
    for edge, side in zip(detection.road_edges, (-1, 1), strict=True):
        x, z = offsets(scene[0], edge)
        assert np.abs(side * x - EDGE)[z < 12].max() < 0.3
        assert z[-1] - z[0] > 15
        assert np.linalg.norm(np.diff(edge.points, axis=0), axis=1).max() <= 0.5


def test_far_off_a_kerb_is_no_nearer_than_the_line_before_it(rendered):
    road = road_with_kerbs("fields")
    pair = rendered(render_frame, Scene(road, motion=Motion(start=4.0)), 0, 1)
    found = LaneDetector(CAMERA).detect(StereoFrame(pair.left, pair.right))
    x, _ = offsets(road, found.road_edges[0])
    assert x.max() < -1.8


def test_road_edges_are_no_lanes_and_have_roles_of_their_own(detection):
    assert [edge.role for edge in detection.road_edges] == ["ego_left", "ego_right"]
    assert [lane.role for lane in detection.lanes] == ["ego_left", "ego_right"]
    assert {(edge.kind, edge.paint_width, edge.id) for edge in detection.road_edges} == {("edge", 0.0, -1)}
    assert {lane.kind for lane in detection.lanes} == {"solid"}
    for edge, lane in zip(detection.road_edges, detection.lanes, strict=True):
        assert abs(edge.lateral_offset) > abs(lane.lateral_offset) + 0.3


def test_every_road_edge_is_a_candidate_with_its_probability(detection):
    edges = [each for each in detection.candidates if each.is_edge]
    assert [each.refusal for each in edges] == ["a road edge"] * 2
    by_offset = sorted(edges, key=lambda each: each.line.n[0])
    assert [each.probability[1] for each in by_offset] == [edge.confidence for edge in detection.road_edges]
    assert all(edge.confidence >= 0.3 for edge in detection.road_edges)
    for each in edges:
        assert each.evidence.far_rise > KERB / 2
    assert not any(each.is_edge and each in detection.candidates[:2] for each in edges)


def test_without_evidence_there_are_no_road_edges(scene):
    config = replaced(DetectorConfig(), {"lane_selection.evidence": False})
    found = LaneDetector(CAMERA, config).detect(StereoFrame(scene[1].left, scene[1].right))
    assert found.lanes
    assert found.road_edges == ()


def test_what_is_less_probable_than_configured_is_no_road_edge(scene):
    config = replaced(DetectorConfig(), {"lane_selection.confidence_min": 0.9})
    found = LaneDetector(CAMERA, config).detect(StereoFrame(scene[1].left, scene[1].right))
    assert len(found.lanes) == 2
    assert found.road_edges == ()
