# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The fit of the evidence model: the choice among all candidates of a frame is made as probable as it can be.

What is maximised is the likelihood of the labels under the model that the detector chooses by (see
`ordered_choice`), what the labels leave open summed over; less a ridge on all coefficients.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.dp.ordered_choice import NEVER, Marginals, at_least_one, marginals
from lane_dp_ros.core.lanes.evidence_model import CLASSES, PAIRS, EvidenceModel, Term
from lane_dp_ros.core.lanes.neighbours import PAINT, relations
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.tools.evidence_fit.curves import GAPS, OVERLAPS, SIGNS, Curve, curve
from lane_dp_ros.tools.evidence_fit.examples import CLUTTER, Example, evidence_values

Floats = NDArray[Any]

RIDGE = 1.0  # on each coefficient
PAIR_RIDGE, PAIR_SMOOTHNESS = 0.3, 1.0  # on the terms of pairs, and on their bends
# A border makes no paint: roads without any have borders, too.
NEVER_SPEAKS_FOR = ("paint_before_edge", "paint_behind_edge", "paint_across_edge")
MAX_ITERATIONS = 200
TOLERANCE = 1e-5  # of the loss; steps that better it by less end the search
GROUP = 100  # examples that are worked out at once


@dataclass(frozen=True, eq=False)
class _Class:
    """The curves of a class, and where the coefficients of each stand: the start first, then the curves."""

    curves: Mapping[str, Curve]
    unknown: tuple[str, ...]
    """Measurements that some candidates lack: these have log-odds of their own."""

    @property
    def size(self) -> int:
        """The number of coefficients."""
        return 2 + sum(len(each.signs) for each in self.curves.values()) + len(self.unknown)

    def design(self, values: Mapping[str, Floats], rendered: bool) -> Floats:
        """Return what each coefficient counts in each candidate, (N, size).

        The last one is for `rendered` scenes: how often they show such lines says nothing of real roads.
        """
        count = len(next(iter(values.values())))
        parts = [np.ones((count, 1)), *(each.segments(values[name]) for name, each in self.curves.items())]
        missing = [np.isnan(values[name])[:, None].astype(float) for name in self.unknown]
        return np.hstack([*parts, *missing, np.full((count, 1), float(rendered))])

    def bounds(self) -> list[tuple[float | None, float | None]]:
        """Return the bounds of each coefficient by the curves' signs."""
        limits: dict[int, tuple[float | None, float | None]] = {
            1: (0.0, None),
            -1: (None, 0.0),
        }
        of_curves = [limits[int(sign)] for each in self.curves.values() for sign in each.signs]
        return [(None, None), *of_curves, *[(None, None)] * (len(self.unknown) + 1)]

    def terms(self, coefficients: Floats) -> tuple[float, dict[str, Term]]:
        """Return the start and the terms that coefficients make."""
        at, terms = 1, {}
        missing = dict(zip(self.unknown, coefficients[-1 - len(self.unknown) : -1], strict=True))
        for name, each in self.curves.items():
            steps = coefficients[at : at + len(each.signs)]
            terms[name] = each.term(steps, float(missing.get(name, 0.0)))
            at += len(each.signs)
        return float(coefficients[0]), terms


@dataclass(frozen=True, eq=False)
class _Group:
    """Examples of similar size as arrays, filled up with candidates that are nothing."""

    design: tuple[Floats, ...]
    """(examples, things, coefficients) of each class."""
    can_be: NDArray[np.bool_]
    """(examples, things, classes): what the detector could take each for; no border for paint."""
    possible: NDArray[np.bool_]
    """(examples, things, classes): what each may be by its labels."""
    skipping: Floats
    """(examples, things + 2, things + 2): one of those that match a label is chosen."""
    pairs: Floats
    """(examples, things, things, knots): what each knot of the gap counts."""
    overlap: Floats
    one_paint: NDArray[np.bool_]
    """(examples, things, things): which two are not both lane lines."""
    relations: Mapping[str, NDArray[np.bool_]]
    weight: Floats


