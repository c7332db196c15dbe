# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Pairing by stamps, on sequences short enough to follow by eye and on random ones. Stamps in ms."""

from hypothesis import given
from hypothesis import strategies as st

from lane_dp_ros.messages.stereo_sync import StereoSync

MS = 1_000_000


def paired(arrivals, tolerance_ms=10, sync=None):
    """Feed ("L" or "R", ms) arrivals, return the pairs as (left ms, right ms)."""
    sync = sync or StereoSync(tolerance_ms * MS)
    pairs = []
    for letter, ms in arrivals:
        pair = sync.add("left" if letter == "L" else "right", ms * MS, ms)
        if pair is not None:
            assert pair.stamp_ns == pair.left * MS
            pairs.append((pair.left, pair.right))
    return pairs


def test_equal_stamps_pair_at_once_whichever_side_comes_first():
    assert paired([("L", 0), ("R", 0), ("R", 100), ("L", 100)]) == [(0, 0), (100, 100)]


def test_a_constant_offset_within_the_tolerance_pairs_at_once():
    assert paired([("L", 0), ("R", 4), ("L", 100), ("R", 104)]) == [(0, 4), (100, 104)]


def test_beyond_the_tolerance_nothing_pairs():
    sync = StereoSync(10 * MS)
    assert paired([("L", 0), ("R", 11), ("L", 100), ("R", 111)], sync=sync) == []


def test_the_tolerance_itself_is_within():
    assert paired([("L", 0), ("R", 10)]) == [(0, 10)]


def test_the_nearest_partner_wins():
    assert paired([("L", 0), ("L", 8), ("R", 9)]) == [(8, 9)]


def test_after_equal_stamps_a_lost_image_does_not_shift_the_partners():
    arrivals = [("L", 0), ("R", 0), ("L", 33), ("R", 66), ("L", 66), ("L", 99), ("R", 99)]
    assert paired(arrivals, tolerance_ms=40) == [(0, 0), (66, 66), (99, 99)]


def test_chance_equality_only_delays_the_next_pair():
    arrivals = [("L", 0), ("R", 0), ("L", 100), ("R", 103), ("L", 200), ("R", 203)]
    assert paired(arrivals) == [(0, 0), (100, 103), (200, 203)]


def test_images_without_a_partner_are_dropped_and_counted():
    sync = StereoSync(10 * MS)
    assert paired([("L", 0), ("L", 100), ("R", 100), ("R", 200), ("L", 300), ("R", 300)], sync=sync) == [
        (100, 100),
        (300, 300),
    ]
    assert (sync.matched, sync.unpaired) == (2, {"left": 1, "right": 1})


def test_one_side_alone_fills_no_memory():
    sync = StereoSync(10 * MS, capacity=5)
    paired([("L", 100 * i) for i in range(50)], sync=sync)
    assert sync.unpaired == {"left": 45, "right": 0}


def test_a_bag_that_loops_pairs_on():
    loop = [("L", 5000), ("R", 5000), ("L", 5100), ("R", 5100)]
    assert paired(loop + loop) == [(5000, 5000), (5100, 5100)] * 2


def test_a_bag_that_loops_pairs_on_though_the_sides_cross_the_seam_apart():
    arrivals = [("L", 5000), ("L", 0), ("L", 100), ("R", 5000), ("R", 0), ("R", 100)]
    assert paired(arrivals) == [(0, 0), (100, 100)]


def test_a_jump_ahead_by_more_than_a_second_drops_what_waits():
    sync = StereoSync(10 * MS)
    assert paired([("L", 0), ("L", 1001), ("R", 1001)], sync=sync) == [(1001, 1001)]
    assert sync.unpaired == {"left": 1, "right": 0}


def test_slow_cameras_pair_too():
    arrivals = [(side, 2000 * i) for i in range(4) for side in "LR"]
    assert len(paired(arrivals)) == 4


def test_clear_forgets():
    sync = StereoSync(10 * MS)
    paired([("L", 0)], sync=sync)
    sync.clear()
    assert paired([("R", 0)], sync=sync) == []
    assert sync.unpaired == {"left": 1, "right": 0}


