# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Models fitted without some drives or kinds of scenes, and how the detector fares there with them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.detector import LaneDetector
from lane_dp_ros.core.lanes.evidence_model import EvidenceModel
from lane_dp_ros.core.parameter import replaced
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.tools.evaluation.matching import judge, judge_unpainted
from lane_dp_ros.tools.evaluation.scores import FrameScore
from lane_dp_ros.tools.evidence_fit.collecting import Collected, FrameSource, KnownPair
from lane_dp_ros.tools.evidence_fit.fit import EvidenceFit
from lane_dp_ros.tools.parallel import parallel_map
from lane_dp_ros.tools.progress import progress

SCENES = "rendered scenes"  # the drive of those that are rendered for the fit
SEPARATOR = "+"  # between the names of what a scene is mixed of
FOLDS = 8  # of the drives, and of the categories: a fit takes a minute


@dataclass(frozen=True)
class Fold:
    """What one model does without: the frames, by their numbers, that it is not fitted to, and judged on."""

    unseen: frozenset[int]
    judged: tuple[int, ...]


def folds(collected: Sequence[Collected]) -> tuple[list[Fold], list[Fold]]:
    """Return those that leave out drives, and those that leave out categories of rendered scenes.

    Each drive and each category is left out of one of at most `FOLDS` models. A scene is judged by the model
    that did without the first thing it is mixed of, and without every scene that has that in it.
    Raises CommandError where nothing is left to fit to.
    """
    real = [i for i, each in enumerate(collected) if each.drive != SCENES]
    scenes = [i for i, each in enumerate(collected) if each.drive == SCENES]
    of_drives = _drive_folds(collected, real)
    if not scenes and len(of_drives) == 1:
        drive = collected[real[0]].drive
        raise CommandError(f"all frames are of the drive {drive!r}: label another one, too, or add --scenes")
    return of_drives, _category_folds(collected, scenes)


def fit_all(
    collected: Sequence[Collected], parts: Sequence[Fold], jobs: int
) -> tuple[EvidenceModel, list[EvidenceModel]]:
    """Return the model fitted to all frames, and for each fold the one fitted to all that it may see."""
    whole = Fold(frozenset(), ())
    with parallel_map(partial(_fitted, collected), [whole, *parts], jobs) as found:
        first, *others = (model for _, model in progress(found, 1 + len(parts), "fit"))
    return first, others


def judged(tasks: Sequence[tuple[FrameSource, tuple[Path, ...]]], jobs: int) -> list[tuple[FrameScore, ...]]:
    """Return the verdicts on each frame, detected by itself with the model of each file in turn."""
    with parallel_map(_verdicts, tasks, jobs) as found:
        return [scores for _, scores in progress(found, len(tasks), "frame")]


def _drive_folds(collected: Sequence[Collected], real: Sequence[int]) -> list[Fold]:
    sizes = Counter(collected[i].drive for i in real)
    parts = [[i for i in real if collected[i].drive in names] for names in _groups(sizes)]
    return [Fold(frozenset(part), tuple(part)) for part in parts]


def _category_folds(collected: Sequence[Collected], scenes: Sequence[int]) -> list[Fold]:
    names = {i: collected[i].category.split(SEPARATOR) for i in scenes}
    made = []
    for group in _groups(Counter(each[0] for each in names.values())):
        unseen = frozenset(i for i in scenes if group.intersection(names[i]))
        made.append(Fold(unseen, tuple(i for i in scenes if names[i][0] in group)))
    return made


def _groups(sizes: Mapping[str, int]) -> list[set[str]]:
    """Return names in at most `FOLDS` groups of similar size."""
    groups: list[set[str]] = [set() for _ in range(min(FOLDS, len(sizes)))]
    for name in sorted(sizes, key=lambda name: (-sizes[name], name)):
        min(groups, key=lambda group: sum(sizes[each] for each in group)).add(name)
    return groups


def _fitted(collected: Sequence[Collected], fold: Fold) -> EvidenceModel:
    seen = [each for i, each in enumerate(collected) if i not in fold.unseen]
    fit = EvidenceFit(
        [example for each in seen for example in each.examples],
        [weight for each in seen for weight in each.weights],
    )
    return fit.model(fit.fit(), {})


def _verdicts(task: tuple[FrameSource, tuple[Path, ...]]) -> tuple[FrameScore, ...]:
    source, models = task
    pair = source.load()
    return tuple(_verdict(pair, source.drive, path) for path in models)


def _verdict(pair: KnownPair, drive: str, model: Path) -> FrameScore:
    config = replaced(DetectorConfig(), {"lane_selection.evidence_model": str(model)})
    found = LaneDetector(pair.camera, config).detect(pair.frame)
    if pair.truth is None:
        return judge_unpainted(pair.name, found.lanes, drive, 0)
    return judge(pair.truth, found.lanes, pair.truth.camera, road_edges=found.road_edges)
