# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Work on a stream in several processes, with the results in the order of the stream."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from typing import TypeVar

from lane_dp_ros.messages.errors import CommandError

Item = TypeVar("Item")
Result = TypeVar("Result")

AHEAD = 2  # items in flight for each process: one at work, one waiting


def available_cpus() -> int:
    """Return how many CPUs this process may use; taskset or a container can make them fewer."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@contextmanager
def parallel_map(
    function: Callable[[Item], Result], items: Iterable[Item], jobs: int
) -> Iterator[Iterator[tuple[Item, Result]]]:
    """Open an iterator over (item, function(item)), in the order of `items`, at work in `jobs` processes.

    With one job all is done in this process. With more, `function`, items and results must be picklable, and
    at most 2 x `jobs` items are held at a time. When the block ends, however it does, the processes end.
    The iterator raises what `function` raises, and CommandError when a process dies.
    """
    if jobs == 1:
        yield ((item, function(item)) for item in items)
        return
    # Spawned, as a fork would copy the locks of OpenCV's threads, held or not.
    pool = ProcessPoolExecutor(jobs, multiprocessing.get_context("spawn"), _set_up_worker)
    try:
        _start(pool, jobs)
        yield _in_order(pool, function, items, jobs)
    except BrokenProcessPool:
        raise CommandError("a worker process died (out of memory?): try fewer, such as --jobs 1") from None
    finally:
        pool.shutdown(cancel_futures=True)


def _start(pool: ProcessPoolExecutor, jobs: int) -> None:
    """Start the processes, deaf to Ctrl-C from their first moment: that is this process's to answer."""
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)  # what a new process starts with
    try:
        for _ in range(jobs):
            pool.submit(int)
    finally:
        signal.signal(signal.SIGINT, before)


def _set_up_worker() -> None:
    import cv2

    signal.signal(signal.SIGINT, signal.SIG_IGN)
    cv2.setNumThreads(1)  # each process has a core
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    # Even a parent that is killed leaves no process behind.
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _in_order(
    pool: ProcessPoolExecutor, function: Callable[[Item], Result], items: Iterable[Item], jobs: int
) -> Iterator[tuple[Item, Result]]:
    pending: deque[tuple[Item, Future[Result]]] = deque()
    for item in items:
        pending.append((item, pool.submit(function, item)))
        if len(pending) == AHEAD * jobs:
            first, future = pending.popleft()
            yield first, future.result()
    for first, future in pending:
        yield first, future.result()
