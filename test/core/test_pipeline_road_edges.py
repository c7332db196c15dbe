# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Road edges over time: followed beside the lanes, by themselves."""

from dataclasses import replace

import numpy as np
import pytest

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.detector import LaneDetector
from lane_dp_ros.core.parameter import replaced
from lane_dp_ros.core.pipeline import LanePipeline
from lane_dp_ros.core.types import Lane, StereoFrame
from lane_dp_ros.scenes import CAMERA, render_sequence

START, TENTH = 1_316_533_000_000_000_000, 100_000_000  # ns
CONFIG = DetectorConfig()
Z = np.arange(6.0, 25.0, 0.25)


@pytest.fixture(scope="module")
def frames():
    """Eight frames of a road, 0.1 s apart, with three lines."""
    pairs = list(render_sequence(frames=8, rate=10.0, seed=1))
    return [StereoFrame(pair.left, pair.right).grey() for pair in pairs]


@pytest.fixture
def see(monkeypatch):
    """Return a function: have the detector see, frame by frame, road edges at offsets [m]."""
    detect, offsets_of_frames = LaneDetector.detect, []

    def detected(self, frame, prior, disparity=None):
        edges = tuple(map(road_edge, offsets_of_frames.pop(0)))
        return replace(detect(self, frame, prior, disparity), road_edges=edges)

    monkeypatch.setattr(LaneDetector, "detect", detected)
    return offsets_of_frames.extend


def road_edge(offset):
    points = np.column_stack([np.full_like(Z, offset), np.full_like(Z, 1.65), Z])
    return Lane(points, 0.8, 0.0, "other", 0.0, offset, kind="edge")


def follow(frames, pipeline, config=CONFIG, first=0, camera=CAMERA):
    stamps = (START + i * TENTH for i in range(first, first + len(frames)))
    return [pipeline.process(f, camera, ns, config) for f, ns in zip(frames, stamps, strict=True)]


def test_road_edges_keep_their_ids_and_have_roles_of_their_own(frames, see):
    see([(-6.0, -4.0, 5.0), (-5.9, -3.9, 5.1), (-5.8, -3.8, 5.2)])
    results = follow(frames[:3], LanePipeline())
    for result in results:
        assert [edge.role for edge in result.road_edges] == ["other", "ego_left", "ego_right"]
        assert {"ego_left", "ego_right"} < {lane.role for lane in result.lanes}
        assert {edge.kind for edge in result.road_edges} == {"edge"}
        assert all(lane.kind != "edge" for lane in result.lanes)
    ids = [[edge.id for edge in result.road_edges] for result in results]
    assert ids[0] == ids[1] == ids[2] and len(set(ids[0])) == 3


def test_lanes_are_the_same_with_and_without_road_edges(frames, see):
    see([(), (), (-2.4, 2.5), (-2.4, 2.5)])  # beside the lines, not on their paint
    without, with_edges = (follow(frames[:2], LanePipeline()) for _ in range(2))
    for one, other in zip(without, with_edges, strict=True):
        assert one.road_edges == () and len(other.road_edges) == 2
        assert [(a.id, a.role) for a in one.lanes] == [(b.id, b.role) for b in other.lanes]
        for a, b in zip(one.lanes, other.lanes, strict=True):
            np.testing.assert_array_equal(a.points, b.points)


def test_road_edges_are_smoothed(frames, see):
    """One wobbles by 3 cm from frame to frame beside two that do not: it is published as wobbling less."""
    see([(-4.0, 4.0 + 0.015 * (-1) ** i, 7.0) for i in range(8)])
    found = [result.road_edges[1].points[:, 0].mean() for result in follow(frames, LanePipeline())]
    assert np.abs(np.diff(found[3:])).max() < 0.027


def test_a_lost_road_edge_coasts_with_less_confidence(frames, see):
    see([(-4.0, 4.0)] * 6 + [(-4.0,)] * 2)
    results = follow(frames, LanePipeline())
    lost = results[5].road_edges[1].id
    (coasted,) = (edge for edge in results[7].road_edges if edge.id == lost)
    assert (coasted.kind, coasted.role) == ("edge", "ego_right")
    assert 0 < coasted.confidence < 0.8
    assert coasted.points[:, 0].mean() == pytest.approx(4.0, abs=0.2)


def test_without_tracking_road_edges_get_ids_only(frames, see):
    see([(4.0,), (4.1,), ()])
    off = replaced(CONFIG, {"tracking.enabled": False})
    first, second, third = follow(frames[:3], LanePipeline(), off)
    assert first.road_edges[0].id == second.road_edges[0].id >= 0
    np.testing.assert_array_equal(second.road_edges[0].points, road_edge(4.1).points)
    assert third.road_edges == ()


def test_another_camera_or_a_jump_of_time_ends_what_was_followed(frames, see):
    pipeline = LanePipeline()
    see([(4.0,)] * 3)
    (first,) = follow(frames[:1], pipeline)
    nearer = replace(CAMERA, baseline=0.9 * CAMERA.baseline)
    (other,) = follow(frames[:1], pipeline, first=1, camera=nearer)
    (later,) = follow(frames[:1], pipeline, first=30, camera=nearer)
    assert len({result.road_edges[0].id for result in (first, other, later)}) == 3
