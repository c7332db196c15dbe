# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Surfaces a little off rendered roads are moved onto them; where too little is to be seen they stay."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lane_dp_ros.core.geometry.disparity_map import DisparityMap
from lane_dp_ros.core.geometry.road_surface import geometry
from lane_dp_ros.core.geometry.vertical_curve import VerticalCurve
from lane_dp_ros.core.road.direct_alignment import aligned
from lane_dp_ros.core.road.disparity import DisparityConfig, dense_disparity
from lane_dp_ros.core.types import StereoFrame
from lane_dp_ros.scenes import CAMERA, Road, render_pair

pytestmark = pytest.mark.filterwarnings("error")

HEIGHT, PITCH = 1.65, 0.012  # m, rad; the rendered road's
TRUTH = VerticalCurve.plane(CAMERA, HEIGHT, PITCH)
LARGEST = 103.0  # px
OFF = st.floats(-1, 1)
OFF_AT_MOST = np.array([0.015 * HEIGHT, 3e-3, 1e-3, 0.01])  # m, rad, 1/m, rad
WITHIN = np.array([0.003 * HEIGHT, 5e-4, 3e-4, 1e-3])


@pytest.fixture(scope="module")
def frame(rendered):
    """A rendered bend."""
    pair = rendered(render_pair, Road(curvature=0.005, swing=0), 50.0, 3)
    return StereoFrame(pair.left, pair.right).grey()


@pytest.fixture(scope="module")
def disparity(frame):
    return dense_disparity(frame, CAMERA, DisparityConfig(), LARGEST)


def registered(*arguments):
    return aligned(*arguments).surface


def moved(surface, *shares):
    """Return the surface off by these shares of what is brought back."""
    return VerticalCurve.of_geometry(surface.camera, geometry(surface) + OFF_AT_MOST * shares)


def error(found, truth=TRUTH):
    return np.abs(geometry(found) - geometry(truth))


def changed(frame, gain, brightness=0.0, noise=0.0):
    """Return the pair with other grey values about 100 and with noise."""
    rng = np.random.default_rng(0)
    images = (
        100 + gain * (image - 100.0) + brightness + rng.normal(0, noise, image.shape)
        for image in (frame.left, frame.right)
    )
    return StereoFrame(*(np.clip(np.rint(image), 0, 255).astype(np.uint8) for image in images))


@settings(max_examples=60)
@given(height=OFF, pitch=OFF, curvature=OFF, roll=OFF)
def test_a_surface_nearby_is_brought_back(frame, disparity, height, pitch, curvature, roll):
    start = moved(TRUTH, height, pitch, curvature, roll)
    assert np.all(error(registered(start, frame, disparity)) < WITHIN)


def test_roads_of_another_height_and_pitch(scene):
    road, pair = scene
    frame = StereoFrame(pair.left, pair.right)
    truth = VerticalCurve.plane(CAMERA, road.camera_height, road.pitch)
    disparity = dense_disparity(frame, CAMERA, DisparityConfig(), LARGEST)
    for sign in (-1, 1):
        found = registered(moved(truth, sign, -sign, sign, sign), frame, disparity)
        assert np.all(error(found, truth) < WITHIN)


@settings(max_examples=10)
@given(offset=st.integers(-300, 300))
def test_principal_points_may_lie_apart(frame, offset):
    """The right camera looks so many pixels to the side; what it no longer shows is not looked at."""
    camera = replace(CAMERA, disparity_offset=float(offset))
    turned = StereoFrame(frame.left, np.roll(frame.right, -offset, axis=1))
    disparity = dense_disparity(turned, camera, DisparityConfig(), LARGEST)
    truth = VerticalCurve(camera, TRUTH.coefficients)
    found = registered(moved(truth, 0.5, 0.5, 0.5, 0.5), turned, disparity)
    assert np.all(error(found, truth) < WITHIN)


@pytest.mark.parametrize("brightness", [-20, 20])  # grey levels
@pytest.mark.parametrize("gain", [0.9, 1.1])
def test_a_camera_of_other_brightness_and_contrast_moves_nothing(frame, disparity, gain, brightness):
    other = StereoFrame(frame.left, changed(frame, gain, brightness).right)
    start = moved(TRUTH, 0.5, 0.5, 0.5, 0.5)
    found, alike = (registered(start, each, disparity) for each in (other, frame))
    assert np.all(error(found) < WITHIN)
    assert np.all(error(found, alike) < WITHIN)


