# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""How a message is made: `make(type_name, **fields)`, the fields that are not named having their defaults.

Messages come in duck-typed and go out through such a function, so that the same conversions serve rclpy's
messages (`lane_dp_ros.ros.rclpy_message.rclpy_message`) and those of the rosbags library
(`lane_dp_ros.messages.bag_message.bag_message`).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

Make = Callable[..., Any]
