# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What the frames before say of a frame: where to begin, along which axis, and that another road serves."""

import numpy as np
import pytest

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.detector import LaneDetector
from lane_dp_ros.core.geometry.road_axis import RoadAxis
from lane_dp_ros.core.geometry.road_surface import geometry
from lane_dp_ros.core.geometry.vertical_curve import VerticalCurve
from lane_dp_ros.core.parameter import replaced
from lane_dp_ros.core.road import vanishing_point
from lane_dp_ros.core.search import LaneSearch
from lane_dp_ros.core.types import Prior, RoadEstimate, StereoFrame
from lane_dp_ros.scenes import CAMERA, Road, render_pair

DETECTOR = LaneDetector(CAMERA)
ASKEW = RoadAxis(0.4, -0.03)


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


@pytest.fixture
def searched(monkeypatch):
    """The axes along which lanes are searched, in order."""
    axes, along = [], LaneSearch.along

    def recorded(self, axis, *rest):
        axes.append(axis)
        return along(self, axis, *rest)

    monkeypatch.setattr(LaneSearch, "along", recorded)
    return axes


def test_a_prior_axis_with_less_paint_changes_nothing_but_the_time(frame, detection):
    """The edges are asked, too, and there is more paint along theirs."""
    again = DETECTOR.detect(frame, Prior(axis=ASKEW, paint=detection.score))
    assert_same_lanes(again, detection)
    assert again.birds_eye.axis == detection.birds_eye.axis
    assert again.direction == detection.direction
    assert again.score == detection.score > 0
    assert set(again.seconds) == set(detection.seconds)


def test_where_the_prior_axis_explains_the_pair_the_edges_are_not_asked(frame, detection, searched):
    own = detection.birds_eye.axis
    found = DETECTOR.detect(frame, Prior(axis=own, paint=detection.score))
    assert searched == [own]
    assert set(detection.seconds) - set(found.seconds) == {"vanishing_point"}
    assert found.score == detection.score
    assert found.direction == detection.direction
    assert_same_lanes(found, detection)


@pytest.mark.parametrize(("found_of_known", "voted"), [(0.81, False), (0.79, True)])
def test_the_edges_are_asked_where_a_fifth_of_the_paint_is_missing(frame, detection, found_of_known, voted):
    known = detection.birds_eye.axis
    found = DETECTOR.detect(frame, Prior(axis=known, paint=detection.score / found_of_known))
    assert ("vanishing_point" in found.seconds) == voted


def test_where_no_paint_is_known_along_the_prior_axis_the_edges_vote_and_have_more(
    frame, detection, searched
):
    """Both axes are searched, the prior's first."""
    found = DETECTOR.detect(frame, Prior(axis=ASKEW))
    assert searched[0] == ASKEW and len(set(searched)) > 1
    assert found.voted
    assert found.birds_eye.axis == detection.birds_eye.axis
    assert_same_lanes(found, detection)


@pytest.mark.usefixtures("misled")
def test_where_no_paint_is_known_along_the_prior_axis_it_may_have_more_than_the_edges(
    frame, detection, searched
):
    own = detection.birds_eye.axis
    found = DETECTOR.detect(frame, Prior(axis=own))
    assert searched[:2] == [own, ASKEW]
    assert found.voted
    assert found.birds_eye.axis == own
    assert_same_lanes(found, detection)


def test_it_is_told_whether_the_edges_voted(frame, detection, monkeypatch):
    asked, estimate = [], vanishing_point.ArcVanishingPoint.estimate

    def recorded(*given):
        asked.append(given)
        return estimate(*given)

    monkeypatch.setattr(vanishing_point.ArcVanishingPoint, "estimate", recorded)
    axis, paint = detection.birds_eye.axis, detection.score
    wall = StereoFrame(frame.left, frame.left)
    for pair, prior in [
        (frame, Prior()),
        (frame, Prior(paint=paint)),  # without an axis
        (frame, Prior(axis=axis)),
        (frame, Prior(axis=axis, paint=paint)),
        (frame, Prior(axis=axis, paint=2 * paint)),
        (wall, Prior(axis=axis)),  # without a road
        (wall, given(detection.road, "last")),
    ]:
        asked.clear()
        assert DETECTOR.detect(pair, prior).voted == (len(asked) == 1)
        assert len(asked) <= 1
    assert not DETECTOR.detect(wall, Prior(axis=axis)).voted
    assert not DETECTOR.detect(frame, Prior(axis=axis, paint=paint)).voted