def alone(arrivals, tolerance_ms=10):
    """As `paired`, with left images handed out alone after 500 ms without a right one."""
    return paired(arrivals, sync=StereoSync(tolerance_ms * MS, alone_after_ns=500 * MS))


def lefts(*range_ms):
    return [("L", ms) for ms in range(*range_ms, 100)]


def test_left_images_go_on_alone_when_the_right_camera_falls_silent():
    arrivals = [("L", 0), ("R", 0), *lefts(100, 800)]
    assert alone(arrivals) == [(0, 0), (600, None), (700, None)]


def test_left_images_go_on_alone_when_the_right_camera_never_spoke():
    assert alone(lefts(0, 700)) == [(500, None), (600, None)]


def test_they_wait_for_a_camera_that_comes_back():
    arrivals = [*lefts(0, 600), ("R", 500), ("L", 600), ("R", 600), ("L", 700), ("R", 700)]
    assert alone(arrivals) == [(500, None), (600, 600), (700, 700)]


def test_a_late_right_image_makes_no_second_answer_and_the_stamps_rise():
    late = [(ms + 40, side, ms) for ms in range(0, 3000, 100) for side in "LR" if side == "L" or ms > 1500]
    late = [(at + 50 * (side == "R"), side, ms) for at, side, ms in late]
    found = [left for left, _ in alone([(side, ms) for _, side, ms in sorted(late)])]
    assert found == sorted(set(found))


def test_nothing_is_alone_while_right_images_come_whatever_their_stamps():
    assert alone([(side, ms + 30 * (side == "R")) for ms in range(0, 2000, 100) for side in "LR"]) == []


def test_slow_cameras_are_not_silent():
    arrivals = [(side, 900 * i) for i in range(4) for side in "LR"]
    assert alone(arrivals) == [(900 * i, 900 * i) for i in range(4)]


def test_a_jump_of_time_is_no_silence():
    assert alone([("L", 5000), ("L", 0), ("L", 100), ("R", 100)]) == [(100, 100)]
    assert alone([("L", 0), ("L", 5000), ("L", 5400), ("L", 5500)]) == [(5500, None)]


def test_without_being_asked_nothing_is_handed_out_alone():
    assert paired(lefts(0, 3000)) == []


arrivals = st.lists(st.tuples(st.sampled_from("LR"), st.integers(0, 3000)), max_size=60)


@given(arrivals, st.integers(0, 50), st.sampled_from([None, 500 * MS]))
def test_whatever_comes_the_books_balance(sequence, tolerance_ms, alone_after_ns):
    sync = StereoSync(tolerance_ms * MS, capacity=3, alone_after_ns=alone_after_ns)
    pairs = paired(sequence, sync=sync)
    assert all(b is None or abs(a - b) <= tolerance_ms for a, b in pairs)
    assert sync.matched + sync.alone == len(pairs)
    for letter, side, handed_out in (
        ("L", "left", sync.matched + sync.alone),
        ("R", "right", sync.matched),
    ):
        waiting = sum(name == letter for name, _ in sequence) - handed_out - sync.unpaired[side]
        assert 0 <= waiting <= 3
    sync.clear()
    assert 2 * sync.matched + sync.alone + sum(sync.unpaired.values()) == len(sequence)


@given(st.data(), st.integers(0, 49))
def test_a_rig_with_equal_stamps_never_pairs_others(data, tolerance_ms):
    """10 Hz, images lost at random, each side up to three frames late."""
    events = []
    for side in "LR":
        kept = data.draw(st.lists(st.integers(0, 30), unique=True).map(sorted))
        late = data.draw(st.integers(0, 3))
        events += [(index + late, side, 100 * index) for index in kept]
    pairs = paired([(side, ms) for _, side, ms in sorted(events)], tolerance_ms)
    assert all(a == b for a, b in pairs)
    assert pairs == sorted(set(pairs))


offset = st.integers(1, 5) | st.integers(-5, -1)


@given(st.lists(offset, max_size=30), st.permutations("LR"))
def test_a_rig_with_jitter_pairs_every_frame(jitter, order):
    expected = [(100 * i, 100 * i + j) for i, j in enumerate(jitter)]
    assert paired([(side, pair["LR".index(side)]) for pair in expected for side in order]) == expected
