# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The evidence for paint, on drawn roads whose numbers are known: its band, its segments, what is beside."""

from dataclasses import asdict, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lane_dp_ros.core.birdseye.edge_map import edge_map
from lane_dp_ros.core.lanes import cross_section
from lane_dp_ros.core.lanes import evidence as lane_evidence
from lane_dp_ros.core.lanes.candidate import LaneLine
from lane_dp_ros.core.lanes.evidence import EvidenceSource, courses, measure_border, measure_paint
from lane_dp_ros.core.lanes.plane_sweep import LineHeights
from lane_dp_ros.core.lanes.selection import LaneSelectionConfig
from lane_dp_ros.core.types import StereoFrame

CENTRE = 1.025  # m
LIMITS = LaneSelectionConfig()


@pytest.mark.parametrize("width", [0.15, 0.20, 0.25, 0.30])
def test_the_width_of_paint_is_that_at_half_its_contrast(painted_road, evidence_of, width):
    assert evidence_of(painted_road().line(CENTRE, width)).paint_width == pytest.approx(width, abs=0.01)


def test_a_narrow_line_has_a_small_wide_band_ratio(painted_road, evidence_of):
    """A band of nine columns with three of paint in it has a third of the paint's contrast."""
    assert evidence_of(painted_road().line(CENTRE, 0.15)).wide_band_ratio == pytest.approx(1 / 3, abs=0.01)


def test_a_broad_band_is_too_wide_and_its_ratio_too_large(painted_road, evidence_of):
    found = evidence_of(painted_road().line(CENTRE, 0.5))
    assert found.paint_width > LIMITS.paint_width_max
    assert found.wide_band_ratio > LIMITS.wide_band_ratio_max


def test_a_step_is_no_band(painted_road, evidence_of):
    found = evidence_of(painted_road().step(CENTRE))
    assert found.paint_width > LIMITS.paint_width_max


def test_a_dark_line_is_darker_than_the_road(painted_road, evidence_of):
    found = evidence_of(painted_road().line(CENTRE, brightness=-60))
    assert found.brightness < 0
    assert found.contrast < 0.1


@pytest.mark.parametrize("aside", [-0.4, -0.2, -0.1, 0.1, 0.2, 0.4])
@pytest.mark.parametrize("brightness", [-60, -3, 60])
def test_beside_its_paint_a_line_still_has_a_width(painted_road, evidence_of, brightness, aside):
    """As a marker's scale it must be positive; the cross sections do not reach farther."""
    found = evidence_of(painted_road().line(CENTRE, brightness=brightness).step(CENTRE + 1), CENTRE + aside)
    reach = 2 * (cross_section.SECTION + 1) * cross_section.SAMPLE
    assert 0.05 <= found.paint_width <= reach
    assert reach < 2.2  # m; the next lane's line is farther off


@pytest.mark.parametrize("course", [CENTRE, -CENTRE], ids=["right", "left"])
def test_brightness_is_that_over_the_road_towards_the_vehicle(painted_road, evidence_of, course):
    """Asphalt of 90 levels on the vehicle's side, 40 on the other: (90 + 80 - 90) / (90 + 10)."""
    road = painted_road(ground=90)
    road.grey[:, road.n > course if course > 0 else road.n < course] = 40
    near = np.abs(road.n - course) < 0.3
    road.grey[:, near] = 90
    assert evidence_of(road.line(course), course).brightness == pytest.approx(0.8, abs=0.01)


def test_the_width_is_that_of_the_nearest_ten_metres_of_paint(painted_road, evidence_of):
    """From 4 to 13 m the paint is narrow, from there to 24 m, where the picture blurs it, broad."""
    road = painted_road().line(CENTRE, 0.15, last=13).line(CENTRE, 0.3, first=13)
    assert evidence_of(road).paint_width == pytest.approx(0.15, abs=0.01)


