# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""How sure a model is of paint in drives that it never saw: one number puts it right."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.dp.ordered_choice import NEVER, at_least_one, marginals
from lane_dp_ros.core.lanes.evidence_model import CLASSES, EvidenceModel
from lane_dp_ros.core.lanes.neighbours import PAINT
from lane_dp_ros.tools.evidence_fit.examples import CLUTTER, Example
from lane_dp_ros.tools.evidence_fit.fit import Floats, minimiser

LIMIT = 3.0  # log-odds; few frames may ask for more
RIDGE = 0.1  # on the number: what few frames say counts little


def calibration(unseen: Sequence[tuple[Example, EvidenceModel]]) -> Floats:
    """Return what to add to the start of each class (2,), by examples that their models were not fitted to.

    It makes the labels of these examples as probable as may be: a model is less sure of drives that it was
    not fitted to than it could be, or surer. Nothing is added to road edges: labels name few of them, and
    would teach silence, by which kerbs become paint.
    """
    frames = [_Frame.of(example, model) for example, model in unseen if example.evidence]

    def loss(added: Floats) -> tuple[float, Floats]:
        """Return the negative logarithm of the likelihood with these numbers, and its gradient."""
        parts = [each.loss(added) for each in frames]
        ridge = RIDGE / 2 * float(added @ added)
        return ridge + sum(part for part, _ in parts), RIDGE * added + sum(slope for _, slope in parts)

    begin = np.zeros(len(CLASSES))
    bounds = [(-LIMIT, LIMIT) if kind == PAINT else (0.0, 0.0) for kind in range(len(CLASSES))]
    found = minimiser()(loss, begin, jac=True, method="L-BFGS-B", bounds=bounds)
    return np.asarray(found.x)


def calibrated(model: EvidenceModel, added: Floats) -> EvidenceModel:
    """Return a model with numbers (2,) added to the starts of its classes."""
    start = {kind: model.start[kind] + float(more) for kind, more in zip(CLASSES, added, strict=True)}
    return replace(model, start=start)


@dataclass(frozen=True, eq=False)
class _Frame:
    """What the candidates (N,) of a frame are worth by a model, and what its labels allow."""

    worth: Floats
    together: Floats
    possible: NDArray[np.bool_]
    skipping: Floats

    @classmethod
    def of(cls, example: Example, model: EvidenceModel) -> _Frame:
        """Return an example in the eyes of a model; a border without paint can be no paint."""
        worth = np.stack([model.log_odds(kind, example.evidence) for kind in CLASSES], axis=-1)
        worth[np.isnan([each.score for each in example.evidence]), PAINT] = NEVER
        skipping = at_least_one(example.found, len(worth))
        together = example.neighbours.log_odds(model)
        return cls(worth[None], together[None], example.may_be[None, :, :CLUTTER], skipping[None])

    def loss(self, added: Floats) -> tuple[float, Floats]:
        """Return the negative logarithm of the labels' likelihood, and its gradient (2,)."""
        worth = np.maximum(self.worth + added, NEVER)
        free = marginals(worth, self.together)
        told = marginals(np.where(self.possible, worth, NEVER), self.together, self.skipping)
        slope = (free.of_things - told.of_things).sum(axis=(0, 1))
        return float(free.log_total[0] - told.log_total[0]), slope
