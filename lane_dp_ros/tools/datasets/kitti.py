# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Stereo sequences in the folder layouts of the KITTI data sets."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from datetime import datetime, timezone
from decimal import Decimal, InvalidOperation
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.messages.errors import CommandError, one_line

if TYPE_CHECKING:
    from lane_dp_ros.messages.stereo_bag import StereoImages

PAIR_SPACING = 2_000_000_000  # ns between single pairs: more than the 1 s after which the node forgets
GRAY, COLOUR = (0, 1), (2, 3)  # numbers of KITTI's left and right cameras


@dataclass(frozen=True)
class StereoSequence:
    """The files of a stereo sequence, pair by pair; `P_left`, `P_right` are the 3x4 projection matrices."""

    left: list[Path]
    right: list[Path]
    stamps_ns: list[int]
    P_left: NDArray[np.float64]
    P_right: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.left)


def read_odometry(folder: Path) -> StereoSequence:
    """Find the pairs of a sequences/NN folder: gray image_0, image_1, or else colour image_2, image_3.

    Raises CommandError naming what was looked for, as do the other readers here.
    """
    cameras = _cameras(folder, "image_{}", "calib.txt, times.txt, and image_0, image_1 (or image_2, image_3)")
    left, right = _image_pairs([folder / f"image_{camera}" for camera in cameras])
    P_left, P_right = _projections(folder / "calib.txt", [f"P{camera}" for camera in cameras])
    stamps = _stamps(folder / "times.txt", left, _seconds_to_ns)
    return StereoSequence(left, right, stamps, P_left, P_right)


def read_raw(folder: Path) -> StereoSequence:
    """Find the pairs of a DATE_drive_NNNN_sync folder: gray image_00, image_01, or else image_02, image_03.

    Both sides get the left camera's stamps: one trigger exposes the two.
    """
    wanted = "image_00/data, image_01/data (or image_02, image_03), as in 2011_09_26_drive_0027_sync"
    cameras = _cameras(folder, "image_0{}/data", wanted)
    left, right = _image_pairs([folder / f"image_0{camera}/data" for camera in cameras])
    calibration = _calib_cam_to_cam(folder)
    P_left, P_right = _projections(calibration, [f"P_rect_0{camera}" for camera in cameras])
    stamps = _stamps(folder / f"image_0{cameras[0]}/timestamps.txt", left, _date_to_ns)
    return StereoSequence(left, right, stamps, P_left, P_right)


def read_stereo(folder: Path) -> StereoSequence:
    """Find the single pairs image_2/*_10.png, image_3/*_10.png; stamps are 2 s apart."""
    left, right = single_pairs(folder)
    P_left, P_right = colour_projections(_calib_cam_to_cam(folder))
    stamps = [index * PAIR_SPACING for index in range(len(left))]
    return StereoSequence(left, right, stamps, P_left, P_right)


def read_single_pair(left: Path, right: Path) -> StereoSequence:
    """Return one pair of a folder as `read_stereo` takes it, or with a calibration of its own.

    The official files unpack to calib_cam_to_cam/NNNNNN.txt for image_2/NNNNNN_10.png.
    """
    folder = left.parents[1]
    own = folder / "calib_cam_to_cam" / f"{left.stem.partition('_')[0]}.txt"
    P_left, P_right = colour_projections(own if own.is_file() else _calib_cam_to_cam(folder))
    return StereoSequence([left], [right], [0], P_left, P_right)


def single_pairs(folder: Path) -> tuple[list[Path], list[Path]]:
    """Return the left and right pictures image_2/*_10.png, image_3/*_10.png of a folder."""
    _cameras(folder, "image_{}", "image_2/*_10.png, image_3/*_10.png and calib_cam_to_cam.txt", (COLOUR,))
    return _image_pairs([folder / "image_2", folder / "image_3"], "*_10.png")


