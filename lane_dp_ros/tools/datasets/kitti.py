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

from lane_dp_ros.messages.errors import CommandError, quoted
from lane_dp_ros.tools.datasets.kitti_calibration import (
    CameraCalibration,
    Image8,
    drive_calibration,
    sequence_calibration,
    text_lines,
)

if TYPE_CHECKING:
    from lane_dp_ros.messages.stereo_bag import StereoImages

PAIR_SPACING = 2_000_000_000  # ns between single pairs: more than the 1 s after which the node forgets
GRAY, COLOUR = (0, 1), (2, 3)  # numbers of KITTI's left and right cameras
ENDINGS = (".png", ".jpg", ".jpeg")  # of pictures; of one in several forms the first counts

Calibration = tuple[CameraCalibration, CameraCalibration]  # left and right


@dataclass(frozen=True)
class StereoSequence:
    """The files of a stereo sequence, pair by pair, each pair with its calibration."""

    left: list[Path]
    right: list[Path]
    stamps_ns: list[int]
    calibrations: list[Calibration]

    def __len__(self) -> int:
        return len(self.left)

    @property
    def P_left(self) -> NDArray[np.float64]:
        """The projection matrix (3, 4) of the first pair's left camera."""
        return self.calibrations[0][0].P

    @property
    def P_right(self) -> NDArray[np.float64]:
        """The projection matrix (3, 4) of the first pair's right camera."""
        return self.calibrations[0][1].P


def read_odometry(folder: Path) -> StereoSequence:
    """Find the pairs of a sequences/NN folder: gray image_0, image_1, or else colour image_2, image_3.

    Raises CommandError naming what was looked for, as do the other readers here.
    """
    cameras = _cameras(folder, "image_{}", "calib.txt, times.txt, and image_0, image_1 (or image_2, image_3)")
    left, right = _image_pairs([folder / f"image_{camera}" for camera in cameras])
    calibration = sequence_calibration(folder / "calib.txt", cameras)
    stamps = _stamps(folder / "times.txt", left, _seconds_to_ns)
    return StereoSequence(left, right, stamps, [calibration] * len(left))


def read_raw(folder: Path) -> StereoSequence:
    """Find the pairs of a DATE_drive_NNNN_sync folder: gray image_00, image_01, or else image_02, image_03.

    Those of a DATE_drive_NNNN_extract folder, which are not rectified, are rectified when they are loaded.
    Both sides get the left camera's stamps: one trigger exposes the two.
    """
    wanted = "image_00/data, image_01/data (or image_02, image_03), as in 2011_09_26_drive_0027_sync"
    cameras = _cameras(folder, "image_0{}/data", wanted)
    left, right = _image_pairs([folder / f"image_0{camera}/data" for camera in cameras])
    calibration = drive_calibration(_calib_cam_to_cam(folder), cameras)
    stamps = _stamps(folder / f"image_0{cameras[0]}/timestamps.txt", left, _date_to_ns)
    return StereoSequence(left, right, stamps, [calibration] * len(left))


def read_stereo(folder: Path) -> StereoSequence:
    """Find the single pairs *_10.png of the stereo benchmarks of 2015 and 2012; stamps are 2 s apart.

    2015 has image_2, image_3, and calib_cam_to_cam.txt or a folder calib_cam_to_cam with NNNNNN.txt; 2012 has
    image_0, image_1 or colored_0, colored_1, and a folder calib. `folder` may be the parent of `training`.
    """
    left, right = single_pairs(folder)
    calibrations = [_single_calibration(path) for path in left]
    stamps = [index * PAIR_SPACING for index in range(len(left))]
    return StereoSequence(left, right, stamps, calibrations)


def read_single_pair(left: Path, right: Path) -> StereoSequence:
    """Return one pair of a folder as `read_stereo` takes it."""
    return StereoSequence([left], [right], [0], [_single_calibration(left)])


def single_pairs(folder: Path) -> tuple[list[Path], list[Path]]:
    """Return the left and right pictures *_10.png of a folder as `read_stereo` takes it."""
    inner = folder / "training"
    for root in (folder, inner):
        for names in SINGLE_PAIRS:
            if all((root / name).is_dir() for name in names):
                return _image_pairs([root / name for name in names], "*_10")
    wanted = "image_2/*_10.png, image_3/*_10.png and calib_cam_to_cam (or image_0, image_1 and calib)"
    if not folder.is_dir():
        raise CommandError(f"{folder}: no such folder, expected one with {wanted}")
    raise CommandError(f"{folder} has no stereo images: looked for {wanted}")


LAYOUTS = {"kitti-odometry": read_odometry, "kitti-raw": read_raw, "kitti-stereo": read_stereo}


# Folders of the left and the right camera, and the cameras' numbers.
SINGLE_PAIRS = {
    ("image_2", "image_3"): COLOUR,
    ("image_0", "image_1"): GRAY,
    ("colored_0", "colored_1"): COLOUR,
}


def load_pairs(sequence: StereoSequence) -> Iterator[StereoImages]:
    """Yield the pictures, rectified. Raises CommandError as `load_pair` does."""
    from lane_dp_ros.messages.stereo_bag import StereoImages

    files = zip(sequence.stamps_ns, sequence.calibrations, sequence.left, sequence.right, strict=True)
    for stamp_ns, calibration, left, right in files:
        yield StereoImages(stamp_ns, *load_pair(calibration, left, right))


