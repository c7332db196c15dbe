# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The search along one axis, on drawn pictures of a flat road with lines of known place."""

from dataclasses import replace

import numpy as np
import pytest

from lane_dp_ros.core import search as lane_search
from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.geometry.quadratic_surface import QuadraticSurface
from lane_dp_ros.core.geometry.road_axis import RoadAxis
from lane_dp_ros.core.lanes.candidate import LaneLine
from lane_dp_ros.core.parameter import replaced
from lane_dp_ros.core.search import LaneSearch, RoadView, SearchResult
from lane_dp_ros.core.stopwatch import Stopwatch
from lane_dp_ros.core.types import StereoFrame

STEPS = ["birds_eye", "paint_map", "path_search", "lane_model", "road_edges", "lane_selection"]
BEND = RoadAxis(heading=-0.05, curvature=0.01)


def searched(view, axis, config=None, watch=None):
    search = LaneSearch(config or DetectorConfig())
    return search.along(axis, view.surface, view, np.random.default_rng(0), watch or Stopwatch())


@pytest.fixture(scope="module")
def search(camera, disparity_of, picture_of, right_of):
    """Return a function: what is found along an axis of a road with lines at `offsets` [m] along `road`."""
    surface = QuadraticSurface.plane(camera, 1.6, 0.02)

    def search(offsets=(-1.8, 1.7), axis=BEND, road=BEND, watch=None, **values):
        picture = picture_of(surface, road, offsets)
        right = right_of(picture, surface)
        view = RoadView(StereoFrame(picture, right), disparity_of(surface), surface)
        config = replaced(
            DetectorConfig(), {name.replace("__", "."): value for name, value in values.items()}
        )
        return searched(view, axis, config, watch)

    return search


@pytest.fixture(scope="module")
def painted_surface(camera, disparity_of, picture_of):
    """Return a function: what is found on a straight road of lines of known brightness, in noise."""
    surface = QuadraticSurface.plane(camera, 1.6, 0.02)

    def painted_surface(offsets, brightness, noise):
        blank = picture_of(surface, RoadAxis(), ())
        picture = blank + np.random.default_rng(1).normal(0, noise, blank.shape)
        for n, levels in zip(offsets, brightness, strict=True):
            drawn = picture_of(surface, RoadAxis(), (n,)).astype(float) - blank
            picture += drawn / 110 * levels
        grey = np.clip(np.rint(picture), 0, 255).astype(np.uint8)
        view = RoadView(StereoFrame(grey), disparity_of(surface), surface)
        return searched(view, RoadAxis())

    return painted_surface


def offsets_of(found: SearchResult) -> list[float]:
    return sorted(float(np.median(lane.line.n)) for lane in found.lanes)


def of_paths(found: SearchResult) -> list[LaneLine]:
    """Return the lines of all paths, lanes or not."""
    return [candidate.line for candidate in found.candidates if candidate.variant == "path"]


def test_a_line_that_only_one_camera_shows_well_is_followed(camera, picture_of, right_of, disparity_of):
    """Beyond 14 m of one line the left image is burnt out."""
    surface = QuadraticSurface.plane(camera, 1.6, 0.02)
    right = right_of(picture_of(surface, RoadAxis(), (-1.8, 1.7)), surface)
    left = picture_of(surface, RoadAxis(), (-1.8, 1.7))
    x, z = surface.pixel_to_ground(*np.indices(left.shape, dtype=np.float32)[::-1])
    left[(x > 0.9) & (z > 14)] = 255
    ends = []
    for image in (None, right):
        found = searched(RoadView(StereoFrame(left, image), disparity_of(surface), surface), RoadAxis())
        ends.append([float(lane.line.s[-1]) for lane in found.lanes if np.median(lane.line.n) > 0])
    assert ends[0] == [] or ends[0][0] < 16
    assert ends[1][0] > 24


def test_lines_along_the_axis_are_found_where_they_are(search):
    found = search()
    assert offsets_of(found) == pytest.approx([-1.8, 1.7], abs=0.01)
    assert found.paint.view.axis is BEND
    assert found.paint.paint_map.feature.shape == found.paint.view.image.shape
    assert len(found.paths) >= len(of_paths(found)) >= 2


