# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Labelled pairs in a mirror and at other exposures, and of a rig whose principal points are apart."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
from study_runner import JudgedPair

from lane_dp_ros.core.types import StereoFrame
from lane_dp_ros.tools.evidence_fit.variations import GAMMAS, exposed, mirrored, resized

__all__ = ["GAMMAS", "apart", "exposed", "mirrored", "resized", "varied"]


def varied(pairs: Iterable[JudgedPair]) -> list[JudgedPair]:
    """Return each pair in a mirror and at other exposures; the names tell."""
    return [each for pair in pairs for each in (mirrored(pair), *(exposed(pair, gamma) for gamma in GAMMAS))]


def apart(pair: JudgedPair, offset: int) -> JudgedPair:
    """Return a pair whose principal points are `offset` px apart: the right picture is moved, and cut off."""
    left, right = pair.frame.left, pair.frame.right
    assert right is not None
    moved = np.zeros_like(right)
    taken, given = (slice(max(0, side), min(0, side) or None) for side in (offset, -offset))
    moved[:, given] = right[:, taken]
    camera = replace(pair.camera, disparity_offset=pair.camera.disparity_offset + offset)
    name = f"{pair.name} ({offset:+d} px apart)"
    truth = None if pair.truth is None else replace(pair.truth, name=name)
    return replace(pair, name=name, frame=StereoFrame(left, moved), camera=camera, truth=truth)
