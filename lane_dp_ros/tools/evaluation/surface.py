# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Judge the measured surface of the road, without any labels, by the ground that LiDAR saw."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import numpy as np

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.tools.datasets.kitti_lidar import LidarFrame, read_lidar_frames
from lane_dp_ros.tools.evaluation.annotations import LabelledFrame
from lane_dp_ros.tools.evaluation.answers import detect_pair
from lane_dp_ros.tools.evaluation.depth import depth_errors
from lane_dp_ros.tools.evaluation.evaluate import DetectorChoice, Evaluation
from lane_dp_ros.tools.evaluation.lidar_ground import fit_lidar_ground
from lane_dp_ros.tools.evaluation.scores import FrameScore
from lane_dp_ros.tools.parallel import parallel_map
from lane_dp_ros.tools.progress import progress

SEED = 0  # of the fit to LiDAR


def evaluate_surface(folder: Path, choice: DetectorChoice) -> Evaluation:
    """Measure the road's surface in every pair of a folder that has LiDAR disparity, and judge its depth.

    The scores have no lanes. Frames whose LiDAR shows no road are left out. Raises CommandError or
    ValueError, in one line, for a folder that cannot be judged.
    """
    frames, without = read_lidar_frames(folder)
    sequence = folder.resolve().name
    judge = partial(judge_surface, choice.configs[1], sequence)
    with parallel_map(judge, frames, min(choice.jobs, len(frames))) as found:
        scores = [score for _, score in progress(found, len(frames), "pair")]
    results = tuple(score for score in scores if score is not None)
    if not results:
        raise CommandError(f"{folder}: the LiDAR disparity of none of its {len(frames)} frames shows a road")
    left_out = {
        "pairs without LiDAR disparity": without,
        "frames whose LiDAR shows no road": len(frames) - len(results),
    }
    notes = tuple(f"{count} {what}, left out" for what, count in left_out.items() if count)
    return Evaluation(results, notes=notes)


def judge_surface(config: DetectorConfig, sequence: str, frame: LidarFrame) -> FrameScore | None:
    """Return how deep the surface of a pair is measured, as far as LiDAR reaches; None without a road."""
    left, right, disparity = frame.load()
    camera = frame.camera
    true = np.where(disparity > 0, disparity - camera.disparity_offset, 0)
    ground = fit_lidar_ground(true, camera, np.random.default_rng(SEED))
    if ground is None:
        return None
    name, (height, width) = f"{sequence}/{frame.name}", disparity.shape
    truth = LabelledFrame(name, camera, (width, height), ground.coefficients, (), sequence=sequence)
    answer = detect_pair(config, left, right, camera)
    errors = depth_errors(truth, answer.surface, ground.reach)
    return FrameScore(name, sequence, "", None, (), latency=answer.latency, depth=errors)
