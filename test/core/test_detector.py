# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The whole detector on rendered pairs, whose lane lines are known exactly, and on pictures of nothing."""

import cv2
import numpy as np
import pytest

from lane_dp_ros.core.birdseye.paint_map import BandsPaintMap
from lane_dp_ros.core.config import DetectorConfig, preset
from lane_dp_ros.core.detector import LaneDetector
from lane_dp_ros.core.geometry.quadratic_surface import QuadraticSurface
from lane_dp_ros.core.parameter import replaced
from lane_dp_ros.core.types import Prior, RoadEstimate, StereoFrame
from lane_dp_ros.scenes import CAMERA, SIZE, Road, render_pair
from lane_dp_ros.scenes.road import DASHED, SOLID, UNPAINTED, Line

pytestmark = pytest.mark.filterwarnings("error")

ROADS = {
    "left bend": Road(curvature=-0.006, swing=0),
    "right bend": Road(curvature=0.006, swing=0),
    "three lanes": Road(swing=0, lines=(SOLID, DASHED, DASHED, SOLID), lane_widths=(3.5,) * 3),
}
STAGES = [
    "disparity",
    "road_profile",
    "vanishing_point",
    "birds_eye",
    "paint_map",
    "path_search",
    "lane_model",
    "road_edges",
    "lane_selection",
    "markings",
]
ROWS, COLUMNS = SIZE[1], SIZE[0]


@pytest.fixture(scope="session", params=ROADS.values(), ids=ROADS)
def road_pair(request):
    return request.param, render_pair(request.param, position=50.0, seed=2)


@pytest.fixture(scope="session")
def pair():
    return render_pair(ROADS["left bend"], position=50.0, seed=2)


@pytest.fixture(scope="session")
def detection(pair):
    return LaneDetector(CAMERA).detect(StereoFrame(pair.left, pair.right))


def lateral_errors(road, lane, truth):
    """Return |x - true x| [m] along a lane, on the rendered road: both are taken there from the picture."""
    ground = QuadraticSurface.plane(CAMERA, road.camera_height, road.pitch)
    (x, z), (true_x, true_z) = (
        ground.pixel_to_ground(*CAMERA.project(line).T) for line in (lane.points, truth)
    )
    inside = (z >= true_z[0]) & (z <= true_z[-1])
    assert inside.mean() > 0.8
    return np.abs(x - np.interp(z, true_z, true_x))[inside]


def test_every_line_is_found_where_it_is_painted(road_pair):
    road, pair = road_pair
    found = LaneDetector(CAMERA).detect(StereoFrame(pair.left, pair.right))
    assert len(found.lanes) == len(road.lines)
    assert found.note == ""
    for lane, truth, offset in zip(found.lanes, pair.lanes, road.offsets, strict=True):
        assert lateral_errors(road, lane, truth).mean() < 0.02
        assert lane.lateral_offset == pytest.approx(offset, abs=0.15)
        assert lane.paint_width == pytest.approx(SOLID.width, abs=0.03)  # a camera's curve widens it
        assert lane.curvature == pytest.approx(road.curvature, abs=0.0015)
        assert 0 < lane.confidence <= 1
        assert np.linalg.norm(np.diff(lane.points, axis=0), axis=1).max() <= 0.5
        assert np.all(np.diff(lane.points[:, 2]) > 0)
    egos = [lane.lateral_offset for lane in found.lanes if lane.role != "other"]
    assert egos == pytest.approx([-1.75, 1.75], abs=0.1)


def test_the_sparse_border_of_the_own_lane_is_found():
    """Dashes of 1.6 m every 10.6 m are too little by themselves; parallel to a solid line they add up."""
    road = Road(swing=0, lane_widths=(3.5,), lines=(SOLID, Line("dashed", dash=1.6, gap=9.0)), driven=0)
    pair = render_pair(road, position=13.0, seed=5)
    found = LaneDetector(CAMERA).detect(StereoFrame(pair.left, pair.right))
    egos = [lane for lane in found.lanes if lane.role != "other"]
    assert [lane.role for lane in egos] == ["ego_left", "ego_right"]
    for lane, truth in zip(egos, pair.lanes, strict=True):
        assert lateral_errors(road, lane, truth).mean() < 0.02


