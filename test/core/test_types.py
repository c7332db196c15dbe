# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Stereo frames, the prior of nothing, and lanes."""

import numpy as np
import pytest

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.geometry.quadratic_surface import QuadraticSurface
from lane_dp_ros.core.types import Lane, Prior, RoadEstimate, StereoFrame, with_roles

GREY = np.zeros((20, 30), np.uint8)


@pytest.mark.parametrize(
    ("left", "right", "message"),
    [
        (GREY, GREY[:, 1:], "the images differ in size: left 30x20, right 29x20, expected equal"),
        (GREY, GREY[1:], "left 30x20, right 30x19"),
        (GREY.astype(float), GREY, r"the left image is float64 \(20, 30\), expected uint8 \(H, W\)"),
        (GREY, GREY.astype(np.uint16), r"the right image is uint16 \(20, 30\), expected uint8"),
        (GREY[0], GREY, r"the left image is uint8 \(30,\)"),
        (None, GREY, r"the left image is NoneType, expected an array"),
        (GREY, GREY.tolist(), r"the right image is list, expected an array"),
        (np.zeros((20, 30, 4), np.uint8), GREY, r"the left image is uint8 \(20, 30, 4\), .* or \(H, W, 3\)"),
        (GREY[:0], GREY[:0], r"the left image is empty: \(0, 30\)"),
        (GREY, np.zeros((0, 0, 3), np.uint8), r"the right image is empty: \(0, 0, 3\)"),
    ],
)
def test_bad_images_are_refused(left, right, message):
    with pytest.raises(ValueError, match=message):
        StereoFrame(left, right)


@pytest.mark.parametrize(
    "left", [GREY.tolist(), None, GREY[0], GREY.astype(float)], ids=["list", "none", "row", "float"]
)
def test_a_bad_left_image_is_refused_without_a_right_one_as_well(left):
    with pytest.raises(ValueError, match="the left image is"):
        StereoFrame(left)


def test_a_frame_may_lack_its_right_image():
    frame = StereoFrame(GREY)
    assert frame.right is None
    assert frame.grey().right is None


def test_coloured_images_become_grey_and_grey_ones_stay():
    """BGR: 0.114 B + 0.587 G + 0.299 R."""
    colour = np.zeros((2, 3, 3), np.uint8)
    colour[0, 0], colour[0, 1], colour[0, 2] = (200, 0, 0), (0, 200, 0), (0, 0, 200)
    grey = np.arange(6, dtype=np.uint8).reshape(2, 3)
    frame = StereoFrame(colour, grey).grey()
    assert frame.left.tolist() == [[23, 117, 60], [0, 0, 0]]
    assert frame.right.tolist() == grey.tolist()


def test_views_of_larger_images_become_images_of_their_own():
    """OpenCV takes no views with steps."""
    large = np.arange(48, dtype=np.uint8).reshape(6, 8)
    frame = StereoFrame(large[::2, ::2], large[::2, 1::2]).grey()
    assert frame.left.flags.c_contiguous and frame.right.flags.c_contiguous
    assert frame.left.tolist() == large[::2, ::2].tolist()


def test_without_frames_before_what_is_measured_serves():
    surface = QuadraticSurface.plane(StereoCamera(700.0, 700.0, 320.0, 120.0, 0.5), 1.65, 0.0)
    prior = Prior()
    assert prior.road(surface) == RoadEstimate(surface, "measured", "")
    assert prior.road(None) == RoadEstimate(None, "none", "")
    assert prior.surface is prior.axis is prior.paint is None


def test_extent_is_the_depth_of_the_nearest_and_farthest_point():
    points = np.array([[-1.7, 1.6, 5.0], [-1.7, 1.6, 5.5], [-1.6, 1.6, 6.0]])
    lane = Lane(points, 0.8, 0.15, "ego_left", 0.0, -1.7)
    assert lane.extent == (5.0, 6.0)
    assert lane.id == -1  # nobody has tracked it yet


def line_at(offset, kind=""):
    points = np.array([[offset, 1.65, 5.0], [offset, 1.65, 5.5]])
    return Lane(points, 0.9, 0.15, "other", 0.0, offset, kind=kind)


def test_lanes_and_road_edges_have_roles_among_themselves():
    mixed = [
        line_at(-5.0),
        line_at(-1.5, "edge"),
        line_at(-1.75, "solid"),
        line_at(2.0),
        line_at(1.0, "edge"),
        line_at(4.0, "edge"),
    ]
    roles = [line.role for line in with_roles(mixed)]
    assert roles == ["other", "ego_left", "ego_left", "ego_right", "ego_right", "other"]


def test_a_lane_keeps_its_role_beside_a_road_edge_that_is_nearer():
    lanes = with_roles([line_at(-1.75), line_at(1.75)])
    assert [lane.role for lane in lanes] == ["ego_left", "ego_right"]
    assert with_roles([*lanes, line_at(0.5, "edge")])[:2] == lanes
