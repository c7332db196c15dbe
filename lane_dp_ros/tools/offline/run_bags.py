# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Detect in one bag or in many, each into files of its own."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.messages.bag import BagReader, BagWriter
from lane_dp_ros.messages.errors import CommandError, one_line
from lane_dp_ros.messages.node_config import NodeConfig
from lane_dp_ros.messages.stereo_bag import find_stereo_topics
from lane_dp_ros.messages.topic_choice import TopicChoice
from lane_dp_ros.tools.offline.detect_bag import Output, detect_bag
from lane_dp_ros.tools.offline.lane_bag import LaneBag, Pictures
from lane_dp_ros.tools.offline.line_table import csv_table, parquet_table
from lane_dp_ros.tools.offline.rerun_file import rerun_file
from lane_dp_ros.tools.offline.summary import Summary
from lane_dp_ros.tools.offline.video import video


@dataclass(frozen=True)
class Outputs:
    """The files to write of a bag: each path may be None. Of several bags they are folders: see `of`."""

    bag: Path | None = None
    video: Path | None = None
    csv: Path | None = None
    parquet: Path | None = None
    rerun: Path | None = None
    pictures: Pictures = "jpeg"
    left_image: bool = False
    force: bool = False

    def of(self, bag: Path) -> Outputs:
        """Return the files of one bag of several, in these folders, under its name."""
        name = bag.stem if bag.suffix in (".mcap", ".db3", ".bag") else bag.name

        def inside(folder: Path | None, ending: str) -> Path | None:
            """Return the bag's file in a folder, None without one."""
            return None if folder is None else folder / f"{name}{ending}"

        return replace(
            self,
            bag=inside(self.bag, ".mcap"),
            video=inside(self.video, ".mp4"),
            csv=inside(self.csv, ".csv"),
            parquet=inside(self.parquet, ".parquet"),
            rerun=inside(self.rerun, ".rrd"),
        )

    @property
    def paths(self) -> list[Path]:
        """Those that are wanted."""
        wanted = (self.bag, self.video, self.csv, self.parquet, self.rerun)
        return [path for path in wanted if path is not None]

    def opened(self, stack: ExitStack, namespace: str, lifetime: float) -> Iterator[Output]:
        """Open what is wanted on `stack`; topics get `namespace`, lanes a `lifetime` [s]."""
        if self.bag is not None:
            writer = stack.enter_context(BagWriter(self.bag, force=self.force))
            yield LaneBag(writer, namespace, lifetime, self.pictures, self.left_image)
        if self.video is not None:
            yield stack.enter_context(video(self.video, self.force))
        if self.csv is not None:
            yield stack.enter_context(csv_table(self.csv, self.force))
        if self.parquet is not None:
            yield stack.enter_context(parquet_table(self.parquet, self.force))
        if self.rerun is not None:
            yield stack.enter_context(rerun_file(self.rerun, self.force))


def run_bag(
    bag: Path,
    outputs: Outputs,
    config: tuple[NodeConfig, DetectorConfig],
    jobs: int = 1,
    choice: TopicChoice | None = None,
) -> Summary:
    """Detect in all pairs of a bag and write what is wanted; nothing of it is there unless all is well.

    `choice` are the topics of its stereo camera. Raises CommandError as `detect_bag`, for an output that
    cannot be written, and for one that is the bag.
    """
    with BagReader(bag, choice) as reader, ExitStack() as stack:
        for path in outputs.paths:
            if path.resolve() in (
                bag.resolve(),
                *bag.resolve().parents,
            ):  # it may be given by a file in its folder
                raise CommandError(f"{path} is the input bag itself: choose another output")
        topics = find_stereo_topics(reader)
        opened = list(outputs.opened(stack, topics.namespace, config[0].lane_lifetime))
        return detect_bag(reader, topics, opened, config, jobs)


@dataclass(frozen=True)
class Ran:
    """How it went with one bag of several: a summary, or why there is none; neither where it was skipped."""

    bag: Path
    summary: Summary | None = None
    failure: str = ""


def run_bags(
    bags: Sequence[Path],
    outputs: Outputs,
    config: tuple[NodeConfig, DetectorConfig],
    jobs: int = 1,
    skip_existing: bool = False,
    choice: TopicChoice | None = None,
) -> Iterator[Ran]:
    """Yield how it went with each bag, one after the other; one that fails does not stop the rest.

    `outputs` are folders, which are made; `choice` are the topics of the stereo cameras. With `skip_existing`
    a bag whose files are all there is left out. Raises CommandError before anything is done: for a file where
    a folder is to be, and for bags whose files would have one name.
    """
    _check_folders(outputs)
    files = {bag: outputs.of(bag) for bag in bags}
    _check_names(files)
    for bag, wanted in files.items():
        if skip_existing and all(os.path.lexists(path) for path in wanted.paths):
            yield Ran(bag)
            continue
        try:
            yield Ran(bag, run_bag(bag, wanted, config, jobs, choice))
        except (CommandError, ValueError, OSError) as error:
            yield Ran(bag, failure=one_line(error))


def _check_folders(outputs: Outputs) -> None:
    for path in outputs.paths:
        if os.path.lexists(path) and not path.is_dir():
            raise CommandError(f"{path} is no folder: of several bags, or with --skip-existing, outputs are")


def _check_names(files: dict[Path, Outputs]) -> None:
    first: dict[Path, Path] = {}
    for bag, wanted in files.items():
        for path in wanted.paths:
            if path in first:
                raise CommandError(
                    f"{first[path]} and {bag} would both be written to {path}: rename one, or run them apart"
                )
            first[path] = bag
