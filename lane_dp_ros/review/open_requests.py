# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The requests that are being answered, counted, so that none is cut off at the end."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from http import HTTPStatus


class RefusedError(Exception):
    """A request that is answered with an error."""

    def __init__(self, status: HTTPStatus, reason: str) -> None:
        super().__init__(reason)
        self.status = status


class OpenRequests:
    """The requests that are being answered.

    None may be cut off at the end: the last change would be lost, and a process that ends while OpenCV is at
    work in another thread aborts.
    """

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._open, self._count = True, 0

    @contextmanager
    def one_more(self) -> Iterator[None]:
        """Count a request. Raises RefusedError after the end: the file of judgements is no longer ours."""
        with self._changed:
            if not self._open:
                raise RefusedError(HTTPStatus.SERVICE_UNAVAILABLE, "this review was ended")
            self._count += 1
        try:
            yield
        finally:
            with self._changed:
                self._count -= 1
                self._changed.notify_all()

    def close(self) -> None:
        """Take no more, and wait for those that are being answered."""
        with self._changed:
            self._open = False
            self._changed.wait_for(lambda: self._count == 0)
