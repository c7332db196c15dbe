# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Which slices of a bag other processes look at, so that all have about the same to do."""

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lane_dp_ros.tools.offline.look_ahead import Slice, slices_ahead

SECOND = 1_000_000_000


def slices(
    seconds: float, jobs: int, left_over: float = 0.2, rate: float = 10.0
) -> list[tuple[float, float]]:
    """Return the slices [s] of a bag that begins at 100 s, with `rate` pairs a second."""
    span = Slice(100 * SECOND, round((100 + seconds) * SECOND))
    return [
        (start / SECOND, end / SECOND)
        for start, end in slices_ahead(span, int(seconds * rate), jobs, left_over)
    ]


def test_one_process_looks_at_nothing_ahead() -> None:
    assert slices(3600, 1) == []


@pytest.mark.parametrize("jobs", [2, 4, 16])
def test_a_short_bag_is_not_worth_another_process(jobs) -> None:
    assert slices(13, jobs) == []


def test_of_a_minute_the_other_process_takes_the_last_half() -> None:
    """It begins a second late; of its pairs a fifth of the work is left for this one."""
    ((start, end),) = slices(60, 2)
    assert end == pytest.approx(160)
    assert end - start == pytest.approx((60 - 1) / 1.7)


def test_with_as_much_left_over_this_process_hardly_does_more_than_come_after() -> None:
    ((start, end),) = slices(45, 2, left_over=0.5)
    assert (start, end) == pytest.approx((105, 145))


def test_few_pairs_are_not_worth_another_process_however_long_they_took() -> None:
    assert slices(1e9, 8, rate=1e-8) == []
    assert len(slices(1e9, 2, rate=1e-7)) == 3


@given(st.floats(0, 20_000), st.integers(1, 64), st.sampled_from([0.2, 0.5]))
def test_slices_follow_one_another_within_the_bag(seconds, jobs, left_over) -> None:
    found = slices(seconds, jobs, left_over)
    assert all(start > 100 and end <= 100 + seconds + 1e-6 for start, end in found)
    assert all(8 - 1e-6 < end - start <= 61 for start, end in found)
    assert all(end <= start + 1e-6 for (_, end), (start, _) in pairwise(found))
