# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Work on a stream in several processes, with the results in the order of the stream."""

from __future__ import annotations

import multiprocessing
import os
import pickle
import signal
import threading
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from multiprocessing.connection import Connection
from queue import SimpleQueue
from typing import Generic, TypeVar

from lane_dp_ros.messages.errors import CommandError

Item = TypeVar("Item")
Result = TypeVar("Result")

DIED = "a worker process died (out of memory?): try fewer, such as --jobs 1"
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
        with _deaf_to_ctrl_c():
            for _ in range(jobs):
                pool.submit(int)  # starts a process
        yield _in_order(pool, function, items, jobs)
    except BrokenProcessPool:
        raise CommandError(DIED) from None
    finally:
        pool.shutdown(cancel_futures=True)


class Stream(Generic[Result]):
    """An iterator over function(item), at work in a process of its own that runs ahead of who reads it.

    `function`, item and results must be picklable; the results wait here, serialised. The iterator raises
    what `function` raises, and CommandError when the process dies.
    """

    def __init__(self, function: Callable[[Item], Iterable[Result]], item: Item) -> None:
        spawn = multiprocessing.get_context("spawn")  # as above
        self._receiver, sender = spawn.Pipe(duplex=False)
        self._process = spawn.Process(target=_send_all, args=(function, item, sender), daemon=True)
        self._waiting: SimpleQueue[bytes | None] = SimpleQueue()
        self.done = False
        """Whether the process has no more to do, though what it sent may still wait here."""
        with _deaf_to_ctrl_c():
            self._process.start()
        sender.close()
        threading.Thread(target=self._receive, daemon=True).start()

    def __iter__(self) -> Iterator[Result]:
        while (sent := self._waiting.get()) is not None:
            result, error = pickle.loads(sent)
            if error is not None:
                raise error
            if result is None:
                return
            yield from result
        raise CommandError(DIED)

    def close(self) -> None:
        """End the process."""
        self._process.kill()
        self._process.join()

    def _receive(self) -> None:
        with self._receiver, suppress(EOFError, OSError):
            while True:
                self._waiting.put(self._receiver.recv_bytes())
        self.done = True
        self._waiting.put(None)


def _send_all(function: Callable[[Item], Iterable[Result]], item: Item, sender: Connection) -> None:
    """Send each result, in a list of its own, None behind the last, or the error that ended them."""
    _set_up_worker()
    try:
        for result in function(item):
            sender.send(([result], None))
        sender.send((None, None))
    except Exception as error:  # noqa: BLE001 - it is raised again in the other process
        sender.send((None, error))


@contextmanager
def _deaf_to_ctrl_c() -> Iterator[None]:
    """Let processes that start be deaf to it from their first moment: it is this process's to answer."""
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)  # what a new process starts with
    try:
        yield
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
