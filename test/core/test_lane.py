# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""A lane line."""

import numpy as np

from lane_dp_ros.core.types import Lane


def test_extent_is_the_depth_of_the_nearest_and_farthest_point():
    points = np.array([[-1.7, 1.6, 5.0], [-1.7, 1.6, 5.5], [-1.6, 1.6, 6.0]])
    lane = Lane(points, 0.8, 0.15, "ego_left", 0.0, -1.7)
    assert lane.extent == (5.0, 6.0)
    assert lane.id == -1  # nobody has tracked it yet
