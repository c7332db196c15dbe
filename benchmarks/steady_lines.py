# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""How steady the published lines of KITTI's odometry 01 and 02 are from frame to frame, by their ids.

python benchmarks/steady_lines.py DATA
DATA: the labelled KITTI frames. Their labels are 0.4 s apart or more, too far to tell jitter; what the node
publishes for all pairs in order is not. A line's own motion counts, too: on the ramp of 01 it is no straight
line over five frames.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable

import numpy as np
from command_line import exit_code, parser_of
from study_runner import drive_pairs

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.pipeline import LanePipeline
from lane_dp_ros.core.types import Lane
from lane_dp_ros.tools.evaluation.assignment import JITTER_DEPTH
from lane_dp_ros.tools.evaluation.stability import JITTER_FRAMES, deviations

DRIVES = ("01", "02")


def jitters(frames: Iterable[Iterable[Lane]]) -> list[float]:
    """Return, for each id in five frames on end, the deviation [m] of x at 10 m from a straight line."""
    places = [
        {lane.id: np.interp(JITTER_DEPTH, lane.points[:, 2], lane.points[:, 0]) for lane in lanes
         if lane.extent[0] <= JITTER_DEPTH <= lane.extent[1]}
        for lanes in frames
    ]  # fmt: skip
    windows = [places[i : i + JITTER_FRAMES] for i in range(len(places) - JITTER_FRAMES + 1)]
    of_windows = [
        deviations(
            np.array([[place[i] for i in common] for place in window]), np.arange(float(JITTER_FRAMES))
        )
        for window in windows
        if (common := sorted(set(window[0]).intersection(*window[1:])))
    ]
    return [float(deviation) for of_window in of_windows for deviation in of_window]


def run(arguments: argparse.Namespace) -> None:
    """Follow the drives, and print."""
    config, everything = DetectorConfig(), []
    for name in DRIVES:
        pipeline = LanePipeline(monitored=False)
        frames = [pair.followed(config, pipeline).lanes for pair in drive_pairs(arguments.data, name)]
        of_drive = jitters(frames)
        everything += of_drive
        ids = {lane.id for lanes in frames for lane in lanes}
        print(
            f"{name}: {len(frames)} frames, {len(ids)} ids, "
            f"jitter {np.mean(of_drive):.4f} m over {len(of_drive)} times five frames"
        )
    print(f"all: jitter {np.mean(everything):.4f} m")


def main() -> int:
    """Follow and print; 1 for a known error, in one line."""
    return exit_code(run, parser_of(__doc__).parse_args())


if __name__ == "__main__":
    sys.exit(main())
