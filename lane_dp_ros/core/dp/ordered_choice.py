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
    worth = np.maximum(worth, NEVER)
    joined = np.maximum(together + skipping[:, 1:-1, 1:-1, None, None], NEVER) + worth[:, None, :, None, :]
    first, last = worth + skipping[:, 0, 1:-1, None], skipping[:, 1:-1, -1, None]
    # Everything relative to the best choice that ends with the thing in its class: no exponential overflows.
    best = _best_up_to(first, joined)
    top = np.maximum((best + last).max(axis=(1, 2), initial=NEVER), skipping[:, 0, -1])
    begins, ends = np.exp(first - best), np.exp(best + last - top[:, None, None])
    in_order = np.triu(np.ones((count, count), bool), 1)[..., None, None]
    relative = best[:, :, None, :, None] + joined - best[:, None, :, None, :]
    steps = np.exp(np.where(in_order, relative, NEVER))
    # All chains of steps from one to the other: 1 + S + S^2 + ..., a sum that ends, as they are in order.
    flat = steps.transpose(0, 1, 3, 2, 4).reshape(rows, count * classes, count * classes)
    chains = np.linalg.inv(np.eye(count * classes) - flat)
    to = (begins.reshape(rows, 1, -1) @ chains).reshape(worth.shape)
    after = (chains @ ends.reshape(rows, -1, 1)).reshape(worth.shape)
    total = np.exp(skipping[:, 0, -1] - top) + (to * ends).sum(axis=(1, 2))
    to /= total[:, None, None]
    of_pairs = to[:, :, None, :, None] * steps * after[:, None, :, None, :]
    return Marginals(top + np.log(total), to * after, of_pairs)


def _best_up_to(first: Floats, joined: Floats) -> Floats:
    """Return what the best choice is worth that ends with each thing in each class, (rows, things, classes).

    `first` (rows, things, classes) is what a choice is worth that begins with it, `joined` (rows, things,
    things, classes, classes) what the second of two adds.
    """
    best = first.astype(np.float64)
    for j in range(1, first.shape[1]):
        came = (best[:, :j, :, None] + joined[:, :j, j]).max(axis=(1, 2))
        np.maximum(best[:, j], came, out=best[:, j])
    return best


def at_least_one(sets: Sequence[Sequence[int]], count: int) -> Floats:
    """Return the `skipping` (things + 2, things + 2) of `count` things that have one of each set chosen."""
    skipping = np.zeros((count + 2, count + 2))
    place = np.arange(count + 2)
    for things in sets:
        before, behind = place < min(things) + 1, place > max(things) + 1
        skipping[before[:, None] & behind] = NEVER
    return skipping