def load_pair(calibration: Calibration, left: Path, right: Path) -> tuple[Image8, Image8]:
    """Return two pictures, rectified, (H, W) gray or (H, W, 3) BGR.

    Raises CommandError for a file that is no picture, for unequal sizes, or sizes that are not the
    calibration's.
    """
    images = [
        camera.rectified(_load_image(path), path)
        for camera, path in zip(calibration, (left, right), strict=True)
    ]
    if images[0].shape != images[1].shape:
        raise CommandError(
            f"{left} is {_size(images[0])} and {right} {_size(images[1])}, expected equal pictures"
        )
    return images[0], images[1]


def _load_image(path: Path) -> NDArray[np.uint8]:
    import cv2

    image = cv2.imread(str(path), cv2.IMREAD_ANYCOLOR)
    if image is None:
        raise CommandError(f"{path} cannot be read as a picture")
    return np.asarray(image, dtype=np.uint8)


def _size(image: NDArray[np.uint8]) -> str:
    return f"{image.shape[1]}x{image.shape[0]} {'gray' if image.ndim == 2 else 'colour'}"


def _cameras(folder: Path, pattern: str, wanted: str) -> tuple[int, int]:
    """Return the numbers of the left and right camera whose folders are there."""
    if not folder.is_dir():
        raise CommandError(f"{folder}: no such folder, expected one with {wanted}")
    for pair in (GRAY, COLOUR):
        if all((folder / pattern.format(camera)).is_dir() for camera in pair):
            return pair
    raise CommandError(f"{folder} has no stereo images: looked for {wanted}")


def _image_pairs(sides: list[Path], pattern: str = "*") -> tuple[list[Path], list[Path]]:
    """Return the left and right pictures, which must bear the same names."""
    left, right = (_pictures(side, pattern) for side in sides)
    if not left and not right:
        looked = (side / f"{pattern}{ENDINGS[0]}" for side in sides)
        raise CommandError("no images: looked for {} and {}, or .jpg".format(*looked))
    if odd := sorted(left.keys() ^ right.keys()):
        raise CommandError(
            f"{len(left)} images in {sides[0]} and {len(right)} in {sides[1]}, "
            f"expected the same names in both: {(left | right)[odd[0]].name} has no partner"
        )
    return list(left.values()), list(right.values())


def _pictures(folder: Path, pattern: str) -> dict[str, Path]:
    """Return the pictures of a folder by their names without ending, in order; of two alike the .png."""
    found = [path for path in folder.glob(f"{pattern}.*") if path.suffix.lower() in ENDINGS]
    found.sort(key=lambda path: (path.stem, -ENDINGS.index(path.suffix.lower())))
    return {path.stem: path for path in found}


def _single_calibration(left: Path) -> Calibration:
    """Return the calibration of a single pair: its own, or in 2015 that of all."""
    folder, name = left.parents[1], f"{left.stem.partition('_')[0]}.txt"
    cameras = next(number for names, number in SINGLE_PAIRS.items() if left.parent.name in names)
    if left.parent.name != "image_2":
        return sequence_calibration(folder / "calib" / name, cameras)
    own = folder / "calib_cam_to_cam" / name
    return drive_calibration(own if own.is_file() else _calib_cam_to_cam(folder), cameras)


def _calib_cam_to_cam(folder: Path) -> Path:
    """Return the calibration's path: in the folder, or in its parent as KITTI's zip files unpack."""
    candidates = [place / "calib_cam_to_cam.txt" for place in (folder, folder.resolve().parent)]
    for path in candidates:
        if path.is_file():
            return path
    raise CommandError(f"no calibration: looked for {candidates[0]} and {candidates[1]}")


def _stamps(path: Path, images: list[Path], to_ns: Callable[[str], int]) -> list[int]:
    """Return the stamps of the images: line by line, or, where images were taken out, by their numbers."""
    lines = [line for line in text_lines(path) if line.strip()]
    numbers = list(range(len(images)))
    if len(lines) != len(images):
        numbers = [int(image.stem) if image.stem.isdecimal() else len(lines) for image in images]
    if missing := [image for image, number in zip(images, numbers, strict=True) if number >= len(lines)]:
        count = f"{len(lines)} lines, expected {len(images)}"
        raise CommandError(f"{path} has {count}: none for {missing[0].name}")
    try:
        stamps = [to_ns(lines[number]) for number in numbers]
    except ValueError as error:
        raise CommandError(f"{path}: {error}") from None
    for number, before, stamp in zip(numbers[1:], stamps, stamps[1:], strict=False):
        if stamp <= before:
            came = f"line {number + 1} is {quoted(lines[number].strip())}"
            raise CommandError(f"{path}: {came}, expected later than the line before")
    return stamps


def _seconds_to_ns(text: str) -> int:
    try:
        seconds = Decimal(text.strip())
        if not 0 <= seconds < 2**31:  # what a stamp holds
            raise ValueError
        return round(seconds * 1_000_000_000)
    except (InvalidOperation, ValueError):
        raise ValueError(f"expected seconds >= 0, got {quoted(text)}") from None


def _date_to_ns(text: str) -> int:
    """Return the ns of a date with nanoseconds, such as "2011-09-26 13:02:25.964389445" (UTC)."""
    whole, _, fraction = text.strip().partition(".")
    try:
        seconds = datetime.strptime(whole, "%Y-%m-%d %H:%M:%S").replace(tzinfo=timezone.utc).timestamp()
        return int(seconds) * 1_000_000_000 + int(fraction.ljust(9, "0")[:9])
    except ValueError:
        raise ValueError(
            f"expected a date such as 2011-09-26 13:02:25.964389445, got {quoted(text)}"
        ) from None
