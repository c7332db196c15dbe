# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What the left picture alone may be trusted with: paint, but not what merely looks like it."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from lane_dp_ros.core.detector import LaneDetector
from lane_dp_ros.core.geometry.quadratic_surface import QuadraticSurface
from lane_dp_ros.core.lanes.candidate import Candidate, LaneEvidence, LaneLine
from lane_dp_ros.core.lanes.mono_fallback import MonoFallbackConfig, is_kept, without_heights
from lane_dp_ros.core.types import Lane, Prior, RoadEstimate, StereoFrame
from lane_dp_ros.scenes import CAMERA, SIZE, Road, render_pair
from lane_dp_ros.scenes.road import SOLID, UNPAINTED

CONFIG = MonoFallbackConfig()
DOUBTED = 0.5  # confidence
PAINT = LaneEvidence(
    paint_width=0.15,
    wide_band_ratio=0.4,
    height=np.nan,  # as it is without a right picture
    kerb_step=0.0,
    slope=0.01,
    off_paint_fraction=0.02,
    texture=0.03,
    contrast=0.6,
    saturation_contrast=0.4,
    brightness=0.6,
    longest_segment=20.0,
    dashes=1,
)


def line(n=1.5, score=15.0, start=6.0):
    s = np.arange(start, 30.0, 0.25)
    return LaneLine(np.arange(len(s)), s, np.full(len(s), n), 0.0, score)


def judged(lines, evidence, config=CONFIG):
    """Return the confidences, in the order of the lines; each is 0.9 before."""
    order = np.argsort([each.n[0] for each in lines])
    candidates = [Candidate(lines[i], evidence[i]) for i in order]
    lanes = [Lane(np.zeros((2, 3)), 0.9, 0.15, "other", 0.0, float(lines[i].n[0])) for i in order]
    found = without_heights(lanes, candidates, config)
    return [found[list(order).index(i)].confidence for i in range(len(lines))]


def test_paint_is_not_doubted():
    assert judged([line(1.5), line(-1.8)], [PAINT, PAINT]) == [0.9, 0.9]


@pytest.mark.parametrize(
    "unlike",
    [
        {"paint_width": 0.08},
        {"paint_width": 0.3},
        {"wide_band_ratio": 0.0},
        {"brightness": 0.1},
        {"texture": 0.12},
    ],
    ids=str,
)
def test_what_is_unlike_paint_is_doubted(unlike):
    assert judged([line(1.5), line(-1.8)], [replace(PAINT, **unlike), PAINT]) == [DOUBTED, 0.9]


@pytest.mark.parametrize("given", [{"score": 5.0}, {"start": 13.0}], ids=str)
def test_little_paint_and_paint_far_off_are_doubted(given):
    assert judged([line(-1.8), line(1.5, **given)], [PAINT, PAINT]) == [0.9, DOUBTED]


@pytest.mark.parametrize(("n", "confidence"), [(3.1, DOUBTED), (5.0, 0.9), (1.9, 0.9)])
def test_a_rail_beside_the_border_line_is_doubted_but_the_next_lane_and_a_double_line_are_not(n, confidence):
    assert judged([line(n), line(1.4), line(-1.8)], [PAINT] * 3) == [confidence, 0.9, 0.9]


def test_a_line_on_the_vehicles_other_side_makes_no_rail():
    """Between the two of them is the vehicle."""
    assert judged([line(1.4), line(-0.2)], [PAINT] * 2) == [0.9, 0.9]


def test_what_is_doubted_already_is_not_lifted():
    lane = Lane(np.zeros((2, 3)), 0.2, 0.15, "other", 0.0, 1.5)
    candidate = Candidate(line(1.5), replace(PAINT, wide_band_ratio=-1.0))
    (found,) = without_heights([lane], [candidate], CONFIG)
    assert found.confidence == 0.2


def lane_at(x, confidence, first=6.0, last=20.0):
    z = np.arange(first, last, 0.25)
    points = np.stack([np.full_like(z, x), np.full_like(z, 1.65), z], axis=1)
    return Lane(points, confidence, 0.15, "other", 0.0, x)


