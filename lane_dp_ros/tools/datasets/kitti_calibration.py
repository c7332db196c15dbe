# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""KITTI's calibration files: lines "NAME: numbers", of a drive or of a single pair."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.messages.errors import CommandError, one_line, quoted

Floats = NDArray[np.float64]
Image8 = NDArray[np.uint8]


@dataclass(frozen=True, eq=False)
class CameraCalibration:
    """One rectified camera: P (3, 4), its images' size (width, height), and how to rectify them.

    `size` is None where the file does not say it; `raw_size`, K (3, 3), D (5,) and R (3, 3) are those of the
    camera itself, where the file has them.
    """

    P: Floats
    size: tuple[int, int] | None = None
    raw_size: tuple[int, int] | None = None
    distortion: tuple[Floats, Floats, Floats] | None = None

    def rectified(self, image: Image8, path: Path) -> Image8:
        """Return an image as it is, or one of the archive `_extract` rectified.

        Raises CommandError for an image of another size than the calibration's.
        """
        came = (image.shape[1], image.shape[0])
        if self.size is None or came == self.size:
            return image
        if came == self.raw_size and self.distortion is not None:
            import cv2

            return np.asarray(cv2.remap(image, *self._maps, cv2.INTER_LINEAR), dtype=np.uint8)
        wanted = " or ".join(_size(size) for size in (self.size, self.raw_size) if size)
        raise CommandError(f"{path} is {_size(came)}, its calibration is of {wanted}")

    @cached_property
    def _maps(self) -> tuple[Any, Any]:
        import cv2

        assert self.distortion is not None
        assert self.size is not None
        K, D, R = self.distortion
        return cv2.initUndistortRectifyMap(K, D, R, self.P[:, :3], self.size, cv2.CV_32FC1)


def drive_calibration(path: Path, cameras: tuple[int, int]) -> tuple[CameraCalibration, CameraCalibration]:
    """Return the left and right camera of a calib_cam_to_cam file: P_rect_00, S_rect_00 and so on.

    Raises CommandError, as does `sequence_calibration`, naming the line that is missing or no numbers.
    """
    lines = _Lines(path)
    left, right = (_drive_camera(lines, f"{camera:02}") for camera in cameras)
    return left, right


def sequence_calibration(path: Path, cameras: tuple[int, int]) -> tuple[CameraCalibration, CameraCalibration]:
    """Return the left and right camera of a calib file of rectified images: P0, P1 and so on."""
    lines = _Lines(path)
    left, right = (CameraCalibration(lines.matrix(f"P{camera}", (3, 4))) for camera in cameras)
    return left, right


def text_lines(path: Path) -> list[str]:
    """Return the lines of a text file, whatever system wrote it. Raises CommandError for what is no text."""
    try:
        return path.read_text(encoding="utf-8-sig").splitlines()  # Windows' editors begin it with a mark
    except (OSError, UnicodeDecodeError) as error:
        raise CommandError(f"{path} cannot be read: {one_line(error)}") from None


class _Lines:
    """The lines "NAME: numbers" of a file by their names."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._texts = dict(line.split(":", 1) for line in text_lines(path) if ":" in line)

    def __contains__(self, name: str) -> bool:
        return name in self._texts

    def matrix(self, name: str, shape: tuple[int, ...]) -> Floats:
        """Return the finite numbers of a line, row by row in a `shape`; raise CommandError for others."""
        text, count = self._texts.get(name), int(np.prod(shape))
        try:
            matrix = np.array([float(value) for value in (text or "").split()]).reshape(shape)
            if not np.all(np.isfinite(matrix)):
                raise ValueError
            return matrix
        except ValueError:
            came = "no such line" if text is None else f"{name}: {quoted(text.strip())[1:-1]}"
            wanted = f"expected a line '{name}: ' with {count} numbers"
            raise CommandError(f"{self._path}: {wanted}, got {came}") from None

    def size(self, name: str) -> tuple[int, int] | None:
        """Return the width and height [px] of a line, None where there is no such line."""
        if name not in self:
            return None
        width, height = self.matrix(name, (2,))
        return int(width), int(height)


def _drive_camera(lines: _Lines, number: str) -> CameraCalibration:
    P = lines.matrix(f"P_rect_{number}", (3, 4))
    distortion = None
    if all(f"{name}_{number}" in lines for name in ("K", "D", "R_rect")):
        K, R = (lines.matrix(f"{name}_{number}", (3, 3)) for name in ("K", "R_rect"))
        distortion = (K, lines.matrix(f"D_{number}", (5,)), R)
    return CameraCalibration(P, lines.size(f"S_rect_{number}"), lines.size(f"S_{number}"), distortion)


def _size(size: tuple[int, int]) -> str:
    return f"{size[0]}x{size[1]}"
