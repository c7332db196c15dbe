# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Why ROS or a node does not start: arguments, parameters, names and environment that are wrong."""

from __future__ import annotations

import re

from rclpy.exceptions import NameValidationException, ParameterException

from lane_dp_ros.messages.errors import one_line

START_ERRORS = (RuntimeError, ValueError, ParameterException, NameValidationException)


def start_reason(error: Exception) -> str:
    """Return the reason in one line, without the places in its C sources that rcl names."""
    return re.sub(r", at /\S+:\d+", "", one_line(error))
