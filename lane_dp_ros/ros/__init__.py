# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The node, its parameters and diagnostics, and the player of bags. The only package that imports rclpy."""
