# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The command line lane_dp: one file a command, their shared arguments, and what runs them."""

from lane_dp_ros.tools.cli.main import main

__all__ = ["main"]
