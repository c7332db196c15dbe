# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Heavy work that never queues: one thread that takes the newest item."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any


class LatestOnlyWorker:
    """A thread that works on the newest item offered; one that waits is replaced, and counted as dropped."""

    def __init__(self, work: Callable[[Any], None]) -> None:
        self.dropped = 0
        self._work = work
        self._waiting: Any = None
        self._closing = False
        self._changed = threading.Condition()
        # A daemon, because things may go wrong before anybody is there to call close().
        self._thread = threading.Thread(target=self._run, name="latest_only", daemon=True)
        self._thread.start()

    def offer(self, item: Any) -> None:
        """Hand over an item, not None; returns at once."""
        with self._changed:
            self.dropped += self._waiting is not None
            self._waiting = item
            self._changed.notify()

    def close(self) -> None:
        """End the thread, after the item in work, if any; what waits is left undone."""
        with self._changed:
            self._closing = True
            self._changed.notify()
        self._thread.join()

    def _run(self) -> None:
        while (item := self._next()) is not None:
            self._work(item)

    def _next(self) -> Any:
        with self._changed:
            self._changed.wait_for(lambda: self._closing or self._waiting is not None)
            item, self._waiting = self._waiting, None
            return None if self._closing else item
