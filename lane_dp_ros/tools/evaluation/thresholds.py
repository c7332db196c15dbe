# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The limits that an evaluation can be held to: --min-precision and the like."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from lane_dp_ros.tools.evaluation.summary import Summary


class Threshold(NamedTuple):
    """A limit that a user may set: option, the summary's attribute, its name, whether it is a lower limit."""

    option: str
    attribute: str
    name: str
    is_lower: bool


THRESHOLDS = (
    Threshold("--min-precision", "paper_precision", "precision", True),
    Threshold("--min-recall", "lane_recall", "recall", True),
    Threshold("--min-detection-precision", "detection_precision", "detection precision", True),
    Threshold("--max-error", "localisation_error", "error", False),
    Threshold("--max-false-per-frame", "false_lanes_per_frame", "false lanes per frame", False),
)


def missed_thresholds(total: Summary, limits: Mapping[str, float | None]) -> str:
    """Return one line that says which of the limits, {option: value}, are missed and by how much; or ""."""
    given = [(threshold, limits[threshold.option]) for threshold in THRESHOLDS]
    texts = [_missed(total, threshold, limit) for threshold, limit in given if limit is not None]
    return "; ".join(text for text in texts if text)


def _missed(total: Summary, threshold: Threshold, limit: float) -> str:
    value = getattr(total, threshold.attribute)
    if math.isnan(value):
        return f"{threshold.name} is not known, there is nothing to count, {threshold.option} is {limit:g}"
    short = limit - value if threshold.is_lower else value - limit
    if short <= 0:
        return ""
    side = "below" if threshold.is_lower else "above"
    return f"{threshold.name} {value:.4f} is {side} {threshold.option} {limit:g} by {short:.2g}"
