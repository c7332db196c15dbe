# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The CameraInfo of both sides that belong together. Plain Python, times are given."""

from __future__ import annotations

from typing import Any, NamedTuple

from lane_dp_ros.messages.stamp import stamp_from_ros
from lane_dp_ros.messages.stereo_sync import SIDES, Side

SETTLING = 1.0  # s that a change on one side waits for the other side's


class _Change(NamedTuple):
    """Which side changed, the stamp of its message, and when it came [s]."""

    side: Side
    stamp_ns: int
    time: float


class CameraInfos:
    """Keeps the last CameraInfo of each side, and never mixes an old calibration with a new one.

    A side that changes waits until the other one has spoken, too, with a stamp that is no older, or has not
    done so for a second: then it was the only one to change.
    """

    def __init__(self) -> None:
        self._last: dict[Side, Any] = {}
        self._in_use: tuple[Any, Any] | None = None
        self._changed: _Change | None = None

    def hear(self, side: Side, msg: Any, now: float) -> None:
        """Take a CameraInfo in."""
        is_new = side not in self._last or _calibration(msg) != _calibration(self._last[side])
        self._last[side] = msg
        if is_new and self._in_use is not None and self._changed is None:
            self._changed = _Change(side, stamp_from_ros(msg.header.stamp), now)
        elif (
            self._changed is not None
            and side != self._changed.side
            and stamp_from_ros(msg.header.stamp) >= self._changed.stamp_ns
        ):
            self._changed = None

    def both(self, now: float) -> tuple[Any, Any] | None:
        """Return left and right that belong together, None before both have come."""
        if self._changed is not None and now - self._changed.time > SETTLING:
            self._changed = None
        if self._changed is None and len(self._last) == len(SIDES):
            self._in_use = (self._last["left"], self._last["right"])
        return self._in_use


def _calibration(msg: Any) -> tuple[Any, ...]:
    return (msg.width, msg.height, *map(float, msg.p))