def test_a_line_off_by_a_column_gives_the_same_cross_section(painted_road, evidence_of):
    road = painted_road().line(CENTRE)
    on, off = evidence_of(road), evidence_of(road, CENTRE + 0.08)
    assert off.paint_width == pytest.approx(on.paint_width, abs=0.02)
    assert off.wide_band_ratio == pytest.approx(on.wide_band_ratio, abs=0.06)


def test_what_is_not_painted_blurs_no_width(painted_road, evidence_of):
    found = evidence_of(painted_road().line(CENTRE, first=10, last=11.3))
    assert found.paint_width == pytest.approx(0.15, abs=0.01)


def test_slope_is_the_steepest_lateral_over_forward(painted_road, evidence_of):
    def course(s):
        return 1 + 0.1 * (s - 4)

    assert evidence_of(painted_road().line(course), course).slope == pytest.approx(0.1)
    assert evidence_of(painted_road().line(CENTRE)).slope == 0


@pytest.mark.parametrize(("aside", "off_paint_fraction"), [(0.25, 0.25), (0.05, 0.0), (0.6, 0.0)], ids=str)
def test_the_off_paint_fraction_is_the_share_of_the_paint_that_a_line_passes_beside(
    painted_road, evidence_of, aside, off_paint_fraction
):
    """The farthest 5 m of 20 lie aside; paint that is too far off is none of the line's."""
    road = painted_road().line(lambda s: CENTRE + aside * (s > 19))
    assert evidence_of(road).off_paint_fraction == pytest.approx(off_paint_fraction, abs=0.02)


def test_where_there_is_no_paint_no_line_passes_beside_it(painted_road, evidence_of):
    assert evidence_of(painted_road()).off_paint_fraction == 0


