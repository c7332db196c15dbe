# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The pipeline's parameters: each complete, and the paper's numbers in the paper's preset."""

import pytest

from lane_dp_ros.core.birdseye.birds_eye import _grid
from lane_dp_ros.core.config import DetectorConfig, preset
from lane_dp_ros.core.parameter import parameters, replaced
from lane_dp_ros.core.presets import PRESETS
from lane_dp_ros.core.road.disparity import DisparityConfig
from lane_dp_ros.core.road.road_profile import RoadProfileConfig

ALL = parameters(DetectorConfig())
# What an expert or a fit should touch only; ROS tools do not list them.
EXPERT = {
    "path_search": ("slope_max", "slope_cost", "bend_cost", "separation_min", "passes"),
    "lane_selection": ("paint_width_max", "wide_band_ratio_max", "height_max", "unknown_height_slope_max"),
    "extension": ("gap_max", "turn_max"),
    "parallel": (
        "contrast_min",
        "contrast_max",
        "blank_cost",
        "score_min",
        "lane_width_min",
        "lane_width_max",
        "ego_max",
    ),
    "stop_line": ("unpainted_min", "rise_min"),
    "axis_refinement": ("slope_min", "score_min"),
    "tracking": ("hits_min", "heading_deviation_max", "new_beside", "merge_distance", "confidence_decay"),
}
PAPER = {  # section V and VI of the paper; resolution and band as in the authors' program
    "paint_map.feature": "edges_and_grey",
    "paint_map.edge_weight": 0.6,
    "path_search.smoothness": 2.0,
    "path_search.neighbours": 3,
    "path_search.suppression": 1.0,
    "birds_eye.length": 30.0,
    "birds_eye.width": 12.0,
    "lane_model.model": "parabola",
    "vanishing_point.method": "dense",
    "vanishing_point.centred_principal_point": True,
    "road_profile.model": "quadratic",
}


@pytest.mark.parametrize("spec", ALL.values(), ids=ALL)
def test_every_parameter_has_a_sentence_and_bounds_that_hold_its_default(spec):
    assert spec.description[0].isalpha()
    assert spec.description.endswith(".")
    assert spec.type in (bool, str) or spec.allowed
    assert spec.checked(spec.default) == spec.default


@pytest.mark.parametrize("name", PRESETS)
def test_a_preset_is_within_its_own_bounds(name):
    specs = parameters(preset(name))
    assert {n: spec.checked(spec.default) for n, spec in specs.items()} == {
        n: spec.default for n, spec in specs.items()
    }


def test_what_an_expert_should_touch_only_is_marked():
    expert = {name for name, spec in ALL.items() if spec.expert}
    assert expert == {f"{stage}.{field}" for stage, fields in EXPERT.items() for field in fields}
    assert list(parameters(DetectorConfig(), expert=False)) == [name for name in ALL if name not in expert]


def test_expert_parameters_can_be_replaced_as_others_can():
    config = replaced(DetectorConfig(), {"parallel.score_min": 8.0, "lane_selection.height_max": 0.2})
    assert (config.parallel.score_min, config.lane_selection.height_max) == (8.0, 0.2)


def test_the_default_preset_is_the_default():
    assert preset("default") == DetectorConfig()


def test_the_paper_preset_has_the_papers_numbers():
    specs = parameters(preset("paper"))
    assert {name: specs[name].default for name in PAPER} == PAPER


def test_the_paper_preset_has_its_threshold_in_cells_and_its_size_of_view():
    config = preset("paper")
    cell = config.birds_eye.lateral_resolution
    assert (config.lane_model.residual_threshold / cell) ** 2 == pytest.approx(5)  # t_r, px^2
    assert cell == pytest.approx(1 / 20)
    assert [len(axis) for axis in _grid(config.birds_eye)] == [450, 240]  # 15 and 20 px/m


def test_an_unknown_preset_is_refused():
    with pytest.raises(ValueError, match="preset 'papers': expected one of default, paper"):
        preset("papers")


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"disparity.P1": 500, "disparity.P2": 500}, "disparity.P2: got 500, expected more than P1 = 500"),
        (
            {"paint_map.contrast_min": 2.8},
            "paint_map.contrast_max: got 2.8, expected more than contrast_min = 2.8",
        ),
        (
            {"parallel.lane_width_min": 3.0, "parallel.lane_width_max": 2.5},
            "parallel.lane_width_max: got 2.5, expected more than lane_width_min = 3.0",
        ),
        (
            {"parallel.contrast_min": 1.5},
            "parallel.contrast_max: got 1.4, expected more than contrast_min = 1.5",
        ),
    ],
)
def test_values_that_contradict_one_another_are_refused(values, message):
    with pytest.raises(ValueError, match=message):
        replaced(DetectorConfig(), values)


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: DisparityConfig(P1=-1), "DisparityConfig.P1: got -1, expected 0 to 4000"),
        (lambda: DisparityConfig(P1=500, P2=500), "disparity.P2: got 500, expected more than P1 = 500"),
        (
            lambda: RoadProfileConfig(camera_height=0.0),
            "RoadProfileConfig.camera_height: got 0.0, expected 0.3",
        ),
        (lambda: DetectorConfig(seed=-1), "DetectorConfig.seed: got -1, expected 0 to"),
    ],
)
def test_a_config_that_is_built_directly_is_checked_as_well(build, message):
    with pytest.raises(ValueError, match=message):
        build()
