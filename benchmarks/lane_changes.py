# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What differs between the lanes that two versions of the detector find in a frame."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.types import Lane
from lane_dp_ros.tools.evaluation.annotations import by_depth

Floats = NDArray[np.float64]
Kind = Literal["appears", "vanishes", "moves", "extent", "role", "confidence", "no answer"]
KINDS: tuple[Kind, ...] = get_args(Kind)

SAME_LINE = 0.5  # m; mean lateral distance below which two lines may be one and the same
MOVED = 0.02  # m; largest lateral distance that is no difference
EXTENT = 1.0  # m; largest change of the nearest or farthest depth that is no difference
CONFIDENCE = 0.05  # largest change of the confidence that is no difference


@dataclass(frozen=True)
class Change:
    """One difference in a frame: of which kind, and in words."""

    frame: str
    kind: Kind
    text: str

    def __str__(self) -> str:
        return f"{self.frame}: {self.kind}: {self.text}"


def changes(frame: str, old: Sequence[Lane] | None, new: Sequence[Lane] | None) -> list[Change]:
    """Return how the new lanes of a frame differ from the old ones; None stands for no answer at all."""
    if old is None or new is None:
        sides = [side for side, lanes in (("old", old), ("new", new)) if lanes is None]
        return [Change(frame, "no answer", f"by the {sides[0]} one")] if len(sides) == 1 else []
    pairs = same_lines(old, new)
    gone = [lane for i, lane in enumerate(old) if i not in {i for i, _ in pairs}]
    come = [lane for j, lane in enumerate(new) if j not in {j for _, j in pairs}]
    return [
        *(Change(frame, "vanishes", describe(lane)) for lane in gone),
        *(Change(frame, "appears", describe(lane)) for lane in come),
        *(change for i, j in pairs for change in _changes_of_line(frame, old[i], new[j])),
    ]


def same_lines(old: Sequence[Lane], new: Sequence[Lane]) -> list[tuple[int, int]]:
    """Return the indices (old, new) of lines that are the same: one to one, the nearest pair first."""
    near = sorted(
        (distance, i, j)
        for i, a in enumerate(old)
        for j, b in enumerate(new)
        if (distance := _mean(lateral_distances(a, b))) < SAME_LINE
    )
    pairs: list[tuple[int, int]] = []
    for _, i, j in near:
        if all(i != taken_i and j != taken_j for taken_i, taken_j in pairs):
            pairs.append((i, j))
    return sorted(pairs)


def lateral_distances(a: Lane, b: Lane) -> Floats:
    """Return |x of a - x of b| [m] at the depth of each point of either; empty where they share no depth.

    Between these depths both are straight: the largest value is the largest distance anywhere.
    """
    one, other = (by_depth(np.asarray(lane.points, dtype=np.float64)[:, [0, 2]]) for lane in (a, b))
    near, far = max(one[0, 1], other[0, 1]), min(one[-1, 1], other[-1, 1])
    depths = np.concatenate([one[:, 1], other[:, 1]])
    shared = np.unique(depths[(depths >= near) & (depths <= far)])
    x_one, x_other = (np.interp(shared, line[:, 1], line[:, 0]) for line in (one, other))
    distances: Floats = np.abs(x_one - x_other)
    return distances


def describe(lane: Lane) -> str:
    """Return a line in words: its role, where it begins, over which depths it runs, its confidence."""
    start = f"x {lane.points[0, 0]:+.2f} m, {_extent(lane)}"
    return f"{lane.role}, {start}, confidence {lane.confidence:.2f}"


def _changes_of_line(frame: str, old: Lane, new: Lane) -> Iterator[Change]:
    if (moved := float(lateral_distances(old, new).max())) > MOVED:
        yield Change(frame, "moves", f"by {moved:.3f} m: {describe(new)}")
    if np.abs(np.subtract(new.extent, old.extent)).max() > EXTENT:
        yield Change(frame, "extent", f"from {_extent(old)}: {describe(new)}")
    if new.role != old.role:
        yield Change(frame, "role", f"from {old.role}: {describe(new)}")
    if abs(new.confidence - old.confidence) > CONFIDENCE:
        yield Change(frame, "confidence", f"from {old.confidence:.2f}: {describe(new)}")


def _extent(lane: Lane) -> str:
    return "{:.1f} to {:.1f} m".format(*lane.extent)


def _mean(distances: Floats) -> float:
    return float(distances.mean()) if distances.size else np.inf
