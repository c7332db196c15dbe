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
from lane_dp_ros.messages.errors import CommandError, one_line

WIDTH = 110

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
    """Return the values of a ROS parameter file by dotted name, whatever node it is headed with.

    Raises CommandError when the file cannot be read or is laid out otherwise.
    """
    document = _loaded(path)
    nodes = list(document.values()) if isinstance(document, dict) else []
    values = nodes[0].get("ros__parameters") if len(nodes) == 1 and isinstance(nodes[0], dict) else None
    if not isinstance(values, dict):
        raise CommandError(f"{path} is no ROS parameter file: expected '/**:' with 'ros__parameters:' in it")
    return dict(_flat(values, ""))


def _loaded(path: Path) -> Any:
    import yaml  # only this needs it

    try:
        return yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        raise CommandError(f"{path} cannot be read: {one_line(error)}") from None


def _flat(tree: Mapping[str, Any], prefix: str) -> Iterator[tuple[str, Any]]:
    for name, value in tree.items():
        if isinstance(value, dict):
            yield from _flat(value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", value
