# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""When the image pairs of a bag were recorded."""

from __future__ import annotations

from collections.abc import Mapping

from lane_dp_ros.messages.bag import BagReader
from lane_dp_ros.messages.stamp import stamp_from_ros
from lane_dp_ros.messages.stereo_sync import Side


def image_arrivals(reader: BagReader, topics: Mapping[Side, list[str]]) -> dict[int, int]:
    """Return, for each stamp [ns] of a left image, when the later one of its pair was recorded [ns]."""
    arrivals = {
        stamp_from_ros(message.header.stamp): time_ns
        for _, time_ns, message in reader.messages(topics["left"])
    }
    for _, time_ns, message in reader.messages(topics["right"]):
        stamp_ns = stamp_from_ros(message.header.stamp)
        if stamp_ns in arrivals:
            arrivals[stamp_ns] = max(arrivals[stamp_ns], time_ns)
    return arrivals