def test_posts_beside_a_sparse_border_are_no_lines():
    road = Road(swing=0, lane_widths=(3.5,), lines=(SOLID, Line("dashed", dash=1.6, gap=9.0)), driven=0)
    pair = render_pair(road, position=13.0, seed=5)
    assert len(LaneDetector(CAMERA).detect(StereoFrame(pair.left, pair.right)).lanes) == 2


def test_the_road_is_that_of_the_scene(road_pair):
    road, pair = road_pair
    found = LaneDetector(CAMERA).detect(StereoFrame(pair.left, pair.right))
    assert found.road.camera_height == pytest.approx(road.camera_height, abs=0.03)
    assert found.road.pitch == pytest.approx(road.pitch, abs=0.003)
    assert found.birds_eye.axis.curvature == pytest.approx(road.curvature, abs=0.001)


def test_the_left_picture_alone_finds_the_lines_on_a_road_that_is_given(road_pair):
    road, pair = road_pair
    surface = QuadraticSurface.plane(CAMERA, road.camera_height, road.pitch)
    given = Prior(lambda _: RoadEstimate(surface, "nominal"))
    found = LaneDetector(CAMERA).detect(StereoFrame(pair.left), given)
    assert found.road_estimate.surface is found.birds_eye.road_surface is surface
    assert found.road is None
    assert found.note == "no right image"
    assert found.disparity.shape == (ROWS, COLUMNS)
    assert np.isnan(found.disparity.full).all()
    assert len(found.lanes) == len(road.lines)
    for lane, truth in zip(found.lanes, pair.lanes, strict=True):
        assert lateral_errors(road, lane, truth).mean() < 0.02


def test_the_detection_carries_what_led_to_the_lanes(detection):
    assert detection.disparity.shape == (ROWS, COLUMNS)
    assert detection.paint_map.feature.shape == detection.birds_eye.image.shape == (120, 320)
    assert len(detection.paths) >= len(detection.lanes)
    assert detection.road_estimate == RoadEstimate(detection.road, "measured")
    assert detection.direction.axis is detection.birds_eye.axis
    assert detection.direction.ipm_plane is detection.birds_eye.ipm_plane
    lanes = [candidate for candidate in detection.candidates if not candidate.refusal]
    assert len(lanes) == len(detection.lanes)
    assert detection.score == sum(candidate.score for candidate in lanes) > 20  # m
    assert any(candidate.refusal for candidate in detection.candidates)  # nothing is thrown away
    assert list(detection.seconds) == STAGES
    assert all(seconds >= 0 for seconds in detection.seconds.values())
    assert CAMERA.cy - 40 < detection.direction.vanishing_point[1] < CAMERA.cy


def test_the_paper_preset_finds_the_own_lane_of_a_straight_road():
    road = ROADS["three lanes"]
    pair = render_pair(road, position=20.0, seed=3)
    found = LaneDetector(CAMERA, preset("paper")).detect(StereoFrame(pair.left, pair.right))
    assert list(found.seconds) == [stage for stage in STAGES if stage not in ("road_edges", "lane_selection")]
    assert len(found.lanes) == len(road.lines)
    for lane, truth in zip(found.lanes, pair.lanes, strict=True):
        assert lateral_errors(road, lane, truth).mean() < 0.1
    assert len(found.direction.u_of_row) == 5  # a quartic


