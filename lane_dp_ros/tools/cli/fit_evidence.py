# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""lane_dp fit-evidence: the model that judges lines by their evidence, fitted to labelled frames."""

from __future__ import annotations

import argparse
import tempfile
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.tools.cli.arguments import add_jobs, add_topics, seed, topic_choice

if TYPE_CHECKING:
    from lane_dp_ros.tools.evidence_fit.collecting import FrameSource, KnownPair

RENDERED = 600  # scenes, unless another number is asked for
EPILOG = """\
Prints how the detector fares with the model on all frames, and with others on the drives and the categories
of scenes that they were not fitted to. The parameter lane_selection.evidence_model selects the file. scipy
must be installed."""


def add_command(commands: argparse._SubParsersAction) -> None:
    """Add `fit-evidence` to the commands of lane_dp."""
    text = "fit the model by which lines are judged to labelled frames and rendered scenes"
    command = commands.add_parser("fit-evidence", help=text, description=text, epilog=EPILOG)
    labelled = "bag or folder with labels, as lane_dp review exports them, in it or beside it"
    command.add_argument("data", type=Path, nargs="+", metavar="DATA", help=labelled)
    bare = "bag, or folder sequences/NN of KITTI's odometry, that shows no paint at all"
    command.add_argument("--unpainted", type=Path, nargs="+", default=[], metavar="BAG", help=bare)
    rendered = f"number of scenes to render, to learn from as well; default: {RENDERED}"
    command.add_argument("--scenes", type=seed, default=RENDERED, metavar="N", help=rendered)
    command.add_argument("--seed", type=seed, default=0, metavar="N", help="of the scenes; default: 0")
    command.add_argument("-o", "--output", type=Path, required=True, metavar="FILE", help="the model, JSON")
    command.add_argument("--force", action="store_true", help="replace FILE")
    add_jobs(command)
    add_topics(command)
    command.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Collect, fit, print the figures, and write the model."""
    from lane_dp_ros.tools.evidence_fit.evidence_fit import fitted_evidence, write_model
    from lane_dp_ros.tools.evidence_fit.fit import minimiser

    minimiser()
    _check_output(arguments.output, arguments.force)
    with tempfile.TemporaryDirectory() as folder:
        sources = _sources(arguments, Path(folder))
        fitted = fitted_evidence(sources, arguments.jobs)
    fitted = replace(fitted, data={**fitted.data, "seed": arguments.seed})
    print(fitted.tables)
    write_model(fitted, arguments.output)
    print(f"\n{arguments.output}: fitted to {len(sources)} frames")


def training_frame(seed: int, number: int) -> KnownPair:
    """Return a rendered scene in grey."""
    from lane_dp_ros.core.types import StereoFrame
    from lane_dp_ros.scenes.training import training_pair
    from lane_dp_ros.tools.evidence_fit.collecting import KnownPair

    pair = training_pair(seed, number)
    frame = StereoFrame(pair.left, pair.right).grey()
    return KnownPair(pair.truth.name, frame, pair.truth.camera, pair.truth)


def _sources(arguments: argparse.Namespace, folder: Path) -> list[FrameSource]:
    """Return all frames to learn from; rendered ones are kept in a folder meanwhile."""
    from lane_dp_ros.tools.evidence_fit.collecting import FrameSource, Kept
    from lane_dp_ros.tools.evidence_fit.frames import labelled_frames, unpainted_frames
    from lane_dp_ros.tools.evidence_fit.left_out import SCENES

    topics = topic_choice(arguments)
    labelled = [source for data in arguments.data for source in labelled_frames(data, topics)]
    drives = {source.drive for source in labelled}
    bare = [source for path in arguments.unpainted for source in unpainted_frames(path, drives, topics)]
    scenes = [
        FrameSource(SCENES, Kept(partial(training_frame, arguments.seed, i), folder / f"{i}.pickle"))
        for i in range(arguments.scenes)
    ]
    return [*labelled, *bare, *scenes]


def _check_output(path: Path, force: bool) -> None:
    """Raise CommandError, before all the work, for a file that is there or cannot be written."""
    if path.exists() and not force:
        raise CommandError(f"{path} exists already: choose another name, or add --force to replace it")
    if not path.absolute().parent.is_dir():
        raise CommandError(f"{path.absolute().parent}: no such folder to write {path.name} into")
