# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The node's parameters: described, checked, and taken into use while it runs."""

import pytest
from rclpy.parameter import Parameter

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.parameter import parameters
from lane_dp_ros.messages.node_config import NodeConfig, all_parameters, configs


def set_one(rig, name, value):
    return rig.node.set_parameters([Parameter(name, value=value)])[0]


def test_configs_hold_the_values_given():
    node, detector = configs({"sync_tolerance": 0.02, "disparity.P2": 9000})
    assert (node.sync_tolerance, node.image_transport, detector.disparity.P2) == (0.02, "raw", 9000)
    assert configs({}) == (NodeConfig(), DetectorConfig())
    with pytest.raises(ValueError, match=r"disparity.P3: no such parameter"):
        configs({"disparity.P3": 1})


def test_all_parameters_have_the_presets_values():
    assert not set(parameters(NodeConfig())) & set(parameters(DetectorConfig()))
    assert all_parameters("paper")["vanishing_point.method"].default == "dense"
    assert all_parameters("paper").keys() == all_parameters().keys()
    with pytest.raises(ValueError, match="preset 'x': expected one of default, paper"):
        all_parameters("x")


def test_every_parameter_is_described_with_unit_and_range(rig):
    for name, spec in all_parameters().items():
        described = rig.node.describe_parameter(name)
        assert described.description.startswith(spec.description)
        assert (f"[{spec.unit}]" in described.description) == bool(spec.unit)
        assert not described.read_only and not described.dynamic_typing
        ranges = [*described.integer_range, *described.floating_point_range]
        assert [(r.from_value, r.to_value) for r in ranges] == (
            [] if spec.minimum is None else [(spec.minimum, spec.maximum)]
        )
        assert all(choice in described.additional_constraints for choice in spec.choices)
        assert rig.node.get_parameter(name).value == spec.default


@pytest.mark.parametrize(
    ("name", "value", "reason"),
    [
        ("sync_tolerance", 0.6, "sync_tolerance out of range"),
        ("sync_tolerance", float("nan"), "sync_tolerance"),
        ("sync_tolerance", "much", "Wrong parameter type"),
        ("disparity.correlation_window_size", 4, "step: 2"),
        ("disparity.P1", 4000, ", expected more than P1 = 4000"),
        ("image_transport", "theora", "image_transport: got 'theora', expected one of raw, compressed"),
    ],
)
def test_what_is_refused_says_why_and_changes_nothing(rig, name, value, reason):
    before = rig.node.get_parameter(name).value
    result = set_one(rig, name, value)
    assert not result.successful
    assert reason in result.reason
    assert rig.node.get_parameter(name).value == before


def test_a_whole_number_is_taken_for_a_float(make_rig):
    rig = make_rig(parameter_overrides=[Parameter("lane_lifetime", value=2)])
    assert rig.node.get_parameter("lane_lifetime").value == 2.0
    assert set_one(rig, "lane_lifetime", 1).successful
    assert rig.node.get_parameter("lane_lifetime").type_ is Parameter.Type.DOUBLE
    rig.assert_lives()
    assert rig.arrays[0].markers[1].lifetime.sec == 1


def test_the_tolerance_is_taken_into_use(rig, scene_pair):
    def send_apart(late_ns):
        stamp_ns = rig.next_stamp()
        rig.image_publishers["left"].publish(rig.image(scene_pair[0], stamp_ns))
        rig.image_publishers["right"].publish(rig.image(scene_pair[1], stamp_ns + late_ns))
        return stamp_ns

    rig.send_infos()
    too_far = send_apart(30_000_000)
    assert rig.answer(send_apart(9_000_000))  # so the two before them were looked at
    assert set_one(rig, "sync_tolerance", 0.05).successful
    assert rig.answer(send_apart(30_000_000))
    assert rig.answers(too_far) == []


def test_a_detector_parameter_rebuilds_the_detector(rig):
    rig.send_infos()
    farthest = max(lane.points[-1, 2] for lane in rig.answer(rig.send()))
    assert farthest > 20
    assert set_one(rig, "birds_eye.length", 12.0).successful
    nearer = rig.answer(rig.send())
    assert nearer and all(lane.points[-1, 2] < 18 for lane in nearer)


def test_values_that_only_go_together_can_be_given_together(make_rig):
    both = [Parameter("disparity.P1", value=900), Parameter("disparity.P2", value=1000)]
    rig = make_rig(parameter_overrides=both)
    changed = [Parameter("disparity.P1", value=2000), Parameter("disparity.P2", value=3000)]
    assert not rig.node.set_parameters(changed[:1])[0].successful
    assert rig.node.set_parameters_atomically(changed).successful
    rig.assert_lives()


def test_a_value_under_an_old_name_counts(make_rig):
    rig = make_rig(parameter_overrides=[Parameter("tracking.bridge_time", value=0.3)])
    assert rig.node.get_parameter("tracking.coast_time").value == 0.3
    assert not rig.node.has_parameter("tracking.bridge_time")


REMOVED = {  # with the values that they had
    "disparity.disparity_range": 128,
    "disparity.downscale": 2,
    "road_profile.roll": True,
    "road_profile.residual_threshold": 1.0,
    "lane_selection.score_min": 1.9,
    "lane_selection.texture_max": 0.2,
}


def test_parameters_that_are_no_more_are_left_out_with_a_warning(make_rig, capfd):
    rig = make_rig(parameter_overrides=[Parameter(name, value=value) for name, value in REMOVED.items()])
    said = capfd.readouterr().err
    for name in REMOVED:
        assert not rig.node.has_parameter(name)
        assert said.count(f"Parameter {name} is no more, left out: ") == 1
    assert "ignored" not in said  # they are not taken for misspelt names
    assert all(rig.node.get_parameter(name).value == spec.default for name, spec in all_parameters().items())
    rig.assert_lives()
