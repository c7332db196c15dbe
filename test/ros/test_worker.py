# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The worker thread: newest item first, nothing queues, an orderly end."""

import threading

import pytest

from lane_dp_ros.ros.worker import LatestOnlyWorker


class Gate:
    """Work that notes what it took and waits to be let through."""

    def __init__(self):
        self.taken = []
        self.started = threading.Semaphore(0)
        self.go_on = threading.Semaphore(0)

    def __call__(self, item):
        self.taken.append(item)
        self.started.release()
        assert self.go_on.acquire(timeout=10)


@pytest.fixture
def gate():
    return Gate()


def test_while_one_is_in_work_only_the_newest_waits(gate):
    worker = LatestOnlyWorker(gate)
    worker.offer(1)
    assert gate.started.acquire(timeout=10)
    for item in (2, 3, 4):
        worker.offer(item)
    gate.go_on.release(2)
    assert gate.started.acquire(timeout=10)
    worker.close()
    assert (gate.taken, worker.dropped) == ([1, 4], 2)


def test_items_that_come_one_by_one_are_all_done(gate):
    worker = LatestOnlyWorker(gate)
    gate.go_on.release(20)
    for item in range(1, 21):
        worker.offer(item)
        assert gate.started.acquire(timeout=10)
    worker.close()
    assert (gate.taken, worker.dropped) == (list(range(1, 21)), 0)


def test_close_ends_the_work_at_hand_and_leaves_what_waits(gate):
    worker = LatestOnlyWorker(gate)
    worker.offer(1)
    assert gate.started.acquire(timeout=10)
    worker.offer(2)
    gate.go_on.release()
    worker.close()
    assert gate.taken in ([1], [1, 2])
    assert threading.active_count() == 1 or all(t.name != "latest_only" for t in threading.enumerate())
