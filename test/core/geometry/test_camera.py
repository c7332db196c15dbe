# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The stereo camera: KITTI's own numbers, projections there and back, and matrices that make no camera."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lane_dp_ros.core.geometry.camera import StereoCamera

# KITTI odometry, sequence 02, calib.txt: P2 and P3, the colour cameras; both P[0,3] are not zero.
P2 = np.array([
    [718.856, 0, 607.1928, 45.38225], [0, 718.856, 185.2157, -0.1130887], [0, 0, 1, 0.003779761],
])  # fmt: skip
P3 = np.array([
    [718.856, 0, 607.1928, -337.2877], [0, 718.856, 185.2157, 2.369057], [0, 0, 1, 0.004915215],
])  # fmt: skip
POINTS = st.lists(
    st.tuples(st.floats(-30, 30), st.floats(-5, 5), st.floats(1, 100)), min_size=1, max_size=5
).map(np.array)


def with_value(P, row, column, value):
    changed = P.copy()
    changed[row, column] = value
    return changed


def pixels_by_matrix(P, points):
    u, v, w = P @ np.column_stack([points, np.ones(len(points))]).T
    return np.column_stack([u / w, v / w])


def test_kittis_colour_cameras():
    camera = StereoCamera.from_projections(P2, P3)
    assert (camera.fx, camera.fy, camera.cx, camera.cy) == (718.856, 718.856, 607.1928, 185.2157)
    assert camera.baseline == pytest.approx(0.532332, abs=1e-6)  # (45.38225 + 337.2877) / 718.856
    assert camera.disparity_offset == 0
    # (45.38225 - 607.1928 * 0.003779761) / 718.856: the colour camera stands 6 cm beside the grey one
    assert camera.left_translation == pytest.approx((0.059939, -0.001131, 0.003780), abs=1e-6)


def test_the_projection_matrix_comes_back():
    np.testing.assert_allclose(StereoCamera.from_projections(P2, P3).P_left, P2, atol=1e-12)


@pytest.mark.parametrize("shape", [(12,), (3, 4), (1, 12)])
def test_matrices_may_come_as_twelve_values(shape):
    given_flat = StereoCamera.from_projections(P2.reshape(shape).tolist(), P3.reshape(shape))
    assert given_flat == StereoCamera.from_projections(P2, P3)


def test_different_principal_points_shift_the_disparity():
    camera = StereoCamera.from_projections(P2, with_value(P3, 0, 2, 600.0))
    assert camera.disparity_offset == pytest.approx(7.1928)


@given(points=POINTS)
def test_projecting_is_the_matrix_product(points):
    camera = StereoCamera.from_projections(P2, P3)
    np.testing.assert_allclose(camera.project(points), pixels_by_matrix(P2, points), atol=1e-8)


@given(points=POINTS)
def test_points_come_back_from_their_pixels_and_depths(camera, points):
    depth = points[:, 2] + camera.left_translation[2]
    np.testing.assert_allclose(camera.back_project(camera.project(points), depth), points, atol=1e-9)


@given(points=POINTS, offset=st.floats(-20, 20))
def test_disparity_is_that_of_the_two_projections(points, offset):
    P_left = np.array([[700.0, 0, 300, 35], [0, 650, 120, 0], [0, 0, 1, 0]])
    P_right = P_left - [[0, 0, offset, 350], [0] * 4, [0] * 4]
    camera = StereoCamera.from_projections(P_left, P_right)
    left, right = (pixels_by_matrix(P, points) for P in (P_left, P_right))
    expected = camera.fx * camera.baseline / points[:, 2] + camera.disparity_offset
    np.testing.assert_allclose(left[:, 0] - right[:, 0], expected, atol=1e-8)


