# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What the frames before say of a frame: along another axis there may be more paint, another road serves."""

import numpy as np
import pytest

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.detector import LaneDetector, jumps
from lane_dp_ros.core.geometry.road_axis import RoadAxis
from lane_dp_ros.core.geometry.road_surface import RoadSurface
from lane_dp_ros.core.parameter import replaced
from lane_dp_ros.core.road import vanishing_point
from lane_dp_ros.core.types import Prior, RoadEstimate, StereoFrame
from lane_dp_ros.scenes import CAMERA, Road, render_pair

DETECTOR = LaneDetector(CAMERA)
ASKEW = RoadAxis(0.4, -0.03)
KNOWN = RoadAxis(0.1, 0.03)


@pytest.fixture(scope="module")
def frame():
    pair = render_pair(Road(curvature=0.006, swing=0), position=50.0, seed=2)
    return StereoFrame(pair.left, pair.right)


@pytest.fixture(scope="module")
def detection(frame):
    return DETECTOR.detect(frame)


@pytest.fixture
def misled(monkeypatch):
    """Let the edges vote for an axis along which there is no paint."""
    monkeypatch.setattr(vanishing_point, "arc_of_edges", lambda *_: ASKEW)


def assert_same_lanes(found, expected):
    assert len(found.lanes) == len(expected.lanes) > 0
    for lane, before in zip(found.lanes, expected.lanes, strict=True):
        np.testing.assert_array_equal(lane.points, before.points)
        assert (lane.role, lane.confidence) == (before.role, before.confidence)


@pytest.mark.parametrize(
    ("heading", "curvature", "is_jump"),
    [
        (0.0, 0.0, False),
        (0.045, -0.009, False),
        (-0.045, 0.009, False),
        (0.055, 0.0, True),
        (-0.055, 0.0, True),
        (0.0, 0.011, True),
        (0.0, -0.011, True),
    ],
)
def test_only_more_than_roads_and_vehicles_do_is_a_jump_of_the_axis(heading, curvature, is_jump):
    axis = RoadAxis(KNOWN.heading + heading, KNOWN.curvature + curvature)
    assert jumps(axis, KNOWN) == jumps(KNOWN, axis) == is_jump


def test_a_prior_axis_with_less_paint_changes_nothing_but_the_time(frame, detection):
    again = DETECTOR.detect(frame, Prior(axis=ASKEW))
    assert_same_lanes(again, detection)
    assert again.birds_eye.axis == detection.birds_eye.axis
    assert again.direction == detection.direction
    assert again.score == detection.score > 0
    assert list(again.seconds) == list(detection.seconds)


@pytest.mark.usefixtures("misled")
def test_the_prior_axis_brings_the_lanes_back(frame, detection):
    alone = DETECTOR.detect(frame)
    assert alone.score < detection.score
    assert alone.birds_eye.axis != detection.birds_eye.axis
    found = DETECTOR.detect(frame, Prior(axis=detection.birds_eye.axis))
    assert found.score == detection.score
    assert_same_lanes(found, detection)
    np.testing.assert_array_equal(found.paint_map.feature, detection.paint_map.feature)  # both images served
    assert found.direction == detection.direction
    assert not found.note


def test_a_prior_axis_near_that_of_the_frame_is_not_searched(frame, detection, monkeypatch):
    """Less than a jump is the road or the vehicle: what this frame shows counts."""
    searched = []
    along = DETECTOR._search.along

    def recorded(axis, *rest):
        searched.append(axis)
        return along(axis, *rest)

    monkeypatch.setattr(DETECTOR._search, "along", recorded)
    own = detection.birds_eye.axis
    near, far = RoadAxis(own.heading + 0.04, own.curvature), RoadAxis(own.heading + 0.06, own.curvature)
    DETECTOR.detect(frame, Prior(axis=near))
    assert near not in searched
    DETECTOR.detect(frame, Prior(axis=far))
    assert far in searched


@pytest.mark.parametrize("method", ["arc", "dense"])
def test_the_direction_is_the_one_along_which_lanes_were_found(frame, method):
    """By either method: the plane that maps the road is the one that was looked through."""
    config = replaced(DetectorConfig(), {"vanishing_point.method": method})
    for prior in (Prior(), Prior(axis=RoadAxis(-0.06, 0.006)), Prior(axis=RoadAxis(0.06, 0.006))):
        found = LaneDetector(CAMERA, config).detect(frame, prior)
        assert found.direction.axis == found.birds_eye.axis
        assert found.direction.ipm_plane == found.birds_eye.ipm_plane


def test_a_frame_without_a_road_has_no_lanes_whatever_the_prior_axis(frame):
    wall = StereoFrame(frame.left, frame.left)
    found = DETECTOR.detect(wall, Prior(axis=RoadAxis()))
    assert found.lanes == () and found.birds_eye is None
    assert found.note == "no road surface in the disparity 1.2 to 2.3 m below the camera"


def given(surface, source, reason=""):
    return Prior(lambda _: RoadEstimate(surface, source, reason))


@pytest.mark.parametrize("source", ["last", "nominal"])
def test_where_another_road_serves_the_left_image_is_looked_at_alone(frame, detection, source):
    """What was measured is kept to be told; heights are unknown, and nothing is taken for standing things."""
    surface = RoadSurface.plane(CAMERA, 1.65, 0.0)
    found = DETECTOR.detect(frame, given(surface, source, "pitch 0.1 rad after 0"))
    assert found.road_estimate == RoadEstimate(surface, source, "pitch 0.1 rad after 0")
    assert found.note == "the road contradicts the one before: pitch 0.1 rad after 0"
    assert found.road == detection.road
    np.testing.assert_array_equal(found.disparity.full, detection.disparity.full)
    assert found.birds_eye.road_surface is surface
    assert np.isnan(found.birds_eye.height).all()
    assert found.candidates and all(np.isnan(each.evidence.height) for each in found.candidates)
    alone = DETECTOR.detect(StereoFrame(frame.left), given(surface, source, "pitch 0.1 rad after 0"))
    assert_same_lanes(found, alone)


def test_the_gate_is_asked_once_with_the_road_that_was_measured(frame, detection):
    asked = []

    def gate(measured):
        asked.append(measured)
        return RoadEstimate(measured)

    assert_same_lanes(DETECTOR.detect(frame, Prior(gate)), detection)
    assert asked == [detection.road]
    DETECTOR.detect(StereoFrame(frame.left), Prior(gate))
    assert asked[1:] == [None]


def test_known_lanes_change_nothing_where_heights_are_measured(frame, detection):
    assert_same_lanes(DETECTOR.detect(frame, Prior(lanes=())), detection)
