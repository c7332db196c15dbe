# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Whether a line is paint by its own evidence, and if not, why: here kerbs, verges and rails are refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from lane_dp_ros.core.lanes.candidate import LaneEvidence, LaneLine
from lane_dp_ros.core.lanes.selection import LaneSelectionConfig


def refusal(line: LaneLine, evidence: LaneEvidence, config: LaneSelectionConfig, bend: float) -> str:
    """Return why a line is no paint, by itself; empty where it has the evidence. `bend` [1/m]: the road's."""
    bright = (
        evidence.contrast >= config.contrast_min
        or evidence.saturation_contrast >= config.saturation_contrast_min
    )
    slope_max = config.slope_max + config.slope_per_bend * abs(bend)
    reasons = (
        (not evidence.paint_width <= config.paint_width_max, f"{evidence.paint_width:.2f} m broad"),
        (not evidence.wide_band_ratio <= config.wide_band_ratio_max, "as bright beside as on it"),
        (not bright, f"contrast {evidence.contrast:.2f}"),
        # NaN, an unknown height, speaks for and against nothing.
        (evidence.height > config.height_max, f"{evidence.height:.2f} m above the road"),
        (not evidence.slope <= slope_max, f"slope {evidence.slope:.2f}"),
        (
            not evidence.off_paint_fraction <= config.off_paint_fraction_max,
            f"beside its paint for {evidence.off_paint_fraction:.0%}",
        ),
        (not evidence.texture <= config.texture_max, f"texture {evidence.texture:.2f} beside it"),
        (not line.s[0] <= config.start_max, f"begins at {line.s[0]:.0f} m"),
    )
    return next((reason for fails, reason in reasons if fails), "") or kerb_sign(evidence, config)


def is_pale(evidence: LaneEvidence, config: LaneSelectionConfig) -> bool:
    """Return whether a stripe is as pale as kerbs are."""
    return (
        evidence.contrast < config.kerb_contrast_max
        and evidence.saturation_contrast < config.kerb_saturation_contrast_max
    )


def kerb_sign(evidence: LaneEvidence, config: LaneSelectionConfig) -> str:
    """Return what a pale stripe has of a kerb, a gutter, a rail or a verge; empty for nothing."""
    if not is_pale(evidence, config):
        return ""
    # Of dashes, which glare makes dim and broad, width, height and brightness say nothing.
    unbroken = evidence.longest_segment >= config.unbroken_min
    signs = (
        (evidence.kerb_step > config.kerb_step_min, f"kerb: a step of {evidence.kerb_step:.2f} m behind it"),
        (evidence.height < -config.kerb_step_min, f"gutter: {-evidence.height:.2f} m below the road"),
        (unbroken and not config.rail_width_max <= evidence.paint_width, "rail: narrow and unbroken"),
        (unbroken and not evidence.paint_width <= config.kerb_width_min, "kerb: broad and unbroken"),
        (unbroken and evidence.height > config.kerb_height_min, f"kerb: {evidence.height:.2f} m high"),
        (unbroken and evidence.brightness < config.kerb_brightness_max, "kerb: darker than the lane"),
    )
    return next((sign for holds, sign in signs if holds), "")


def needs_height(line: LaneLine, evidence: LaneEvidence, config: LaneSelectionConfig) -> bool:
    """Return whether a line is paint by all that is known without its heights, but for its course."""
    unknown = replace(evidence, height=np.nan, kerb_step=0.0)
    return is_paint_but_for_course(line, unknown, config)


def is_paint_but_for_course(line: LaneLine, evidence: LaneEvidence, config: LaneSelectionConfig) -> bool:
    """Return whether a line is paint by all but where it leads: steeply, or past its paint."""
    return not refusal(line, replace(evidence, slope=0.0, off_paint_fraction=0.0), config, bend=0.0)
