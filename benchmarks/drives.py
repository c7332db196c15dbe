# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Which labelled KITTI frames are of one drive: what is left out together when something is fitted."""

from __future__ import annotations

from study_runner import JudgedPair

from lane_dp_ros.messages.errors import CommandError

# First and last number of the frames of stereo 2015 on one road, by their numbers and by what is seen.
STEREO_DRIVES = (
    ("7-16 (junctions)", 7, 16),
    ("22-31 (dual carriageway)", 22, 31),
    ("57", 57, 57),
    ("72-81 (multi-lane)", 72, 81),
    ("89", 89, 89),
    ("112", 112, 112),
    ("119-126 (gutters)", 119, 126),
    ("144-148 (city)", 144, 148),
)


def drive_of(pair: JudgedPair) -> str:
    """Return the drive that a labelled pair is of: a sequence, or the road that it shares with others.

    A frame among those of one road is of that road, whatever its label calls it: none may serve a fit that
    its neighbours are judged by. Raises CommandError for a frame of stereo 2015 of no known drive.
    """
    if pair.sequence != "kitti_stereo_2015":
        return pair.sequence
    number = int(pair.name.rpartition("/")[2].partition("_")[0])
    for name, first, last in STEREO_DRIVES:
        if first <= number <= last:
            return f"stereo 2015, {name}"
    if pair.truth is None or not pair.truth.drive:
        raise CommandError(f"{pair.name} is of no known drive: its label names none, nor does STEREO_DRIVES")
    return f"stereo 2015, {pair.truth.drive}"
