# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What lies under a line: centres of paint, the feature near it, runs of rows."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lane_dp_ros.core.birdseye.paint_map import PaintMap
from lane_dp_ros.core.birdseye.paint_profile import PaintProfile, paint_gain, runs_of


@pytest.mark.parametrize(
    ("rows", "runs"),
    [
        ([], []),
        ([0, 0], []),
        ([1], [[0, 1]]),
        ([1, 1, 0, 1], [[0, 2], [3, 4]]),
        ([0, 1, 1, 0, 0, 1, 0], [[1, 3], [5, 6]]),
    ],
)
def test_each_run_has_its_first_row_and_the_one_after_its_last(rows, runs):
    found = runs_of(np.array(rows, bool))
    assert found.shape == (len(runs), 2)
    assert found.tolist() == runs


@given(rows=st.lists(st.booleans(), max_size=30))
def test_runs_hold_all_true_rows_and_no_other(rows):
    rows = np.array(rows, bool)
    rebuilt = np.zeros_like(rows)
    for first, end in runs_of(rows).tolist():
        assert first < end
        rebuilt[first:end] = True
    assert rebuilt.tolist() == rows.tolist()


@pytest.mark.parametrize("width", [0.10, 0.15, 0.25])
@pytest.mark.parametrize("brightness", [15, 80])
def test_the_centre_of_paint_is_found_within_a_centimetre(painted_road, width, brightness):
    for centre in np.arange(1.0, 1.05, 0.01):  # over the width of a column
        paint = painted_road().line(centre, width, brightness).bands()
        rows = np.arange(0, 80, 10)
        for aside in (-2, 0, 2):  # columns by which the path is off the centre
            columns = np.full(len(rows), aside + (centre - paint.view.n[0]) / 0.05)
            n, weight = paint.centres(rows, columns)
            np.testing.assert_allclose(n, centre, atol=0.01)
            assert np.all(weight > 0.5)


def test_without_paint_the_centre_is_the_path_itself_and_weighs_nothing(painted_road):
    paint = painted_road().line(1.0, first=10).bands()
    rows = np.array([79, 70, 20])
    n, weight = paint.centres(rows, np.array([50.25, 60.5, 30.0]))
    np.testing.assert_allclose(n, paint.view.n[0] + 0.05 * np.array([50.25, 60.5, 30.0]))
    assert not weight.any()


@pytest.mark.parametrize("side", [-1, 1])
def test_the_window_for_paint_ends_with_the_view(painted_road, side):
    paint = painted_road().line(side * 4.825).bands()
    beside = np.array([(side * 4.925 - paint.view.n[0]) / 0.05])  # two columns outwards
    n, weight = paint.centres(np.array([40]), beside)
    assert n[0] == pytest.approx(side * 4.825, abs=0.01)
    assert weight[0] > 0.5


def profile_of(painted_road, feature):
    """Return the profile of a view whose first columns have these features in every row, 0 elsewhere."""
    view = painted_road().view()
    everywhere = np.zeros(view.image.shape, np.float32)
    everywhere[:, : len(feature)] = feature
    nothing = np.zeros_like(everywhere)
    return PaintProfile(view, PaintMap(everywhere, view.on_road, nothing, nothing, nothing))


def test_the_feature_near_a_line_is_the_highest_within_ten_centimetres(painted_road):
    """Columns of 0.05 m: two to each side; of the line itself, one."""
    paint = profile_of(painted_road, [0.3, 0, 0, 0, 0.9, 0, 0, 0, 0])
    columns = np.arange(9)
    rows = np.full(9, 40)
    assert paint.feature(rows, columns) == pytest.approx([0.3, 0.3, 0.9, 0.9, 0.9, 0.9, 0.9, 0, 0])
    assert paint.feature_on_line(rows, columns) == pytest.approx([0.3, 0.3, 0, 0.9, 0.9, 0.9, 0, 0, 0])


def test_the_feature_is_that_of_each_row(painted_road):
    paint = profile_of(painted_road, [0.0] * 5)
    paint.paint_map.feature[[10, 11], [2, 3]] = 0.7, 0.4
    assert paint.feature(np.array([9, 10, 11]), np.array([3, 3, 3])) == pytest.approx([0, 0.7, 0.4])


def test_a_metre_of_line_gains_its_paint_less_what_blank_road_costs():
    assert paint_gain(np.array([0.0, 0.5, 1.0]), 0.2) == pytest.approx([-0.2, 0.3, 0.8])
    assert paint_gain(np.array([False, True]), 0.2) == pytest.approx([-0.2, 0.8])
