# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The numbers by which two evaluations are compared, and which way each of them is better."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from operator import attrgetter

from lane_dp_ros.tools.evaluation.summary import Summary


@dataclass(frozen=True)
class Measure:
    """A number of a summary, NaN where there is nothing to count; `spec` prints it."""

    name: str
    of: Callable[[Summary], float]
    higher_is_better: bool = False
    spec: str = ".3f"
    by_group: bool = False
    """Whether it is told of each sequence and category, too."""


def _share(name: str, attribute: str, by_group: bool = False) -> Measure:
    return Measure(name, attrgetter(attribute), higher_is_better=True, by_group=by_group)


def _failed(attribute: str, summary: Summary) -> float:
    return float(getattr(summary, attribute)) if summary.ego_labels else math.nan


def _switches(summary: Summary) -> float:
    return summary.id_switches if summary.id_chances else math.nan


MEASURES = (
    _share("paper's precision", "paper_precision", by_group=True),
    Measure("incorrect", partial(_failed, "incorrect"), spec=".0f"),
    Measure("missed", partial(_failed, "missed"), spec=".0f"),
    _share("recall", "lane_recall", by_group=True),
    _share("detection precision", "detection_precision", by_group=True),
    _share("strict detection precision", "strict_detection_precision"),
    Measure("false lanes per frame", attrgetter("false_lanes_per_frame"), by_group=True),
    Measure("strict false lanes per frame", attrgetter("strict_false_lanes_per_frame")),
    Measure("error [m]", attrgetter("localisation_error"), by_group=True),
    Measure("error [m], 6-12 m ahead", attrgetter("near_error")),
    Measure("error [m], 12-25 m ahead", attrgetter("far_error")),
    Measure("3-D error [m], 6-12 m ahead", attrgetter("in_space.near.value")),
    Measure("3-D error [m], 12-25 m ahead", attrgetter("in_space.far.value")),
    Measure("depth error [%] of 90 % at 12 m", lambda s: 100 * s.depth.spread(12.0), spec=".2f"),
    Measure("depth error [%] of 90 % at 25 m", lambda s: 100 * s.depth.spread(25.0), spec=".2f"),
    _share("road edges, recall", "road_edges.recall"),
    Measure("road edges, false per frame", attrgetter("road_edges.false_per_frame")),
    _share("kind of paint right", "paint.kind_right"),
    _share("colour of paint right", "paint.colour_right"),
    Measure("id switches", _switches, spec=".0f"),
    Measure("jitter [m]", attrgetter("jitter")),
    Measure("latency [ms]", lambda s: 1e3 * s.latency, spec=".1f"),
    _share("TuSimple accuracy", "tusimple.accuracy"),
    _share("CULane F1", "culane.f1"),
)
GROUP_MEASURES = tuple(measure for measure in MEASURES if measure.by_group)


@dataclass(frozen=True)
class Difference:
    """A measure before and after a change; a difference is one that can be read from the printed numbers."""

    measure: Measure
    before: float
    after: float

    @classmethod
    def of(cls, measure: Measure, before: Summary, after: Summary) -> Difference:
        """Return the difference of a measure between two summaries."""
        return cls(measure, measure.of(before), measure.of(after))

    @property
    def texts(self) -> tuple[str, str]:
        """Both numbers; "-" stands where there was nothing to count."""
        return self._text(self.before), self._text(self.after)

    def _text(self, value: float) -> str:
        return "-" if math.isnan(value) else format(value, self.measure.spec)

    @property
    def change(self) -> float:
        """The number after less the one before, NaN where either is not known, 0 where both read the same."""
        before, after = self.texts
        return 0.0 if before == after != "-" else self.after - self.before

    @property
    def verdict(self) -> str:
        """ "better" or "worse", empty where nothing changed that can be compared."""
        if math.isnan(self.change) or not self.change:
            return ""
        return "better" if (self.change > 0) == self.measure.higher_is_better else "worse"