def test_the_covariance_is_symmetric_and_positive_definite(frame, disparity):
    covariance = registered(moved(TRUTH, 0.5, 0.5, 0.5, 0.5), frame, disparity).covariance
    assert covariance.shape == (4, 4)
    np.testing.assert_allclose(covariance, covariance.T, rtol=1e-6, atol=1e-15)
    assert np.all(np.linalg.eigvalsh(covariance) > 0)
    # Millimetres and hundredths of a degree: the errors are of this size, too.
    deviations = np.sqrt(np.diag(covariance))
    assert np.all(deviations > [1e-4, 1e-5, 1e-6, 1e-5])
    assert np.all(deviations < [5e-3, 5e-4, 2e-4, 1e-3])


def test_less_texture_makes_a_surface_less_certain(frame, disparity):
    """A sixth of the contrast, in the same noise of 2 grey levels."""
    clear, faint = (
        registered(TRUTH, changed(frame, gain, noise=2.0), disparity).covariance for gain in (1.0, 0.15)
    )
    assert np.all(np.diag(faint) > 3 * np.diag(clear))


def test_less_of_the_road_makes_its_cross_slope_less_certain(frame, disparity):
    """The left half alone."""
    half = disparity.matched.copy()
    half[:, half.shape[1] // 2 :] = np.nan
    whole, part = (registered(TRUTH, frame, replace(disparity, matched=m)) for m in (disparity.matched, half))
    assert part.covariance[3, 3] > 2 * whole.covariance[3, 3]
    assert np.all(error(part) < 2 * WITHIN)


def test_without_a_right_image_the_surface_stays(frame, disparity):
    assert registered(TRUTH, StereoFrame(frame.left), disparity) is TRUTH


def test_a_pair_without_texture_leaves_the_surface_as_it_is(frame, disparity):
    blank = StereoFrame(*(np.full_like(frame.left, 90) for _ in range(2)))
    found = registered(TRUTH, blank, disparity)
    assert found == TRUTH
    assert found.covariance is None


def test_where_nothing_was_matched_the_surface_stays(frame):
    found = registered(TRUTH, frame, DisparityMap.unknown(frame.left.shape))
    assert found == TRUTH
    assert found.covariance is None


def test_where_the_matched_road_is_another_one_the_surface_stays(frame, disparity):
    """It lies half a metre lower: no pixel is taken for road."""
    lower = VerticalCurve.plane(CAMERA, HEIGHT + 0.5, PITCH)
    found = registered(lower, frame, disparity)
    assert found == lower
    assert found.covariance is None


def test_the_near_road_alone_is_enough(frame, disparity):
    """12 m ahead the view ends: a lorry, or the crest of a ramp."""
    near = disparity.matched.copy()
    near[disparity.centres[1] < CAMERA.cy + CAMERA.fy * HEIGHT / 12] = np.nan
    found = registered(moved(TRUTH, 0.3, 0.3, 0.0, 0.3), frame, replace(disparity, matched=near))
    assert np.all(error(found)[[0, 1, 3]] < 3 * WITHIN[[0, 1, 3]])


@settings(max_examples=200)  # every pair of values
@given(data=st.data())
def test_awkward_images_and_disparities_give_a_surface(awkward, data):
    image, disparity, camera = data.draw(awkward)
    surface = VerticalCurve.plane(camera, HEIGHT, PITCH)
    found = registered(surface, StereoFrame(image, image), disparity)
    assert np.isfinite(found.coefficients).all()


@given(
    focal=st.floats(150, 4000),
    height=st.floats(0.25, 4.0),
    cy=st.floats(0, 350),
    pitch=st.floats(-0.15, 0.15),
    cell=st.integers(1, 12),
)
def test_no_camera_is_too_awkward(disparity_of, focal, height, cy, pitch, cell):
    """The road is as it was matched; near and far road may lie outside the image."""
    camera = replace(CAMERA, fx=focal, fy=focal, cx=160.0, cy=cy)
    surface = VerticalCurve.plane(camera, height, pitch)
    image = np.random.default_rng(0).integers(0, 256, (200, 320)).astype(np.uint8)
    found = registered(surface, StereoFrame(image, image), disparity_of(surface, image.shape, cell))
    assert np.isfinite(found.coefficients).all()


def test_how_much_of_the_road_is_alike_in_both_images(frame, disparity):
    """A right image of another moment shows another road beneath the same surface."""
    assert aligned(TRUTH, frame, disparity).agreement > 0.95
    other = StereoFrame(frame.left, np.ascontiguousarray(frame.right[:, ::-1]))
    assert aligned(TRUTH, other, disparity).agreement < 0.8
    assert aligned(TRUTH, StereoFrame(frame.left), disparity).agreement == 1
