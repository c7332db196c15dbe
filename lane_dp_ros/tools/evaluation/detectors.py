# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Detectors to compare: ours with a preset, the baseline, and any that a Python file brings along."""

from __future__ import annotations

import importlib.util
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path
from types import ModuleType

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lane_dp_ros.core.config import DetectorConfig, preset
from lane_dp_ros.core.detector import LaneDetector
from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.types import Lane, StereoFrame
from lane_dp_ros.messages.errors import CommandError, one_line
from lane_dp_ros.tools.evaluation import global_vanishing_point

Image8 = NDArray[np.uint8]
Detect = Callable[[Image8, Image8, StereoCamera], tuple[Lane, ...]]

WIDTH = 0.15  # m; a file's lines come without one


@dataclass(frozen=True)
class Detector:
    """A detector by its name in tables; `detect` can be sent to another process."""

    name: str
    detect: Detect


def preset_detector(name: str) -> Detector:
    """Return ours with a preset."""
    return Detector(
        "ours" if name == "default" else f"ours, {name} preset", partial(_detect_with, preset(name))
    )


def baseline_detector() -> Detector:
    """Return our reading of the detector that the paper compares itself with."""
    return Detector(global_vanishing_point.NAME, _detect_baseline)


def file_detector(path: Path) -> Detector:
    """Return the detector of a Python file: its function lanes(left, right, camera), its NAME if it has one.

    `lanes` gets uint8 images, (H, W) gray or (H, W, 3) BGR, with their StereoCamera, and returns lines (N, 3)
    [m] in the left optical frame. Raises CommandError for a file that cannot be run or has no such function.
    """
    module = _module(path)
    return Detector(str(getattr(module, "NAME", path.stem)), partial(_detect_by, path))


def _detect_with(
    config: DetectorConfig, left: Image8, right: Image8, camera: StereoCamera
) -> tuple[Lane, ...]:
    return LaneDetector(camera, config).detect(StereoFrame(left, right)).lanes


def _detect_baseline(left: Image8, right: Image8, camera: StereoCamera) -> tuple[Lane, ...]:
    return tuple(map(_lane, global_vanishing_point.lanes(left, right, camera)))


def _detect_by(path: Path, left: Image8, right: Image8, camera: StereoCamera) -> tuple[Lane, ...]:
    module = _module(path)
    try:
        return tuple(_lane(points) for points in module.lanes(left, right, camera))
    except Exception as error:
        raise CommandError(f"{path} failed: {type(error).__name__}: {one_line(error)}") from error


def _lane(line: ArrayLike) -> Lane:
    points = np.asarray(line, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 3 or not np.all(np.isfinite(points)):
        raise ValueError(f"a line has the shape {points.shape}, expected (N, 3), finite")
    return Lane(points, 1.0, WIDTH, "other", 0.0, float(points[0, 0]))


@cache
def _module(path: Path) -> ModuleType:
    """Import a Python file under a name of its own."""
    name = f"lane_dp_detector_{path.stem}"
    spec = importlib.util.spec_from_file_location(name, path)
    if not path.is_file() or spec is None or spec.loader is None:
        raise CommandError(
            f"{path} is no Python file, expected one with a function lanes(left, right, camera)"
        )
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module  # where its dataclasses look for their types
    try:
        spec.loader.exec_module(module)
    except Exception as error:
        raise CommandError(f"{path} cannot be run: {type(error).__name__}: {one_line(error)}") from error
    if not callable(getattr(module, "lanes", None)):
        raise CommandError(f"{path} has no function lanes(left, right, camera)")
    return module
