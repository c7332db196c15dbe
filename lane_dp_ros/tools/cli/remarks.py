# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What the package has to say besides results, as lines on standard error."""

from __future__ import annotations

import logging
import sys
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def remarks_on_stderr() -> Iterator[None]:
    """Write what the package's modules log while the block runs, each line once, headed by `lane_dp: `."""
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(logging.Formatter("lane_dp: %(message)s"))
    handler.addFilter(_once())
    logger = logging.getLogger("lane_dp_ros")
    before = logger.level, logger.propagate
    logger.addHandler(handler)
    logger.setLevel(logging.INFO)
    logger.propagate = False
    try:
        yield
    finally:
        logger.removeHandler(handler)
        logger.setLevel(before[0])
        logger.propagate = before[1]


def _once() -> logging.Filter:
    """Return a filter that lets a line pass the first time: a bag may be opened anew for each picture."""
    said: set[str] = set()

    class Once(logging.Filter):
        """Passes what was not said yet."""

        def filter(self, record: logging.LogRecord) -> bool:
            """Return whether this line is new."""
            is_new = (text := record.getMessage()) not in said
            said.add(text)
            return is_new

    return Once()
