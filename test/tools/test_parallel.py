# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""A stream through several processes. What they run must be importable there: builtins do."""

import math
import os
import signal

import pytest

from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.tools.parallel import available_cpus, parallel_map

PID = "__import__('os').getpid()"


@pytest.mark.parametrize("jobs", [1, 2, 3])
def test_results_come_in_the_order_of_the_items(jobs) -> None:
    slow_first = [f"__import__('time').sleep({0.2 if i == 0 else 0}) or {i}" for i in range(9)]
    with parallel_map(eval, slow_first, jobs) as results:
        assert list(results) == [(item, i) for i, item in enumerate(slow_first)]


@pytest.mark.parametrize(("jobs", "held"), [(1, 1), (2, 4)])
def test_few_items_are_held(jobs, held) -> None:
    drawn = []

    def items():
        for i in range(20):
            drawn.append(i)
            yield i

    with parallel_map(abs, items(), jobs) as results:
        in_flight = [len(drawn) - done for done, _ in enumerate(results)]
    assert max(in_flight) == held


def test_fewer_items_than_processes() -> None:
    with parallel_map(abs, [-3], 2) as results:
        assert list(results) == [(-3, 3)]
    with parallel_map(abs, [], 2) as results:
        assert list(results) == []


def test_the_processes_are_others_and_set_up() -> None:
    before = signal.getsignal(signal.SIGINT)
    items = [PID, "__import__('cv2').getNumThreads()", "__import__('signal').getsignal(2)"]
    with parallel_map(eval, items, 2) as results:
        pid, threads, handler = (result for _, result in results)
    assert pid != os.getpid()
    assert threads == 1
    assert handler == signal.SIG_IGN
    assert signal.getsignal(signal.SIGINT) is before
    with pytest.raises(ProcessLookupError):
        os.kill(pid, 0)


def test_one_job_needs_no_other_process() -> None:
    with parallel_map(eval, [PID], 1) as results:
        assert list(results) == [(PID, os.getpid())]


@pytest.mark.parametrize("jobs", [1, 2])
def test_an_error_comes_through(jobs) -> None:
    with (
        pytest.raises(ValueError, match=r"math domain|nonnegative"),
        parallel_map(math.sqrt, [-1], jobs) as results,
    ):
        list(results)


def test_a_process_that_dies() -> None:
    with (
        pytest.raises(CommandError, match="a worker process died"),
        parallel_map(os._exit, [1], 2) as results,
    ):
        list(results)


def test_the_cpus_are_those_of_this_process() -> None:
    assert available_cpus() == len(os.sched_getaffinity(0))