class EvidenceFit:
    """Fits the model to examples with weights (N,).

    Raises CommandError where there is nothing to learn from.
    """

    def __init__(self, examples: Sequence[Example], weights: Sequence[float]) -> None:
        if not any(len(each.evidence) for each in examples):
            raise CommandError("no candidates in any frame: nothing to learn from")
        self.examples = examples
        self._classes = tuple(_curves_of(kind, examples) for kind in CLASSES)
        order = sorted(range(len(examples)), key=lambda i: len(examples[i].evidence))
        order = [i for i in order if examples[i].evidence]
        parts = [order[i : i + GROUP] for i in range(0, len(order), GROUP)]
        self._groups = [
            self._group([examples[i] for i in part], [weights[i] for i in part]) for part in parts
        ]
        self._knots = [len(OVERLAPS) if name == "paint_on_paint" else len(GAPS) for name in PAIRS]

    def fit(self, start: Floats | None = None) -> Floats:
        """Return the coefficients (K,) of the best model; the search begins at `start`."""
        minimize = minimiser()
        sizes = [each.size for each in self._classes]
        begin = np.zeros(sum(sizes) + sum(self._knots)) if start is None else start
        bounds = [bound for each in self._classes for bound in each.bounds()]
        for name, knots in zip(PAIRS, self._knots, strict=True):
            bounds += [(None, 0.0 if name in NEVER_SPEAKS_FOR else None)] * knots
        found = minimize(
            self._loss,
            begin,
            jac=True,
            method="L-BFGS-B",
            bounds=bounds,
            options={"maxiter": MAX_ITERATIONS, "ftol": TOLERANCE},
        )
        return np.asarray(found.x)

    def model(self, coefficients: Floats, source: Mapping[str, Any]) -> EvidenceModel:
        """Return the model that coefficients make."""
        of_classes, of_pairs = self._split(coefficients)
        made = [each.terms(own) for each, own in zip(self._classes, of_classes, strict=True)]
        pairs = {
            name: Term(np.array(OVERLAPS if name == "paint_on_paint" else GAPS), own)
            for name, own in zip(PAIRS, of_pairs, strict=True)
        }
        return EvidenceModel(
            {kind: start for kind, (start, _) in zip(CLASSES, made, strict=True)},
            {kind: terms for kind, (_, terms) in zip(CLASSES, made, strict=True)},
            pairs,
            source,
        )

    def _split(self, coefficients: Floats) -> tuple[list[Floats], list[Floats]]:
        sizes = [each.size for each in self._classes] + self._knots
        parts = np.split(coefficients, np.cumsum(sizes)[:-1])
        return parts[: len(CLASSES)], parts[len(CLASSES) :]

    def _group(self, examples: Sequence[Example], weights: Sequence[float]) -> _Group:
        count = max(len(each.evidence) for each in examples)
        sizes = [each.size for each in self._classes]
        design = tuple(np.zeros((len(examples), count, size)) for size in sizes)
        may_be = np.zeros((len(examples), count, 3), bool)
        may_be[:, :, CLUTTER] = True
        can_be = np.zeros((len(examples), count, CLUTTER), bool)
        pairs = np.zeros((len(examples), count, count, len(GAPS)))
        overlap = np.zeros((len(examples), count, count, len(OVERLAPS)))
        left = np.zeros((len(examples), count), bool)
        one_paint = np.zeros((len(examples), count, count), bool)
        skipping = np.zeros((len(examples), count + 2, count + 2))
        for i, each in enumerate(examples):
            n = len(each.evidence)
            for k, kind in enumerate(self._classes):
                values = {name: evidence_values([each], name) for name in kind.curves}
                design[k][i, :n] = kind.design(values, each.rendered)
            may_be[i, :n] = each.may_be
            can_be[i, :n] = True
            can_be[i, :n, PAINT] = np.isfinite(evidence_values([each], "score"))
            pairs[i, :n, :n] = hats(each.neighbours.gap, GAPS)
            overlap[i, :n, :n] = hats(each.neighbours.overlap, OVERLAPS)
            left[i, :n] = each.neighbours.left
            one_paint[i, :n, :n] = each.neighbours.one_paint
            skipping[i] = at_least_one(each.found, count)
        where = {name: np.stack([relations(row)[name] for row in left]) for name in PAIRS}
        possible = may_be[..., :CLUTTER]
        return _Group(design, can_be, possible, skipping, pairs, overlap, one_paint, where, np.array(weights))

    def _loss(self, coefficients: Floats) -> tuple[float, Floats]:
        """Return the negative logarithm of the likelihood, with the ridge, and its gradient."""
        of_classes, of_pairs = self._split(coefficients)
        loss, gradient = 0.0, np.zeros_like(coefficients)
        for group in self._groups:
            worth = np.stack([A @ b for A, b in zip(group.design, of_classes, strict=True)], axis=-1)
            worth = np.where(group.can_be, worth, NEVER)
            together = sum(
                group.relations[name] * (_basis(group, name) @ own)[..., None, None]
                for name, own in zip(PAIRS, of_pairs, strict=True)
            )
            together[group.one_paint, PAINT, PAINT] = NEVER
            free = marginals(worth, together)
            told = marginals(np.where(group.possible, worth, NEVER), together, group.skipping)
            loss += float(group.weight @ (free.log_total - told.log_total))
            gradient += self._gradient(group, free, told)
        ridge, slope = self._ridge(of_classes, of_pairs)
        return loss + ridge, gradient + slope

    def _gradient(self, group: _Group, free: Marginals, told: Marginals) -> Floats:
        excess = (free.of_things - told.of_things) * group.weight[:, None, None]
        parts = [np.einsum("eic,ei->c", A, excess[..., k]) for k, A in enumerate(group.design)]
        pairs = (free.of_pairs - told.of_pairs) * group.weight[:, None, None, None, None]
        for name in PAIRS:
            of_term = (pairs * group.relations[name]).sum(axis=(-1, -2))
            parts.append(np.einsum("eijk,eij->k", _basis(group, name), of_term))
        return np.concatenate(parts)

    def _ridge(self, of_classes: Sequence[Floats], of_pairs: Sequence[Floats]) -> tuple[float, Floats]:
        total, slopes = 0.0, []
        for own in of_classes:
            held = own.copy()
            held[0] = 0
            total += RIDGE / 2 * float(held @ held)
            slopes.append(RIDGE * held)
        for own in of_pairs:
            bends = np.diff(own, 2)
            total += PAIR_RIDGE / 2 * float(own @ own) + PAIR_SMOOTHNESS / 2 * float(bends @ bends)
            slope = PAIR_RIDGE * own
            for k, weight in enumerate((1, -2, 1)):
                slope[k : k + len(bends)] += PAIR_SMOOTHNESS * weight * bends
            slopes.append(slope)
        return total, np.concatenate(slopes)


