# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Every parameter of the lane pipeline, stage by stage, and the two presets."""

from __future__ import annotations

from dataclasses import dataclass, field

from lane_dp_ros.core.parameter import Parameters, Value, parameter, replaced


@dataclass(frozen=True)
class DisparityConfig(Parameters):
    """The stereo matcher; names and meaning as in stereo_image_proc (semi-global block matching)."""

    disparity_range: int = parameter(
        128,
        "Number of disparities searched; bounds the nearest depth.",
        unit="px",
        limits=(32, 1024),
        step=32,
    )
    correlation_window_size: int = parameter(
        7, "Side of the matched window, odd.", unit="px", limits=(1, 31), step=2
    )
    P1: int = parameter(400, "Penalty on disparity changes of 1 px.", limits=(0, 4000))
    P2: int = parameter(1600, "Penalty on larger disparity changes, more than P1.", limits=(1, 16000))
    uniqueness_ratio: int = parameter(  # OpenCV divides by 100 less this
        10, "How much the best match must beat the second.", unit="%", limits=(0, 99)
    )
    speckle_size: int = parameter(
        100, "Smaller patches of disparity are invalid.", unit="px", limits=(0, 1000)
    )
    downscale: int = parameter(
        2, "Match at 1/downscale of the image's resolution; 2 takes a tenth of the time.", limits=(1, 4)
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        _check_order(self, "disparity", "P1", "P2")


@dataclass(frozen=True)
class RoadProfileConfig(Parameters):
    """The road's surface from the disparity."""

    roll: bool = parameter(True, "Fit the road's cross slope, too.")
    camera_height: float = parameter(
        1.65,
        "Camera above the road; the measured one is within a factor of 1.4. Serves where none is measured.",
        unit="m",
        limits=(0.3, 5.0),
    )
    camera_pitch: float = parameter(
        0.0, "Camera looks down on the road; serves where none is measured.", unit="rad", limits=(-0.3, 0.3)
    )
    residual_threshold: float = parameter(
        1.0, "Disparities farther from the surface do not belong to it.", unit="px", limits=(0.2, 5.0)
    )


@dataclass(frozen=True)
class VanishingPointConfig(Parameters):
    """The road's direction from the edges on it."""

    method: str = parameter(
        "arc",
        "arc: heading and curvature of the road's axis by voting; dense: the paper's quartic u_vp(v).",
        choices=("arc", "dense"),
    )
    centred_principal_point: bool = parameter(
        False, "Pitch and yaw by the paper's formula, which takes the image's middle for the principal point."
    )
    heading_max: float = parameter(
        0.5, "Largest angle between road and vehicle; for arc.", unit="rad", limits=(0.1, 0.8)
    )
    curvature_max: float = parameter(
        0.05, "Sharpest bend, 1/radius; for arc.", unit="1/m", limits=(0.005, 0.1)
    )


@dataclass(frozen=True)
class BirdsEyeConfig(Parameters):
    """The piece of road that is looked at, in road coordinates."""

    near: float = parameter(4.0, "Where the view begins, ahead of the camera.", unit="m", limits=(0.0, 20.0))
    length: float = parameter(30.0, "Length of the view along the road.", unit="m", limits=(10.0, 100.0))
    width: float = parameter(16.0, "Width of the view, half to each side.", unit="m", limits=(4.0, 40.0))
    forward_resolution: float = parameter(0.25, "Cell length.", unit="m", limits=(0.02, 1.0))
    lateral_resolution: float = parameter(0.05, "Cell width.", unit="m", limits=(0.01, 0.2))
    height_tolerance: float = parameter(
        0.12, "What stands higher above the road's surface is not road.", unit="m", limits=(0.02, 1.0)
    )


@dataclass(frozen=True)
class PaintMapConfig(Parameters):
    """How much each cell of the bird's-eye view looks like paint, f in [0, 1]; its cost is 1 - f."""

    feature: str = parameter(
        "bands",
        "bands: contrast of a bright band against both sides; edges_and_grey: the paper's w_e f_e + w_g f_g.",
        choices=("bands", "edges_and_grey"),
    )
    edge_weight: float = parameter(
        0.6,
        "w_e, the share of the edges in f; the rest, w_g, is grey; for edges_and_grey.",
        limits=(0.0, 1.0),
    )
    contrast_min: float = parameter(
        0.35, "Contrast of no paint, in units of the road's texture; for bands.", limits=(0.0, 10.0)
    )
    contrast_max: float = parameter(
        2.8, "Contrast of certain paint, in units of the road's texture; for bands.", limits=(0.1, 20.0)
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        _check_order(self, "paint_map", "contrast_min", "contrast_max")


@dataclass(frozen=True)
class PathSearchConfig(Parameters):
    """The search for paths through the graph."""

    free_ends: bool = parameter(
        True,
        "Paths start and end where the paint does and remember their slope; else the paper's Algorithm 2.",
    )
    max_paths: int = parameter(12, "At most so many candidates.", limits=(1, 50))
    suppression: float = parameter(
        0.3, "Half width of the band closed around a path that was found.", unit="m", limits=(0.1, 2.0)
    )
    min_score: float = parameter(
        1.5, "Metres of paint that make a candidate; for free ends.", unit="m", limits=(0.5, 20.0)
    )
    blank_cost: float = parameter(
        0.14, "Metres of paint that a metre of blank road costs; for free ends.", limits=(0.01, 1.0)
    )
    neighbours: int = parameter(
        3, "k, columns by which a path may move from row to row; for Algorithm 2.", limits=(1, 10)
    )
    smoothness: float = parameter(
        2.0, "lambda, cost of moving by j columns is lambda j^2; for Algorithm 2.", limits=(0.0, 100.0)
    )
    max_mean_cost: float = parameter(
        0.65, "epsilon, mean cost along a path that ends the search; for Algorithm 2.", limits=(0.0, 1.0)
    )


@dataclass(frozen=True)
class LaneModelConfig(Parameters):
    """The smooth line through a path."""

    model: str = parameter(
        "cubic",
        "cubic: robust cubic through the centres of the paint; parabola: the paper's parabola by RANSAC.",
        choices=("cubic", "parabola"),
    )
    residual_threshold: float = parameter(
        0.1, "Points of the path nearer to the parabola are inliers.", unit="m", limits=(0.01, 1.0)
    )
    min_inliers: float = parameter(0.6, "Share of inliers that makes a parabola a lane.", limits=(0.0, 1.0))
    max_trials: int = parameter(100, "RANSAC samples.", limits=(10, 1000))


@dataclass(frozen=True)
class LaneSelectionConfig(Parameters):
    """What makes a line a lane."""

    evidence: bool = parameter(True, "Judge lines by their evidence; else every line of the model is a lane.")
    paint_width_max: float = parameter(0.36, "Broader bands are no lane lines.", unit="m", limits=(0.1, 1.0))
    height_max: float = parameter(
        0.05, "Greatest height above the ground beside it; more is a kerb.", unit="m", limits=(0.0, 1.0)
    )
    slope_max: float = parameter(
        0.11, "Steepest lateral over forward on a straight road.", limits=(0.01, 1.0)
    )
    texture_max: float = parameter(
        0.2, "Texture over brightness of the ground beside the line; more is grass.", limits=(0.01, 1.0)
    )
    contrast_min: float = parameter(
        0.1,
        "Weber contrast of the paint against the road on both sides; in glare less will do.",
        limits=(-1.0, 1.0),
    )
    start_max: float = parameter(22.0, "Farthest beginning of a line.", unit="m", limits=(5.0, 100.0))
    score_min: float = parameter(
        1.9, "Net metres of paint of a line beside another one.", unit="m", limits=(0.5, 20.0)
    )
    score_alone: float = parameter(
        3.0, "Net metres of paint of a line by itself.", unit="m", limits=(0.5, 30.0)
    )
    lane_width_min: float = parameter(2.5, "Narrowest lane.", unit="m", limits=(1.0, 4.0))
    lane_width_max: float = parameter(4.3, "Widest lane.", unit="m", limits=(2.0, 8.0))

    def __post_init__(self) -> None:
        super().__post_init__()
        _check_order(self, "lane_selection", "lane_width_min", "lane_width_max")


@dataclass(frozen=True)
class TrackingConfig(Parameters):
    """Lines over time."""

    enabled: bool = parameter(True, "Smooth lines, bridge short losses, steady the axis; else give ids only.")
    coast_time: float = parameter(
        0.5, "How long a lost line is published where it must be by now.", unit="s", limits=(0.0, 0.5)
    )


@dataclass(frozen=True)
class DetectorConfig(Parameters):
    """All stages of the lane pipeline."""

    disparity: DisparityConfig = field(default_factory=DisparityConfig)
    road_profile: RoadProfileConfig = field(default_factory=RoadProfileConfig)
    vanishing_point: VanishingPointConfig = field(default_factory=VanishingPointConfig)
    birds_eye: BirdsEyeConfig = field(default_factory=BirdsEyeConfig)
    paint_map: PaintMapConfig = field(default_factory=PaintMapConfig)
    path_search: PathSearchConfig = field(default_factory=PathSearchConfig)
    lane_model: LaneModelConfig = field(default_factory=LaneModelConfig)
    lane_selection: LaneSelectionConfig = field(default_factory=LaneSelectionConfig)
    tracking: TrackingConfig = field(default_factory=TrackingConfig)
    seed: int = parameter(0, "Seed of the random samples: same frame, same lanes.", limits=(0, 2**31 - 1))


PRESETS = ("default", "paper")

PAPER: dict[str, Value] = {
    "road_profile.roll": False,
    "vanishing_point.method": "dense",
    "vanishing_point.centred_principal_point": True,
    "birds_eye.near": 0.0,
    "birds_eye.width": 12.0,
    "birds_eye.forward_resolution": 1 / 15,
    "paint_map.feature": "edges_and_grey",
    "path_search.free_ends": False,
    "path_search.suppression": 1.0,
    "lane_model.model": "parabola",
    "lane_model.residual_threshold": 5**0.5 * 0.05,  # t_r = 5 px^2 at 20 px/m
    "lane_selection.evidence": False,
    "tracking.enabled": False,
}


def preset(name: str) -> DetectorConfig:
    """Return the configuration of that name: "default", or "paper" (the paper's numbers and formulas).

    Raises ValueError for another name.
    """
    if name not in PRESETS:
        raise ValueError(f"preset {name!r}: expected one of {', '.join(PRESETS)}")
    return replaced(DetectorConfig(), PAPER if name == "paper" else {})


def _check_order(config: object, stage: str, lower: str, upper: str) -> None:
    low, high = getattr(config, lower), getattr(config, upper)
    if high <= low:
        raise ValueError(f"{stage}.{upper}: got {high}, expected more than {lower} = {low}")