def test_one_point_may_come_alone(camera):
    assert camera.project([0.0, 0.0, 10.0]).shape == (1, 2)
    assert camera.back_project([330.0, 120.0], [10.0]).shape == (1, 3)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"fx": 0.0}, "fx is 0.0, expected a focal length > 0 px"),
        ({"fy": float("nan")}, "fy is nan, expected a focal length > 0 px"),
        ({"fx": float("inf")}, "fx is inf, expected"),
        ({"cx": float("nan")}, "not finite numbers"),
        ({"disparity_offset": float("inf")}, "not finite numbers"),
        ({"left_translation": (0.0, float("nan"), 0.0)}, "not finite numbers"),
        (
            {"baseline": 0.0},
            r"the baseline is 0 m, expected 0.01 to 4 m on a vehicle \(P\[0,3\] is equal left",
        ),
        ({"baseline": 540.0}, r"is 540 m, expected 0.01 to 4 m on a vehicle \(is P\[0,3\] in px mm\?\)"),
        ({"baseline": 7.5}, r"is 7.5 m, expected 0.01 to 4 m on a vehicle \(is P\[0,3\] in px cm\?\)"),
        ({"baseline": 54.0}, r"\(is P\[0,3\] in px mm or px cm\?\)"),
        ({"baseline": 0.54 / 700}, r"\(is P\[0,3\] in px km, or without its factor fx\?\)"),
        ({"baseline": 1e9}, r"is 1e\+09 m, .* \(P\[0,3\] is -fx \* baseline \[px m\]\)"),
        ({"baseline": float("inf")}, "the baseline is inf m, expected > 0"),
        ({"baseline": -0.54}, "the baseline is -0.54 m, expected > 0"),
        ({"baseline": float("nan")}, "the baseline is nan m, expected > 0"),
    ],
)
def test_values_of_no_camera_are_refused(changes, message):
    with pytest.raises(ValueError, match=message):
        StereoCamera(**{"fx": 700.0, "fy": 700.0, "cx": 300.0, "cy": 100.0, "baseline": 0.5} | changes)


# D405, D435, OAK-D, ZED 2, KITTI, mirrors of a lorry; calibrations with rounded numbers
@pytest.mark.parametrize("baseline", [0.018, 0.05, 0.075, 0.12, 0.54, 2.6])
def test_the_baselines_that_vehicles_have_are_taken(baseline):
    P_left = np.array([[700.0, 1e-9, 300, 0], [0, 702, 120, 0], [1e-12, 0, 1, 0]])
    P_right = P_left - [[0.1, 0, 20, 700 * baseline], [0, 0.2, 0.3, 0], [0] * 4]
    assert StereoCamera.from_projections(P_left, P_right).baseline == pytest.approx(baseline)


@pytest.mark.parametrize(
    ("P_left", "P_right", "message"),
    [
        (P2[:, :3], P3, r"P of the left camera has 9 values, expected 12 \(3x4\)"),
        (P2, [], r"P of the right camera has 0 values, expected 12 \(3x4\)"),
        (np.zeros(12), np.zeros(12), r"fx = 0, fy = 0, expected > 0 \(not calibrated\?\)"),
        (with_value(P2, 0, 0, np.nan), P3, "fx = nan, fy = 718.856, expected > 0"),
        (with_value(P2, 1, 1, -1), P3, "fx = 718.856, fy = -1, expected > 0"),
        (with_value(P2, 1, 3, np.inf), P3, "not finite numbers"),
        (P2, with_value(P3, 0, 3, np.nan), "not finite numbers"),
        (P2, with_value(P3, 0, 0, 800), r"fx is 718.856 px left and 800 px right, expected equal"),
        (P2, with_value(P3, 1, 2, 190), r"cy is 185.216 px left and 190 px right, expected equal"),
        (P2, with_value(P3, 1, 3, -400), "the right camera stands above or below the left one"),
        (with_value(P2, 2, 2, 0), P3, r"P of the left camera has the third row \[.*\], expected 0 0 1 t"),
        (P3, P2, r"the baseline is -0.5323 m, expected > 0 \(left and right swapped\?\)"),
        (P2, P2, r"the baseline is 0 m, .*\(P\[0,3\] is equal left and right, expected -fx \* baseline"),
        (
            P2,
            with_value(P3, 0, 1, 52.4),
            r"P of the right camera has a skew of 52.4 px \(P\[0,1\]\), expected 0",
        ),
        (with_value(P2, 0, 1, -3), P3, r"P of the left camera has a skew of -3 px \(P\[0,1\]\), expected 0"),
        (P2, with_value(P3, 1, 0, 9), r"P of the right camera has a skew of 9 px \(P\[1,0\]\), expected 0"),
        (P2, with_value(P3, 1, 1, 640), "fy is 718.856 px left and 640 px right, expected equal"),
        (P2, with_value(P3, 2, 0, 0.05), "P of the right camera has the third row .* expected 0 0 1 t"),
        (P2, with_value(P3, 0, 0, np.nan), "P of the right camera has fx = nan"),
    ],
)
def test_matrices_of_no_stereo_camera_are_refused(P_left, P_right, message):
    with pytest.raises(ValueError, match=message):
        StereoCamera.from_projections(P_left, P_right)
