# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The node's parameters in ROS: declared with meaning, unit and range, and changeable while it runs."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor, SetParametersResult
from rclpy.node import Node
from rclpy.parameter import Parameter as RosParameter

from lane_dp_ros.core.parameter import Parameter, Value
from lane_dp_ros.messages.node_config import (
    REMOVED,
    NodeConfig,
    all_parameters,
    configs,
    current_name,
    is_of_ros,
    with_current_names,
)


def descriptor(spec: Parameter) -> ParameterDescriptor:
    """Return what ROS tools show of a parameter, and the range that rclpy itself keeps to."""
    unit = f" [{spec.unit}]" if spec.unit else ""
    described = ParameterDescriptor(
        description=spec.description + unit, additional_constraints=spec.allowed.capitalize()
    )
    if spec.minimum is None or spec.maximum is None:
        return described
    if spec.type is int:
        # To rclpy, too, a step counts from the range's lower end, and 0 means any value.
        described.integer_range = [
            IntegerRange(from_value=int(spec.minimum), to_value=int(spec.maximum), step=int(spec.step))
        ]
    else:
        described.floating_point_range = [
            FloatingPointRange(from_value=float(spec.minimum), to_value=float(spec.maximum), step=0.0)
        ]
    return described


class LiveParameters:
    """The parameters of a node, always as two configs whose values are checked together.

    `on_change(before, after)` is called with the node's own config after each change. Raises ValueError
    when the values that the node was started with are wrong. `node` must be one that declares what it is
    started with (automatically_declare_parameters_from_overrides): names that nobody knows are logged.
    """

    def __init__(self, node: Node, on_change: Callable[[NodeConfig, NodeConfig], None]) -> None:
        self._on_change = on_change
        given = _given(node)
        known = all_parameters(expert=True)
        self._specs = {name: spec for name, spec in known.items() if not spec.expert or name in given}
        self._values = {
            name: _declared(node, spec, given.get(name, spec.default)) for name, spec in self._specs.items()
        }
        self.node_config, self.detector_config = configs(self._values)
        node.add_pre_set_parameters_callback(self._whole_numbers_to_floats)
        node.add_on_set_parameters_callback(self._check)
        node.add_post_set_parameters_callback(self._take)

    def _with(self, changes: list[RosParameter]) -> dict[str, Value]:
        return self._values | {change.name: change.value for change in changes if change.name in self._values}

    def _whole_numbers_to_floats(self, changes: list[RosParameter]) -> list[RosParameter]:
        """Take 1 for 1.0, which ROS would refuse."""
        floats = {name for name, spec in self._specs.items() if spec.type is float}
        return [
            RosParameter(change.name, value=float(change.value))
            if change.name in floats and change.type_ is RosParameter.Type.INTEGER
            else change
            for change in changes
        ]

    def _check(self, changes: list[RosParameter]) -> SetParametersResult:
        try:
            configs(self._with(changes))
        except ValueError as error:
            return SetParametersResult(successful=False, reason=str(error))
        return SetParametersResult(successful=True)

    def _take(self, changes: list[RosParameter]) -> None:
        before = self.node_config
        self._values = self._with(changes)
        self.node_config, self.detector_config = configs(self._values)
        if self.node_config != before:
            self._on_change(before, self.node_config)


def _given(node: Node) -> dict[str, Any]:
    """Return the values that the user gave, by the parameters' names of today.

    They were declared by rclpy without meaning and range, and no longer are. Logs old names, and those that
    ROS would ignore without a word: a name may be misspelt.
    """
    values = {name: each.value for name, each in node.get_parameters_by_prefix("").items()}
    given, renamed = with_current_names({n: value for n, value in values.items() if not is_of_ros(n)})
    known = all_parameters(expert=True)
    for warning in renamed:
        node.get_logger().warning(f"Parameter {warning}")
    if unknown := [name for name in given if name not in known]:
        node.get_logger().warning(
            f"Parameters that this node does not have are ignored: {', '.join(unknown)}"
        )
    for name in values:
        if current_name(name) in known or name in REMOVED:
            node.undeclare_parameter(name)
    return given


def _declared(node: Node, spec: Parameter, value: Any) -> Value:
    """Declare a parameter with meaning and range; return its value."""
    checked = spec.checked(value)
    node.declare_parameter(spec.name, checked, descriptor(spec), ignore_override=True)
    return checked
