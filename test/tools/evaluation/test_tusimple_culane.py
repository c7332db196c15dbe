# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The measures of TuSimple and CULane, against cases worked out by hand."""

import numpy as np
import pytest

from lane_dp_ros.tools.evaluation.tusimple_culane import CULane, TuSimple, culane, tusimple, tusimple_rows

ROWS = np.arange(100.0, 200.0, 10.0)  # ten


def upright(u, top=100, bottom=199):
    """Return a line straight up the image."""
    return np.array([[u, top], [u, bottom]], dtype=float)


def test_rows():
    assert tusimple_rows(200, 171.3).tolist() == [180, 190]
    assert tusimple_rows(201, -5.0)[[0, -1]].tolist() == [0, 200]


def test_tusimple_perfect():
    lines = [upright(50), upright(150)]
    assert tusimple(lines, lines, ROWS) == TuSimple(1, 1.0, 0.0, 0.0)


@pytest.mark.parametrize(("shift", "accuracy"), [(19.9, 1.0), (20.0, 0.0), (-19.9, 1.0)])
def test_tusimple_width_of_an_upright_line(shift, accuracy):
    assert tusimple([upright(50 + shift)], [upright(50)], ROWS) == TuSimple(
        1, accuracy, 1 - accuracy, 1 - accuracy
    )


@pytest.mark.parametrize(("shift", "accuracy"), [(28.2, 1.0), (28.3, 0.0)])
def test_tusimple_width_of_a_line_at_45_degrees(shift, accuracy):
    slanting = np.array([[50.0, 100.0], [150.0, 200.0]])  # 20 px / cos(45 deg) = 28.28 px
    assert tusimple([slanting + np.array([shift, 0])], [slanting], ROWS).accuracy == accuracy


@pytest.mark.parametrize(("bottom", "accuracy", "wrong"), [(180, 0.9, 0.0), (170, 0.8, 1.0)])
def test_tusimple_wants_85_percent_of_the_rows(bottom, accuracy, wrong):
    assert tusimple([upright(50, 100, bottom)], [upright(50)], ROWS) == TuSimple(1, accuracy, wrong, wrong)


def test_tusimple_rows_where_neither_is_are_right():
    assert tusimple([upright(50, 150)], [upright(50, 150)], ROWS).accuracy == 1.0
    assert tusimple([upright(250, 150)], [upright(50, 150)], ROWS).accuracy == 0.5


def test_tusimple_counts_lines_without_a_label_and_labels_without_a_line():
    found = tusimple([upright(50), upright(350), upright(450)], [upright(50), upright(150)], ROWS)
    assert found == TuSimple(1, 0.5, 2 / 3, 0.5)
    assert tusimple([], [upright(50)], ROWS) == TuSimple(1, 0.0, 0.0, 1.0)


def test_tusimple_fails_a_frame_with_three_lines_too_many():
    lines = [upright(u) for u in (50, 250, 350, 450)]
    assert tusimple(lines, [upright(50)], ROWS) == TuSimple(1, 0.0, 0.0, 1.0)
    assert tusimple(lines[:3], [upright(50)], ROWS) == TuSimple(1, 1.0, 2 / 3, 0.0)


def test_tusimple_lets_one_of_five_labels_go():
    labels = [upright(u) for u in (50, 150, 250, 350, 450)]
    assert tusimple(labels[:4], labels, ROWS) == TuSimple(1, 1.0, 0.0, 0.0)
    assert tusimple(labels[:3], labels, ROWS) == TuSimple(1, 0.75, 0.0, 0.25)
    assert tusimple(labels, labels, ROWS) == TuSimple(1, 1.0, 0.0, 0.0)


def test_tusimple_leaves_out_frames_without_labels_and_means_over_the_others():
    total = tusimple([upright(50)], [], ROWS) + TuSimple(1, 1.0, 0.0, 0.0) + TuSimple(1, 0.5, 0.2, 0.4)
    assert (total.frames, total.accuracy, total.fp, total.fn) == (2, 0.75, 0.1, 0.2)
    assert np.isnan(TuSimple().accuracy)


SIZE = (640, 200)


@pytest.mark.parametrize(("shift", "tp"), [(0, 1), (9, 1), (11, 0)])
def test_culane_iou_of_upright_lines(shift, tp):
    """Bands 30 px wide, s px apart: IoU (30 - s) / (30 + s), 0.5 at s = 10."""
    through = upright(100, -100, 300)  # beyond the image, so that the round ends do not count
    assert culane([through + np.array([shift, 0])], [through], SIZE) == CULane(tp, 1 - tp, 1 - tp)


@pytest.mark.parametrize(("length", "tp"), [(0.6, 1), (0.4, 0)])
def test_culane_iou_of_a_shorter_line(length, tp):
    assert culane([upright(100, 0, 400 * length)], [upright(100, 0, 400)], (640, 500)).tp == tp


def test_culane_pairs_for_the_largest_sum_not_the_largest_first():
    """Greedily, the second line would take the first label (IoU 0.88), and leave the first line 0.25."""
    through = [upright(u, -100, 300) for u in (100, 109)]
    lines = [upright(u, -100, 300) for u in (91, 102)]
    assert culane(lines, through, SIZE) == CULane(2, 0, 0)


def test_culane_counts():
    lines, labels = [upright(100), upright(300)], [upright(100), upright(500), upright(600)]
    found = culane(lines, labels, SIZE)
    assert found == CULane(tp=1, fp=1, fn=2)
    assert found.f1 == pytest.approx(2 / 5)  # precision 1/2, recall 1/3
    assert (found + CULane(3, 0, 0)).f1 == pytest.approx(8 / 11)
    assert np.isnan(culane([], [], SIZE).f1)


def test_culane_takes_lines_that_leave_the_image():
    far = np.array([[100.0, 0.0], [100.0, 199.0], [1e9, 1e9]])
    assert culane([far], [far], SIZE) == CULane(1, 0, 0)
    assert culane([upright(-500)], [upright(100)], SIZE) == CULane(0, 1, 1)
    assert culane([np.empty((0, 2))], [upright(100)], SIZE) == CULane(0, 1, 1)
