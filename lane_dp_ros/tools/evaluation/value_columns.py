# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The columns of the tables beside the main one: depth and 3-D, road edges, frames without paint."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import NamedTuple

from lane_dp_ros.tools.evaluation.depth import DEPTHS
from lane_dp_ros.tools.evaluation.summary import Summary


class ValueColumn(NamedTuple):
    """A column of a table: its head in two lines, its number, its spec."""

    top: str
    bottom: str
    of: Callable[[Summary], float]
    spec: str = ".3f"


def _bias(depth: float, summary: Summary) -> float:
    return 100 * summary.depth.bias(depth)


def _spread(depth: float, summary: Summary) -> float:
    return 100 * summary.depth.spread(depth)


def _depth_columns(depth: float) -> Iterator[ValueColumn]:
    """Yield the bias and the spread of the surface's depth in per cent, at a depth [m]."""
    yield ValueColumn("depth %", f"{depth:g} m", partial(_bias, depth), "+.2f")
    yield ValueColumn("90 %", "within", partial(_spread, depth), ".2f")


DEPTH_COLUMNS = (
    *(column for depth in DEPTHS for column in _depth_columns(depth)),
    ValueColumn("no", "surface", lambda s: s.depth.no_surface if s.depth.frames else math.nan, ".0f"),
)
SPACE_COLUMNS = (
    *DEPTH_COLUMNS,
    ValueColumn("3-D m", "6-12 m", lambda s: s.in_space.near.value),
    ValueColumn("3-D m", "12-25 m", lambda s: s.in_space.far.value),
    ValueColumn("3-D m", "at 10 m", lambda s: s.in_space.at_10.value),
    ValueColumn("3-D m", "at 25 m", lambda s: s.in_space.at_25.value),
)
EDGE_COLUMNS = (
    ValueColumn("road edges", "labelled", lambda s: s.road_edges.labels, "d"),
    ValueColumn("", "found", lambda s: s.road_edges.matched, "d"),
    ValueColumn("", "recall", lambda s: s.road_edges.recall),
    ValueColumn("", "published", lambda s: s.road_edges.detections, "d"),
    ValueColumn("", "false", lambda s: s.road_edges.false_edges, "d"),
    ValueColumn("false", "per frame", lambda s: s.road_edges.false_per_frame, ".2f"),
    ValueColumn("error m", "6-25 m", lambda s: s.road_edges.error.value),
)


def value_cells(summary: Summary, columns: Sequence[ValueColumn]) -> list[str]:
    """Return the numbers of a line of a table; "-" stands where there was nothing to count."""
    values = [column.of(summary) for column in columns]
    return [
        "-" if math.isnan(value) else format(value, column.spec)
        for value, column in zip(values, columns, strict=True)
    ]
