# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Short drives through scenes of named categories: as a bag with its truth, or as a sheet of pictures."""

from __future__ import annotations

import zlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from difflib import get_close_matches
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.messages.bag import BagWriter
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.messages.stereo_bag import StereoBagWriter, StereoImages
from lane_dp_ros.scenes.categories import CATEGORIES
from lane_dp_ros.scenes.drive_options import BAG, FRAMES, RATE, TRUTH
from lane_dp_ros.scenes.scene import CAMERA, FIRST_STAMP_NS, Scene, ScenePair, render_frame
from lane_dp_ros.tools.evaluation.annotations import LabelledFrame
from lane_dp_ros.tools.evaluation.truth_file import save_truth
from lane_dp_ros.tools.parallel import parallel_map
from lane_dp_ros.tools.progress import progress

PAUSE_NS = 3_000_000_000  # between two drives: the detector forgets the one before
SHEET_FRAME = 2  # of each drive
SHEET_WIDTH, SHEET_COLUMNS = 720, 2  # [px] of a thumbnail

Bytes = NDArray[np.uint8]


@dataclass(frozen=True)
class Drive:
    """A drive through one category's scene: how many frames, how many a second, from which seed."""

    category: str
    frames: int = FRAMES
    rate: float = RATE
    seed: int = 0
    first_stamp_ns: int = FIRST_STAMP_NS

    @property
    def world_seed(self) -> int:
        """The seed of everything in this world; another category's is another."""
        return (self.seed << 32) + zlib.crc32(self.category.encode())

    def scene(self) -> Scene:
        """Return the scene that the seed makes of the category."""
        scene = CATEGORIES[self.category](np.random.default_rng(self.world_seed))
        return replace(scene, motion=replace(scene.motion, rate=self.rate))

    def render(self, index: int) -> ScenePair:
        """Render one frame."""
        return render_frame(self.scene(), index, self.world_seed, self.first_stamp_ns, self.category)


def drives(
    categories: Sequence[str], frames: int = FRAMES, rate: float = RATE, seed: int = 0
) -> tuple[Drive, ...]:
    """Return one drive through each category, one after the other in time.

    Raises CommandError for a category that there is none of.
    """
    for category in categories:
        if category not in CATEGORIES:
            near = get_close_matches(category, CATEGORIES, n=1)
            hint = f"did you mean {near[0]}?" if near else "lane_dp scenes --list names them all"
            raise CommandError(f"no scenes of category {category!r}: {hint}")
    length_ns = round(frames * 1e9 / rate) + PAUSE_NS
    return tuple(
        Drive(category, frames, rate, seed, FIRST_STAMP_NS + i * length_ns)
        for i, category in enumerate(categories)
    )


def write_drives(folder: Path, chosen: Sequence[Drive], force: bool, jobs: int) -> tuple[LabelledFrame, ...]:
    """Render drives into a folder: scenes.mcap and truth.json, with a progress bar. Returns the truth.

    Raises CommandError when they are there already, unless `force`.
    """
    truth_path = folder / TRUTH
    if truth_path.exists() and not force:
        raise CommandError(
            f"{truth_path} exists already: choose another folder, or add --force to replace it"
        )
    frames = [(drive, index) for drive in chosen for index in range(drive.frames)]
    truth = []
    with BagWriter(folder / BAG, force=force) as writer:
        bag = StereoBagWriter(writer, CAMERA.P_left, right_projection())
        for pair in _rendered(frames, jobs):
            bag.write(StereoImages(pair.stamp_ns, pair.left, pair.right))
            truth.append(pair.truth)
    save_truth(truth, truth_path)
    return tuple(truth)


def right_projection() -> NDArray[np.float64]:
    """Return P of the right camera, 3x4."""
    P_right = CAMERA.P_left
    P_right[0, 3] -= CAMERA.fx * CAMERA.baseline
    return P_right


def write_sheet(path: Path, chosen: Sequence[Drive], force: bool, jobs: int) -> None:
    """Write a picture with a labelled thumbnail of each drive's left camera.

    Raises CommandError when the file is there already, unless `force`, or cannot be written.
    """
    if path.exists() and not force:
        raise CommandError(f"{path} exists already: choose another name, or add --force to replace it")
    frames = [(drive, min(SHEET_FRAME, drive.frames - 1)) for drive in chosen]
    names = [drive.category for drive in chosen]
    tiles = [_thumbnail(pair.left, name) for pair, name in zip(_rendered(frames, jobs), names, strict=True)]
    tiles += [np.zeros_like(tiles[0])] * (-len(tiles) % SHEET_COLUMNS)
    rows = [np.hstack(tiles[i : i + SHEET_COLUMNS]) for i in range(0, len(tiles), SHEET_COLUMNS)]
    _, data = cv2.imencode(".png", np.vstack(rows))
    path.write_bytes(data.tobytes())


def _rendered(frames: Sequence[tuple[Drive, int]], jobs: int) -> Iterator[ScenePair]:
    with parallel_map(_render, frames, min(jobs, len(frames))) as results:
        for _, pair in progress(results, len(frames), "pair"):
            yield pair


def _render(frame: tuple[Drive, int]) -> ScenePair:
    drive, index = frame
    return drive.render(index)


def _thumbnail(image: Bytes, name: str) -> Bytes:
    height = round(SHEET_WIDTH * image.shape[0] / image.shape[1])
    small = cv2.resize(image, (SHEET_WIDTH, height), interpolation=cv2.INTER_AREA)
    (width, height), _ = cv2.getTextSize(name, cv2.FONT_HERSHEY_SIMPLEX, 0.6, 1)
    cv2.rectangle(small, (0, 0), (width + 14, height + 14), (0, 0, 0), cv2.FILLED)
    cv2.putText(small, name, (7, height + 6), cv2.FONT_HERSHEY_SIMPLEX, 0.6, (255, 255, 255), 1, cv2.LINE_AA)
    return small.astype(np.uint8, copy=False)
