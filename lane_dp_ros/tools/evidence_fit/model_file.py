# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Write an evidence model as a file that people can read."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from lane_dp_ros.core.lanes.evidence_model import CLASSES, FORMAT, EvidenceModel, Term

DIGITS = 4  # significant, of each number


def model_text(model: EvidenceModel, about: Mapping[str, Any]) -> str:
    """Return the file of a model: what it is `about`, then a line for each term."""
    lines = [f'"format": {json.dumps(FORMAT)}']
    lines += [f"{json.dumps(name)}: {json.dumps(value)}" for name, value in about.items()]
    for kind in CLASSES:
        lines.append(
            f'"{kind}": {{"start": {_rounded(model.start[kind])}, "terms": {_terms(model.terms[kind])}}}'
        )
    lines.append(f'"pairs": {_terms(model.pairs)}')
    return "{\n" + ",\n".join(lines) + "\n}\n"


def _terms(terms: Mapping[str, Term]) -> str:
    of_terms = ",\n".join(f'  "{name}": {_term(term)}' for name, term in terms.items())
    return "{\n" + of_terms + "\n}"


def _term(term: Term) -> str:
    at, log_odds = ([_rounded(value) for value in values] for values in (term.at, term.log_odds))
    return json.dumps({"at": at, "log_odds": log_odds, "unknown": _rounded(term.unknown)})


def _rounded(value: float) -> float:
    return float(f"{float(value):.{DIGITS}g}")
