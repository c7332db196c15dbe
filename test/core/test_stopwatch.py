# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The computing time of the stages."""

import time

import pytest

from lane_dp_ros.core.stopwatch import Stopwatch


def test_stages_stand_in_the_order_in_which_they_first_ran():
    watch = Stopwatch()
    for stage in ("view", "graph", "view", "paths", "graph"):
        with watch(stage):
            pass
    assert list(watch.seconds) == ["view", "graph", "paths"]


def test_a_stage_takes_as_long_as_its_block():
    watch = Stopwatch()
    start = time.perf_counter()
    with watch("stage"):
        time.sleep(0.02)
    assert 0.02 <= watch.seconds["stage"] <= time.perf_counter() - start


def test_a_stage_that_runs_again_is_added_up():
    watch = Stopwatch()
    for _ in range(3):
        with watch("stage"):
            time.sleep(0.01)
    assert watch.seconds["stage"] >= 0.03


def test_an_error_in_a_stage_comes_through():
    watch = Stopwatch()
    with pytest.raises(ZeroDivisionError), watch("stage"):
        1 / 0  # noqa: B018


def test_two_watches_know_nothing_of_each_other():
    first, second = Stopwatch(), Stopwatch()
    with first("stage"):
        pass
    assert second.seconds == {}


def test_the_seconds_of_before_are_added_to_and_left_as_they_were():
    before = {"first": 1.0, "second": 2.0}
    watch = Stopwatch(before)
    with watch("second"), watch("third"):
        pass
    assert list(watch.seconds) == ["first", "second", "third"]
    assert watch.seconds["first"] == 1.0
    assert 2.0 < watch.seconds["second"] < 3.0
    assert before == {"first": 1.0, "second": 2.0}