def colour_projections(path: Path) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the projection matrices of the colour cameras of a calib_cam_to_cam file."""
    return _projections(path, ["P_rect_02", "P_rect_03"])


LAYOUTS = {"kitti-odometry": read_odometry, "kitti-raw": read_raw, "kitti-stereo": read_stereo}


def load_pairs(sequence: StereoSequence) -> Iterator[StereoImages]:
    """Yield the pictures. Raises CommandError for a file that is no picture, or a pair of unequal sizes."""
    from lane_dp_ros.messages.stereo_bag import StereoImages

    for stamp_ns, *paths in zip(sequence.stamps_ns, sequence.left, sequence.right, strict=True):
        left, right = (_load_image(path) for path in paths)
        if left.shape != right.shape:
            raise CommandError(
                f"{paths[0]} is {_size(left)} and {paths[1]} {_size(right)}, expected equal pictures"
            )
        yield StereoImages(stamp_ns, left, right)


def _load_image(path: Path) -> NDArray[np.uint8]:
    import cv2

    image = cv2.imread(str(path), cv2.IMREAD_ANYCOLOR)
    if image is None:
        raise CommandError(f"{path} cannot be read as a picture")
    return np.asarray(image, dtype=np.uint8)


def _size(image: NDArray[np.uint8]) -> str:
    return f"{image.shape[1]}x{image.shape[0]} {'gray' if image.ndim == 2 else 'colour'}"


def _cameras(
    folder: Path, pattern: str, wanted: str, choices: tuple[tuple[int, int], ...] = (GRAY, COLOUR)
) -> tuple[int, int]:
    """Return the numbers of the left and right camera whose folders are there."""
    if not folder.is_dir():
        raise CommandError(f"{folder}: no such folder, expected one with {wanted}")
    for pair in choices:
        if all((folder / pattern.format(camera)).is_dir() for camera in pair):
            return pair
    raise CommandError(f"{folder} has no stereo images: looked for {wanted}")


def _image_pairs(sides: list[Path], pattern: str = "*.png") -> tuple[list[Path], list[Path]]:
    """Return the left and right pictures, which must bear the same names."""
    left, right = sides
    names = [sorted(path.name for path in side.glob(pattern)) for side in sides]
    if not names[0] and not names[1]:
        raise CommandError(f"no images: looked for {left / pattern} and {right / pattern}")
    if odd := sorted(set(names[0]) ^ set(names[1])):
        raise CommandError(
            f"{len(names[0])} images in {left} and {len(names[1])} in {right}, "
            f"expected the same names in both: {odd[0]} has no partner"
        )
    return [left / name for name in names[0]], [right / name for name in names[1]]


def _calib_cam_to_cam(folder: Path) -> Path:
    """Return the calibration's path: in the folder, or in its parent as KITTI's zip files unpack."""
    candidates = [place / "calib_cam_to_cam.txt" for place in (folder, folder.resolve().parent)]
    for path in candidates:
        if path.is_file():
            return path
    raise CommandError(f"no calibration: looked for {candidates[0]} and {candidates[1]}")


def _projections(path: Path, names: list[str]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return two projection matrices of a calibration file, lines "NAME: 12 numbers"."""
    entries = dict(line.split(":", 1) for line in _lines(path) if ":" in line)
    left, right = (_matrix(path, name, entries.get(name)) for name in names)
    return left, right


def _matrix(path: Path, name: str, text: str | None) -> NDArray[np.float64]:
    try:
        matrix = np.array([float(value) for value in (text or "").split()]).reshape(3, 4)
        if not np.all(np.isfinite(matrix)):
            raise ValueError
        return matrix
    except ValueError:
        came = "no such line" if text is None else f"{name}:{text.rstrip()[:60]}"
        raise CommandError(f"{path}: expected a line '{name}: ' with 12 numbers, got {came}") from None


def _stamps(path: Path, images: list[Path], to_ns: Callable[[str], int]) -> list[int]:
    """Return the stamps of the images: line by line, or, where images were taken out, by their numbers."""
    lines = [line for line in _lines(path) if line.strip()]
    numbers = list(range(len(images)))
    if len(lines) != len(images):
        numbers = [int(image.stem) if image.stem.isdecimal() else len(lines) for image in images]
    if missing := [image for image, number in zip(images, numbers, strict=True) if number >= len(lines)]:
        count = f"{len(lines)} lines, expected {len(images)}"
        raise CommandError(f"{path} has {count}: none for {missing[0].name}")
    try:
        return [to_ns(lines[number]) for number in numbers]
    except ValueError as error:
        raise CommandError(f"{path}: {error}") from None


def _seconds_to_ns(text: str) -> int:
    try:
        seconds = Decimal(text.strip())
        if not 0 <= seconds < 2**31:  # what a stamp holds
            raise ValueError
        return round(seconds * 1_000_000_000)
    except (InvalidOperation, ValueError):
        raise ValueError(f"expected seconds >= 0, got {text!r}") from None


def _date_to_ns(text: str) -> int:
    """Return the ns of a date with nanoseconds, such as "2011-09-26 13:02:25.964389445" (UTC)."""
    whole, _, fraction = text.strip().partition(".")
    try:
        seconds = datetime.strptime(whole, "%Y-%m-%d %H:%M:%S").replace(tzinfo=timezone.utc).timestamp()
        return int(seconds) * 1_000_000_000 + int(fraction.ljust(9, "0")[:9])
    except ValueError:
        raise ValueError(f"expected a date such as 2011-09-26 13:02:25.964389445, got {text!r}") from None


def _lines(path: Path) -> list[str]:
    try:
        return path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise CommandError(f"{path} cannot be read: {one_line(error)}") from None
