# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""builtin_interfaces/Time to nanoseconds, and back."""

from __future__ import annotations

from typing import Any

from lane_dp_ros.messages.make import Make

NS_PER_S = 1_000_000_000


def stamp_from_ros(stamp: Any) -> int:
    """Return the nanoseconds of a builtin_interfaces/Time, such as a header's `stamp`."""
    return int(stamp.sec) * NS_PER_S + int(stamp.nanosec)


def stamp_to_ros(stamp_ns: int, make: Make) -> Any:
    """Return builtin_interfaces/Time."""
    seconds, nanoseconds = divmod(stamp_ns, NS_PER_S)
    return make("builtin_interfaces/msg/Time", sec=seconds, nanosec=nanoseconds)