def test_the_road_is_mapped_by_the_plane_that_is_given(camera, disparity_of, picture_of):
    surface, plane = (QuadraticSurface.plane(camera, height, 0.02) for height in (1.6, 1.5))
    frame = StereoFrame(picture_of(surface, RoadAxis(), (-1.8, 1.7)))
    road, search = RoadView(frame, disparity_of(surface), surface), LaneSearch(DetectorConfig())
    found = search.along(RoadAxis(), plane, road, np.random.default_rng(0), Stopwatch())
    assert found.paint.view.ipm_plane is plane
    assert found.paint.view.road_surface is surface
    assert offsets_of(found) == pytest.approx([-1.8 * 1.5 / 1.6, 1.7 * 1.5 / 1.6], abs=0.02)


def test_the_lanes_are_candidates_with_their_own_evidence(search):
    found = search()
    assert len(found.lanes) == 2
    assert found.candidates[:2] == found.lanes  # they come first
    for lane in found.lanes:
        assert lane.refusal == ""
        assert lane.evidence.paint_width == pytest.approx(0.15, abs=0.04)
        assert lane.evidence.height == pytest.approx(0, abs=0.01)
        assert lane.evidence.length == lane.line.length


def test_the_score_is_the_paint_of_all_lanes(search):
    found = search()
    assert found.score == sum(lane.line.score for lane in found.lanes) > 20  # m


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
    assert found.lanes == found.candidates
    assert len(found.lanes) >= 3
    assert {lane.variant for lane in found.lanes} == {"path"}


def test_what_has_no_evidence_of_paint_is_a_candidate_only(search):
    found = search(lane_selection__paint_width_max=0.1)
    assert found.lanes == ()
    assert found.score == 0
    assert len(found.candidates) >= 2
    assert all(candidate.refusal for candidate in found.candidates)
    of_paint = [candidate for candidate in found.candidates if candidate.variant == "path"]
    assert all(candidate.refusal.endswith(" m broad") for candidate in of_paint)


def test_paths_from_border_to_border_are_not_extended(search):
    found = search(path_search__free_ends=False)
    ends = {(path.rows[0], path.rows[-1]) for path in found.paths}
    assert {(line.rows[0], line.rows[-1]) for line in of_paths(found)} <= ends


def test_a_second_look_finds_the_faint_border_of_the_own_lane(painted_surface):
    """It is too faint for a path; along a line parallel to the bright one it adds up."""
    found = painted_surface((-1.8, 1.7), (110, 4), noise=10)
    assert offsets_of(found) == pytest.approx([-1.8, 1.7], abs=0.08)
    by_path = [float(np.median(line.n)) for line in of_paths(found)]
    assert not any(n == pytest.approx(1.7, abs=0.3) for n in by_path)
    assert sorted(lane.variant for lane in found.lanes) == ["parallel", "path"]


def test_a_second_look_finds_nothing_where_there_is_nothing(painted_surface):
    assert offsets_of(painted_surface((-1.8,), (110,), noise=10)) == pytest.approx([-1.8], abs=0.02)


def test_the_same_picture_gives_the_same_lanes(search):
    first, again = search(), search()
    assert offsets_of(first) == offsets_of(again)
    assert first.score == again.score


@pytest.fixture(scope="module")
def one_line(camera, disparity_of, right_of):
    """Return a function: what is found on a straight road of one line x(z), `paint` [grey levels] bright."""
    surface = QuadraticSurface.plane(camera, 1.6, 0.02)
    disparity = disparity_of(surface)
    x, z = surface.pixel_to_ground(*np.indices(disparity.shape, dtype=np.float32)[::-1])

    def one_line(course, paint=200):
        image = np.full(disparity.shape, 90, np.uint8)
        image[np.abs(x - course(z)) < 0.08] = paint
        frame = StereoFrame(image, right_of(image, surface))
        return searched(RoadView(frame, disparity, surface), RoadAxis())

    return one_line


@pytest.mark.parametrize("paint", [200, 130], ids=["bright", "pale"])
def test_of_a_line_that_leads_astray_the_nearer_half_is_kept(one_line, paint):
    """Its paint turns aside 20 m ahead, steeper than any lane."""
    found = one_line(lambda z: 1.7 + 0.3 * np.maximum(0, z - 20), paint)
    assert max(line.s[-1] for line in of_paths(found)) > 25  # the candidates stay as they were found
    assert offsets_of(found) == pytest.approx([1.7], abs=0.05)
    assert all(lane.line.s[-1] < 20 for lane in found.lanes)
    halves = [candidate for candidate in found.candidates if candidate.variant == "near half"]
    assert [half.refusal for half in halves] == [""]


