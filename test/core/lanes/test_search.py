# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The search along one axis, on drawn pictures of a flat road with lines of known place."""

import numpy as np
import pytest
from lane_dp_ros.core.lanes.search import LaneSearch, search_lanes

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.geometry.road_axis import RoadAxis
from lane_dp_ros.core.geometry.road_surface import RoadSurface
from lane_dp_ros.core.lanes.selection import OFF_PAINT_FRACTION_MAX
from lane_dp_ros.core.parameter import replaced
from lane_dp_ros.core.stopwatch import Stopwatch
from lane_dp_ros.core.types import StereoFrame

STEPS = ["birds_eye", "paint_map", "path_search", "lane_model", "lane_selection"]
BEND = RoadAxis(heading=-0.05, curvature=0.01)


@pytest.fixture(scope="module")
def search(camera, disparity_of, picture_of, right_of):
    """Return a function: what is found along an axis of a road with lines at `offsets` [m] along `road`."""
    surface = RoadSurface.plane(camera, 1.6, 0.02)

    def search(offsets=(-1.8, 1.7), axis=BEND, road=BEND, watch=None, **values):
        picture = picture_of(surface, road, offsets)
        right = right_of(picture, surface)
        everything = StereoFrame(picture, right, disparity_of(surface), surface, surface)
        config = replaced(
            DetectorConfig(), {name.replace("__", "."): value for name, value in values.items()}
        )
        return search_lanes(everything, axis, config, np.random.default_rng(0), watch or Stopwatch())

    return search


@pytest.fixture(scope="module")
def painted_surface(camera, disparity_of, picture_of):
    """Return a function: what is found on a straight road of lines of known brightness, in noise."""
    surface = RoadSurface.plane(camera, 1.6, 0.02)

    def painted_surface(offsets, brightness, noise):
        blank = picture_of(surface, RoadAxis(), ())
        picture = blank + np.random.default_rng(1).normal(0, noise, blank.shape)
        for n, levels in zip(offsets, brightness, strict=True):
            drawn = picture_of(surface, RoadAxis(), (n,)).astype(float) - blank
            picture += drawn / 110 * levels
        grey = np.clip(np.rint(picture), 0, 255).astype(np.uint8)
        everything = StereoFrame(grey, None, disparity_of(surface), surface, surface)
        config = replaced(DetectorConfig(), {"lane_selection.contrast_min": 0.0})
        return search_lanes(everything, RoadAxis(), config, np.random.default_rng(0), Stopwatch())

    return painted_surface


def offsets_of(found: LaneSearch) -> list[float]:
    return sorted(float(np.median(line.n)) for line, _ in found.lanes)


def test_a_line_that_only_one_camera_shows_well_is_followed(camera, picture_of, right_of, disparity_of):
    """Beyond 14 m of one line the left image is burnt out."""
    surface = RoadSurface.plane(camera, 1.6, 0.02)
    right = right_of(picture_of(surface, RoadAxis(), (-1.8, 1.7)), surface)
    left = picture_of(surface, RoadAxis(), (-1.8, 1.7))
    x, z = surface.pixel_to_ground(*np.indices(left.shape, dtype=np.float32)[::-1])
    left[(x > 0.9) & (z > 14)] = 255
    ends = []
    for image in (None, right):
        picture = StereoFrame(left, image, disparity_of(surface), surface, surface)
        found = search_lanes(picture, RoadAxis(), DetectorConfig(), np.random.default_rng(0), Stopwatch())
        ends.append([float(line.s[-1]) for line, _ in found.lanes if np.median(line.n) > 0])
    assert ends[0] == [] or ends[0][0] < 16
    assert ends[1][0] > 24


def test_lines_along_the_axis_are_found_where_they_are(search):
    found = search()
    assert offsets_of(found) == pytest.approx([-1.8, 1.7], abs=0.01)
    assert found.view.axis is BEND
    assert found.graph.feature.shape == found.view.image.shape
    assert len(found.paths) >= len(found.candidates) >= 2


def test_the_lanes_are_candidates_with_their_own_evidence(search):
    found = search()
    candidates = {id(line): evidence for line, evidence in found.candidates}
    assert all(candidates[id(line)] is evidence for line, evidence in found.lanes)
    for line, evidence in found.lanes:
        assert evidence.paint_width == pytest.approx(0.15, abs=0.04)
        assert evidence.height == pytest.approx(0, abs=0.01)
        assert evidence.run <= line.length + 0.25


