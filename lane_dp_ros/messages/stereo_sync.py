# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Pair left and right images by their stamps. Plain Python: it knows neither ROS nor the clock."""

from __future__ import annotations

from typing import Any, Literal, NamedTuple

from lane_dp_ros.messages.stamp import NS_PER_S

Side = Literal["left", "right"]
SIDES: tuple[Side, Side] = ("left", "right")


class StereoPair(NamedTuple):
    """Two images that belong together, and the left one's stamp; `right` is None for a left one alone."""

    left: Any
    right: Any | None
    stamp_ns: int


RIGHT_SILENT_AFTER_NS = NS_PER_S // 2  # without a right image, then left ones are worked on alone


class StereoSync:
    """Pair what comes from two cameras: equal stamps first, else the nearest within a tolerance.

    At most `capacity` images of each side wait for their partner. An image that is older than one that was
    paired, or for which there is no room, is dropped and counted in `unpaired`. The stamps of the pairs rise
    until a side's stamps run backwards or jump by more than `jump_ns`: then what waits on
    that side is dropped.

    With `alone_after_ns`, left images are handed out alone, each as it comes, once so much time has passed
    on their stamps without any right image; with the first right one that comes they wait for theirs again.
    """

    def __init__(
        self,
        tolerance_ns: int,
        capacity: int = 5,
        jump_ns: int = NS_PER_S,
        alone_after_ns: int | None = None,
    ) -> None:
        self.tolerance_ns = tolerance_ns
        self.matched = 0
        self.alone = 0
        self.unpaired: dict[Side, int] = {"left": 0, "right": 0}
        self._capacity = capacity
        self._jump_ns = jump_ns
        self._alone_after_ns = alone_after_ns
        self._alone_since: int | None = None  # stamp of the first left image after the last right one
        self._waiting: dict[Side, dict[int, Any]] = {"left": {}, "right": {}}
        self._last_stamp: dict[Side, int] = {}
        self._stamps_are_equal = False

    def add(self, side: Side, stamp_ns: int, image: Any) -> StereoPair | None:
        """Take an image in; return the pair that it completes, or None."""
        self._forget_at_a_jump(side, stamp_ns)
        if side == "right":
            self._alone_since = None
        elif self._alone_since is None:
            self._alone_since = stamp_ns
        waiting = self._waiting[side]
        if stamp_ns in waiting:
            self.unpaired[side] += 1
        waiting[stamp_ns] = image
        stamps = self._equal(stamp_ns) or self._nearest()
        if stamps is not None:
            return self._taken(*stamps)
        if side == "left" and self._right_is_silent(stamp_ns):
            return self._taken_alone(stamp_ns)
        if len(waiting) > self._capacity:
            self._drop(side, min(waiting))
        return None

    def clear(self) -> None:
        """Drop what waits, as if nothing had come yet."""
        for side in SIDES:
            self._drop(side)
        self._last_stamp.clear()
        self._alone_since = None
        self._stamps_are_equal = False

    def _forget_at_a_jump(self, side: Side, stamp_ns: int) -> None:
        last = self._last_stamp.get(side, stamp_ns)
        self._last_stamp[side] = stamp_ns
        if not 0 <= stamp_ns - last <= self._jump_ns:
            # Only this side: the other one may be past the jump already, its images waiting for ours.
            self._drop(side)
            self._alone_since = None

    def _right_is_silent(self, left_ns: int) -> bool:
        if self._alone_after_ns is None or self._alone_since is None:
            return False
        return left_ns - self._alone_since >= self._alone_after_ns

    def _equal(self, stamp_ns: int) -> tuple[int, int] | None:
        left, right = self._waiting.values()
        return (stamp_ns, stamp_ns) if stamp_ns in left and stamp_ns in right else None

    def _nearest(self) -> tuple[int, int] | None:
        left, right = self._waiting.values()
        near = [(a, b) for a in left for b in right if self._may_pair(a, b)]
        return min(near, key=lambda pair: (abs(pair[0] - pair[1]), -pair[0]), default=None)

    def _may_pair(self, left_ns: int, right_ns: int) -> bool:
        """Tell whether two stamps are near enough, and no equal one can be still on its way.

        A rig whose last pair had equal stamps may have lost one image: its partner must not take the next
        one's. So the earlier image first waits for its side to move on. Other rigs need not wait; after
        stamps that were equal by chance they lose one pair at most.
        """
        if abs(left_ns - right_ns) > self.tolerance_ns:
            return False
        earlier: Side = "left" if left_ns < right_ns else "right"
        return not self._stamps_are_equal or self._last_stamp[earlier] > max(left_ns, right_ns)

    def _taken(self, left_ns: int, right_ns: int) -> StereoPair:
        left, right = self._waiting["left"].pop(left_ns), self._waiting["right"].pop(right_ns)
        self._drop("left", left_ns)
        self._drop("right", right_ns)
        self._stamps_are_equal = left_ns == right_ns
        self.matched += 1
        return StereoPair(left, right, left_ns)

    def _taken_alone(self, left_ns: int) -> StereoPair:
        left = self._waiting["left"].pop(left_ns)
        for side in SIDES:
            self._drop(side, left_ns)
        self.alone += 1
        return StereoPair(left, None, left_ns)

    def _drop(self, side: Side, until_ns: int | None = None) -> None:
        """Drop and count what waits on a side: all of it, or all up to a stamp."""
        waiting = self._waiting[side]
        kept = {} if until_ns is None else {ns: image for ns, image in waiting.items() if ns > until_ns}
        self.unpaired[side] += len(waiting) - len(kept)
        self._waiting[side] = kept
