# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What to detect with: a preset, and a ROS parameter file on top of it."""

from __future__ import annotations

import sys
from pathlib import Path

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.messages.node_config import (
    NodeConfig,
    all_parameters,
    configs,
    is_of_ros,
    with_current_names,
)
from lane_dp_ros.tools.parameter_file import read_parameter_file


def load_config(preset: str, path: Path | None) -> tuple[NodeConfig, DetectorConfig]:
    """Return the preset with the values of a ROS parameter file, if any, on top.

    What `ros2 param dump` writes of ROS's own parameters is left out.
    Raises CommandError or ValueError naming what is wrong in the file.
    """
    values = {name: parameter.default for name, parameter in all_parameters(preset).items()}
    given = read_parameter_file(path) if path else {}
    given, renamed = with_current_names({n: value for n, value in given.items() if not is_of_ros(n)})
    for warning in renamed:
        print(f"lane_dp: {path}: {warning}", file=sys.stderr)
    try:
        return configs({**values, **given})
    except ValueError as error:
        raise CommandError(f"{path}: {error}") from None