def test_the_score_is_the_paint_of_all_lanes(search):
    found = search()
    assert found.score == sum(line.score for line, _ in found.lanes) > 20  # m


def test_the_axis_of_the_road_scores_higher_than_another_one(search):
    assert search().score > search(axis=RoadAxis(0.1)).score


def test_a_blank_road_has_no_lanes_and_no_score(search):
    found = search(offsets=())
    assert found.lanes == found.candidates == ()
    assert found.score == 0


def test_the_time_of_each_step_is_taken_and_added_up(search):
    watch = Stopwatch()
    search(watch=watch)
    first = dict(watch.seconds)
    assert list(first) == STEPS
    search(watch=watch)
    assert list(watch.seconds) == STEPS
    assert all(watch.seconds[step] > first[step] > 0 for step in STEPS)


def test_without_evidence_every_line_of_the_model_is_a_lane(search):
    found = search(offsets=(-1.8, -0.9, 1.7), lane_selection__evidence=False)
    assert found.lanes is found.candidates
    assert len(found.lanes) >= 3


def test_what_has_no_evidence_of_paint_is_a_candidate_only(search):
    found = search(lane_selection__paint_width_max=0.1)
    assert found.lanes == ()
    assert len(found.candidates) >= 2


def test_paths_from_border_to_border_are_not_extended(search):
    found = search(path_search__free_ends=False)
    ends = {(path.rows[0], path.rows[-1]) for path in found.paths}
    assert {(line.rows[0], line.rows[-1]) for line, _ in found.candidates} <= ends


def test_a_second_look_finds_the_faint_border_of_the_own_lane(painted_surface):
    """It is too faint for a path; along a line parallel to the bright one it adds up."""
    found = painted_surface((-1.8, 1.7), (110, 4), noise=10)
    assert offsets_of(found) == pytest.approx([-1.8, 1.7], abs=0.08)
    by_path = [float(np.median(line.n)) for line, _ in found.candidates]
    assert not any(n == pytest.approx(1.7, abs=0.3) for n in by_path)


def test_a_second_look_finds_nothing_where_there_is_nothing(painted_surface):
    assert offsets_of(painted_surface((-1.8,), (110,), noise=10)) == pytest.approx([-1.8], abs=0.02)


def test_the_same_picture_gives_the_same_lanes(search):
    first, again = search(), search()
    assert offsets_of(first) == offsets_of(again)
    assert first.score == again.score


@pytest.fixture(scope="module")
def one_line(camera, disparity_of, right_of):
    """Return a function: what is found on a straight road of one line x(z), `paint` [grey levels] bright."""
    surface = RoadSurface.plane(camera, 1.6, 0.02)
    disparity = disparity_of(surface)
    x, z = surface.pixel_to_ground(*np.indices(disparity.shape, dtype=np.float32)[::-1])

    def one_line(course, paint=200):
        image = np.full(disparity.shape, 90, np.uint8)
        image[np.abs(x - course(z)) < 0.08] = paint
        picture = StereoFrame(image, right_of(image, surface), disparity, surface, surface)
        return search_lanes(picture, RoadAxis(), DetectorConfig(), np.random.default_rng(0), Stopwatch())

    return one_line


@pytest.mark.parametrize(("paint", "kept"), [(200, True), (130, False)], ids=["bright", "as pale as a kerb"])
def test_of_a_line_that_leads_astray_the_nearer_half_is_kept(one_line, paint, kept):
    """Its paint turns aside 20 m ahead, steeper than any lane."""
    found = one_line(lambda z: 1.7 + 0.3 * np.maximum(0, z - 20), paint)
    assert max(line.s[-1] for line, _ in found.candidates) > 25  # the candidates stay as they were found
    assert offsets_of(found) == pytest.approx([1.7] if kept else [], abs=0.05)
    assert all(line.s[-1] < 20 for line, _ in found.lanes)


def test_of_a_line_that_strays_from_its_paint_the_nearer_half_is_kept(one_line):
    """Something else begins 0.5 m aside where it ends: no smooth curve lies on both."""
    found = one_line(lambda z: 1.7 + 0.5 * (z > 20))
    longest, evidence = max(found.candidates, key=lambda each: each[0].length)
    assert longest.s[-1] > 25
    assert (
        evidence.off_paint_fraction > OFF_PAINT_FRACTION_MAX
        and evidence.slope < DetectorConfig().lane_selection.slope_max
    )
    assert offsets_of(found) == pytest.approx([1.7], abs=0.02)
    assert all(line.s[-1] <= 20 for line, _ in found.lanes)
