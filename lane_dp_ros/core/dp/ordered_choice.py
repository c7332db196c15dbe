# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Choice among things in a row, each of which has one of several classes or none.

What a choice is worth is the sum of what each chosen thing is worth in its class, and of what each two that
follow one another in the choice are worth together. The row-by-row dynamic programme finds the best choice;
with sums of exponentials in place of maxima it tells how probable each class of each thing is, where worth is
log-odds (a semi-Markov conditional random field; Sarawagi, Cohen, NIPS 2004).

Arrays of many rows at once have the shape (rows, things, ...); things that a row lacks are worth -inf.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[Any]

NONE = -1  # the class of a thing that is not chosen
NEVER = -1e9  # worth of what is not allowed; sums and differences of it stay finite


@dataclass(frozen=True, eq=False)
class Marginals:
    """How probable the classes of each thing are.

    `log_total` (rows,) is the logarithm of the sum of exp(worth) over all choices, `of_things`
    (rows, things, classes), `of_pairs` (rows, things, things, classes, classes) those of two that follow one
    another in the choice.
    """

    log_total: Floats
    of_things: Floats
    of_pairs: Floats


def best_choice(worth: Floats, together: Floats) -> list[int]:
    """Return the class of each thing, or `NONE`, in the choice of the highest worth.

    `worth` (things, classes); `together` (things, things, classes, classes) of the first and the second of
    two that follow one another.
    """
    count, classes = worth.shape
    best = worth.astype(np.float64)
    before = np.full((count, classes), NONE)
    for j in range(1, count):
        joined = (best[:j, :, None] + together[:j, j]).reshape(j * classes, classes)
        came = joined.argmax(axis=0)
        gain = joined[came, range(classes)]
        before[j] = np.where(gain > 0, came, NONE)
        best[j] += np.maximum(gain, 0)
    chosen = [NONE] * count
    at = int(best.argmax()) if count else NONE
    if count and best.flat[at] <= 0:
        return chosen
    while at != NONE:
        thing, kind = divmod(at, classes)
        chosen[thing] = kind
        at = int(before[thing, kind])
    return chosen


def marginals(worth: Floats, together: Floats, skipping: Floats | None = None) -> Marginals:
    """Return how probable the classes are, see `Marginals`.

    `worth` (rows, things, classes) and `together` (rows, things, things, classes, classes) as in
    `best_choice`. `skipping` (rows, things + 2, things + 2), 0 where not given, is what it is worth that none
    is chosen of all things between two; the first and the last of its things are those before and behind all.
    """
    rows, count, classes = worth.shape
    if skipping is None:
        skipping = np.zeros((rows, count + 2, count + 2))
    joined = np.maximum(together + skipping[:, 1:-1, 1:-1, None, None], NEVER)
    to, after = np.empty_like(worth, np.float64), np.empty_like(worth, np.float64)
    for j in range(count):
        came = (to[:, :j, :, None] + joined[:, :j, j]).reshape(rows, -1, classes)
        to[:, j] = worth[:, j] + _log_sum(came, skipping[:, 0, j + 1, None])
    for i in reversed(range(count)):
        goes = joined[:, i, i + 1 :] + (worth + after)[:, i + 1 :, None]
        goes = goes.transpose(0, 1, 3, 2).reshape(rows, -1, classes)
        after[:, i] = _log_sum(goes, skipping[:, i + 1, -1, None])
    ends = to + skipping[:, 1:-1, -1, None]
    log_total = _log_sum(ends.reshape(rows, -1, 1), skipping[:, 0, -1, None])[:, 0]
    total = log_total[:, None, None]
    of_things = np.exp(to + after - total)
    pairs = to[:, :, None, :, None] + joined + (worth + after)[:, None, :, None, :]
    in_order = np.triu(np.ones((count, count), bool), 1)[..., None, None]
    of_pairs = np.exp(np.where(in_order, pairs - total[..., None, None], NEVER))
    return Marginals(log_total, of_things, of_pairs)


def at_least_one(sets: Sequence[Sequence[int]], count: int) -> Floats:
    """Return the `skipping` (things + 2, things + 2) of `count` things that have one of each set chosen."""
    skipping = np.zeros((count + 2, count + 2))
    place = np.arange(count + 2)
    for things in sets:
        before, behind = place < min(things) + 1, place > max(things) + 1
        skipping[before[:, None] & behind] = NEVER
    return skipping


def _log_sum(terms: Floats, one_more: Floats) -> Floats:
    """Return log(sum(exp)) over axis 1 of `terms` (rows, N, classes) and of `one_more` (rows, 1)."""
    top = np.maximum(terms.max(axis=1, initial=NEVER), one_more)
    total = np.exp(terms - top[:, None]).sum(axis=1) + np.exp(one_more - top)
    return np.asarray(top + np.log(total))