def minimiser() -> Callable[..., Any]:
    """Return scipy's `minimize`. Raises ModuleNotFoundError where scipy is not installed."""
    from scipy.optimize import minimize

    return minimize  # type: ignore[no-any-return]


def hats(values: Floats, knots: Sequence[float]) -> Floats:
    """Return how much each knot counts in a straight line between knots at values (...,), (..., knots)."""
    at = np.asarray(knots)
    values = np.clip(values, at[0], at[-1])
    i = np.clip(np.searchsorted(at, values, side="right") - 1, 0, len(at) - 2)
    share = (values - at[i]) / (at[i + 1] - at[i])
    counted = np.zeros((*values.shape, len(at)))
    np.put_along_axis(counted, i[..., None], (1 - share)[..., None], axis=-1)
    np.put_along_axis(counted, i[..., None] + 1, share[..., None], axis=-1)
    return counted


def _basis(group: _Group, name: str) -> Floats:
    return group.overlap if name == "paint_on_paint" else group.pairs


def _curves_of(kind: str, examples: Sequence[Example]) -> _Class:
    values = {name: evidence_values(examples, name) for name in SIGNS[kind]}
    curves = {name: curve(sign, values[name]) for name, sign in SIGNS[kind].items()}
    can_be = np.ones(len(values["start"]), bool) if kind == "edge" else np.isfinite(values["score"])
    return _Class(curves, tuple(name for name, each in values.items() if np.isnan(each[can_be]).any()))
