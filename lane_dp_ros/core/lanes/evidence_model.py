# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The log-odds that a line is paint, or a border of the carriageway: a sum of one term a measurement.

Each term is a curve of its measurement, fitted to labelled lines with its physical sign fixed (a generalised
additive model; Hastie, Tibshirani 1986); a measurement that is not known has log-odds of its own. Further
terms are of two lines side by side. `lane_dp fit-evidence` writes the file that this reads.
"""

from __future__ import annotations

import json
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.lanes.candidate import LaneEvidence

Floats = NDArray[Any]

FORMAT = "lane_dp_ros evidence 1"
SHIPPED = "shipped"  # the name of the model that comes with the package
CLASSES = ("paint", "edge")
# Of two lines, the left and the right one: both paint, and how much of them lies in one place; paint before
# and behind a border, a border behind one, seen from the vehicle; one or both borders on either side of it.
PAIRS = (
    "paint_beside_paint",
    "paint_on_paint",
    "paint_before_edge",
    "paint_behind_edge",
    "edge_behind_edge",
    "paint_across_edge",
    "edge_across_edge",
)
LARGEST = 1e6  # of the numbers in a file


@dataclass(frozen=True, eq=False)
class Term:
    """Log-odds by one measurement: straight between the points `at` (N,), beyond the ends as at them.

    `unknown` are those of a measurement that is NaN.
    """

    at: Floats
    log_odds: Floats
    unknown: float = 0.0

    def __call__(self, values: Any) -> Floats:
        """Return the log-odds of values of any shape."""
        given = np.asarray(values, dtype=np.float64)
        return np.where(np.isnan(given), self.unknown, np.interp(given, self.at, self.log_odds))

    @property
    def highest(self) -> float:
        """The most that it can add."""
        return max(float(self.log_odds.max()), self.unknown)


@dataclass(frozen=True, eq=False)
class EvidenceModel:
    """The terms of each class by the name of their measurement, see `LaneEvidence`; those of `PAIRS`.

    `start` are the log-odds of each class before anything is measured; `source` is the whole file.
    """

    start: Mapping[str, float]
    terms: Mapping[str, Mapping[str, Term]]
    pairs: Mapping[str, Term]
    source: Mapping[str, Any]

    def parts(self, kind: str, evidence: LaneEvidence) -> dict[str, float]:
        """Return what each measurement adds to the log-odds of a class."""
        return {name: float(term(getattr(evidence, name))) for name, term in self.terms[kind].items()}

    def log_odds(self, kind: str, evidence: Sequence[LaneEvidence], without: Collection[str] = ()) -> Floats:
        """Return the log-odds (N,) of a class against clutter, by the own evidence of each of N lines.

        As if what is named in `without` were not known.
        """
        total = np.full(len(evidence), self.start[kind])
        for name, term in self.terms[kind].items():
            if name in without:
                total += term.unknown
            else:
                total += term(np.array([getattr(each, name) for each in evidence], np.float64))
        return total


@lru_cache(maxsize=8)
def evidence_model(path: str = SHIPPED) -> EvidenceModel:
    """Return the model in a file, or the one that comes with the package.

    Raises ValueError, in one line, for a file that cannot be read or holds something else.
    """
    try:
        text = (
            files("lane_dp_ros.core.lanes") / "evidence.json" if path == SHIPPED else Path(path)
        ).read_text()
        return parsed_model(json.loads(text))
    except (OSError, ValueError, RecursionError) as error:
        what = error.strerror if isinstance(error, OSError) else str(error)
        raise ValueError(
            f"evidence model {path!r}: {str(what)[:200]}; expected a file of lane_dp fit-evidence"
        ) from None


def parsed_model(content: Any) -> EvidenceModel:
    """Return the model that the content of a file describes. Raises ValueError for anything else."""
    if not isinstance(content, dict) or content.get("format") != FORMAT:
        raise ValueError(f"it does not say format {FORMAT!r}")
    classes = {kind: _mapping(content, kind) for kind in CLASSES}
    terms = {kind: _terms(_mapping(classes[kind], "terms"), kind) for kind in CLASSES}
    measured = set(LaneEvidence.__dataclass_fields__)
    for kind in CLASSES:
        if unknown := sorted(set(terms[kind]) - measured):
            raise ValueError(f"{kind}: there is no measurement {unknown[0][:40]!r}")
    pairs = _terms(_mapping(content, "pairs"), "pairs")
    if set(pairs) != set(PAIRS):
        raise ValueError(f"pairs: expected the terms {', '.join(PAIRS)}")
    start = {kind: _number(classes[kind].get("start"), f"{kind}: start") for kind in CLASSES}
    return EvidenceModel(start, terms, pairs, content)


def _mapping(content: Mapping[str, Any], name: str) -> Mapping[str, Any]:
    value = content.get(name)
    if not isinstance(value, dict):
        raise ValueError(f"it lacks the section {name!r}")
    return value


def _terms(content: Mapping[str, Any], where: str) -> dict[str, Term]:
    return {name: _term(content, name, f"{where}: {name[:40]}") for name in content}


def _term(content: Mapping[str, Any], name: str, where: str) -> Term:
    fields = _mapping(content, name)
    at, log_odds = (_numbers(fields.get(key), f"{where}: {key}") for key in ("at", "log_odds"))
    if len(at) != len(log_odds) or not np.all(np.diff(at) > 0):
        raise ValueError(f"{where}: expected as many log_odds as rising values at")
    return Term(at, log_odds, _number(fields.get("unknown", 0.0), f"{where}: unknown"))


def _numbers(value: Any, where: str) -> Floats:
    if not isinstance(value, list) or not 1 <= len(value) <= 1000:
        raise ValueError(f"{where}: expected a list of 1 to 1000 numbers")
    return np.array([_number(each, where) for each in value])


def _number(value: Any, where: str) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not abs(value) <= LARGEST:
        raise ValueError(f"{where}: expected a number of at most {LARGEST:.0e}")
    return float(value)
