# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Make rclpy's messages by name."""

from __future__ import annotations

import array
import importlib
from functools import cache
from typing import Any

import numpy as np


def rclpy_message(type_name: str, **fields: Any) -> Any:
    """Return a message such as ``rclpy_message("std_msgs/msg/String", data="x")``; the rest has defaults.

    uint8 arrays become what rclpy keeps, an array.array: assigning the numpy array itself takes a thousand
    times as long, because rclpy then looks at every value.
    """
    return _message_class(type_name)(**{name: _field(value) for name, value in fields.items()})


@cache
def _message_class(type_name: str) -> Any:
    package, _, name = type_name.split("/")
    return getattr(importlib.import_module(f"{package}.msg"), name)


def _field(value: Any) -> Any:
    return array.array("B", value.astype(np.uint8).tobytes()) if isinstance(value, np.ndarray) else value
