# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Lines along borders, on drawn roads with kerbs at a known place."""

import numpy as np
import pytest

from lane_dp_ros.core.birdseye.edge_map import edge_map
from lane_dp_ros.core.lanes.candidate import LanePath
from lane_dp_ros.core.lanes.edge_lines import EdgeLineSearch
from lane_dp_ros.core.lanes.evidence import EvidenceSource, measure_border
from lane_dp_ros.core.lanes.line_fit import MIN_ROWS
from lane_dp_ros.core.lanes.path_search import FreeEndSearch, PathSearchConfig
from lane_dp_ros.core.types import StereoFrame

pytestmark = pytest.mark.filterwarnings("error")


def lines_of(road):
    paint = road.bands()
    edges = edge_map(paint.view, paint.paint_map)
    lines = EdgeLineSearch(PathSearchConfig()).find(edges, paint.view)
    return paint, edges, lines


def kerb(road, course, first=0.0, height=0.12):
    """Raise the ground behind n = course(s) from s = `first` on, on the side on which that is."""
    n = course(road.s)[:, None]
    road.height[((road.n - n) * np.sign(n) > 0) & (road.s >= first)[:, None]] = height
    return road


@pytest.mark.parametrize("side", [-1, 1], ids=["left", "right"])
@pytest.mark.parametrize("slope", [0.0, 0.03])
def test_a_line_runs_along_the_kerb(painted_road, side, slope):
    def course(s):
        return side * (3.0 + slope * (s - 10))

    paint, _, lines = lines_of(kerb(painted_road(), course))
    assert np.abs(lines[0].n - course(lines[0].s)).mean() < 0.12
    assert lines[0].length > 15  # of 20 m
    assert np.all(np.diff(lines[0].s) > 0)
    np.testing.assert_array_equal(lines[0].s, paint.view.s[lines[0].rows])
    assert lines[0].score == max(line.score for line in lines) > 8


def test_kerbs_on_both_sides_have_a_line_each(painted_road):
    road = kerb(kerb(painted_road(), lambda s: 0 * s + 3.0), lambda s: 0 * s - 2.5)
    _, _, lines = lines_of(road)
    offsets = [float(np.median(line.n)) for line in lines]
    assert {-2.5 if n < 0 else 3.0 for n in offsets} == {-2.5, 3.0}
    assert all(n == pytest.approx(-2.5 if n < 0 else 3.0, abs=0.15) for n in offsets)


def test_a_line_begins_where_the_kerb_does(painted_road):
    _, _, lines = lines_of(kerb(painted_road(), lambda s: 0 * s + 3.0, first=12.0))
    assert lines[0].s[0] == pytest.approx(12.0, abs=1.1)


def test_blank_road_has_no_borders(painted_road):
    assert lines_of(painted_road())[2] == []


def test_a_short_step_is_no_border(painted_road):
    road = painted_road()
    road.height[(np.abs(road.s - 12) < 0.8)[:, None] & (road.n > 3)] = 0.1
    assert lines_of(road)[2] == []


@pytest.mark.parametrize(("rows", "found"), [(2 * MIN_ROWS, True), (MIN_ROWS - 1, False)])
def test_a_border_has_as_many_rows_as_a_fit_needs(painted_road, monkeypatch, rows, found):
    """However sure each of them is."""
    path = LanePath(np.arange(19, 19 - rows, -1), np.full(rows, 39.0), 9.0)
    monkeypatch.setattr(FreeEndSearch, "find", lambda *_: [path])
    assert bool(lines_of(kerb(painted_road(), lambda s: 0 * s + 3.0))[2]) == found


def test_the_evidence_of_a_border_is_the_step_behind_it(painted_road):
    paint, edges, lines = lines_of(kerb(painted_road().step(3.0, -40), lambda s: 0 * s + 3.0))
    (found, *_) = measure_border(lines, EvidenceSource(paint, edges, StereoFrame(paint.view.image)))
    assert found.length == lines[0].length
    assert found.start == lines[0].s[0]
    assert found.slope < 0.03
    assert found.rise == pytest.approx(0.12, abs=0.02)
    assert found.grey_step == pytest.approx(-0.4, abs=0.05)
    assert found.far_grey_step == pytest.approx(-0.4, abs=0.05)
    assert found.ground == pytest.approx(0.0, abs=0.01)
    assert found.border > 0.6
    assert found.painted == 0
    assert np.isnan([found.score, found.contrast, found.height]).all()  # of what is no paint


def test_a_height_that_half_the_line_lacks_is_not_known(painted_road):
    road = kerb(painted_road().step(3.0, -40), lambda s: 0 * s + 3.0)
    road.height[25:] = np.nan
    paint, edges, lines = lines_of(road)
    (found, *_) = measure_border(lines, EvidenceSource(paint, edges, StereoFrame(paint.view.image)))
    assert lines[0].length > 15
    assert np.isnan([found.rise, found.far_rise, found.ground]).all()
    assert found.grey_step == pytest.approx(-0.4, abs=0.05)
