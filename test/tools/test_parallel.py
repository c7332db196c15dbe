# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""A stream through several processes. What they run must be importable there: builtins do."""

import math
import os
import signal
import time

import pytest

from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.tools.parallel import Stream, available_cpus, parallel_map

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


def test_a_stream_comes_in_order_from_another_process_that_is_set_up() -> None:
    before = signal.getsignal(signal.SIGINT)
    stream = Stream(
        eval, f"({PID}, __import__('cv2').getNumThreads(), __import__('signal').getsignal(2), None)"
    )
    pid, *rest = stream
    assert pid != os.getpid()
    assert rest == [1, signal.SIG_IGN, None]
    assert signal.getsignal(signal.SIGINT) is before
    stream.close()
    with pytest.raises(ProcessLookupError):
        os.kill(pid, 0)


def test_a_stream_runs_ahead_of_who_reads_it() -> None:
    stream = Stream(range, 2000)
    deadline = time.monotonic() + 30
    while not stream.done:
        assert time.monotonic() < deadline
        time.sleep(0.01)
    assert list(stream) == list(range(2000))
    stream.close()


def test_a_stream_ends_when_it_is_closed_though_there_is_more() -> None:
    stream = Stream(eval, f"__import__('itertools').chain([{PID}], __import__('itertools').count())")
    pid = next(iter(stream))
    stream.close()
    with pytest.raises(ProcessLookupError):
        os.kill(pid, 0)


def test_an_error_comes_through_a_stream_after_what_came_before() -> None:
    stream = Stream(eval, "map((1).__truediv__, [1, 0])")
    results = iter(stream)
    assert next(results) == 1
    with pytest.raises(ZeroDivisionError):
        next(results)
    stream.close()


def test_the_process_of_a_stream_that_dies() -> None:
    stream = Stream(eval, "map(__import__('os')._exit, [1])")
    with pytest.raises(CommandError, match="a worker process died"):
        list(stream)
    stream.close()


def test_the_cpus_are_those_of_this_process() -> None:
    assert available_cpus() == len(os.sched_getaffinity(0))
