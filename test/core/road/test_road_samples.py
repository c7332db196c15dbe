# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The v-disparity histogram and the road's path through it, on pictures small enough to check by eye."""

import numpy as np
import pytest

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.geometry.disparity_map import DisparityMap
from lane_dp_ros.core.road.road_samples import road_samples, v_disparity, v_disparity_path

pytestmark = pytest.mark.filterwarnings("error")


def test_v_disparity_counts_the_disparities_of_each_row():
    rows = np.array([0, 0, 0, 1, 1])
    disparity = np.array([1.0, 1.9, 2.0, 0.5, 9.0])  # the last bin takes what is too large
    assert v_disparity(rows, disparity, (2, 4)).tolist() == [[0, 2, 1, 0], [1, 0, 0, 1]]


def test_the_path_follows_the_road_past_a_wall():
    histogram = np.zeros((5, 12), np.float32)
    road = [1, 3, 5, 7, 7]  # two pixels a row, as steep as it may be; the bottom row costs nothing
    histogram[range(5), road] = 5
    histogram[:3, 6] = 4  # a wall 6 px near
    rows, path = v_disparity_path(histogram)
    assert rows.tolist() == [0, 1, 2, 3, 4]
    assert path.tolist() == [1.5, 3.5, 5.5, 7.5, 7.5]  # middles of the bins


def test_rows_without_a_vote_are_not_on_the_path():
    histogram = np.zeros((5, 5), np.float32)
    histogram[[0, 1, 3, 4], [1, 2, 3, 3]] = 1
    rows, path = v_disparity_path(histogram)
    assert rows.tolist() == [0, 1, 3, 4]
    assert path.tolist() == [1.5, 2.5, 3.5, 3.5]


@pytest.mark.parametrize(("offset", "first", "last"), [(0.0, 0, 400), (160.0, 160, 400), (-160.0, 0, 240)])
def test_the_share_of_matched_cells_is_of_those_that_the_right_image_shows(offset, first, last):
    """Principal points apart by 160 px: two fifths of the left image are beside the right one."""
    camera = StereoCamera(400.0, 400.0, 200.0, 20.0, 0.5, disparity_offset=offset)
    road = np.linspace(5, 40, 200, dtype=np.float32)[:, None].repeat(400, axis=1)
    road[:, :first] = road[:, last:] = np.nan
    assert road_samples(DisparityMap((200, 400), 0, road), camera, 1.6).matched > 0.99
    road[::2] = np.nan
    assert road_samples(DisparityMap((200, 400), 0, road), camera, 1.6).matched == pytest.approx(
        0.5, abs=0.01
    )
