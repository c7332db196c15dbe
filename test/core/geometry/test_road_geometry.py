# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""A surface in physical terms: there and back, and by points on it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lane_dp_ros.core.geometry.road_surface import RoadSurface, geometry, surface_of
from lane_dp_ros.scenes import CAMERA

NOMINAL = RoadSurface.plane(CAMERA, 1.5, 0.0)


@given(st.floats(1.0, 3.0), st.floats(-0.15, 0.15), st.floats(-0.15, 0.15), st.floats(-3e-3, 3e-3))
def test_a_surface_has_the_geometry_that_it_is_made_of(height, pitch, roll, curvature):
    values = np.array([height, pitch, roll, curvature])
    np.testing.assert_allclose(geometry(surface_of(NOMINAL, values)), values, rtol=1e-6, atol=1e-9)


def test_a_plane_has_its_height_and_pitch_and_no_more():
    assert geometry(RoadSurface.plane(CAMERA, 1.6, 0.02)) == pytest.approx([1.6, 0.02, 0.0, 0.0])


def test_the_vertical_curvature_is_that_of_the_heights():
    """Points 8, 10 and 12 m ahead lie on a parabola of that curvature, which climbs."""
    surface = surface_of(NOMINAL, np.array([1.65, 0.0, 0.0, 2e-3]))
    z = np.array([8.0, 10.0, 12.0])
    _, v = surface.ground_to_pixel(np.zeros(3), z)
    down = (v - CAMERA.cy) * z / CAMERA.fy
    assert -np.diff(down, 2)[0] / 2.0**2 == pytest.approx(2e-3, rel=0.05)