@pytest.mark.parametrize("name", ["default", "paper"])
def test_the_same_pair_gives_the_same_lanes_bit_for_bit(pair, name):
    detector = LaneDetector(CAMERA, preset(name))
    first = detector.detect(StereoFrame(pair.left, pair.right))
    detector.detect(StereoFrame(pair.right, pair.left))  # what comes between leaves no trace
    for again in (
        detector.detect(StereoFrame(pair.left, pair.right)),
        LaneDetector(CAMERA, preset(name)).detect(StereoFrame(pair.left, pair.right)),
    ):
        assert len(again.lanes) == len(first.lanes) > 0
        for a, b in zip(first.lanes, again.lanes, strict=True):
            np.testing.assert_array_equal(a.points, b.points)
            assert (a.confidence, a.paint_width, a.role) == (b.confidence, b.paint_width, b.role)
        np.testing.assert_array_equal(first.disparity.full, again.disparity.full)


@pytest.mark.parametrize("name", ["default", "paper"])
def test_a_disparity_that_was_matched_before_gives_the_same_lanes_bit_for_bit(pair, name):
    detector, frame = LaneDetector(CAMERA, preset(name)), StereoFrame(pair.left, pair.right)
    first, matched = detector.detect(frame), LaneDetector(CAMERA, preset(name)).match(frame)
    np.testing.assert_array_equal(first.disparity.matched, matched.matched)
    again = detector.detect(frame, disparity=matched)
    assert again.disparity is matched
    assert again.road == first.road == detector.measure_road(frame, matched)
    assert again.score == first.score
    assert len(again.lanes) == len(first.lanes) > 0
    for a, b in zip(first.lanes, again.lanes, strict=True):
        np.testing.assert_array_equal(a.points, b.points)
        assert (a.confidence, a.paint_width, a.role) == (b.confidence, b.paint_width, b.role)


def test_of_a_left_image_alone_nothing_is_matched_and_no_road_measured(pair):
    detector, left = LaneDetector(CAMERA), StereoFrame(pair.left)
    matched = detector.match(left)
    assert matched.shape == (ROWS, COLUMNS)
    assert np.isnan(matched.matched).all()
    assert detector.measure_road(left, matched) is None


def test_grey_pictures_give_the_lanes_of_coloured_ones(pair, detection):
    grey = [np.rint(image @ [0.114, 0.587, 0.299]).astype(np.uint8) for image in (pair.left, pair.right)]
    found = LaneDetector(CAMERA).detect(StereoFrame(*grey))
    assert len(found.lanes) == len(detection.lanes)
    for a, b in zip(found.lanes, detection.lanes, strict=True):
        assert a.lateral_offset == pytest.approx(b.lateral_offset, abs=0.02)
        assert a.role == b.role


def test_pictures_are_left_as_they_were(pair):
    left, right = pair.left.copy(), pair.right.copy()
    left.flags.writeable = right.flags.writeable = False  # as views of a message are
    LaneDetector(CAMERA).detect(StereoFrame(left, right))
    np.testing.assert_array_equal(left, pair.left)


@pytest.mark.parametrize("lateral", [0.02, 0.1])
@pytest.mark.parametrize("forward", [0.1, 0.5])
def test_other_resolutions_find_the_same_lanes(pair, detection, lateral, forward):
    sizes = {"birds_eye.lateral_resolution": lateral, "birds_eye.forward_resolution": forward}
    found = LaneDetector(CAMERA, replaced(DetectorConfig(), sizes)).detect(StereoFrame(pair.left, pair.right))
    assert [lane.role for lane in found.lanes] == [lane.role for lane in detection.lanes]
    for a, b in zip(found.lanes, detection.lanes, strict=True):
        assert a.lateral_offset == pytest.approx(b.lateral_offset, abs=0.1)


@pytest.mark.parametrize("lateral", [0.01, 0.2])
@pytest.mark.parametrize("forward", [0.02, 1.0])
@pytest.mark.parametrize("size", [(10.0, 4.0), (30.0, 40.0)])
def test_the_ends_of_the_ranges_are_answered(pair, lateral, forward, size):
    values = {
        "birds_eye.lateral_resolution": lateral,
        "birds_eye.forward_resolution": forward,
        "birds_eye.length": size[0],
        "birds_eye.width": size[1],
    }
    LaneDetector(CAMERA, replaced(DetectorConfig(), values)).detect(StereoFrame(pair.left, pair.right))


