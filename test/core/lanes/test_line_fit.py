# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Smooth lines through paths."""

from dataclasses import replace

import numpy as np
import pytest

from lane_dp_ros.core.config import preset
from lane_dp_ros.core.lanes.candidate import LanePath
from lane_dp_ros.core.lanes.line_fit import CubicFit, LaneModelConfig, ParabolaFit, line_fit
from lane_dp_ros.core.lanes.path_search import FreeEndSearch, PathSearchConfig

CUBIC, PARABOLA = LaneModelConfig(), preset("paper").lane_model
MODELS = pytest.mark.parametrize("config", [CUBIC, PARABOLA], ids=["cubic", "parabola"])


def straight(s):
    return 0.0 * s - 1.72


def curved(s):
    return 1.0 + 0.02 * (s - 4) + 0.002 * (s - 4) ** 2


def path_along(view, course, aside=0.0, rows=None):
    """Return a path of whole columns, as the search gives it."""
    rows = np.arange(len(view.s))[::-1] if rows is None else rows
    columns = np.rint((course(view.s[rows]) + aside - view.n[0]) / view.resolution[1])
    return LanePath(rows, columns, score=7.0)


def fit(path, paint, config, seed=0):
    return next(iter(line_fit(config).fit([path], paint, np.random.default_rng(seed))), None)


@MODELS
@pytest.mark.parametrize("course", [straight, curved])
@pytest.mark.parametrize("aside", [-0.05, 0.0, 0.05])
def test_the_line_lies_on_the_centre_of_the_paint(painted_road, config, course, aside):
    paint = painted_road().line(course).grass(-5, 5, roughness=3).bands()
    path = path_along(paint.view, course, aside)
    line = fit(path, paint, config)
    assert np.abs(line.n - course(paint.view.s[::-1])).mean() < 0.01
    assert line.s.tolist() == paint.view.s[::-1].tolist()
    assert line.rows is path.rows
    assert line.score == 7.0
    bend = 0.004 if course is curved else 0.0  # twice the coefficient of s^2, 1/m
    assert line.bend == pytest.approx(bend, abs=0.001)


def test_what_the_search_finds_is_centred_within_a_centimetre(painted_road):
    paint = painted_road().line(curved, brightness=100).bands()
    path = FreeEndSearch(PathSearchConfig()).find(paint.paint_map, paint.view.resolution)[0]
    line = fit(path, paint, CUBIC)
    assert np.abs(line.n - curved(line.s)).mean() < 0.01


@MODELS
def test_paint_of_another_line_does_not_bend_this_one(painted_road, config):
    road = painted_road().line(straight, last=18).line(lambda s: straight(s) + 0.45, first=18)
    paint = road.bands()
    path = path_along(paint.view, straight)
    path.columns[paint.view.s[path.rows] > 18] += 9
    line = fit(path, paint, config)
    on_it = line.s < 18
    assert np.abs(line.n - straight(line.s))[on_it].mean() < 0.06


def test_a_cubic_follows_a_change_of_curvature(painted_road):
    def course(s):
        return 0.0004 * (s - 14) ** 3

    paint = painted_road().line(course).bands()
    line = fit(path_along(paint.view, course), paint, CUBIC)
    assert np.abs(line.n - course(line.s)).mean() < 0.01


def test_a_short_line_is_a_parabola(painted_road):
    paint = painted_road().line(curved, last=15).bands()
    line = fit(path_along(paint.view, curved, rows=np.arange(79, 36, -1)), paint, CUBIC)
    assert line.length < 12
    third_differences = np.diff(line.n, 3)
    np.testing.assert_allclose(third_differences, 0, atol=1e-9)


@MODELS
@pytest.mark.parametrize(("rows", "found"), [(0, False), (3, False), (4, True)])
def test_too_few_rows_make_no_line(painted_road, config, rows, found):
    paint = painted_road().line(straight).bands()
    line = fit(path_along(paint.view, straight, rows=np.arange(79, 79 - rows, -1)), paint, config)
    assert (line is not None) == found


@pytest.mark.parametrize(("share", "found"), [(0.5, False), (0.7, True)])  # min_inliers: 0.6
def test_a_parabola_with_too_few_inliers_is_no_lane(painted_road, share, found):
    paint = painted_road().line(straight).bands()
    path = path_along(paint.view, straight)
    wrong = np.random.default_rng(1).permutation(80) >= share * 80
    path.columns[wrong] += np.random.default_rng(2).integers(10, 60, wrong.sum())
    assert (fit(path, paint, PARABOLA) is not None) == found
    assert fit(path, paint, replace(PARABOLA, min_inliers=0.3)) is not None


def test_the_same_seed_gives_the_same_line(painted_road):
    paint = painted_road().line(curved).bands()
    path = path_along(paint.view, curved)
    path.columns[::3] += 20
    lines = [fit(path, paint, PARABOLA, seed=4) for _ in range(2)]
    np.testing.assert_array_equal(lines[0].n, lines[1].n)


@MODELS
def test_lines_fitted_together_are_as_those_fitted_alone(painted_road, config):
    """One has too few rows, one is short enough for a parabola, and there is paint beside one of them."""
    road = painted_road().line(straight).line(curved).line(lambda s: straight(s) + 0.45, first=18)
    paint = road.bands()
    paths = [
        path_along(paint.view, straight),
        path_along(paint.view, curved, rows=np.arange(79, 76, -1)),
        path_along(paint.view, curved, aside=0.05, rows=np.arange(79, 36, -1)),
        path_along(paint.view, curved, rows=np.arange(70, 5, -1)),
    ]
    together = line_fit(config).fit(paths, paint, np.random.default_rng(0))
    alone = [line for path in paths if (line := fit(path, paint, config)) is not None]
    assert [len(line.rows) for line in together] == [80, 43, 65]
    for one, other in zip(together, alone, strict=True):
        np.testing.assert_allclose(one.n, other.n, atol=0.005 if config is PARABOLA else 1e-12)
        assert one.bend == pytest.approx(other.bend, abs=1e-3 if config is PARABOLA else 1e-12)


def test_the_configuration_names_the_fit():
    assert isinstance(line_fit(CUBIC), CubicFit)
    assert isinstance(line_fit(PARABOLA), ParabolaFit)
