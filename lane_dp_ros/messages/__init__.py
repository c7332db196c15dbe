# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Shared by node and tools: ROS messages to arrays and back, bags, pictures. Nothing here imports ROS."""
