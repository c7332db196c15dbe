# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The progress bar of what takes long."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any


def progress(items: Iterable[Any], total: int, unit: str) -> Iterable[Any]:
    """Yield `items` behind a progress bar; a terminal shows it, a log file gets nothing."""
    from tqdm import tqdm

    return tqdm(items, total=total, unit=unit, disable=None, dynamic_ncols=True)
