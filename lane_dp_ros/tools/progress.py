# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""How far long work is: a bar in a terminal, a plain line now and then in a log."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterable, Iterator
from typing import Any

LOG_PERIOD = 30.0  # s between the lines where there is no terminal


def progress(items: Iterable[Any], total: int, unit: str) -> Iterable[Any]:
    """Yield `items` behind a progress bar on standard error; without a terminal a line every 30 s."""
    if sys.stderr is None:  # closed, as some daemons start their children
        return items
    from tqdm import tqdm

    if sys.stderr.isatty():
        return tqdm(items, total=total, unit=unit, dynamic_ncols=True)
    return _logged(items, total, unit)


def _logged(items: Iterable[Any], total: int, unit: str) -> Iterator[Any]:
    from tqdm import tqdm

    start = said = time.monotonic()
    for count, item in enumerate(items, 1):
        yield item
        if (now := time.monotonic()) - said >= LOG_PERIOD:
            said = now
            text = tqdm.format_meter(
                count,
                total,
                now - start,
                unit=unit,
                bar_format="{n_fmt} of {total_fmt} {unit}s, {rate_fmt}, {remaining} left",
            )
            print(text, file=sys.stderr, flush=True)