def test_texture_is_that_over_brightness_on_the_smoother_side(painted_road, evidence_of):
    """Stripes of 1 m, 10 levels up or down: over 1 m grey changes by 20 levels, texture is 20 / sqrt(2)."""
    stripes = np.where(np.arange(80) // 4 % 2, 10, -10)[:, None]
    everywhere = painted_road(ground=50).line(CENTRE)
    everywhere.grey += stripes
    texture = evidence_of(everywhere).texture
    assert 14.1 / (60 + 10) < texture < 14.2 / (40 + 10)  # on the bright stripes and on the dark ones
    verge = painted_road(ground=50).line(CENTRE)
    verge.grey += stripes * (verge.n > 1.5)
    assert evidence_of(verge).texture == 0


def test_lines_at_the_border_of_the_view_are_looked_at_too(painted_road, evidence_of):
    found = evidence_of(painted_road().line(4.975), 4.975)
    assert np.isfinite([found.paint_width, found.wide_band_ratio, found.brightness, found.texture]).all()


def line_along(view, n, slope=0.0, first=0, count=80):
    """Return the line from n [m] on, over `count` rows, without the `first` nearest ones."""
    rows = np.arange(len(view.s))[::-1][first : first + count]
    s = view.s[rows]
    return LaneLine(rows, s, n + slope * (s - 4), bend=0.0, score=10.0)


def nothing(evidence):
    return np.zeros(len(evidence), bool)


def source_of(paint):
    return EvidenceSource(paint, edge_map(paint.view, paint.paint_map), StereoFrame(paint.view.image))


def measured(lines, paint, needs_height=nothing):
    """Return the evidence for lines on a road of which there is one picture."""
    return measure_paint(lines, source_of(paint), needs_height)


@pytest.fixture(scope="module")
def town(painted_road):
    """A road with a solid and a dashed line, a crack, a light patch, grass, and a part that is not seen."""
    road = painted_road().line(-1.725).line(1.725, dash=(3.0, 3.0), width=0.25).line(0.4, brightness=-40)
    road = road.line(3.0, width=0.9, first=8, last=12).grass(2.5, 5, roughness=15).grass(-5, 2.5, 3, seed=1)
    road.seen[:20, :60] = False
    return road.bands()


LINES = st.builds(
    lambda n, slope, first, count: (n, slope, first, count),
    st.floats(-5.2, 5.2),
    st.floats(-0.1, 0.1),
    st.integers(0, 70),
    st.integers(4, 80),
)


@settings(deadline=None, max_examples=60)
@given(courses=st.lists(LINES, min_size=1, max_size=5))
def test_many_lines_at_once_have_the_evidence_that_each_has_by_itself(town, courses):
    lines = [line_along(town.view, *course) for course in courses]
    together = measured(lines, town)
    assert len(together) == len(lines)
    for line, found in zip(lines, together, strict=True):
        (alone,) = measured([line], town)
        alone = replace(alone, relative_contrast=found.relative_contrast)  # that compares them
        assert asdict(found) == pytest.approx(asdict(alone), abs=1e-8, nan_ok=True)


def test_of_no_lines_there_is_no_evidence(town):
    assert measured([], town, lambda evidence: np.ones(len(evidence), bool)) == []
    assert measure_border([], source_of(town)) == []
    assert courses([], town) == []


def test_heights_are_measured_of_the_lines_alone_that_need_them(town, monkeypatch):
    """They are asked for once, with all other evidence at hand."""
    lines = [line_along(town.view, n) for n in (-1.725, 0.4, 1.725)]
    asked, swept = [], []

    def needs(evidence):
        asked.extend(evidence)
        return np.array([each.contrast > 0 for each in evidence])

    def heights(some, *_):
        swept.extend(some)
        return [LineHeights(0.01 * i, 0.0, 0.02) for i, _ in enumerate(some)]

    monkeypatch.setattr(lane_evidence, "line_heights", heights)
    found = measured(lines, town, needs)
    assert len(asked) == len(lines)
    assert all(np.isnan(evidence.height) and np.isnan(evidence.kerb_step) for evidence in asked)
    assert swept == [lines[0], lines[2]]
    assert [each.height for each in found] == pytest.approx([-0.02, np.nan, 0.01], nan_ok=True)
    assert [each.kerb_step for each in found] == pytest.approx([0.0, np.nan, 0.01], nan_ok=True)


def test_a_variant_is_compared_to_the_lines_and_no_line_to_a_variant(painted_road):
    """Paint of 80 levels above the road, and of 20."""
    paint = painted_road().line(-1.725, brightness=80).line(1.725, brightness=20).bands()
    bright, faint = (line_along(paint.view, n) for n in (-1.725, 1.725))
    source = source_of(paint)
    of_line, of_variant = measure_paint([faint], source, nothing, variants=[bright])
    assert of_line.relative_contrast == of_variant.relative_contrast == 1.0
    of_line, of_other = measure_paint([faint, bright], source, nothing)
    assert of_line.relative_contrast == pytest.approx(0.25, abs=0.02)
    (among,) = measure_paint([faint], source, nothing, among=[of_other])
    assert among.relative_contrast == of_line.relative_contrast


@settings(deadline=None)
@given(
    courses_given=st.lists(st.lists(st.floats(-0.2, 0.2), min_size=3, max_size=80), min_size=1, max_size=3)
)
def test_the_slope_is_the_ninetieth_percentile_of_the_gradient(town, courses_given):
    lines = [
        LaneLine(np.arange(len(steps))[::-1], 5.0 + 0.25 * np.arange(len(steps)), np.cumsum(steps), 0.0, 1.0)
        for steps in courses_given
    ]
    expected = [np.percentile(np.abs(np.gradient(line.n, line.s)), 90) for line in lines]
    assert [slope for slope, _ in courses(lines, town)] == pytest.approx(expected, abs=1e-8)


@pytest.mark.parametrize("count", [40, 450])
def test_the_rows_of_all_lines_may_be_more_than_opencv_takes_at_once(painted_road, count):
    """450 lines of 80 rows each are 36,000."""
    paint = painted_road().line(CENTRE).bands()
    lines = [line_along(paint.view, CENTRE)] * count
    first, *others = measured(lines, paint)
    assert len(others) == count - 1
    for other in (others[0], others[-1]):
        assert other.paint_width == pytest.approx(first.paint_width)
        assert other.contrast == pytest.approx(first.contrast, abs=1e-6)
