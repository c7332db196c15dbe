# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""A data set's sequence as a bag with the topics that the node subscribes to."""

from __future__ import annotations

from lane_dp_ros.messages.bag import BagWriter
from lane_dp_ros.messages.stereo_bag import StereoBagWriter
from lane_dp_ros.tools.datasets.kitti import StereoSequence, load_pairs
from lane_dp_ros.tools.progress import progress

CAMERA_HEIGHT = 1.65  # m above the road, of KITTI's cameras (Geiger et al., IJRR 2013)


def convert(sequence: StereoSequence, writer: BagWriter, jpeg: bool = False) -> None:
    """Write a sequence to an open bag, with a progress bar."""
    stereo = StereoBagWriter(writer, sequence.P_left, sequence.P_right, jpeg, CAMERA_HEIGHT)
    pairs = zip(load_pairs(sequence), sequence.calibrations, strict=True)
    for pair, (left, right) in progress(pairs, len(sequence), "pair"):
        stereo.P_left, stereo.P_right = left.P, right.P
        stereo.write(pair)