def test_of_a_line_that_strays_from_its_paint_the_nearer_half_is_kept(one_line):
    """Something else begins 0.5 m aside where it ends: no smooth curve lies on both."""
    found = one_line(lambda z: 1.7 + 0.5 * (z > 20))
    longest = max(found.candidates, key=lambda each: each.line.length)
    assert longest.line.s[-1] > 25
    assert longest.evidence.off_paint_fraction > 0.1 and longest.evidence.slope < 0.11
    assert offsets_of(found) == pytest.approx([1.7], abs=0.02)
    assert all(lane.line.s[-1] <= 20 for lane in found.lanes)
    assert {lane.variant for lane in found.lanes} == {"near half"}


def test_lines_end_at_stop_lines_before_they_are_measured(search, monkeypatch):
    """Whatever is ended is judged as it was ended."""
    asked = []

    def ended(line, *_):
        asked.append(line)
        return LaneLine(line.rows[:20], line.s[:20], line.n[:20], line.bend, line.score)

    monkeypatch.setattr(lane_search, "end_at_stop_line", ended)
    found = search()
    assert len(asked) == len(of_paths(found)) >= 2
    assert {len(line.rows) for line in of_paths(found)} == {20}


def test_lines_from_border_to_border_do_not_end_at_stop_lines(search, monkeypatch):
    monkeypatch.setattr(lane_search, "end_at_stop_line", lambda *_: pytest.fail("asked"))
    assert search(path_search__free_ends=False).paths


def test_every_path_that_is_fitted_is_a_candidate_once(search):
    """Lanes, refused ones with the reason, and none of them twice."""
    found = search(offsets=(-1.8, -0.4, 1.7))
    assert len(of_paths(found)) == len({id(line) for line in of_paths(found)}) == len(found.paths)
    reasons = [candidate.refusal for candidate in found.candidates]
    assert {bool(reason) for reason in reasons} == {True, False}
    assert len({id(candidate.line) for candidate in found.candidates}) == len(found.candidates)
    assert all(candidate.refusal for candidate in found.candidates if candidate not in found.lanes)


def test_a_parallel_that_is_no_paint_is_refused(search, monkeypatch):
    """Whatever proposes it, a line is a lane by its evidence only."""

    def beside(_, paint, *__):
        rows = np.arange(len(paint.view.s))[::-1]
        return [LaneLine(rows, paint.view.s[rows], np.full(len(rows), 1.7), 0.0, 9.0)]

    monkeypatch.setattr(lane_search, "parallel_lines", beside)
    found = search(offsets=(-1.8,))
    (parallel,) = [candidate for candidate in found.candidates if candidate.variant == "parallel"]
    assert parallel.refusal
    assert offsets_of(found) == pytest.approx([-1.8], abs=0.01)


@pytest.mark.parametrize("heading", [-0.15, 0.0, 0.15])
def test_the_paint_that_was_found_turns_an_axis_that_is_askew(search, heading):
    road = RoadAxis(heading)
    config = DetectorConfig()
    refined = LaneSearch(config).refined_axis(search(road=road, axis=RoadAxis()))
    if heading == 0:
        assert refined is None
    else:
        assert refined.heading == pytest.approx(heading, abs=0.02)
        assert refined.curvature == pytest.approx(0, abs=0.003)


def test_without_evidence_no_axis_is_turned(search):
    found = search(road=RoadAxis(0.15), axis=RoadAxis())
    config = replaced(DetectorConfig(), {"lane_selection.evidence": False})
    assert LaneSearch(config).refined_axis(found) is None


def test_only_paths_turn_the_axis(search):
    """Halves and parallels go by what their own lines do."""
    found = search(road=RoadAxis(0.15), axis=RoadAxis())
    others = SearchResult(
        found.paint, found.paths, tuple(replace(each, variant="parallel") for each in found.candidates)
    )
    assert LaneSearch(DetectorConfig()).refined_axis(others) is None
