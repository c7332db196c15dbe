# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""An evaluation as a JSON file: docs/evaluation.md."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from lane_dp_ros.messages.errors import CommandError, one_line
from lane_dp_ros.tools.evaluation.frame_json import score_from_json, score_to_json
from lane_dp_ros.tools.evaluation.reliability import (
    CONFIDENCE_BINS,
    confidences,
    reliability,
    road_edge_scores,
)
from lane_dp_ros.tools.evaluation.scores import FrameScore, LineScores
from lane_dp_ros.tools.evaluation.summary import by_category, by_sequence
from lane_dp_ros.tools.evaluation.summary_json import number, summary_json

FORMAT = "lane_dp evaluation 1"


def check_json_output(path: Path) -> None:
    """Raise CommandError for a file that is there and is no earlier evaluation: it would be lost."""
    if not path.exists():
        return
    try:
        _read_object(path)
    except CommandError:
        raise CommandError(
            f"{path} exists already and is no evaluation: choose another name for --json"
        ) from None


def write_json(
    results: Sequence[FrameScore], notes: Sequence[str], path: Path, source: Path | None = None
) -> None:
    """Write an evaluation as JSON, a frame to a line; the file appears complete or not at all.

    `source` is what was judged: there the images are found again.
    """
    content = as_json(results, notes, source)
    frames = ",\n  ".join(json.dumps(frame, allow_nan=False) for frame in content.pop("frames"))
    head = json.dumps(content, indent=1, allow_nan=False).removesuffix("\n}")
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        part.write_text(f'{head},\n "frames": [\n  {frames}\n ]\n}}\n', encoding="utf-8")
        part.replace(path)
    except OSError as error:
        raise CommandError(f"cannot write {path}: {error.strerror}") from None
    finally:
        part.unlink(missing_ok=True)


@dataclass(frozen=True)
class EvaluationFile:
    """An evaluation that was written before: its file, its frames, and what was judged."""

    path: Path
    results: tuple[FrameScore, ...]
    source: Path | None = None


def read_json(path: Path) -> EvaluationFile:
    """Read an evaluation again.

    Raises CommandError, in one line, for a file that is none, is damaged, or does not tell of the lines.
    """
    content = _read_object(path)
    try:
        results = tuple(_read_frame(fields) for fields in content["frames"])
        source = content["source"]
    except KeyError as error:
        hint = "an earlier release wrote it: run lane_dp evaluate --json again"
        raise CommandError(f"{path} lacks {error}; perhaps {hint}") from None
    except (TypeError, ValueError, AttributeError) as error:
        raise CommandError(f"{path} is damaged: {one_line(error)}") from None
    return EvaluationFile(path, results, None if source is None else Path(source))


def _read_object(path: Path) -> dict[str, Any]:
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise CommandError(f"cannot read {path}: {error.strerror}") from None
    except (ValueError, RecursionError):
        content = None
    if not (isinstance(content, dict) and content.get("format") == FORMAT):
        raise CommandError(f"{path} is no evaluation, expected what lane_dp evaluate --json writes")
    return content


def _read_frame(fields: Any) -> FrameScore:
    try:
        return score_from_json(fields)
    except (TypeError, ValueError, AttributeError, OverflowError) as error:
        name = fields.get("name") if isinstance(fields, dict) else fields
        raise ValueError(f"frame {str(name)[:80]!r}: {one_line(error)}") from None


def as_json(
    results: Sequence[FrameScore], notes: Sequence[str], source: Path | None = None
) -> dict[str, Any]:
    """Return an evaluation as what JSON can hold; null stands where there was nothing to count."""
    sequences, categories = by_sequence(results), by_category(results)
    total = sequences.pop("total")
    categories.pop("total")
    return {
        "format": FORMAT,
        "source": None if source is None else str(source.resolve()),
        "total": summary_json(total),
        "sequences": {name: summary_json(summary) for name, summary in sequences.items()},
        "categories": {name: summary_json(summary) for name, summary in categories.items()},
        "reliability": _reliability_json(results),
        "road_edge_reliability": _reliability_json(road_edge_scores(results)),
        "notes": list(notes),
        "frames": [score_to_json(result) for result in results],
    }


def _reliability_json(results: Sequence[LineScores]) -> dict[str, Any]:
    bins = reliability(*confidences(results))
    rows = zip(CONFIDENCE_BINS, bins.confidence, bins.right, bins.counts, strict=False)
    return {
        "expected_calibration_error": number(bins.error),
        "bins": [
            {"from": float(low), "mean": number(float(mean)), "right": int(right), "lines": int(lines)}
            for low, mean, right, lines in rows
        ],
    }