def noise(seed):
    return np.random.default_rng(seed).integers(0, 256, (ROWS, COLUMNS), dtype=np.uint8)


NO_ROADS = {
    "black": (np.zeros((ROWS, COLUMNS), np.uint8),) * 2,
    "white": (np.full((ROWS, COLUMNS), 255, np.uint8),) * 2,
    "noise": (noise(0), noise(1)),
    "flat wall": (noise(0), np.roll(noise(0), -20, axis=1)),
    "1x1": (np.zeros((1, 1), np.uint8),) * 2,
    "wide": (noise(0)[:2],) * 2,
    "tall": (noise(0)[:, :3], noise(1)[:, :3]),
}


@pytest.mark.parametrize("images", NO_ROADS.values(), ids=NO_ROADS)
def test_where_there_is_no_road_a_note_says_so(images):
    found = LaneDetector(CAMERA).detect(StereoFrame(*images))
    assert found.lanes == ()
    assert found.note == "no road surface in the disparity 1.2 to 2.3 m below the camera"
    assert found.disparity.shape == images[0].shape
    assert found.road is found.birds_eye is found.direction is found.paint_map is None
    assert list(found.seconds) == STAGES[:2]


def test_one_picture_on_both_sides_is_named(pair):
    for image in (pair.left, noise(0)):
        found = LaneDetector(CAMERA).detect(StereoFrame(image, image))
        assert found.lanes == ()
        assert found.note == "left and right show the same picture"


def test_left_and_right_swapped_show_no_road(pair):
    found = LaneDetector(CAMERA).detect(StereoFrame(pair.right, pair.left))
    assert found.lanes == ()
    assert found.note == "no road surface in the disparity 1.2 to 2.3 m below the camera"


@pytest.mark.parametrize("images", [NO_ROADS[name] for name in ("black", "noise", "1x1", "tall")])
def test_the_paper_preset_answers_pictures_of_nothing(images):
    found = LaneDetector(CAMERA, preset("paper")).detect(StereoFrame(*images))
    assert bool(found.lanes) != bool(found.note)


def test_a_road_without_paint_has_no_lanes_and_a_note_says_so():
    unpainted = Road(swing=0, lines=(UNPAINTED,) * 3)
    pair = render_pair(unpainted, position=10.0, seed=5)
    found = LaneDetector(CAMERA).detect(StereoFrame(pair.left, pair.right))
    assert found.lanes == ()
    assert found.note == f"no lanes among {len(found.paths)} paths"
    assert found.road is not None


def test_a_grey_and_a_coloured_picture_of_equal_size_are_a_pair():
    pair = StereoFrame(np.zeros((20, 30), np.uint8), np.zeros((20, 30, 3), np.uint8))
    assert LaneDetector(CAMERA).detect(pair).lanes == ()


def test_a_left_image_alone_shows_no_road_and_a_note_says_so(pair):
    found = LaneDetector(CAMERA).detect(StereoFrame(pair.left))
    assert found.lanes == found.candidates == ()
    assert found.note == "no right image"
    assert found.road is found.road_estimate.surface is None
    assert found.score == 0


def test_small_pictures_of_the_scene_are_answered(pair):
    quarter = [np.ascontiguousarray(image[::4, ::4]) for image in (pair.left, pair.right)]
    LaneDetector(CAMERA).detect(
        StereoFrame(*quarter)
    )  # the camera's matrix no longer fits: whatever it says, no crash


def test_paint_is_looked_for_in_both_images(pair, detection):
    left, right = (cv2.cvtColor(image, cv2.COLOR_BGR2GRAY) for image in (pair.left, pair.right))
    view, config = detection.birds_eye, DetectorConfig().paint_map
    contrast, paint_map = detection.paint_map.contrast, BandsPaintMap(config)
    np.testing.assert_array_equal(contrast, paint_map.build(view, right).contrast)
    for image in (None, left):
        assert not np.array_equal(contrast, paint_map.build(view, image).contrast)
