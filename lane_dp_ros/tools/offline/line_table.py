# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Answers as a table: a row for each lane line and road edge, for spreadsheets, pandas, polars or duckdb."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from lane_dp_ros.core.pipeline import FrameResult
from lane_dp_ros.core.types import Lane
from lane_dp_ros.messages.stereo_bag import BagPair
from lane_dp_ros.tools.offline.staged_file import staged_file

DISTANCES = (5, 10, 15, 20, 25, 30)  # m ahead, at which a table without points tells where a line lies
BATCH = 2000  # rows that wait before they are written as one group of a Parquet file

Row = dict[str, Any]

LINE_COLUMNS = (
    *("line", "id", "role", "kind", "colour", "confidence", "paint_width_m", "lateral_offset_m"),
    *("curvature_1_per_m", "near_m", "far_m"),
)
COLUMNS = ("stamp_ns", "pair", "road_profile", "problem", *LINE_COLUMNS)
AHEAD = tuple(f"x_at_{z}_m" for z in DISTANCES)


def rows(index: int, pair: BagPair, answer: FrameResult) -> Iterator[Row]:
    """Yield a row for each line of an answer, one without a line where there is none.

    `stamp_ns` is the left image's, `pair` counts the answers, `line` is "lane" or "road_edge"; x [m] lies
    right of the camera, z [m] ahead of it, in the left optical frame.
    """
    frame = {
        "stamp_ns": pair.pair.stamp_ns,
        "pair": index,
        "road_profile": answer.road_profile,
        "problem": answer.problem,
    }
    lines = answer.lanes + answer.road_edges
    yield from (frame | _of_line(lane) for lane in lines)
    if not lines:
        yield frame


def _of_line(lane: Lane) -> Row:
    x, _, z = lane.points.T
    ahead = np.interp(DISTANCES, z, x, left=np.nan, right=np.nan)
    is_edge = lane.kind == "edge"
    return {
        "line": "road_edge" if is_edge else "lane",
        "id": lane.id,
        "role": lane.role,
        "kind": None if is_edge else lane.kind or None,
        "colour": lane.colour or None,
        "confidence": round(lane.confidence, 4),
        "paint_width_m": None if is_edge else round(lane.paint_width, 4),
        "lateral_offset_m": round(lane.lateral_offset, 4),
        "curvature_1_per_m": round(lane.curvature, 7),
        "near_m": round(float(z[0]), 3),
        "far_m": round(float(z[-1]), 3),
        **{
            name: None if np.isnan(value) else round(float(value), 4)
            for name, value in zip(AHEAD, ahead, strict=True)
        },
        "points": lane.points,
    }


@contextmanager
def csv_table(path: Path, force: bool = False) -> Iterator[CsvTable]:
    """Open a CSV file, which appears at `path` when the block ends well. Raises as `staged_file`."""
    with staged_file(path, force) as written, written.open("w", newline="", encoding="utf-8") as file:
        yield CsvTable(csv.DictWriter(file, (*COLUMNS, *AHEAD), extrasaction="ignore"))
        file.flush()


class CsvTable:
    """Writes rows of `COLUMNS` and of where each line lies at `DISTANCES`."""

    def __init__(self, writer: csv.DictWriter[str]) -> None:
        self._writer, self._pairs = writer, 0
        writer.writeheader()

    def write(self, pair: BagPair, answer: FrameResult) -> None:
        """Append the lines of an answer."""
        self._writer.writerows(rows(self._pairs, pair, answer))
        self._pairs += 1


@contextmanager
def parquet_table(path: Path, force: bool = False) -> Iterator[ParquetTable]:
    """Open a Parquet file, which appears at `path` when the block ends well.

    Raises ModuleNotFoundError where pyarrow is not installed, and as `staged_file`.
    """
    import pyarrow.parquet

    schema = _schema(pyarrow)
    with staged_file(path, force) as written, pyarrow.parquet.ParquetWriter(written, schema) as writer:
        table = ParquetTable(writer, schema)
        yield table
        table.flush()


class ParquetTable:
    """Writes rows of `COLUMNS` with the points of each line, as three lists of metres."""

    def __init__(self, writer: Any, schema: Any) -> None:
        self._writer, self._schema = writer, schema
        self._waiting: list[Row] = []
        self._pairs = 0

    def write(self, pair: BagPair, answer: FrameResult) -> None:
        """Append the lines of an answer."""
        self._waiting += [_with_lists(row) for row in rows(self._pairs, pair, answer)]
        self._pairs += 1
        if len(self._waiting) >= BATCH:
            self.flush()

    def flush(self) -> None:
        """Write what waits."""
        import pyarrow

        if self._waiting:
            self._writer.write_table(pyarrow.Table.from_pylist(self._waiting, self._schema))
            self._waiting.clear()


def _with_lists(row: Row) -> Row:
    points = row.get("points")
    return row if points is None else row | {axis: points[:, i].tolist() for i, axis in enumerate("xyz")}


def _schema(pyarrow: Any) -> Any:
    text = ("road_profile", "problem", "line", "role", "kind", "colour")
    kinds = {"stamp_ns": pyarrow.int64(), "pair": pyarrow.int64(), "id": pyarrow.int64()}
    kinds |= {name: pyarrow.string() for name in text}
    columns = [(name, kinds.get(name, pyarrow.float64())) for name in COLUMNS]
    points = [(axis, pyarrow.list_(pyarrow.float64())) for axis in "xyz"]
    return pyarrow.schema(columns + points)
