# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The pairs on which versions of the detector are compared, as bags; each is written once and kept."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import redirect_stdout
from dataclasses import dataclass, replace
from itertools import groupby
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray
from versions import fingerprint

from lane_dp_ros import scenes
from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.messages.bag import BagWriter
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.messages.stereo_bag import StereoBagWriter, StereoImages
from lane_dp_ros.tools import cli
from lane_dp_ros.tools.datasets.kitti import PAIR_SPACING, read_odometry
from lane_dp_ros.tools.evaluation.annotations import LabelledFrame
from lane_dp_ros.tools.evaluation.answers import read_picture
from lane_dp_ros.tools.evaluation.truth_file import load_truth
from lane_dp_ros.tools.progress import progress

Floats = NDArray[np.float64]

DRIVES = ("01", "02", "06")  # of KITTI's odometry
LABELLED, UNPAINTED, SUITE = "labelled", "06", "suite"


@dataclass(frozen=True, eq=False)
class InputBag:
    """A bag of stereo pairs, the set that it belongs to, and its frames' names by stamp [ns].

    `frames` are labelled, with their stamps in the bag; empty where nothing is known, or there is no paint.
    """

    part: str
    path: Path
    names: dict[int, str]
    frames: tuple[LabelledFrame, ...] = ()


def input_bags(data: Path, cache: Path) -> list[InputBag]:
    """Return the bags of the labelled frames, of the drives and of the standard suite of scenes."""
    drives = [drive_bag(data, name, cache) for name in DRIVES]
    return [*labelled_bags(data, cache), *drives, suite_bag(cache)]


def labelled_bags(data: Path, cache: Path) -> list[InputBag]:
    """Return a bag for each camera of the labelled frames; 2 s lie between two pairs, each is by itself."""
    truth = data / "labels" / "lanes.json"
    cameras = by_camera(load_truth(truth))
    pictures = [data / path for frames in cameras for frame in frames for path in (frame.left, frame.right)]

    def write(folder: Path) -> None:
        """Write the bags 0, 1, ..."""
        for i, frames in enumerate(cameras):
            write_frames(data, frames, folder / str(i))

    folder = _kept(cache, LABELLED, [truth, *pictures], write)
    return [_labelled(LABELLED, folder / str(i), frames) for i, frames in enumerate(cameras)]


def by_camera(frames: Iterable[LabelledFrame]) -> list[tuple[LabelledFrame, ...]]:
    """Return the frames of each camera and size of picture, their stamps 2 s apart."""

    def taken_by(frame: LabelledFrame) -> tuple[float, ...]:
        """Return what all pairs of a bag must have in common."""
        camera = frame.camera
        return (*frame.size, camera.fx, camera.fy, camera.cx, camera.cy, camera.baseline)

    groups = groupby(sorted(frames, key=taken_by), taken_by)
    return [tuple(_apart(group)) for _, group in groups]


def _apart(frames: Iterable[LabelledFrame]) -> Iterator[LabelledFrame]:
    return (replace(frame, stamp_ns=(i + 1) * PAIR_SPACING) for i, frame in enumerate(frames))


def write_frames(data: Path, frames: tuple[LabelledFrame, ...], path: Path) -> None:
    """Write the pairs of one camera as a bag."""
    with BagWriter(path) as writer:
        bag = StereoBagWriter(writer, *_projections(frames[0].camera))
        for frame in progress(frames, len(frames), "pair"):
            left, right = (read_picture(data / name) for name in (frame.left, frame.right))
            bag.write(StereoImages(frame.stamp_ns or 0, left, right))


def drive_bag(data: Path, name: str, cache: Path) -> InputBag:
    """Return the bag of a drive of KITTI's odometry, in order."""
    source = data / "kitti_odometry" / "sequences" / name
    drive = read_odometry(source)
    files = [source / "calib.txt", source / "times.txt", *drive.left, *drive.right]
    folder = _kept(
        cache, name, files, lambda part: _lane_dp("convert", "kitti-odometry", source, "-o", part / "bag")
    )
    names = {stamp: f"{name}/{left.stem}" for stamp, left in zip(drive.stamps_ns, drive.left, strict=True)}
    return InputBag(name, folder / "bag", names)


def suite_bag(cache: Path) -> InputBag:
    """Return the bag of the standard suite; it is rendered anew when the code of the scenes changes."""
    code = sorted(Path(scenes.__path__[0]).rglob("*.py"))
    folder = _kept(cache, SUITE, code, lambda part: _lane_dp("scenes", "--suite", "standard", "-o", part))
    return _labelled(SUITE, folder / "scenes.mcap", load_truth(folder / "truth.json"))


def _labelled(part: str, path: Path, frames: tuple[LabelledFrame, ...]) -> InputBag:
    return InputBag(part, path, {frame.stamp_ns or 0: frame.name for frame in frames}, frames)


def _kept(cache: Path, name: str, sources: Iterable[Path], write: Callable[[Path], None]) -> Path:
    """Return the folder that `write` filled from these sources, now or at an earlier time."""
    folder = cache / "inputs" / f"{name}-{fingerprint(sources)}"
    if not folder.exists():
        folder.parent.mkdir(parents=True, exist_ok=True)
        with TemporaryDirectory(dir=folder.parent) as temporary:
            part = Path(temporary) / name
            part.mkdir()
            write(part)
            part.rename(folder)
    return folder


def _lane_dp(*arguments: str | Path) -> None:
    """Run a command of this tree; what it prints is no part of the comparison."""
    with redirect_stdout(sys.stderr):
        if cli.main([*map(str, arguments)]):
            raise CommandError(f"lane_dp {arguments[0]} failed")


def _projections(camera: StereoCamera) -> tuple[Floats, Floats]:
    P_left, P_right = camera.P_left, camera.P_left
    P_right[0, 3] -= camera.fx * camera.baseline
    return P_left, P_right
