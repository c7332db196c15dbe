# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Examples for the fit: the candidates of labelled frames, and what each of them is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.detector import LaneDetection
from lane_dp_ros.core.lanes.candidate import LaneEvidence
from lane_dp_ros.core.lanes.lifting import left_to_right, to_lanes
from lane_dp_ros.core.lanes.neighbours import EDGE, PAINT, Neighbours
from lane_dp_ros.tools.evaluation.annotations import Label, LabelledFrame
from lane_dp_ros.tools.evaluation.assignment import ProjectedLine, assign, distance, nearest, project
from lane_dp_ros.tools.evaluation.matching import DUPLICATE_DISTANCE

Floats = NDArray[Any]

CLUTTER = 2  # beside PAINT and EDGE: what a candidate may be


@dataclass(frozen=True, eq=False)
class Example:
    """A frame's candidates from left to right, how they lie to one another, and what each may be.

    `may_be` (N, 3) tells for each of PAINT, EDGE and CLUTTER whether the labels allow it; all of a candidate
    that nobody can judge. Of each of the `found`, the candidates that match one label, one is the line.
    `drive` and `category` tell where the frame is from.
    """

    name: str
    drive: str
    category: str
    evidence: tuple[LaneEvidence, ...]
    neighbours: Neighbours
    may_be: NDArray[np.bool_]
    found: tuple[tuple[int, ...], ...]

    @property
    def rendered(self) -> bool:
        """Whether it is a frame of a rendered scene."""
        return bool(self.category)


def example(
    name: str, drive: str, detection: LaneDetection, truth: LabelledFrame | None, edges_known: bool
) -> Example:
    """Return a frame's example; without `truth` it has no paint. `edges_known`: every border has a label."""
    candidates = left_to_right(detection.candidates)
    told = _Told(len(candidates))
    borders = np.array([each.variant == "border" for each in candidates], bool)
    if truth is None:
        told.may_be[:, PAINT] = False
    elif detection.birds_eye is not None:
        lines = project(truth, to_lanes(candidates, detection.birds_eye), truth.camera)
        told.by_paint(truth, lines, borders, edges_known)
        told.by_borders(truth, lines)
    told.may_be[borders, PAINT] = False
    return Example(
        name,
        drive,
        "" if truth is None else truth.category,
        tuple(each.evidence for each in candidates),
        Neighbours.of([each.line for each in candidates]),
        told.may_be,
        tuple(told.found),
    )


class _Told:
    """What the labels of a frame tell of its candidates, see `Example`."""

    def __init__(self, count: int) -> None:
        self.may_be = np.ones((count, 3), bool)
        self.found: list[tuple[int, ...]] = []

    def by_paint(
        self,
        truth: LabelledFrame,
        lines: Sequence[ProjectedLine],
        borders: NDArray[np.bool_],
        edges_known: bool,
    ) -> None:
        """Take in the labels of paint; what lies on none of them is none."""
        paint = [label for label in truth.labels if label.painted]
        matching = {label.id: _matching(label, lines, truth, ~borders) for label in paint}
        marked = [label for label in paint if label.sure and matching[label.id]]
        doubtful = [label for label in paint if label not in marked]
        for i, line in enumerate(lines):
            if line.far_aside:
                continue
            if nearest(marked, line) <= DUPLICATE_DISTANCE:
                self.may_be[i] = (False, borders[i], True)
            elif nearest(doubtful, line) > DUPLICATE_DISTANCE:
                self.may_be[i] = (False, not edges_known, True)
        for label in marked:
            self._one_of(matching[label.id], PAINT)

    def by_borders(self, truth: LabelledFrame, lines: Sequence[ProjectedLine]) -> None:
        """Take in the labels of borders; what lies beside one is no paint."""
        for label in truth.labels:
            if label.painted:
                continue
            near = np.array([distance(label, line) <= DUPLICATE_DISTANCE for line in lines], bool)
            free = near & ~np.isin(np.arange(len(lines)), [i for found in self.found for i in found])
            self.may_be[free] = (False, True, True)
            if label.sure:
                self._one_of(_matching(label, lines, truth, free), EDGE)

    def _one_of(self, candidates: Sequence[int], kind: int) -> None:
        if candidates:
            self.found.append(tuple(candidates))
            self.may_be[list(candidates)] = [each in (kind, CLUTTER) for each in (PAINT, EDGE, CLUTTER)]


def _matching(
    label: Label, lines: Sequence[ProjectedLine], truth: LabelledFrame, among: NDArray[np.bool_]
) -> list[int]:
    """Return which of the lines match a label, each as if it were the only one."""
    return [i for i in np.flatnonzero(among).tolist() if assign([label], [lines[i]], truth.camera, ())]


def evidence_values(examples: Sequence[Example], name: str) -> Floats:
    """Return a measurement of all candidates of all examples, (N,)."""
    return np.array([getattr(each, name) for example in examples for each in example.evidence], np.float64)
