# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The whole fit: collect, fit, leave out, calibrate, judge, write."""

from __future__ import annotations

import os
import tempfile
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime, timezone
from pathlib import Path
from typing import Any, NamedTuple

from lane_dp_ros.core.lanes.evidence_model import EvidenceModel
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.tools.evaluation.scores import FrameScore
from lane_dp_ros.tools.evidence_fit.calibration import calibrated, calibration
from lane_dp_ros.tools.evidence_fit.collecting import Collected, FrameSource, collect
from lane_dp_ros.tools.evidence_fit.left_out import SCENES, SEPARATOR, Fold, fit_all, folds, judged
from lane_dp_ros.tools.evidence_fit.model_file import model_text
from lane_dp_ros.tools.evidence_fit.report import Figures, as_json, table

ON_ALL, DRIVE_LEFT_OUT, CATEGORY_LEFT_OUT = "fitted on all", "drive left out", "category left out"


class _Judged(NamedTuple):
    """A frame's drive or category, and its verdicts by a model that saw it and by one that did not."""

    name: str
    seen: FrameScore
    unseen: FrameScore


@dataclass(frozen=True, eq=False)
class FittedEvidence:
    """A fitted model, calibrated; what it was fitted to; the figures by what was left out, then by name."""

    model: EvidenceModel
    data: Mapping[str, Any]
    figures: Mapping[str, Mapping[str, Figures]]

    @property
    def text(self) -> str:
        """The file of the model."""
        figures = {name: as_json(each) for name, each in self.figures.items()}
        today = datetime.now(timezone.utc).date().isoformat()
        return model_text(self.model, {"date": today, "data": self.data, "figures": figures})

    @property
    def tables(self) -> str:
        """The figures as people read them."""
        return "\n\n".join(table(name, each) for name, each in self.figures.items())


def fitted_evidence(sources: Sequence[FrameSource], jobs: int) -> FittedEvidence:
    """Return the model fitted to frames, and its figures; those of `SCENES` were rendered for it.

    Raises CommandError where there is nothing to learn from, or nothing that could be left out.
    """
    collected = collect(sources, jobs)
    of_drives, of_categories = folds(collected)
    parts = [*of_drives, *of_categories]
    model, others = fit_all(collected, parts, jobs)
    unseen = [
        (collected[i].examples[0], other)
        for fold, other in zip(of_drives, others, strict=False)
        for i in fold.judged
    ]
    added = calibration(unseen)
    model, others = calibrated(model, added), [calibrated(other, added) for other in others]
    scores = _scores(collected, parts, model, others, jobs)
    data = {**_counts(collected), "calibration": [round(float(each), 3) for each in added]}
    return FittedEvidence(model, data, _figures(collected, scores))


def write_model(fitted: FittedEvidence, path: Path) -> None:
    """Write the file of a model; it appears complete or not at all."""
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        part.write_text(fitted.text, encoding="utf-8")
        part.replace(path)
    except OSError as error:
        raise CommandError(f"cannot write {path}: {error.strerror}") from None
    finally:
        part.unlink(missing_ok=True)


def _scores(
    collected: Sequence[Collected],
    parts: Sequence[Fold],
    model: EvidenceModel,
    others: Sequence[EvidenceModel],
    jobs: int,
) -> list[tuple[FrameScore, ...]]:
    """Return the verdicts on each frame by the model of all, and by the one that did not see it."""
    with tempfile.TemporaryDirectory() as folder:
        paths = [Path(folder) / f"{number}.json" for number in range(1 + len(others))]
        for path, each in zip(paths, [model, *others], strict=True):
            path.write_text(model_text(each, {}))
        model_of = {i: paths[1 + number] for number, fold in enumerate(parts) for i in fold.judged}
        tasks = [(each.source, (paths[0], model_of[i])) for i, each in enumerate(collected)]
        return judged(tasks, jobs)


def _figures(
    collected: Sequence[Collected], scores: Sequence[tuple[FrameScore, ...]]
) -> dict[str, dict[str, Figures]]:
    """Return the figures: all frames of the data and all scenes, then by drive, then by category."""
    real: list[_Judged] = []
    scenes: list[_Judged] = []
    for each, (seen, unseen) in zip(collected, scores, strict=True):
        if each.drive == SCENES:
            scenes.append(_Judged(each.category.split(SEPARATOR)[0], seen, unseen))
        else:
            real.append(_Judged(each.drive, seen, unseen))
    figures = {"total": _totals("data", DRIVE_LEFT_OUT, real), DRIVE_LEFT_OUT: _by_name(real)}
    if scenes:
        figures["total"] |= _totals("scenes", CATEGORY_LEFT_OUT, scenes)
        figures[CATEGORY_LEFT_OUT] = _by_name(scenes)
    return figures


def _totals(what: str, left_out: str, scores: Sequence[_Judged]) -> dict[str, Figures]:
    return {
        f"{what}, {ON_ALL}": Figures.of([each.seen for each in scores]),
        f"{what}, {left_out}": Figures.of([each.unseen for each in scores]),
    }


def _by_name(scores: Sequence[_Judged]) -> dict[str, Figures]:
    names = sorted({each.name for each in scores})
    return {name: Figures.of([each.unseen for each in scores if each.name == name]) for name in names}


def _counts(collected: Sequence[Collected]) -> dict[str, Any]:
    """Return the number of frames of each drive of the data, and of the rendered scenes."""
    drives = Counter(each.drive for each in collected)
    scenes = drives.pop(SCENES, 0)
    return {"frames": dict(sorted(drives.items())), "scenes": scenes}
