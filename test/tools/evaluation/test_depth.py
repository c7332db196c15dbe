# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The depth of a surface against the truth's: planes whose error can be told without a computer."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.geometry.vertical_curve import VerticalCurve
from lane_dp_ros.tools.evaluation.annotations import LabelledFrame
from lane_dp_ros.tools.evaluation.depth import (
    CURVE_DEPTHS,
    DEPTHS,
    NO_SURFACE,
    DepthErrors,
    DepthSummary,
    depth_errors,
)
from lane_dp_ros.tools.evaluation.scores import FrameScore
from lane_dp_ros.tools.evaluation.summary import summarise
from lane_dp_ros.tools.evaluation.text import surface_tables

CAMERA = StereoCamera(700.0, 700.0, 600.0, 180.0, 0.54)


def frame(ground=(0.0, 100 * 0.54 / 1.65, 0.0, 0.0), size=(1200, 375), **fields):
    """Return a frame without labels; by default of a plane 1.65 m below the camera."""
    return LabelledFrame("a/0", CAMERA, size, np.array(ground), (), **fields)


def plane(height, pitch=0.0):
    return VerticalCurve.plane(CAMERA, height, pitch)


def constant(error):
    return DepthErrors((error,) * len(CURVE_DEPTHS))


def test_the_true_surface_has_no_error():
    np.testing.assert_allclose(depth_errors(frame(), plane(1.65)).errors, 0, atol=1e-12)


def test_a_camera_taken_to_stand_2_per_cent_too_high_sees_2_per_cent_too_deep():
    summary = DepthSummary.of(depth_errors(frame(), plane(1.02 * 1.65)))
    for depth in DEPTHS:
        assert summary.bias(depth) == pytest.approx(0.02) == pytest.approx(summary.spread(depth))
    assert DepthSummary.of(depth_errors(frame(), plane(0.98 * 1.65))).bias(8.0) == pytest.approx(-0.02)


@given(factor=st.floats(0.8, 1.25), pitch=st.floats(-0.04, 0.04), roll=st.floats(-2, 2))
def test_every_factor_of_the_depth_is_reported_as_it_is(factor, pitch, roll):
    """Straight ahead neither pitch nor roll matter, as both surfaces have the same."""
    g0, g1 = (700 * 0.54 / 1.65 * part for part in (math.sin(pitch), math.cos(pitch) / 7))
    errors = depth_errors(frame((g0, g1, 0, roll)), plane(factor * 1.65, pitch)).errors
    np.testing.assert_allclose(np.array(errors)[~np.isnan(errors)], factor - 1, atol=1e-9)
    assert not np.isnan(errors[10:]).any()  # from 16 m on all lie in the picture


def test_a_wrong_pitch_is_seen_in_the_distance():
    errors = depth_errors(frame(), plane(1.65, 0.01)).errors
    # tan(pitch) more: at depth z the ray falls by 1.65 / z a metre; z' = 1.65 / (1.65 / z + 0.01).
    assert errors[2] == pytest.approx(1 / (1 + 0.01 * 8 / 1.65) - 1, abs=1e-3)
    assert errors[19] == pytest.approx(1 / (1 + 0.01 * 25 / 1.65) - 1, abs=1e-3)


def test_nothing_is_said_where_the_road_is_not_in_the_picture():
    errors = np.array(depth_errors(frame(size=(1200, 285)), plane(1.65)).errors)  # 105 rows: 11 m
    assert np.isnan(errors[CURVE_DEPTHS <= 11]).all() and not np.isnan(errors[CURVE_DEPTHS >= 12]).any()
    assert np.isnan(depth_errors(frame(size=(500, 375)), plane(1.65)).errors).all()  # cx is 600


def test_nothing_is_said_beyond_the_reach_of_the_truth():
    errors = np.array(depth_errors(frame(), plane(1.65), reach=20.0).errors)
    assert np.isnan(errors).tolist() == (CURVE_DEPTHS > 20).tolist()


def test_the_exact_profile_goes_before_the_ground():
    z = np.arange(5.0, 32.0)
    profile = np.column_stack([z, 180 + 700 * 1.5 / z])  # 1.5 m below, where the ground says 1.65 m
    truth = frame(profile=profile)
    np.testing.assert_allclose(truth.rows_ahead([7.0, 8.5, 25.0]), 180 + 700 * 1.5 / np.array([7, 8.5, 25]))
    assert np.isnan(truth.rows_ahead([4.0, 32.0])).all()
    np.testing.assert_allclose(depth_errors(truth, plane(1.5)).errors, 0, atol=1e-12)


@given(
    g0=st.floats(-3, 3), g1=st.floats(25, 40), g2=st.floats(-2, 2), z=st.floats(7, 30)
)  # fmt: skip
def test_the_row_of_a_depth_has_that_depth_on_the_ground(g0, g1, g2, z):
    truth = frame((g0, g1, g2, 0.7))
    (row,) = truth.rows_ahead([z])
    if not math.isnan(row):
        assert truth.on_ground([[600.0, row]])[0].tolist() == [0.0, pytest.approx(z)]


def test_a_ground_that_never_gets_so_near_has_no_row():
    assert np.isnan(frame((0, 30, -10, 0)).rows_ahead([8.0])).all()  # at most 22.5 px: 16.8 m


def test_bias_and_spread():
    summary = sum(map(DepthSummary.of, map(constant, (-0.01, 0.0, 0.04))), DepthSummary())
    assert summary.bias(8.0) == 0.0
    assert summary.spread(8.0) == pytest.approx(0.01 + 0.8 * 0.03)  # of 0, 0.01, 0.04, at 1.8 of 2
    assert (summary.frames, summary.no_surface, summary.count(8.0)) == (3, 0, 3)
    curve = summary.curve()
    assert curve.depths.tolist() == list(range(6, 31)) and curve.counts.tolist() == [3] * 25
    np.testing.assert_allclose(curve.low, -0.01 + 0.1 * 0.01)
    np.testing.assert_allclose(curve.high, 0.04 - 0.1 * 0.04)


def test_frames_without_a_surface_are_counted_apart():
    summary = DepthSummary.of(constant(0.01)) + DepthSummary.of(NO_SURFACE) + DepthSummary.of(None)
    assert (summary.frames, summary.no_surface, summary.bias(25.0)) == (2, 1, 0.01)
    assert depth_errors(frame(), None) is NO_SURFACE
    assert math.isnan(DepthSummary().bias(8.0)) and math.isnan(DepthSummary().spread(8.0))


def test_the_table():
    scores = [FrameScore("a/0", "a", "", None, (), depth=constant(0.0213))]
    scores += [replace(scores[0], name="b/0", sequence="b", depth=NO_SURFACE)]
    lines = surface_tables(scores).splitlines()
    assert lines[0].split() == ["depth", "%", "90", "%"] * 4 + ["no"]
    assert lines[2].split() == ["a", *["+2.13", "2.13"] * 4, "0"]
    assert lines[3].split() == ["b", *["-"] * 8, "1"]
    assert summarise(scores).depth.frames == 2