@pytest.mark.parametrize(
    ("lane", "goes_on"),
    [
        (lane_at(5.0, 0.8), True),  # new, and not doubted
        (lane_at(5.0, DOUBTED), False),
        (lane_at(1.9, DOUBTED), True),  # where one was known
        (lane_at(1.9, 0.2, first=10.0, last=30.0), True),
        (lane_at(2.2, DOUBTED), False),  # beside it
        (lane_at(1.75, DOUBTED, first=18.0, last=30.0), False),  # beyond its end
    ],
)
def test_of_doubted_lines_those_that_go_on_with_a_known_one_are_kept(lane, goes_on):
    known = (lane_at(-1.75, 0.9), lane_at(1.75, 0.3))
    assert is_kept(lane, known, CONFIG) == goes_on


def test_where_nothing_is_known_no_doubted_line_is_kept():
    lanes = [lane_at(-1.75, 0.8), lane_at(1.75, DOUBTED)]
    assert [is_kept(lane, (), CONFIG) for lane in lanes] == [True, False]


AT_LIMITS = {
    "paint_width_min": (0.12, {"paint_width": 0.11}),
    "paint_width_max": (0.2, {"paint_width": 0.25}),
    "wide_band_ratio_min": (0.5, {}),
    "brightness_min": (0.7, {}),
    "texture_max": (0.02, {}),
    "start_max": (5.0, {}),
    "score_min": (16.0, {}),
}


@pytest.mark.parametrize("name", AT_LIMITS, ids=str)
def test_the_limits_are_those_of_the_configuration(name):
    value, evidence = AT_LIMITS[name]
    seen = [line(1.5)], [replace(PAINT, **evidence)]
    assert judged(*seen) == [0.9]
    assert judged(*seen, replace(CONFIG, **{name: value})) == [DOUBTED]


@pytest.mark.parametrize(
    ("limits", "confidence"),
    [
        ({}, DOUBTED),
        ({"gap_max": 1.5}, 0.9),
        ({"gap_min": 2.0}, 0.9),
        ({"doubted_confidence": 0.3}, 0.3),
    ],
    ids=str,
)
def test_what_counts_as_beside_and_how_much_is_left_is_configured(limits, confidence):
    config = replace(CONFIG, **limits)
    assert judged([line(3.1), line(1.4)], [PAINT] * 2, config) == [confidence, 0.9]


def left_alone(image, road, known=None):
    """Return what is found in a left image alone, on the road that it shows."""
    surface = QuadraticSurface.plane(CAMERA, road.camera_height, road.pitch)
    prior = Prior(lambda _: RoadEstimate(surface, "nominal"), lanes=known)
    return LaneDetector(CAMERA).detect(StereoFrame(image), prior).lanes


def sure(image, road):
    return [lane for lane in left_alone(image, road) if lane.confidence > DOUBTED]


def test_lines_of_a_rendered_road_are_sure_and_kerbs_are_not():
    painted = Road(swing=0, lane_widths=(3.5,), lines=(SOLID, SOLID), driven=0)
    assert len(sure(render_pair(painted, 10.0, 3).left, painted)) == 2
    bare = Road(swing=0, lines=(UNPAINTED,) * 3)
    assert sure(render_pair(bare, 10.0, 5).left, bare) == []


def test_the_detector_keeps_of_doubted_lines_those_that_go_on_with_known_ones():
    """Kerbs look like paint; where nothing is followed over time they are told with little confidence."""
    bare = Road(swing=0, lines=(UNPAINTED,) * 3, kerb=0.14, shoulder=0.3)
    image = render_pair(bare, 10.0, 5).left
    doubted = left_alone(image, bare)
    assert doubted and all(lane.confidence <= DOUBTED for lane in doubted)
    assert left_alone(image, bare, known=()) == ()
    (kept,) = left_alone(image, bare, known=doubted[:1])
    np.testing.assert_array_equal(kept.points, doubted[0].points)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("sigma", [0, 2])
def test_nothing_in_noise_is_sure(seed, sigma):
    noise = np.random.default_rng(seed).integers(0, 256, (SIZE[1], SIZE[0]), np.uint8)
    image = cv2.GaussianBlur(noise, (0, 0), sigma) if sigma else noise
    assert sure(image, Road()) == []
