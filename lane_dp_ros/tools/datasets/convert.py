# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""A data set's sequence as a bag with the topics that the node subscribes to."""

from __future__ import annotations

from lane_dp_ros.messages.bag import BagWriter
from lane_dp_ros.messages.stereo_bag import StereoBagWriter
from lane_dp_ros.tools.datasets.kitti import StereoSequence, load_pairs
from lane_dp_ros.tools.progress import progress


def convert(sequence: StereoSequence, writer: BagWriter, jpeg: bool = False) -> None:
    """Write a sequence to an open bag, with a progress bar."""
    pairs = zip(load_pairs(sequence), sequence.calibrations, strict=True)
    for pair, (left, right) in progress(pairs, len(sequence), "pair"):
        StereoBagWriter(writer, left.P, right.P, jpeg).write(pair)