@pytest.mark.usefixtures("misled")
@pytest.mark.parametrize("share", [1.0, 2.0], ids=["all its paint", "half its paint"])
def test_the_prior_axis_brings_the_lanes_back(frame, detection, share):
    """Even where it does not explain the pair, it has more paint than the axis of the edges."""
    alone = DETECTOR.detect(frame)
    assert alone.score < detection.score
    assert alone.birds_eye.axis != detection.birds_eye.axis
    found = DETECTOR.detect(frame, Prior(axis=detection.birds_eye.axis, paint=share * detection.score))
    assert found.score == detection.score
    assert_same_lanes(found, detection)
    np.testing.assert_array_equal(found.paint_map.feature, detection.paint_map.feature)  # both images served
    assert found.direction == detection.direction
    assert not found.note


def test_a_prior_axis_that_is_a_little_askew_is_turned_along_the_paint(frame, detection, searched):
    """As the axis of the edges is: no vote is needed where the road turns slowly."""
    own = detection.birds_eye.axis
    askew = RoadAxis(own.heading + 0.1, own.curvature)
    found = DETECTOR.detect(frame, Prior(axis=askew, paint=detection.score))
    assert "vanishing_point" not in found.seconds
    assert searched == [askew, found.birds_eye.axis]
    assert found.birds_eye.axis.heading == pytest.approx(own.heading, abs=0.02)
    assert found.score == pytest.approx(detection.score, rel=0.1)


def test_the_papers_vanishing_point_follows_no_axis(frame):
    """Its plane of the road is that of the frame."""
    detector = LaneDetector(CAMERA, replaced(DetectorConfig(), {"vanishing_point.method": "dense"}))
    alone = detector.detect(frame)
    found = detector.detect(frame, Prior(axis=alone.birds_eye.axis, paint=alone.score))
    assert list(found.seconds) == list(alone.seconds)
    assert found.direction == alone.direction
    assert_same_lanes(found, alone)
    assert detector.detect(frame, Prior(axis=ASKEW)).direction == alone.direction


def test_the_surface_of_a_moment_ago_is_where_the_fit_begins(frame, detection):
    """As long as more of the pair lies on it; the road that is found is that of this pair."""
    disparity = DETECTOR.match(frame)
    high = VerticalCurve.plane(CAMERA, 2.2, 0.1)
    for known in (None, detection.road, high):
        found = DETECTOR.detect(frame, Prior(surface=known))
        assert found.road == DETECTOR.measure_road(frame, disparity, known)
        moved = np.abs(geometry(found.road) - geometry(detection.road))
        assert np.all(moved < [1e-3, 1e-4, 1e-5, 1e-4])  # m, rad, 1/m, rad
    assert DETECTOR.measure_road(frame, disparity, high) == DETECTOR.measure_road(frame, disparity)


@pytest.mark.parametrize("method", ["arc", "dense"])
def test_the_direction_is_the_one_along_which_lanes_were_found(frame, method):
    """By either method, voted, known or turned: the plane that maps the road is the one looked through."""
    config = replaced(DetectorConfig(), {"vanishing_point.method": method})
    for prior in (Prior(), *(Prior(axis=RoadAxis(heading, 0.006), paint=60.0) for heading in (-0.06, 0.06))):
        found = LaneDetector(CAMERA, config).detect(frame, prior)
        assert found.direction.axis == found.birds_eye.axis
        assert found.direction.ipm_plane == found.birds_eye.ipm_plane


def test_a_frame_without_a_road_has_no_lanes_whatever_the_prior_axis(frame):
    wall = StereoFrame(frame.left, frame.left)
    found = DETECTOR.detect(wall, Prior(axis=RoadAxis()))
    assert found.lanes == () and found.birds_eye is None
    assert found.note == "left and right show the same picture"


def given(surface, source, reason=""):
    return Prior(lambda _: RoadEstimate(surface, source, reason))


@pytest.mark.parametrize("source", ["last", "nominal"])
def test_where_another_road_serves_the_left_image_is_looked_at_alone(frame, detection, source):
    """What was measured is kept to be told; heights are unknown, and nothing is taken for standing things."""
    surface = VerticalCurve.plane(CAMERA, 1.65, 0.0)
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
