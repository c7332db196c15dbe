# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""ROS parameter files: print every parameter, read values back."""

from __future__ import annotations

import json
import re
import textwrap
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from lane_dp_ros.core.parameter import Parameter, Value
from lane_dp_ros.messages.errors import CommandError, quoted
from lane_dp_ros.tools.parameter_yaml import load_yaml

WIDTH = 110
NODE = "lane_detector"  # whose parameters they are

Parameters = Mapping[str, Parameter]


def parameter_file(parameters: Parameters, defaults: Parameters, title: str) -> str:
    """Return the YAML text of a ROS parameter file: values of `parameters`, meaning and range as comments.

    It is headed `/**:`, for any node name: a fully qualified name would beat -p and launch arguments.
    """
    lines = [f"# {title}", "/**:", "  ros__parameters:"]
    stage = ""  # those of no stage come first: YAML cannot come back to them
    for name, parameter in sorted(parameters.items(), key=lambda item: "." in item[0]):
        if name.rpartition(".")[0] != stage:
            stage = name.rpartition(".")[0]
            lines += ["", f"    {stage}:"]
        lines += _entry(parameter, defaults[name].default, " " * (6 if stage else 4))
    return "\n".join(lines) + "\n"


def _entry(parameter: Parameter, default: Value, indent: str) -> list[str]:
    unit = f"unit {parameter.unit}" if parameter.unit else ""
    facts = "; ".join(fact for fact in (unit, parameter.allowed, f"default {_yaml(default)}") if fact)
    comment = f"{indent}# "
    text = f"{parameter.description} [{facts}]"
    lines = textwrap.wrap(text, WIDTH, initial_indent=comment, subsequent_indent=comment)
    return [*lines, f"{indent}{parameter.name.rpartition('.')[2]}: {_yaml(parameter.default)}"]


def _yaml(value: Value) -> str:
    """Return a YAML scalar; a float always has a dot, or ROS would read an integer (or a string)."""
    if not isinstance(value, float):
        return json.dumps(value)
    text = repr(value)
    return text if "." in text else re.sub(r"(?=e|$)", ".0", text, count=1)


def read_parameter_file(path: Path) -> dict[str, Any]:
    """Return the values that a ROS parameter file holds for the node, by dotted name.

    They are those of `/**` and other wildcards, then those of lane_detector in whatever namespace; in a file
    of one node alone, those of that node. Raises CommandError when the file cannot be read or is laid out
    otherwise, or for a number that ROS does not hold.
    """
    document = load_yaml(path)
    nodes = list(_nodes(document, "")) if isinstance(document, dict) else []
    ours = [values for name, values in nodes if _is_wildcard(name)]
    ours += [values for name, values in nodes if name.rpartition("/")[2] == NODE]
    if not ours and len(nodes) == 1:
        ours = [nodes[0][1]]
    if not ours and nodes:
        names = ", ".join(name for name, _ in nodes)
        raise CommandError(f"{path} is for {names[:200]}, expected parameters for {NODE} or '/**:'")
    if not ours:
        raise CommandError(f"{path} is no ROS parameter file: expected '/**:' with 'ros__parameters:' in it")
    values = {name: value for each in ours for name, value in _flat(each, "")}
    for name, value in values.items():
        if isinstance(value, int) and not -(2**63) <= value < 2**63:
            raise CommandError(
                f"{path}: {name[:100]}: {quoted(value)} has more than the 64 bits of a ROS integer"
            )
    return values


def _nodes(tree: Mapping[Any, Any], prefix: str) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """Yield the nodes of a file with their parameters; a namespace may be a level of its own."""
    for name, below in tree.items():
        if name == "ros__parameters":
            if isinstance(below, dict):
                yield prefix, below
        elif isinstance(below, dict):
            yield from _nodes(below, f"{prefix}/{str(name).strip('/')}")


def _is_wildcard(name: str) -> bool:
    return name.rpartition("/")[2] in ("*", "**")


def _flat(tree: Mapping[str, Any], prefix: str) -> Iterator[tuple[str, Any]]:
    for name, value in tree.items():
        if isinstance(value, dict):
            yield from _flat(value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", value
